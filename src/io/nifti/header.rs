//! The binary headers of NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes), in either byte order.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::element::Element;
use crate::scene::Endian;

/// Bytes of the larger header.
pub(super) const MAX_BYTES: usize = NIFTI2_BYTES;
const NIFTI1_BYTES: usize = 348;
const NIFTI2_BYTES: usize = 540;

/// `datatype` codes that are read, and the numbers of a voxel.
const DATATYPES: &[(i64, Element, u64)] = &[
    (2, Element::U8, 1),
    (4, Element::I16, 1),
    (8, Element::I32, 1),
    (16, Element::F32, 1),
    (32, Element::F32, 2),
    (64, Element::F64, 1),
    (128, Element::U8, 3),
    (256, Element::I8, 1),
    (512, Element::U16, 1),
    (768, Element::U32, 1),
    (1024, Element::I64, 1),
    (1280, Element::U64, 1),
    (1792, Element::F64, 2),
    (2304, Element::U8, 4),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    One,
    Two,
}

/// Byte offsets of the fields that are read. Their types differ by version too.
struct Offsets {
    datatype: usize,
    dim: usize,
    pixdim: usize,
    vox_offset: usize,
    scl_slope: usize,
    scl_inter: usize,
    qform_code: usize,
    sform_code: usize,
    quatern: usize,
    qoffset: usize,
    srow: usize,
    xyzt_units: usize,
    intent_code: usize,
    descrip: usize,
}

const NIFTI1: Offsets = Offsets {
    datatype: 70,
    dim: 40,
    pixdim: 76,
    vox_offset: 108,
    scl_slope: 112,
    scl_inter: 116,
    qform_code: 252,
    sform_code: 254,
    quatern: 256,
    qoffset: 268,
    srow: 280,
    xyzt_units: 123,
    intent_code: 68,
    descrip: 148,
};

const NIFTI2: Offsets = Offsets {
    datatype: 12,
    dim: 16,
    pixdim: 104,
    vox_offset: 168,
    scl_slope: 176,
    scl_inter: 184,
    qform_code: 344,
    sform_code: 348,
    quatern: 352,
    qoffset: 376,
    srow: 400,
    xyzt_units: 500,
    intent_code: 504,
    descrip: 240,
};

/// A header whose size and magic are right.
pub(super) struct Header {
    path: PathBuf,
    bytes: Vec<u8>,
    version: Version,
    endian: Endian,
    pair: bool,
}

/// Version, byte order and whether the image is another file.
fn identify(head: &[u8]) -> Option<(Version, Endian, bool)> {
    let first = *head.first_chunk::<4>()?;
    let (size, endian) = [
        (u32::from_le_bytes(first), Endian::Little),
        (u32::from_be_bytes(first), Endian::Big),
    ]
    .into_iter()
    .find(|&(size, _)| size as usize == NIFTI1_BYTES || size as usize == NIFTI2_BYTES)?;
    let (version, magic) = if size as usize == NIFTI1_BYTES {
        (Version::One, head.get(344..348)?)
    } else {
        (Version::Two, head.get(4..12)?)
    };
    match magic {
        b"n+1\0" | b"n+2\0\r\n\x1a\n" => Some((version, endian, false)),
        b"ni1\0" | b"ni2\0\r\n\x1a\n" => Some((version, endian, true)),
        _ => None,
    }
}

/// Whether a file starts as a NIfTI header.
pub(super) fn is_header(head: &[u8]) -> bool {
    identify(head).is_some()
}

impl Header {
    pub(super) fn parse(path: &Path, head: &[u8]) -> Result<Self> {
        let identified = identify(head);
        let (version, endian, pair) =
            identified.ok_or_else(|| Error::volume(path, "the NIfTI header is damaged"))?;
        let len = match version {
            Version::One => NIFTI1_BYTES,
            Version::Two => NIFTI2_BYTES,
        };
        let bytes = head.get(..len).ok_or_else(|| {
            Error::volume(
                path,
                format!("the NIfTI header ends after {} of {len} bytes", head.len()),
            )
        })?;
        Ok(Self {
            path: path.to_path_buf(),
            bytes: bytes.to_vec(),
            version,
            endian,
            pair,
        })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn endian(&self) -> Endian {
        self.endian
    }

    /// Whether the image is another file.
    pub(super) fn is_pair(&self) -> bool {
        self.pair
    }

    /// Sizes of all axes.
    pub(super) fn axes(&self) -> Result<Vec<u64>> {
        let dim = |i: usize| match self.version {
            Version::One => i64::from(self.i16_at(NIFTI1.dim + 2 * i)),
            Version::Two => self.i64_at(NIFTI2.dim + 8 * i),
        };
        let count = usize::try_from(dim(0)).ok().filter(|n| (1..=7).contains(n));
        let count = count.ok_or_else(|| {
            self.bad(format!(
                "dim[0] is {}; a number of axes from 1 to 7 is valid",
                dim(0)
            ))
        })?;
        (1..=count)
            .map(|i| {
                u64::try_from(dim(i)).map_err(|_| {
                    self.bad(format!("dim[{i}] is {}; a size cannot be negative", dim(i)))
                })
            })
            .collect()
    }

    /// The type of a voxel's numbers, and how many there are: red, green, blue and alpha, or real and imaginary.
    pub(super) fn element(&self) -> Result<(Element, u64)> {
        let code = i64::from(self.i16_at(self.offsets().datatype));
        let known = DATATYPES.iter().find(|(known, ..)| *known == code);
        known
            .map(|&(_, element, count)| (element, count))
            .ok_or_else(|| {
                let name = |&(code, element, count): &(i64, Element, u64)| match count {
                    1 => format!("{code} ({element})"),
                    count => format!("{code} ({count} x {element})"),
                };
                let valid: Vec<String> = DATATYPES.iter().map(name).collect();
                self.bad(format!(
                    "datatype {code} is not read; valid are {}",
                    valid.join(", ")
                ))
            })
    }

    /// Where the voxels start in their file.
    pub(super) fn data_offset(&self) -> Result<u64> {
        let least = match (self.pair, self.version) {
            (true, _) => 0,
            (false, Version::One) => NIFTI1_BYTES as u64 + 4,
            (false, Version::Two) => NIFTI2_BYTES as u64 + 4,
        };
        let bad = |given: String| {
            self.bad(format!(
                "vox_offset is {given}; a whole number of bytes from {least} is valid"
            ))
        };
        let offset = match self.version {
            Version::One => {
                let offset = f64::from(self.f32_at(NIFTI1.vox_offset));
                // Up to 2^63 the conversion is exact for whole numbers.
                if !(0.0..9e18).contains(&offset) || offset.fract() != 0.0 {
                    return Err(bad(offset.to_string()));
                }
                offset as u64
            }
            Version::Two => {
                let offset = self.i64_at(NIFTI2.vox_offset);
                u64::try_from(offset).map_err(|_| bad(offset.to_string()))?
            }
        };
        match offset {
            // Some writers leave the field empty and put the voxels at the first place that is allowed.
            0 => Ok(least),
            _ if offset < least => Err(bad(offset.to_string())),
            _ => Ok(offset),
        }
    }

    /// `scl_slope`, `scl_inter`.
    pub(super) fn scaling(&self) -> (f64, f64) {
        let at = self.offsets();
        (self.real(at.scl_slope, 0), self.real(at.scl_inter, 0))
    }

    /// `qform_code`, `sform_code`.
    pub(super) fn form_codes(&self) -> (i32, i32) {
        let at = self.offsets();
        (self.code(at.qform_code), self.code(at.sform_code))
    }

    /// `intent_code`.
    pub(super) fn intent_code(&self) -> i32 {
        self.code(self.offsets().intent_code)
    }

    /// `descrip`, up to its first zero byte.
    pub(super) fn description(&self) -> String {
        const LENGTH: usize = 80;
        let from = self.bytes.get(self.offsets().descrip..);
        let field = from.and_then(|b| b.first_chunk::<LENGTH>());
        let text = field.and_then(|b| b.split(|&b| b == 0).next());
        String::from_utf8_lossy(text.unwrap_or_default()).into_owned()
    }

    /// A code of 16 bits in version 1, of 32 in version 2.
    fn code(&self, offset: usize) -> i32 {
        match self.version {
            Version::One => self.i16_at(offset).into(),
            Version::Two => i32::from_ne_bytes(self.field(offset)),
        }
    }

    /// `pixdim[0]`, the sign of the third axis of the quaternion's frame.
    pub(super) fn qfac(&self) -> f64 {
        self.real(self.offsets().pixdim, 0)
    }

    /// `pixdim[1]` to `pixdim[3]`.
    pub(super) fn spacing(&self) -> [f64; 3] {
        [1, 2, 3].map(|i| self.real(self.offsets().pixdim, i))
    }

    /// `quatern_b`, `quatern_c`, `quatern_d`.
    pub(super) fn quaternion(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.real(self.offsets().quatern, i))
    }

    /// `qoffset_x`, `qoffset_y`, `qoffset_z`.
    pub(super) fn quaternion_offset(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.real(self.offsets().qoffset, i))
    }

    /// `srow_x`, `srow_y`, `srow_z`.
    pub(super) fn affine_rows(&self) -> [[f64; 4]; 3] {
        [0, 1, 2].map(|row| [0, 1, 2, 3].map(|i| self.real(self.offsets().srow, 4 * row + i)))
    }

    /// The spatial part of `xyzt_units`.
    pub(super) fn space_unit(&self) -> u8 {
        let units = match self.version {
            Version::One => {
                let [units] = self.field(NIFTI1.xyzt_units);
                units
            }
            Version::Two => (i32::from_ne_bytes(self.field(NIFTI2.xyzt_units)) & 0xff) as u8,
        };
        units & 0x07
    }

    pub(super) fn bad(&self, message: String) -> Error {
        Error::volume(&self.path, message)
    }

    fn offsets(&self) -> &'static Offsets {
        match self.version {
            Version::One => &NIFTI1,
            Version::Two => &NIFTI2,
        }
    }

    /// Number `i` of an array of the version's floats.
    fn real(&self, offset: usize, i: usize) -> f64 {
        match self.version {
            Version::One => self.f32_at(offset + 4 * i).into(),
            Version::Two => f64::from_ne_bytes(self.field(offset + 8 * i)),
        }
    }

    fn i16_at(&self, offset: usize) -> i16 {
        i16::from_ne_bytes(self.field(offset))
    }

    fn i64_at(&self, offset: usize) -> i64 {
        i64::from_ne_bytes(self.field(offset))
    }

    fn f32_at(&self, offset: usize) -> f32 {
        f32::from_ne_bytes(self.field(offset))
    }

    /// The bytes of a field in the machine's order. `bytes` has the length that the version's offsets need.
    fn field<const N: usize>(&self, offset: usize) -> [u8; N] {
        let field = self.bytes.get(offset..).and_then(|b| b.first_chunk::<N>());
        let mut field = field.copied().unwrap_or([0; N]);
        if (self.endian == Endian::Big) != cfg!(target_endian = "big") {
            field.reverse();
        }
        field
    }
}
