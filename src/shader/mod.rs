//! What the host and the compute shaders agree on: the compiled SPIR-V, the host mirrors of GLSL structs, and
//! the interface of every pass.
//!
//! GLSL is the source of the set, binding and specialization ids; `cargo xtask shaders` writes them into
//! [`generated`] together with the SPIR-V. The mirrors in [`structs`] and the interfaces in [`interface`] are
//! written by hand and checked against the SPIR-V by reflection (`tests/shaders.rs`).

pub mod generated;
pub mod interface;
mod layout;
pub mod structs;

pub use interface::{Access, Binding, DescriptorKind, PASSES, PassInterface};
pub use layout::{FieldLayout, GpuStruct, StructLayout};

/// A compiled compute shader with the entry point `main`.
#[derive(Debug)]
pub struct Module {
    /// File name of the SPIR-V without its extension.
    pub name: &'static str,
    /// SPIR-V, in the host's byte order.
    pub words: &'static [u32],
}

/// SPIR-V words from the bytes of a file. Evaluated at compile time: a file of another length than `4 * N` does
/// not compile.
const fn words_from_le_bytes<const N: usize>(bytes: &[u8]) -> [u32; N] {
    assert!(
        bytes.len() == 4 * N,
        "SPIR-V is a whole number of 32-bit words"
    );
    let mut words = [0; N];
    let mut i = 0;
    while i < N {
        let b = 4 * i;
        words[i] = u32::from_le_bytes([bytes[b], bytes[b + 1], bytes[b + 2], bytes[b + 3]]);
        i += 1;
    }
    words
}

/// The words of a file in `spirv/`, as a `&'static [u32]`.
macro_rules! include_spirv {
    ($file:literal) => {{
        const BYTES: &[u8] = include_bytes!(concat!("../../spirv/", $file));
        const WORDS: [u32; BYTES.len() / 4] = $crate::shader::words_from_le_bytes(BYTES);
        static STORED: [u32; WORDS.len()] = WORDS;
        &STORED
    }};
}
use include_spirv;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spirv_bytes_become_words_in_little_endian_order() {
        let words: [u32; 2] = words_from_le_bytes(&[0x03, 0x02, 0x23, 0x07, 1, 0, 0, 0]);
        assert_eq!(
            words,
            [0x0723_0203, 1],
            "the SPIR-V magic number comes first"
        );
    }
}
