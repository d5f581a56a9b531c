//! Files with altered bytes, words and header fields.

use super::seeds::{self, Seed};
use super::{Scratch, judge};

/// Positions of a file at which bytes are altered.
const POSITIONS: usize = 40;
/// Start of a file in which every word is altered: headers.
const HEADER_BYTES: usize = 352;

/// Writes an altered file, reads it, and puts the file back.
fn try_bytes(seed: &Seed, scratch: &Scratch, at: usize, bytes: &[u8], what: &str) {
    let path = seed.write(scratch);
    std::fs::write(path.with_file_name(&seed.files[at].0), bytes).unwrap();
    let _ = judge(&path, &seed.options(), what);
}

#[test]
fn altered_bytes() {
    let scratch = Scratch::new();
    for seed in seeds::all() {
        for (at, (name, original)) in seed.files.iter().enumerate() {
            let mut bytes = original.clone();
            for place in (0..bytes.len()).step_by(bytes.len().div_ceil(POSITIONS)) {
                let was = bytes[place];
                for altered in [0, 0xff, was ^ 1] {
                    bytes[place] = altered;
                    let what = format!("{name}: byte {place} is {altered:#x}");
                    try_bytes(&seed, &scratch, at, &bytes, &what);
                }
                bytes[place] = was;
            }
        }
    }
}

/// Counts, lengths and offsets of binary headers, in both byte orders.
#[test]
fn altered_words() {
    let scratch = Scratch::new();
    for seed in seeds::all() {
        let original = &seed.files[0].1;
        let mut dice = 1u64;
        for width in [2, 4, 8] {
            for place in (0..original.len().min(HEADER_BYTES).saturating_sub(width)).step_by(width)
            {
                // One of the words by turns: all of them at every place take too long.
                dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let words: [u64; 6] = [u64::MAX, u64::MAX >> 1, 1 << 63, 0, 1 << 31, 0x7fff_ffff];
                let word = words[(dice >> 60) as usize % words.len()];
                let big = dice >> 59 & 1 == 1;
                let mut bytes = original.clone();
                let value = if big {
                    word.to_be_bytes()
                } else {
                    word.to_le_bytes()
                };
                let from = if big && word < 1 << 32 { 8 - width } else { 0 };
                bytes[place..place + width].copy_from_slice(&value[from..from + width]);
                let what = format!("{width} bytes at {place} are {word:#x}, big {big}");
                try_bytes(&seed, &scratch, 0, &bytes, &what);
            }
        }
    }
}

/// Each number and word of a text header in turn, by what no writer writes.
#[test]
fn altered_fields() {
    let hostile = [
        "",
        "-1",
        "0",
        "1e999",
        "nan",
        "inf",
        "-inf",
        "4294967296",
        "18446744073709551616",
        "99999999999999999999999999",
        "1e-320",
        "(",
        "%d",
        "../../../../etc/passwd",
        "\0",
        "\u{fffd}",
    ];
    let scratch = Scratch::new();
    let mut texts = seeds::text_headers();
    texts.extend(
        seeds::all()
            .into_iter()
            .filter(|s| s.name().ends_with(".vti")),
    );
    for seed in texts {
        let original = &seed.files[0].1;
        let end = original.len().min(3 * HEADER_BYTES);
        for field in fields(&original[..end]) {
            for value in hostile {
                let bytes = [
                    &original[..field.start],
                    value.as_bytes(),
                    &original[field.end..],
                ];
                let what = format!("{field:?} is {value:?}");
                try_bytes(&seed, &scratch, 0, &bytes.concat(), &what);
            }
        }
    }
}

/// Runs of letters, digits, signs and dots.
fn fields(header: &[u8]) -> Vec<std::ops::Range<usize>> {
    let is_word = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'+' | b'.');
    let mut fields = Vec::new();
    let mut start = None;
    for (at, &byte) in header.iter().enumerate() {
        match (is_word(byte), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                fields.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    fields
}
