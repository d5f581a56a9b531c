//! Small files that claim to be large: refused before anything is allocated, whatever the limits are.

use umbravox::io::{Limits, ReadOptions};

use super::seeds::{self, META, NRRD, gzip};
use super::{Scratch, limited, refuse};

/// As if all the memory in the world were there.
fn unlimited() -> ReadOptions<'static> {
    ReadOptions {
        limits: Limits {
            max_voxels: u64::MAX,
            max_bytes: u64::MAX,
            max_header_bytes: u64::MAX,
            max_archive_bytes: u64::MAX,
            max_files: usize::MAX,
        },
        ..ReadOptions::default()
    }
}

/// Refused with small limits, with those of the program, and with none.
fn refuse_all(name: &str, bytes: &[u8]) {
    let scratch = Scratch::new();
    // A plain name: a detached header's data must be there.
    scratch.file("x.raw", &[1; 120]);
    let path = scratch.file(name, bytes);
    for options in [limited(), ReadOptions::default(), unlimited()] {
        refuse(&path, &options, &[]);
    }
}

/// Sizes whose product is too much, or more than can be counted.
const SIZES: [[u64; 3]; 5] = [
    [20_000; 3],
    [4_294_967_295; 3],
    [1 << 32, 2, 2],
    [1 << 21, 1 << 21, 1 << 22],
    [3_037_000_500, 3_037_000_500, 2],
];

#[test]
fn text_headers() {
    for [x, y, z] in SIZES {
        for seed in seeds::text_headers() {
            let text = String::from_utf8_lossy(&seed.files[0].1).into_owned();
            let at = text.find("3 4 5").unwrap();
            let bytes = &seed.files[0].1;
            let claim = format!("{x} {y} {z}");
            let bytes = [&bytes[..at], claim.as_bytes(), &bytes[at + 5..]].concat();
            refuse_all(seed.name(), &bytes);
        }
    }
}

/// Volumes counted by a fourth axis, and bytes to skip.
#[test]
fn further_axes_and_skips() {
    let more = |from: &str, to: &str| NRRD.replace(from, to) + "raw\n\n";
    for text in [
        more("sizes: 3 4 5", "sizes: 3 4 5 18446744073709551615")
            .replace("dimension: 3", "dimension: 4"),
        more("endian", "byte skip: 18446744073709551615\nendian"),
        more("endian", "byte skip: -9223372036854775808\nendian"),
        more("endian", "line skip: 18446744073709551615\nendian"),
    ] {
        refuse_all("a.nrrd", &[text.as_bytes(), &[1; 120]].concat());
    }
    for line in [
        "HeaderSize = 18446744073709551615",
        "HeaderSize = 9223372036854775807",
        "HeaderSize = -9",
    ] {
        let text = format!("{META}{line}\nElementDataFile = LOCAL\n");
        refuse_all("a.mha", &[text.as_bytes(), &[1; 120]].concat());
    }
}

fn seed(name: &str) -> Vec<u8> {
    let all = seeds::all();
    let seed = all.iter().find(|seed| seed.name() == name);
    seed.unwrap_or_else(|| panic!("no seed {name}")).files[0]
        .1
        .clone()
}

#[test]
fn nifti() {
    for sizes in [[32_767i16; 3], [32_767, 32_767, 2]] {
        let mut bytes = seed("scaled.nii");
        for (axis, size) in sizes.into_iter().enumerate() {
            bytes[42 + 2 * axis..44 + 2 * axis].copy_from_slice(&size.to_le_bytes());
        }
        refuse_all("claim.nii", &bytes);
        refuse_all("claim.nii.gz", &gzip(&bytes));
    }
    for size in [20_000i64, i64::MAX, -1, 1 << 32] {
        let mut bytes = seed("two.nii");
        for axis in 0..3 {
            bytes[24 + 8 * axis..32 + 8 * axis].copy_from_slice(&size.to_le_bytes());
        }
        refuse_all("claim.nii", &bytes);
    }
    for offset in [f32::MAX, f32::NAN, -1.0, 1e9] {
        let mut bytes = seed("scaled.nii");
        bytes[108..112].copy_from_slice(&offset.to_le_bytes());
        refuse_all("claim.nii", &bytes);
    }
}

#[test]
fn numpy_fits_and_vti() {
    let replaced = |name: &str, from: &str, to: &str| {
        let bytes = seed(name);
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes());
        let at = at.unwrap_or_else(|| panic!("{name} has no {from}"));
        // As long as before, where the header is padded.
        let mut tail = bytes[at + from.len()..].to_vec();
        for _ in from.len()..to.len() {
            let blank = tail.windows(2).position(|w| w == b"  ").unwrap_or(0);
            tail.remove(blank);
        }
        [&bytes[..at], to.as_bytes(), &tail].concat()
    };
    for shape in [
        "(20000, 20000, 20000)",
        "(4294967295, 4294967295, 4)",
        "(99999999999999999999, 2, 2)",
    ] {
        refuse_all("claim.npy", &replaced("c.npy", "(5, 6, 7)", shape));
    }
    for size in ["99999", "2147483647", "9223372036854775807"] {
        let from = format!("{:>20}", 7);
        let bytes = replaced("unsigned.fits", &from, &format!("{size:>20}"));
        refuse_all("claim.fits", &bytes);
    }
    for name in [
        "ascii.vti",
        "raw.vti",
        "raw_zlib.vti",
        "base64.vti",
        "base64_zlib.vti",
    ] {
        for extent in ["0 19999 0 19999 0 19999", "-2147483648 2147483647 0 5 0 4"] {
            let text = seed(name);
            let lossy = |from: &str| String::from_utf8_lossy(&text).contains(from);
            assert!(lossy("2 8 0 5 0 4"), "{name}");
            let mut bytes = text.clone();
            while let Some(at) = bytes.windows(11).position(|w| w == b"2 8 0 5 0 4") {
                bytes.splice(at..at + 11, extent.bytes());
            }
            refuse_all("claim.vti", &bytes);
        }
    }
}

/// Columns, rows and pages of 32 bits each.
#[test]
fn tiff() {
    for name in ["big_float.tif", "imagej.tif", "ome.ome.tif"] {
        let bytes = seed(name);
        let big = bytes.starts_with(b"MM");
        let entry = if bytes[2..4].contains(&43) { 20 } else { 12 };
        // ImageWidth and ImageLength, of type LONG or SHORT.
        for tag in [256u16, 257] {
            let tag = if big {
                tag.to_be_bytes()
            } else {
                tag.to_le_bytes()
            };
            let mut claimed = bytes.clone();
            let places: Vec<usize> = bytes
                .windows(2)
                .enumerate()
                .filter(|(at, w)| *w == tag && *at + entry <= bytes.len())
                .map(|(at, _)| at)
                .collect();
            for at in places {
                claimed[at + entry - 8..at + entry].fill(0x7f);
            }
            refuse_all("claim.tif", &claimed);
        }
    }
}

/// An object of one multi-frame picture, with one attribute of two bytes altered.
#[test]
fn dicom() {
    let bytes = seed("enhanced.dcm");
    for (element, claim) in [
        (0x10u8, 0xffffu16),
        (0x11, 0xffff),
        (0x10, 0),
        (0x11, 0),
        (0x00, 64),
    ] {
        let tag = [
            0x28,
            0,
            element,
            if element == 0 { 1 } else { 0 },
            b'U',
            b'S',
            2,
            0,
        ];
        let at = bytes.windows(8).position(|w| w == tag).unwrap() + 8;
        let mut claimed = bytes.clone();
        claimed[at..at + 2].copy_from_slice(&claim.to_le_bytes());
        refuse_all("claim.dcm", &claimed);
    }
    let frames = [0x28, 0, 8, 0, b'I', b'S', 2, 0];
    let at = bytes.windows(8).position(|w| w == frames).unwrap();
    for count in ["1048576 ", "4294967296", "99999999999999999999", "-5", "0 "] {
        let claim = [
            &bytes[..at],
            &[0x28, 0, 8, 0, b'I', b'S', count.len() as u8, 0],
            count.as_bytes(),
        ]
        .concat();
        refuse_all("claim.dcm", &[&claim, &bytes[at + 10..]].concat());
    }
}

/// What archives say of their members.
#[test]
fn archives() {
    let zip = seed("rle.zip");
    // Sizes in the central directory, and in the first local header.
    for (signature, places) in [(b"PK\x01\x02", [20, 24]), (b"PK\x03\x04", [18, 22])] {
        let at = zip.windows(4).position(|w| w == signature).unwrap();
        for place in places {
            let mut claimed = zip.clone();
            claimed[at + place..at + place + 4].copy_from_slice(&0x7fff_ffffu32.to_le_bytes());
            let scratch = Scratch::new();
            let path = scratch.file("claim.zip", &claimed);
            for options in [limited(), ReadOptions::default()] {
                let _ = super::judge(&path, &options, "claims two GiB");
            }
        }
    }
    let mut header = tar::Header::new_ustar();
    for size in [1 << 32, 1 << 40, u64::MAX] {
        header.set_path("a.dcm").unwrap();
        header.set_size(size);
        header.set_cksum();
        refuse_all(
            "claim.tar",
            &[header.as_bytes().as_slice(), &[0; 1024]].concat(),
        );
        refuse_all(
            "claim.tar.gz",
            &gzip(&[header.as_bytes().as_slice(), &[0; 1024]].concat()),
        );
    }
}

/// Every dictionary that the header of an xz block can ask for.
#[test]
fn xz_dictionaries() {
    let bytes = seed("ct_oblique.tar.xz");
    // Stream header of 12 bytes, then size, flags, id, size of properties, and the dictionary.
    assert_eq!(bytes[14..16], [0x21, 1]);
    for bits in 0..=255u8 {
        let mut claimed = bytes.clone();
        claimed[16] = bits;
        let mut checksum = flate2::Crc::new();
        checksum.update(&claimed[12..20]);
        claimed[20..24].copy_from_slice(&checksum.sum().to_le_bytes());
        let scratch = Scratch::new();
        let path = scratch.file("claim.tar.xz", &claimed);
        for options in [limited(), unlimited()] {
            let result = super::judge(&path, &options, &format!("dictionary {bits}"));
            let refused = result.is_err();
            assert!(refused || bits <= 30, "dictionary {bits} was accepted");
        }
    }
}
