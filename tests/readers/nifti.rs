//! NIfTI-1 and NIfTI-2.

use umbravox::io::ReadOptions;
use umbravox::volume::Rescale;

use super::{
    COUNT, Kind, Scratch, assert_holds, assert_placed, assert_refused, gzip, open, stored,
};

const CODES: [(Kind, i16); 10] = [
    (Kind::U8, 2),
    (Kind::I16, 4),
    (Kind::I32, 8),
    (Kind::F32, 16),
    (Kind::F64, 64),
    (Kind::I8, 256),
    (Kind::U16, 512),
    (Kind::U32, 768),
    (Kind::I64, 1024),
    (Kind::U64, 1280),
];

/// Every voxel size is different, and the axes of rotation too.
const SPACING: [f64; 3] = [0.5, 0.75, 2.0];
const IDENTITY: [[f64; 3]; 3] = [[-1., 0., 0.], [0., -1., 0.], [0., 0., 1.]];

/// A header to be written, in either version and byte order.
#[derive(Clone)]
pub(crate) struct Nifti {
    two: bool,
    big: bool,
    pub(crate) bytes: Vec<u8>,
}

impl Nifti {
    /// 3 x 4 x 5 voxels of a type, spacing 0.5, 0.75, 2, no orientation.
    pub(crate) fn new(two: bool, big: bool, kind: Kind) -> Self {
        let bytes = vec![0; if two { 544 } else { 352 }];
        let mut header = Self { two, big, bytes };
        if two {
            header.put(0, &540i32.to_le_bytes());
            header.bytes[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
            header.put(168, &544i64.to_le_bytes());
        } else {
            header.put(0, &348i32.to_le_bytes());
            header.bytes[344..348].copy_from_slice(b"n+1\0");
            header.put(108, &352f32.to_le_bytes());
        }
        let (_, code) = CODES.into_iter().find(|(k, _)| *k == kind).unwrap();
        header.datatype(code);
        for (i, n) in [3, 3, 4, 5, 1, 1, 1, 1].into_iter().enumerate() {
            header.dim(i, n);
        }
        for (i, spacing) in SPACING.into_iter().enumerate() {
            header.real((76, 104), i + 1, spacing);
        }
        header
    }

    /// Makes it the header of a pair.
    pub(crate) fn paired(mut self) -> Self {
        let at = if self.two { 5 } else { 345 };
        self.bytes[at] = b'i';
        self.put(
            if self.two { 168 } else { 108 },
            &[0; 8][..if self.two { 8 } else { 4 }],
        );
        self
    }

    fn put(&mut self, at: usize, little_endian: &[u8]) {
        let mut field = little_endian.to_vec();
        if self.big {
            field.reverse();
        }
        self.bytes[at..at + field.len()].copy_from_slice(&field);
    }

    fn datatype(&mut self, code: i16) {
        self.put(if self.two { 12 } else { 70 }, &code.to_le_bytes());
    }

    fn dim(&mut self, i: usize, n: i16) {
        if self.two {
            self.put(16 + 8 * i, &i64::from(n).to_le_bytes());
        } else {
            self.put(40 + 2 * i, &n.to_le_bytes());
        }
    }

    /// Number `i` of the floats at an offset, which differs by version.
    fn real(&mut self, (one, two): (usize, usize), i: usize, value: f64) {
        if self.two {
            self.put(two + 8 * i, &value.to_le_bytes());
        } else {
            self.put(one + 4 * i, &(value as f32).to_le_bytes());
        }
    }

    fn reals(&mut self, at: (usize, usize), values: &[f64]) {
        for (i, &value) in values.iter().enumerate() {
            self.real(at, i, value);
        }
    }

    fn codes(&mut self, qform: i16, sform: i16) {
        for (i, code) in [qform, sform].into_iter().enumerate() {
            if self.two {
                self.put(344 + 4 * i, &i32::from(code).to_le_bytes());
            } else {
                self.put(252 + 2 * i, &code.to_le_bytes());
            }
        }
    }

    fn units(&mut self, code: u8) {
        if self.two {
            self.put(500, &i32::from(code).to_le_bytes());
        } else {
            self.put(123, &[code]);
        }
    }

    pub(crate) fn with(&self, data: &[u8]) -> Vec<u8> {
        [self.bytes.as_slice(), data].concat()
    }
}

fn versions() -> impl Iterator<Item = (bool, bool)> {
    [(false, false), (false, true), (true, false), (true, true)].into_iter()
}

#[test]
fn every_type_version_and_order() {
    let scratch = Scratch::new();
    for (two, big) in versions() {
        for kind in Kind::ALL {
            let header = Nifti::new(two, big, kind);
            let data = kind.data(big);
            let file = header.with(&data);
            let pair = header.paired().bytes;
            scratch.file("b.hdr", &pair);
            scratch.file("c.hdr.gz", &gzip(&pair));
            for path in [
                scratch.file("a.nii", &file),
                scratch.file("a.nii.gz", &gzip(&file)),
                scratch.file("no_ending", &gzip(&file)),
                scratch.file("b.img", &data),
                scratch.file("b.hdr", &pair),
                scratch.file("c.img.gz", &gzip(&data)),
                scratch.file("c.hdr.gz", &gzip(&pair)),
            ] {
                let volume = open(&path);
                assert_holds(&volume, kind);
                assert_eq!(
                    volume.rescale(),
                    Rescale::default(),
                    "scl_slope 0 is no scaling"
                );
                assert_eq!(volume.spacing(), SPACING);
            }
        }
    }
}

#[test]
fn scaling_is_kept_apart_from_the_voxels() {
    let scratch = Scratch::new();
    for (two, big) in versions() {
        let mut header = Nifti::new(two, big, Kind::I16);
        header.reals((112, 176), &[0.5, -1024.0]);
        let volume = open(&scratch.file("a.nii", &header.with(&Kind::I16.data(big))));
        assert_holds(&volume, Kind::I16);
        assert_eq!(
            volume.rescale(),
            Rescale {
                slope: 0.5,
                intercept: -1024.0
            }
        );
        assert_eq!(volume.value(1, 0, 0), 0.5 * -28999.0 - 1024.0);
        header.reals((112, 176), &[f64::NAN, f64::NAN]);
        let volume = open(&scratch.file("a.nii", &header.with(&Kind::I16.data(big))));
        assert_eq!(volume.rescale(), Rescale::default());
        header.reals((112, 176), &[2.0, f64::NAN]);
        let path = scratch.file("a.nii", &header.with(&Kind::I16.data(big)));
        assert_refused(&path, &ReadOptions::default(), &["scl_inter", "NaN"]);
    }
}

/// A rotation by 120 degrees about (1,1,1) sends x to y, y to z, z to x.
#[test]
fn forms_in_their_order() {
    let scratch = Scratch::new();
    let srow = [
        0.5, -0.25, 0., 10., //
        0.125, 1., -0.5, -20., //
        0., 0.25, 2., 30.,
    ];
    for (two, big) in versions() {
        let mut header = Nifti::new(two, big, Kind::U8);
        header.reals((256, 352), &[0.5, 0.5, 0.5]);
        header.reals((268, 376), &[1., 2., 3.]);
        header.reals((280, 400), &srow);
        let place =
            |header: &Nifti| open(&scratch.file("a.nii", &header.with(&Kind::U8.data(big))));

        let [sx, sy, sz] = SPACING;
        // No form: no orientation, as in ITK.
        let scaled = [[sx, 0., 0.], [0., sy, 0.], [0., 0., sz]];
        assert_placed(&place(&header), scaled, [0.; 3], 0.0);

        // qform: RAS (0,sx,0), (0,0,sy), (sz,0,0).
        header.codes(1, 0);
        let rotated = [[0., -sx, 0.], [0., 0., sy], [-sz, 0., 0.]];
        assert_placed(&place(&header), rotated, [-1., -2., 3.], 1e-7);
        header.real((76, 104), 0, -1.0);
        let mirrored = [[0., -sx, 0.], [0., 0., sy], [sz, 0., 0.]];
        assert_placed(&place(&header), mirrored, [-1., -2., 3.], 1e-7);

        // sform wins; its columns are the steps.
        header.codes(1, 2);
        let steps = [[-0.5, -0.125, 0.], [0.25, -1., 0.25], [0., 0.5, 2.]];
        assert_placed(&place(&header), steps, [-10., 20., 30.], 0.0);

        // Metres and micrometres.
        header.units(1);
        let metres = steps.map(|step| step.map(|c| 1000. * c));
        assert_placed(&place(&header), metres, [-10e3, 20e3, 30e3], 1e-9);
        header.units(3 + 8);
        let micrometres = steps.map(|step| step.map(|c| 1e-3 * c));
        assert_placed(&place(&header), micrometres, [-0.01, 0.02, 0.03], 1e-15);
    }
}

/// Rotation by 180 degrees about y: the real part of the quaternion is 0, or just missed by rounding.
#[test]
fn half_turns() {
    let scratch = Scratch::new();
    for c in [1.0, 1.0 + 1e-6, 1.0 - 1e-9] {
        let mut header = Nifti::new(true, false, Kind::U8);
        header.codes(1, 0);
        header.reals((256, 352), &[0., c, 0.]);
        header.reals((76, 104), &[1., 1., 1., 1.]);
        let volume = open(&scratch.file("a.nii", &header.with(&Kind::U8.data(false))));
        let [x, y, z] = IDENTITY;
        assert_placed(&volume, [x.map(|c| -c), y, z.map(|c| -c)], [0.; 3], 1e-12);
    }
}

#[test]
fn voxels_start_where_the_header_says() {
    let scratch = Scratch::new();
    for (two, big) in versions() {
        let mut header = Nifti::new(two, big, Kind::U16);
        let end = header.bytes.len();
        if two {
            header.put(168, &(end as i64 + 16).to_le_bytes());
        } else {
            header.put(108, &(end as f32 + 16.0).to_le_bytes());
        }
        let file = header.with(&[[0xee; 16].as_slice(), &Kind::U16.data(big)].concat());
        assert_holds(&open(&scratch.file("a.nii", &file)), Kind::U16);
        assert_holds(&open(&scratch.file("a.nii.gz", &gzip(&file))), Kind::U16);
    }
}

/// One way to spoil a header, and what the message must say.
type Spoil = (fn(&mut Nifti), [&'static str; 2]);

const SPOILS: &[Spoil] = &[
    (|h| h.datatype(1536), ["datatype", "1536"]),
    (|h| h.datatype(0), ["datatype", "0"]),
    (|h| h.dim(0, 0), ["dim[0]", "0"]),
    (|h| h.dim(0, 8), ["dim[0]", "8"]),
    (|h| h.dim(0, -3), ["dim[0]", "-3"]),
    (|h| h.dim(0, 2), ["dim", "2 axes"]),
    (|h| h.dim(1, 0), ["dim", "first axis has 0"]),
    (|h| h.dim(2, 1), ["dim", "second axis has 1"]),
    (|h| h.dim(3, -5), ["dim[3]", "-5"]),
    (|h| h.dim(3, 6), ["144 bytes", "file has"]),
    (
        |h| (1..4).for_each(|i| h.dim(i, i16::MAX)),
        ["dim", "limits"],
    ),
    (|h| h.real((76, 104), 1, f64::NAN), ["pixdim", "NaN"]),
    (|h| h.real((76, 104), 2, 0.0), ["pixdim", "0.0"]),
    (|h| h.real((76, 104), 3, -2.0), ["pixdim", "-2.0"]),
    (|h| h.codes(0, 1), ["srow", "span no space"]),
    (
        |h| {
            h.codes(0, 1);
            h.real((280, 400), 3, f64::INFINITY);
        },
        ["srow", "finite"],
    ),
    (
        |h| {
            h.codes(1, 0);
            h.real((256, 352), 1, f64::NAN);
        },
        ["quatern", "NaN"],
    ),
    (
        |h| {
            h.codes(1, 0);
            h.real((268, 376), 1, f64::NAN);
        },
        ["qoffset", "finite"],
    ),
];

#[test]
fn wrong_headers_name_the_field() {
    let scratch = Scratch::new();
    for (two, big) in versions() {
        for (spoil, words) in SPOILS {
            let mut header = Nifti::new(two, big, Kind::U16);
            spoil(&mut header);
            let path = scratch.file("bad.nii", &header.with(&Kind::U16.data(big)));
            assert_refused(
                &path,
                &ReadOptions::default(),
                &["bad.nii", words[0], words[1]],
            );
        }
        for offset in [-1.0, 100.0, 352.5, 1e30, f64::NAN] {
            let mut header = Nifti::new(two, big, Kind::U16);
            if two {
                header.put(168, &(offset as i64 - 1).to_le_bytes());
            } else {
                header.put(108, &(offset as f32).to_le_bytes());
            }
            let path = scratch.file("bad.nii", &header.with(&Kind::U16.data(big)));
            let said = if offset > 1e29 && two {
                "bytes"
            } else {
                "vox_offset"
            };
            assert_refused(&path, &ReadOptions::default(), &["bad.nii", said]);
        }
    }
    let alone = scratch.file(
        "alone.hdr",
        &Nifti::new(false, false, Kind::U8).paired().bytes,
    );
    assert_refused(&alone, &ReadOptions::default(), &["alone.hdr", ".img"]);
}

#[test]
fn gzip_and_plain_are_equal() {
    let scratch = Scratch::new();
    let mut header = Nifti::new(false, false, Kind::F32);
    header.codes(1, 0);
    header.reals((256, 352), &[0.1, 0.2, 0.3]);
    let file = header.with(&Kind::F32.data(false));
    let plain = open(&scratch.file("a.nii", &file));
    // Two members, cut in the middle of a voxel.
    let members = [gzip(&file[..401]), gzip(&file[401..])].concat();
    let packed = open(&scratch.file("b.nii.gz", &members));
    assert_eq!(plain.voxels(), packed.voxels());
    assert_eq!(plain.world_from_ix(), packed.world_from_ix());
    assert_eq!(stored(&plain).len(), COUNT);
}
