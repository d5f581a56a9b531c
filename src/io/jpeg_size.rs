//! The size that a JPEG stream claims, before a decoder believes it (ITU-T T.81, B.2.2).

/// Columns and rows from the frame header; `None` when there is none.
pub(super) fn jpeg_size(stream: &[u8]) -> Option<[u16; 2]> {
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
            let &[_, _, _, high_rows, low_rows, high_columns, low_columns] = after.first_chunk()?;
            let rows = u16::from_be_bytes([high_rows, low_rows]);
            return Some([u16::from_be_bytes([high_columns, low_columns]), rows]);
        }
        rest = after.get(length..)?;
    }
}
