//! Good files of every format, small: what is done to them is done to all.

use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::{GzEncoder, ZlibEncoder};
use umbravox::io::ReadOptions;
use umbravox::scene::RawDescription;

use super::{Scratch, limited};

const SIZE: [u32; 3] = [3, 4, 5];

/// A file, and those that it needs beside it.
pub(crate) struct Seed {
    /// Names and contents; the first is the one that is opened.
    pub(crate) files: Vec<(String, Vec<u8>)>,
    pub(crate) raw: Option<RawDescription>,
}

impl Seed {
    pub(crate) fn name(&self) -> &str {
        &self.files[0].0
    }

    pub(crate) fn options(&self) -> ReadOptions<'static> {
        ReadOptions {
            raw: self.raw.clone(),
            ..limited()
        }
    }

    /// Writes all files into a folder of their own.
    pub(crate) fn write(&self, scratch: &Scratch) -> PathBuf {
        let folder = self.name().replace('.', "_");
        for (name, bytes) in &self.files {
            scratch.file(&format!("{folder}/{name}"), bytes);
        }
        scratch.0.path().join(folder).join(self.name())
    }

    fn one(name: &str, bytes: Vec<u8>) -> Self {
        Self {
            files: vec![(name.to_owned(), bytes)],
            raw: None,
        }
    }
}

/// 60 values of big-endian u16.
fn data() -> Vec<u8> {
    (0..60u16)
        .flat_map(|i| (5 + 1000 * i).to_be_bytes())
        .collect()
}

pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

pub(crate) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn gunzip(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    MultiGzDecoder::new(bytes).read_to_end(&mut plain).unwrap();
    plain
}

pub(crate) const NRRD: &str = "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 3 4 5\nspace: RAS\n\
    space directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (1,2,3)\nendian: big\nencoding: ";
pub(crate) const META: &str = "ObjectType = Image\nNDims = 3\nDimSize = 3 4 5\n\
    ElementType = MET_USHORT\nElementByteOrderMSB = True\nElementSpacing = 1 2 3\n\
    TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 4 5 6\n";

/// Text headers with every coding, built here: their headers are read by people, and altered field by field.
pub(crate) fn text_headers() -> Vec<Seed> {
    let data = data();
    // A number that is cut can still be a number: only one of one digit at the very end cannot.
    let ascii = ("12345 ".repeat(59) + "7").into_bytes();
    let hex: String = data.iter().map(|b| format!("{b:02X}")).collect();
    let local = "ElementDataFile = LOCAL\n";
    let packed = "CompressedData = True\nElementDataFile = LOCAL\n";
    let attached = |name: &str, head: &str, rest: &str, data: &[u8]| {
        Seed::one(name, [head.as_bytes(), rest.as_bytes(), data].concat())
    };
    let detached = |name: &str, head: &str, rest: &str| Seed {
        files: vec![
            (name.to_owned(), [head, rest].concat().into_bytes()),
            ("x.raw".to_owned(), data.clone()),
        ],
        raw: None,
    };
    vec![
        attached("raw.nrrd", NRRD, "raw\n\n", &data),
        attached("gzip.nrrd", NRRD, "gzip\n\n", &gzip(&data)),
        attached("ascii.nrrd", NRRD, "ascii\n\n", &ascii),
        attached("hex.nrrd", NRRD, "hex\n\n", hex.as_bytes()),
        attached("raw.mha", META, local, &data),
        attached("zlib.mha", META, packed, &zlib(&data)),
        detached("data.nhdr", NRRD, "raw\ndata file: x.raw"),
        detached("data.mhd", META, "ElementDataFile = x.raw"),
    ]
}

/// Headerless data, plain and packed.
fn described() -> Vec<Seed> {
    let raw: RawDescription = serde_json::from_value(serde_json::json!(
        { "size": SIZE, "type": "u16", "spacing": [1, 2, 3], "endian": "big" }
    ))
    .unwrap();
    [("a.raw", data()), ("a.raw.gz", gzip(&data()))]
        .map(|(name, bytes)| Seed {
            raw: Some(raw.clone()),
            ..Seed::one(name, bytes)
        })
        .into()
}

/// What other libraries wrote.
fn independent() -> Vec<Seed> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let read = |path: &Path| std::fs::read(path).unwrap();
    let mut seeds = Vec::new();
    let mut formats: Vec<PathBuf> = std::fs::read_dir(data.join("formats"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file() && path.extension().is_none_or(|e| e != "json"))
        .collect();
    formats.sort();
    for path in formats {
        let name = path.file_name().unwrap().to_str().unwrap();
        seeds.push(Seed::one(name, read(&path)));
    }
    let nifti = data.join("geometry/nifti");
    for name in ["big_endian.nii", "two.nii", "scaled.nii"] {
        let packed = read(&nifti.join(name).with_extension("nii.gz"));
        seeds.push(Seed::one(name, gunzip(&packed)));
    }
    for (folder, names) in [
        ("nifti", ["pair.hdr", "pair.img"]),
        ("metaimage", ["detached.mhd", "detached.zraw"]),
        ("nrrd", ["detached.nhdr", "detached.raw"]),
    ] {
        let file = |name: &str| {
            let path = data.join("geometry").join(folder).join(name);
            (name.to_owned(), read(&path))
        };
        seeds.push(Seed {
            files: names.map(file).into(),
            raw: None,
        });
    }
    seeds
}

/// Every seed.
pub(crate) fn all() -> Vec<Seed> {
    let mut seeds = text_headers();
    seeds.extend(described());
    seeds.extend(independent());
    assert!(seeds.len() > 40, "{}", seeds.len());
    seeds
}
