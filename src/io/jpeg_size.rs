//! The size that a JPEG or JPEG 2000 stream claims, before a decoder believes it.

/// Columns and rows, and samples of a pixel: of JPEG from the frame header (ITU-T T.81, B.2.2), of JPEG 2000 from the
/// marker SIZ (ITU-T T.800, A.5.1). `None` when there is none.
pub(super) fn claim_of(stream: &[u8]) -> Option<([u32; 2], u64)> {
    match stream.strip_prefix(J2K_START) {
        Some(parameters) => Some(j2k_claim(parameters).unwrap_or_default()),
        None if is_jp2(stream) => Some(Default::default()),
        None => jpeg_claim(stream),
    }
}

/// Start of codestream, and the marker SIZ.
const J2K_START: &[u8] = &[0xFF, 0x4F, 0xFF, 0x51];

/// A JPEG 2000 stream in boxes, which DICOM does not have (PS3.5, A.4.4): no claim holds of it.
fn is_jp2(stream: &[u8]) -> bool {
    stream.get(4..8) == Some(b"jP  ")
}

/// None of a picture whose samples are not all of its size: the decoder puts each where its pixel is.
fn j2k_claim(parameters: &[u8]) -> Option<([u32; 2], u64)> {
    let word = |i: usize| {
        let bytes = parameters.get(4 + 4 * i..)?.first_chunk()?;
        Some(u32::from_be_bytes(*bytes))
    };
    let size = [
        word(0)?.checked_sub(word(2)?)?,
        word(1)?.checked_sub(word(3)?)?,
    ];
    let count = u16::from_be_bytes(*parameters.get(36..)?.first_chunk()?);
    let samples = parameters.get(38..38 + 3 * usize::from(count))?;
    let whole = samples
        .chunks_exact(3)
        .all(|sample| matches!(sample, [_, 1, 1]));
    whole.then_some((size, count.into()))
}

fn jpeg_claim(stream: &[u8]) -> Option<([u32; 2], u64)> {
    let mut rest = stream.strip_prefix(&[0xFF, 0xD8])?;
    loop {
        let (&[first, marker], after) = rest.split_first_chunk::<2>()?;
        if first != 0xFF {
            return None;
        }
        let length = usize::from(u16::from_be_bytes(*after.first_chunk()?));
        // Start of frame: all of C0 to CF but DHT, JPG and DAC; F7 is that of JPEG-LS.
        let is_frame = matches!(marker, 0xC0..=0xCF if !matches!(marker, 0xC4 | 0xC8 | 0xCC));
        if is_frame || marker == 0xF7 {
            let &[
                _,
                _,
                _,
                high_rows,
                low_rows,
                high_columns,
                low_columns,
                count,
            ] = after.first_chunk()?;
            let rows = u16::from_be_bytes([high_rows, low_rows]);
            let columns = u16::from_be_bytes([high_columns, low_columns]);
            return Some(([columns.into(), rows.into()], count.into()));
        }
        rest = after.get(length..)?;
    }
}
