//! DICOM objects around coded pictures, so that a fuzzer gets past the header.

/// Bytes of an input that say what the header does: transfer syntax, rows, columns, bits and colours.
pub(crate) const HEADER_BYTES: usize = 4;

/// Coded transfer syntaxes (PS3.5, A.4): JPEG baseline, extended, lossless; JPEG-LS; JPEG 2000; RLE.
const SYNTAXES: [&str; 9] = [
    "1.2.840.10008.1.2.4.50",
    "1.2.840.10008.1.2.4.51",
    "1.2.840.10008.1.2.4.57",
    "1.2.840.10008.1.2.4.70",
    "1.2.840.10008.1.2.4.80",
    "1.2.840.10008.1.2.4.81",
    "1.2.840.10008.1.2.4.90",
    "1.2.840.10008.1.2.4.91",
    "1.2.840.10008.1.2.5",
];

/// An object of two frames, both of them the input after its first bytes.
pub(crate) fn object(input: &[u8]) -> Vec<u8> {
    let (header, picture) = input.split_at(HEADER_BYTES.min(input.len()));
    let byte = |at: usize| header.get(at).copied().unwrap_or_default();
    let syntax = SYNTAXES[usize::from(byte(0)) % SYNTAXES.len()];
    let [rows, columns] = [1, 2].map(|at| u16::from(byte(at)).max(2));
    let bits: u16 = if byte(3) & 1 == 0 { 8 } else { 16 };
    let samples: u16 = if byte(3) & 2 == 0 { 1 } else { 3 };
    let signed = u16::from(byte(3) >> 2 & 1);
    let mut file = vec![0; 128];
    file.extend(b"DICM");
    text(&mut file, [0x0002, 0x0010], *b"UI", syntax);
    text(&mut file, [0x0018, 0x0088], *b"DS", "1");
    text(&mut file, [0x0020, 0x000e], *b"UI", "1.2");
    short(&mut file, [0x0028, 0x0002], samples);
    let colours = if samples == 1 { "MONOCHROME2" } else { "RGB" };
    text(&mut file, [0x0028, 0x0004], *b"CS", colours);
    text(&mut file, [0x0028, 0x0008], *b"IS", "2");
    short(&mut file, [0x0028, 0x0010], rows);
    short(&mut file, [0x0028, 0x0011], columns);
    text(&mut file, [0x0028, 0x0030], *b"DS", "1\\1");
    short(&mut file, [0x0028, 0x0100], bits);
    short(&mut file, [0x0028, 0x0101], bits);
    short(&mut file, [0x0028, 0x0102], bits - 1);
    short(&mut file, [0x0028, 0x0103], signed);
    tag(&mut file, [0x7fe0, 0x0010]);
    file.extend(b"OB\0\0\xff\xff\xff\xff");
    item(&mut file, &[]);
    item(&mut file, picture);
    item(&mut file, picture);
    tag(&mut file, [0xfffe, 0xe0dd]);
    file.extend([0; 4]);
    file
}

fn tag(file: &mut Vec<u8>, tag: [u16; 2]) {
    file.extend(tag.iter().flat_map(|part| part.to_le_bytes()));
}

fn element(file: &mut Vec<u8>, at: [u16; 2], kind: [u8; 2], value: &[u8]) {
    tag(file, at);
    file.extend(kind);
    file.extend((value.len() as u16).to_le_bytes());
    file.extend(value);
}

fn short(file: &mut Vec<u8>, at: [u16; 2], value: u16) {
    element(file, at, *b"US", &value.to_le_bytes());
}

/// Padded to an even length, as values are.
fn text(file: &mut Vec<u8>, at: [u16; 2], kind: [u8; 2], value: &str) {
    let mut bytes = value.as_bytes().to_vec();
    if bytes.len() % 2 == 1 {
        bytes.push(if kind == *b"UI" { 0 } else { b' ' });
    }
    element(file, at, kind, &bytes);
}

fn item(file: &mut Vec<u8>, bytes: &[u8]) {
    let padded = bytes.len() + bytes.len() % 2;
    tag(file, [0xfffe, 0xe000]);
    file.extend((padded as u32).to_le_bytes());
    file.extend(bytes);
    file.resize(file.len() + padded - bytes.len(), 0);
}
