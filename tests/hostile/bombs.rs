//! Small files that unpack to large ones.

use std::io::{Cursor, Write};

use flate2::Compression;
use flate2::write::{DeflateEncoder, GzEncoder, ZlibEncoder};
use umbravox::io::ReadOptions;

use super::seeds::{META, NRRD};
use super::{Scratch, limited, refuse};

/// What the bombs unpack to.
const MIB: usize = 200;

fn blow_up(mut to: impl Write) {
    let zeros = vec![0; 1 << 20];
    for _ in 0..MIB {
        to.write_all(&zeros).unwrap();
    }
}

fn zlib_bomb() -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    blow_up(&mut encoder);
    encoder.finish().unwrap()
}

fn gzip_bomb(start: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(start).unwrap();
    blow_up(&mut encoder);
    encoder.finish().unwrap()
}

/// With small limits and with those of the program.
fn refuse_both(name: &str, bytes: &[u8], words: &[&str]) {
    assert!(bytes.len() < MIB << 11, "{name} is small: {}", bytes.len());
    let scratch = Scratch::new();
    let path = scratch.file(name, bytes);
    for options in [limited(), ReadOptions::default()] {
        refuse(&path, &options, words);
    }
}

#[test]
fn archives() {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("a.dcm", zip::write::SimpleFileOptions::default())
        .unwrap();
    blow_up(&mut zip);
    let zip = zip.finish().unwrap().into_inner();
    refuse_both("bomb.zip", &zip, &["unpacks to more"]);
    refuse_both("bomb.npz", &zip, &["unpacks to more"]);

    let mut header = tar::Header::new_ustar();
    header.set_path("a.dcm").unwrap();
    header.set_size((MIB << 20) as u64);
    header.set_cksum();
    let tar = gzip_bomb(header.as_bytes());
    refuse_both("bomb.tar.gz", &tar, &["unpacks to more"]);
}

/// More data than the voxels need: read up to them and a little further, and no more.
#[test]
fn data_behind_the_voxels() {
    let scratch = Scratch::new();
    let header = [NRRD.as_bytes(), b"gzip\n\n"].concat();
    let meta = [
        META.as_bytes(),
        b"CompressedData = True\nElementDataFile = LOCAL\n",
    ]
    .concat();
    for (name, bytes) in [
        ("tail.nrrd", [header, gzip_bomb(b"")].concat()),
        ("tail.mha", [meta, zlib_bomb()].concat()),
    ] {
        let path = scratch.file(name, &bytes);
        let _ = super::judge(&path, &limited(), "zeros without end");
    }
}

/// Deflated DICOM objects unpack whole before they are parsed.
#[test]
fn deflated_dicom() {
    let mut object = vec![0; 128];
    object.extend(b"DICM");
    let syntax = b"1.2.840.10008.1.2.1.99";
    let mut meta = vec![2, 0, 0x10, 0, b'U', b'I', syntax.len() as u8, 0];
    meta.extend(syntax);
    object.extend([2, 0, 0, 0, b'U', b'L', 4, 0]);
    object.extend((meta.len() as u32).to_le_bytes());
    object.extend(meta);
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::best());
    // One value of unlimited text, as long as all that follows.
    deflated
        .write_all(&[0x10, 0, 0, 0x40, b'U', b'T', 0, 0])
        .unwrap();
    deflated
        .write_all(&((MIB << 20) as u32).to_le_bytes())
        .unwrap();
    blow_up(&mut deflated);
    object.extend(deflated.finish().unwrap());
    let scratch = Scratch::new();
    let path = scratch.file("bomb.dcm", &object);
    refuse(&path, &limited(), &["deflated", "limit"]);
}

/// A picture of 16384 x 16384 pixels in a few kilobytes, twice.
#[test]
fn pictures() {
    let chunk = |name: &[u8; 4], data: &[u8]| {
        let crc = crc(&[name, data].concat());
        [
            &(data.len() as u32).to_be_bytes(),
            name.as_slice(),
            data,
            &crc.to_be_bytes(),
        ]
        .concat()
    };
    let size = 16384u32.to_be_bytes();
    let head = [&size, &size, [8, 0, 0, 0, 0].as_slice()].concat();
    let png = [
        b"\x89PNG\r\n\x1a\n".to_vec(),
        chunk(b"IHDR", &head),
        chunk(b"IDAT", &zlib_bomb()),
        chunk(b"IEND", b""),
    ]
    .concat();
    let scratch = Scratch::new();
    scratch.file("stack/1.png", &png);
    scratch.file("stack/2.png", &png);
    refuse(&scratch.0.path().join("stack"), &limited(), &[]);
}

fn crc(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// Sequences inside sequences, deeper than any object has them, must not exhaust the stack; nor must elements of XML.
#[test]
fn nesting() {
    let mut bytes = vec![0; 128];
    bytes.extend(b"DICM");
    let syntax = b"1.2.840.10008.1.2.1\0";
    let mut meta = vec![2, 0, 0x10, 0, b'U', b'I', syntax.len() as u8, 0];
    meta.extend(syntax);
    bytes.extend([2, 0, 0, 0, b'U', b'L', 4, 0]);
    bytes.extend((meta.len() as u32).to_le_bytes());
    bytes.extend(meta);
    for _ in 0..200_000 {
        bytes.extend([
            0x08, 0, 0x15, 0x11, b'S', b'Q', 0, 0, 0xff, 0xff, 0xff, 0xff,
        ]);
        bytes.extend([0xfe, 0xff, 0x00, 0xe0, 0xff, 0xff, 0xff, 0xff]);
    }
    let scratch = Scratch::new();
    refuse(&scratch.file("deep.dcm", &bytes), &limited(), &["deep.dcm"]);
    let open = "<VTKFile type=\"ImageData\">".to_owned() + &"<A>".repeat(200_000);
    refuse(
        &scratch.file("deep.vti", open.as_bytes()),
        &limited(),
        &["deep.vti"],
    );
}
