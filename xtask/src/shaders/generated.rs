//! Writes `src/shader/generated.rs`.

use std::fmt::Write as _;

use anyhow::{Result, bail};

/// A number shared by shaders and host: `#define NAME value // note`.
#[derive(Debug, PartialEq, Eq)]
pub struct Id {
    name: String,
    value: u32,
    note: Option<String>,
}

/// Prefixes of the names in `bindings.glsl`.
const PREFIXES: [&str; 3] = ["SET_", "BINDING_", "SPEC_"];

/// Reads `bindings.glsl`, in its order. Anything but `#define`s of ids, comments and the include guard is an error.
pub fn parse_ids(text: &str) -> Result<Vec<Id>> {
    let mut ids: Vec<Id> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let (code, note) = match line.split_once("//") {
            Some((code, note)) => (code, Some(note.trim().to_owned())),
            None => (line, None),
        };
        let words: Vec<&str> = code.split_whitespace().collect();
        match words[..] {
            [] | ["#ifndef" | "#define", _] | ["#endif"] => {}
            ["#define", name, value] if PREFIXES.iter().any(|p| name.starts_with(p)) => {
                let Ok(value) = value.parse() else {
                    bail!("line {number}: {name} is {value:?}; it must be a decimal number");
                };
                if ids.iter().any(|id| id.name == name) {
                    bail!("line {number}: {name} is defined twice");
                }
                ids.push(Id {
                    name: name.to_owned(),
                    value,
                    note,
                });
            }
            _ => bail!(
                "line {number}: {:?} is not `#define NAME number` with a name that starts with {}",
                code.trim(),
                PREFIXES.join(" or ")
            ),
        }
    }
    Ok(ids)
}

/// The Rust file for modules (names ascending) and ids.
pub fn render(modules: &[&str], ids: &[Id]) -> String {
    let mut out = String::from(
        "//! SPIR-V modules and the ids of their interface.\n\
         //!\n\
         //! Written by `cargo xtask shaders` from `glsl/`. Do not edit.\n\n",
    );
    out += if modules.is_empty() {
        "use super::Module;\n"
    } else {
        "use super::{Module, include_spirv};\n"
    };
    // Writing to a String cannot fail.
    for name in modules {
        let _ = write!(
            out,
            "\n/// `spirv/{name}.spv`.\n\
             pub static {}: Module = Module {{\n    \
                 name: \"{name}\",\n    \
                 words: include_spirv!(\"{name}.spv\"),\n\
             }};\n",
            constant_name(name),
        );
    }
    out += "\n/// Every module, by name.\n#[rustfmt::skip]\npub static MODULES: &[&Module] = &[\n";
    for name in modules {
        let _ = writeln!(out, "    &{},", constant_name(name));
    }
    out += "];\n";
    for Id { name, value, note } in ids {
        out.push('\n');
        if let Some(note) = note {
            let _ = writeln!(out, "/// {note}");
        }
        let _ = writeln!(out, "pub const {name}: u32 = {value};");
    }
    out
}

fn constant_name(module: &str) -> String {
    module.to_uppercase().replace(['-', '.'], "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_read_with_their_notes() {
        let text = "#ifndef BINDINGS_GLSL\n#define BINDINGS_GLSL\n\n// Sets.\n\
                    #define SET_FRAME 0\n#define BINDING_ATLAS 12 // density\n#endif\n";
        let ids = parse_ids(text).unwrap();
        let rust = render(&["lao", "march"], &ids);
        assert!(rust.contains("pub const SET_FRAME: u32 = 0;"), "{rust}");
        assert!(
            rust.contains("/// density\npub const BINDING_ATLAS: u32 = 12;"),
            "{rust}"
        );
        assert!(rust.contains("    &LAO,\n    &MARCH,\n"), "{rust}");
    }

    #[test]
    fn anything_else_in_bindings_is_named() {
        let message = |text| parse_ids(text).unwrap_err().to_string();
        assert!(message("#define SET_A 1\n#define SET_A 2\n").contains("line 2: SET_A"));
        assert!(message("#define SET_A 0x1").contains("decimal"));
        assert!(message("#define OTHER 1").contains("BINDING_"));
        assert!(message("\nstruct A { float a; };").contains("line 2"));
    }
}
