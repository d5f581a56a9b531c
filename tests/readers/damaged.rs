//! Files that are cut short, altered byte by byte, or claim what they cannot hold.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use umbravox::io::{Limits, ReadOptions, read};
use umbravox::scene::{Endian, RawDescription, RawType};

use super::nifti::Nifti;
use super::{Kind, Scratch, assert_refused, gzip, zlib};

const NRRD: &str = "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 3 4 5\nendian: big\nencoding: ";
const META: &str = "ObjectType = Image\nNDims = 3\nDimSize = 3 4 5\nElementType = MET_USHORT\n\
                    ElementByteOrderMSB = True\nElementSpacing = 1 2 3\n";

/// A small file of every format and coding. `None` for detached data: the file is the header, kept last.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let data = Kind::U16.data(true);
    let join = |head: &str, coding: &str, data: &[u8]| {
        [head, coding]
            .concat()
            .into_bytes()
            .into_iter()
            .chain(data.iter().copied())
            .collect::<Vec<u8>>()
    };
    // A number that is cut can still be a number: only one of one digit at the very end cannot.
    let ascii = "12345 ".repeat(59) + "7";
    let hex: String = data.iter().map(|b| format!("{b:02X}")).collect();
    let nifti = Nifti::new(false, true, Kind::U16).with(&data);
    let nifti2 = Nifti::new(true, true, Kind::U16).with(&data);
    vec![
        ("raw.nrrd", join(NRRD, "raw\n\n", &data)),
        ("gzip.nrrd", join(NRRD, "gzip\n\n", &gzip(&data))),
        ("ascii.nrrd", join(NRRD, "ascii\n\n", ascii.as_bytes())),
        ("hex.nrrd", join(NRRD, "hex\n\n", hex.as_bytes())),
        ("one.nii", nifti.clone()),
        ("one.nii.gz", gzip(&nifti)),
        ("two.nii", nifti2.clone()),
        ("two.nii.gz", gzip(&nifti2)),
        ("raw.mha", join(META, "ElementDataFile = LOCAL\n", &data)),
        (
            "zlib.mha",
            join(
                META,
                "CompressedData = True\nElementDataFile = LOCAL\n",
                &zlib(&data),
            ),
        ),
        ("data.nhdr", join(NRRD, "raw\ndata file: x.raw", b"")),
        ("data.mhd", join(META, "ElementDataFile = x.raw", b"")),
    ]
}

fn sample_file(scratch: &Scratch, name: &str, bytes: &[u8]) -> PathBuf {
    scratch.file("x.raw", &Kind::U16.data(true));
    scratch.file(name, bytes)
}

#[test]
fn cut_at_every_byte() {
    let scratch = Scratch::new();
    for (name, bytes) in samples() {
        read(
            &sample_file(&scratch, name, &bytes),
            &ReadOptions::default(),
        )
        .unwrap();
        for len in 0..bytes.len() {
            let path = scratch.file(name, &bytes[..len]);
            assert_refused(&path, &ReadOptions::default(), &[name]);
        }
    }
}

#[test]
fn detached_data_cut_at_every_byte() {
    let scratch = Scratch::new();
    let data = Kind::U16.data(true);
    let pair = Nifti::new(false, true, Kind::U16).paired();
    let nrrd = scratch.file(
        "a.nhdr",
        [NRRD, "raw\ndata file: a.img"].concat().as_bytes(),
    );
    let meta = scratch.file(
        "a.mhd",
        [META, "ElementDataFile = a.img\n"].concat().as_bytes(),
    );
    let nifti = scratch.file("a.hdr", &pair.bytes[..348]);
    for len in 0..=data.len() {
        let image = scratch.file("a.img", &data[..len]);
        for path in [&nrrd, &meta, &nifti, &image] {
            if len == data.len() {
                read(path, &ReadOptions::default()).unwrap();
            } else {
                assert_refused(
                    path,
                    &ReadOptions::default(),
                    &["a.img", &format!("has {len}")],
                );
            }
        }
    }
    for len in 0..348 {
        let header = scratch.file("a.hdr", &pair.bytes[..len]);
        assert_refused(&header, &ReadOptions::default(), &["a.hdr"]);
    }
}

#[test]
fn described_data_cut_at_every_byte() {
    let scratch = Scratch::new();
    let data = Kind::U16.data(true);
    let options = ReadOptions {
        raw: Some(RawDescription {
            size: super::SIZE,
            voxel_type: RawType::U16,
            spacing: [1.0; 3],
            endian: Endian::Big,
            offset: 0,
        }),
        ..ReadOptions::default()
    };
    for (name, bytes) in [("a.raw.gz", gzip(&data)), ("a.raw", data)] {
        read(&scratch.file(name, &bytes), &options).unwrap();
        for len in 0..bytes.len() {
            assert_refused(&scratch.file(name, &bytes[..len]), &options, &[name]);
        }
    }
}

/// Whatever one byte becomes, the file is read or refused as bad input, and its data stay below the limits.
#[test]
fn altered_at_every_byte() {
    let scratch = Scratch::new();
    let options = ReadOptions {
        limits: Limits {
            max_voxels: 1 << 16,
            max_bytes: 1 << 18,
            max_header_bytes: 1 << 12,
            ..Limits::default()
        },
        ..ReadOptions::default()
    };
    for (name, mut bytes) in samples() {
        sample_file(&scratch, name, &bytes);
        for at in 0..bytes.len() {
            let original = bytes[at];
            for altered in [
                0,
                1,
                0x7f,
                0x80,
                0xff,
                b'9',
                b'-',
                b'\n',
                original ^ 1,
                original ^ 0x20,
            ] {
                bytes[at] = altered;
                match read(&scratch.file(name, &bytes), &options) {
                    Ok(volume) => assert!(volume.voxels().len() <= 1 << 16),
                    Err(error) => assert!(error.is_bad_input(), "{name} at {at}: {error}"),
                }
            }
            bytes[at] = original;
        }
    }
}

#[track_caller]
fn assert_refused_at_once(path: &Path, options: &ReadOptions<'_>, words: &[&str]) {
    let start = Instant::now();
    assert_refused(path, options, words);
    assert!(
        start.elapsed() < Duration::from_millis(500),
        "{:?}",
        start.elapsed()
    );
}

#[test]
fn terabytes_in_a_kilobyte() {
    let scratch = Scratch::new();
    let unlimited = ReadOptions {
        limits: Limits {
            max_voxels: u64::MAX,
            max_bytes: u64::MAX,
            max_header_bytes: u64::MAX,
            ..Limits::default()
        },
        ..ReadOptions::default()
    };
    let mut nifti = Nifti::new(true, true, Kind::U16);
    for axis in 1..4 {
        nifti.bytes[16 + 8 * axis..24 + 8 * axis].copy_from_slice(&20_000i64.to_be_bytes());
    }
    let nifti = nifti.with(&[0; 400]);
    let packed = gzip(&[0; 100_000]);
    let claim = |(name, bytes): (&'static str, Vec<u8>)| {
        let text = String::from_utf8_lossy(&bytes);
        if !text.contains("3 4 5") {
            return None;
        }
        let at = text.find("3 4 5")?;
        let claimed = [&bytes[..at], b"20000 20000 20000", &bytes[at + 5..]].concat();
        Some((name, claimed))
    };
    let mut files: Vec<(&str, Vec<u8>)> = samples().into_iter().filter_map(claim).collect();
    assert_eq!(files.len(), 8, "the text headers");
    files.push(("claim.nii", nifti.clone()));
    files.push(("claim.nii.gz", gzip(&nifti)));
    files.push((
        "bomb.nrrd",
        [
            NRRD.replace("3 4 5", "20000 20000 20000").as_bytes(),
            b"gzip\n\n",
            &packed,
        ]
        .concat(),
    ));
    for (name, bytes) in files {
        let path = sample_file(&scratch, name, &bytes);
        assert!(bytes.len() < 1100, "{name} has {} bytes", bytes.len());
        assert_refused_at_once(
            &path,
            &ReadOptions::default(),
            &[name, "8000000000000 voxels", "limits"],
        );
        let data = if name.starts_with("data.") {
            "x.raw"
        } else {
            name
        };
        assert_refused_at_once(
            &path,
            &unlimited,
            &[data, "16000000000000 bytes", "cut short"],
        );
    }
}
