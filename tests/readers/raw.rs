//! Headerless files, options, and files of no known format.

use std::cell::RefCell;

use umbravox::io::{FORMATS, Limits, ReadOptions, read};
use umbravox::scene::{Endian, RawDescription, RawType};

use super::{Kind, SIZE, Scratch, assert_holds, assert_placed, assert_refused, gzip, open};

fn described(voxel_type: RawType, big: bool, offset: u64) -> ReadOptions<'static> {
    ReadOptions {
        raw: Some(RawDescription {
            size: SIZE,
            voxel_type,
            spacing: [0.5, 0.75, 2.0],
            endian: if big { Endian::Big } else { Endian::Little },
            offset,
        }),
        ..ReadOptions::default()
    }
}

#[test]
fn every_type_and_order() {
    let scratch = Scratch::new();
    for (kind, raw) in [
        (Kind::U8, RawType::U8),
        (Kind::I8, RawType::I8),
        (Kind::U16, RawType::U16),
        (Kind::I16, RawType::I16),
        (Kind::F32, RawType::F32),
    ] {
        for big in [false, true] {
            for offset in [0u8, 5] {
                let file = [vec![0xaa; offset.into()], kind.data(big)].concat();
                let options = described(raw, big, offset.into());
                for bytes in [gzip(&file), file] {
                    let volume = read(&scratch.file("a.raw", &bytes), &options).unwrap();
                    assert_holds(&volume, kind);
                    let steps = [[0.5, 0., 0.], [0., 0.75, 0.], [0., 0., 2.]];
                    assert_placed(&volume, steps, [0.; 3], 0.0);
                }
            }
        }
    }
}

#[test]
fn the_description_must_match_the_file() {
    let scratch = Scratch::new();
    let options = described(RawType::U16, false, 8);
    for len in [0, 8, 120, 127, 129, 4096] {
        let path = scratch.file("bad.raw", &vec![1; len]);
        assert_refused(
            &path,
            &options,
            &["bad.raw", "128 bytes", &format!("has {len}")],
        );
    }
    let path = scratch.file("a.raw", &[1; 128]);
    let changed = |change: fn(&mut RawDescription)| {
        let mut options = options.clone();
        options.raw.iter_mut().for_each(change);
        options
    };
    assert_refused(
        &path,
        &changed(|d| d.size[1] = 0),
        &["volume.raw.size", "second axis has 0"],
    );
    assert_refused(
        &path,
        &changed(|d| d.size = [u32::MAX; 3]),
        &["volume.raw.size", "counted"],
    );
    assert_refused(
        &path,
        &changed(|d| d.spacing[2] = f64::NAN),
        &["volume.raw.spacing", "NaN"],
    );
    assert_refused(
        &path,
        &changed(|d| d.spacing[0] = 0.0),
        &["volume.raw.spacing", "above 0"],
    );
    assert_refused(
        &path,
        &changed(|d| d.offset = u64::MAX),
        &["offset 18446744073709551615"],
    );
}

#[test]
fn values_that_are_not_finite_are_replaced_and_counted() {
    let scratch = Scratch::new();
    let mut data = Kind::F32.data(true);
    for (voxel, value) in [(7, f32::NAN), (9, f32::INFINITY), (11, f32::NEG_INFINITY)] {
        data[4 * voxel..4 * voxel + 4].copy_from_slice(&value.to_be_bytes());
    }
    let path = scratch.file("a.raw", &data);
    let volume = read(&path, &described(RawType::F32, true, 0)).unwrap();
    assert_eq!(volume.non_finite(), 3);
    assert_eq!(volume.voxels().get(9), -5.25);
    let path = scratch.file("a.raw", &f32::NAN.to_be_bytes().repeat(60));
    assert_refused(
        &path,
        &described(RawType::F32, true, 0),
        &["a.raw", "no voxel is a finite"],
    );
}

#[test]
fn unknown_files_are_told_what_is_read() {
    let scratch = Scratch::new();
    let mut words = vec!["volume.raw", "size", "type"];
    words.extend(FORMATS.iter().map(|f| f.name));
    for bytes in [
        b"".as_slice(),
        b"hello",
        &[0; 5000],
        &gzip(b"hello"),
        b"NRR",
        b"a = b\n",
    ] {
        let path = scratch.file("what.bin", bytes);
        assert_refused(&path, &ReadOptions::default(), &words);
    }
    let misnamed = scratch.file("what.nii.gz", b"hello");
    assert_refused(&misnamed, &ReadOptions::default(), &["its name says NIfTI"]);
    let folder = misnamed.parent().unwrap();
    assert_refused(folder, &ReadOptions::default(), &[folder.to_str().unwrap()]);
    assert_refused(folder, &described(RawType::U8, false, 0), &["folder"]);
    let absent = folder.join("absent.nrrd");
    assert_refused(&absent, &ReadOptions::default(), &["absent.nrrd"]);
}

#[test]
fn names_decide_nothing() {
    let scratch = Scratch::new();
    let header = "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 3 4 5\nencoding: raw\n\n";
    let bytes = [header.as_bytes(), &Kind::U8.data(false)].concat();
    for name in ["a.nii", "a.raw", "a"] {
        assert_holds(&open(&scratch.file(name, &bytes)), Kind::U8);
    }
}

#[test]
fn limits_bind() {
    let scratch = Scratch::new();
    let path = scratch.file("a.raw", &Kind::U16.data(false));
    let with = |limits: Limits| ReadOptions {
        limits,
        ..described(RawType::U16, false, 0)
    };
    let limits = Limits {
        max_voxels: 60,
        max_bytes: 120,
        max_header_bytes: 100,
        ..Limits::default()
    };
    assert_holds(&read(&path, &with(limits)).unwrap(), Kind::U16);
    let fewer = Limits {
        max_voxels: 59,
        ..limits
    };
    assert_refused(&path, &with(fewer), &["60 voxels", "59"]);
    let smaller = Limits {
        max_bytes: 119,
        ..limits
    };
    assert_refused(&path, &with(smaller), &["120 bytes", "119"]);
    let endless = scratch.file(
        "a.nrrd",
        &[b"NRRD0004\n# ".as_slice(), &[b'x'; 200]].concat(),
    );
    let options = ReadOptions {
        limits,
        ..ReadOptions::default()
    };
    assert_refused(&endless, &options, &["header does not end"]);
}

#[test]
fn messages_stay_short_whatever_they_quote() {
    let scratch = Scratch::new();
    let long = "x".repeat(100_000);
    for (name, bytes) in [
        ("a.nrrd", format!("NRRD0004\n{long}\n")),
        ("a.mha", format!("NDims = 3\nDimSize = {long}\n{long}")),
    ] {
        let path = scratch.file(name, bytes.as_bytes());
        let message = read(&path, &ReadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(name) && message.contains("xxx"),
            "{message}"
        );
        assert!(message.len() < 1500, "{} bytes", message.len());
    }
}

#[test]
fn progress_reaches_the_end() {
    let scratch = Scratch::new();
    let size = [128, 128, 100];
    let bytes = 128 * 128 * 100 * 2;
    let calls = RefCell::new(Vec::new());
    let note = |done, total| calls.borrow_mut().push((done, total));
    let mut options = described(RawType::U16, false, 0);
    options.raw.iter_mut().for_each(|d| d.size = size);
    let options = ReadOptions {
        progress: Some(&note),
        ..options
    };
    read(&scratch.file("a.raw", &vec![3; bytes]), &options).unwrap();
    let calls = calls.into_inner();
    assert!(calls.len() > 2 && calls.is_sorted(), "{calls:?}");
    assert!(calls.iter().all(|&(_, total)| total == bytes as u64));
    assert_eq!(calls.last(), Some(&(bytes as u64, bytes as u64)));
}
