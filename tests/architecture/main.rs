//! The shape of the repository: module direction, where `unsafe` is, file sizes, and the header of every pass.

mod rust_code;

use std::fs;
use std::path::{Path, PathBuf};

use rust_code::code_of;

/// Modules of the library from the bottom up, each with the modules that it may use.
const MODULES: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("volume", &["error"]),
    ("picture", &[]),
    ("scene", &["error", "volume"]),
    ("shader", &[]),
    ("io", &["error", "volume", "scene"]),
    ("field", &["volume", "scene"]),
    ("occlusion", &["volume", "scene", "field"]),
    ("analytic", &[]),
    (
        "reference",
        &["error", "volume", "scene", "field", "occlusion", "analytic"],
    ),
    ("gpu", &["error", "shader"]),
    ("atlas", &["error", "volume", "scene", "shader", "gpu"]),
    (
        "pass",
        &["error", "volume", "scene", "shader", "gpu", "atlas"],
    ),
    (
        "renderer",
        &[
            "error",
            "volume",
            "scene",
            "occlusion",
            "shader",
            "gpu",
            "atlas",
            "pass",
        ],
    ),
    (
        "embed",
        &[
            "error", "volume", "scene", "shader", "gpu", "atlas", "pass", "renderer",
        ],
    ),
    (
        "headless",
        &[
            "error", "volume", "scene", "field", "shader", "gpu", "atlas", "pass", "renderer",
            "embed", "picture",
        ],
    ),
    ("output", &["error", "picture", "scene"]),
    (
        "conformance",
        &[
            "error", "volume", "scene", "field", "analytic", "headless", "picture",
        ],
    ),
];

/// The only places with `unsafe` in the library.
const UNSAFE_ALLOWED: [&str; 2] = ["src/gpu/", "src/embed.rs"];

const MAX_LINES: usize = 600;
const MAX_LINES_OF_PASS_SHADER: usize = 150;

/// What the header of a pass says, in this order.
const PASS_HEADER: [&str; 6] = ["Reads", "Writes", "Grid", "Method", "Limits", "Twin"];

/// A text file of the repository.
struct File {
    /// From the root of the repository, with `/`.
    path: String,
    text: String,
}

/// Every file below a folder with one of these extensions; none when there is no such folder.
fn files(folder: &str, extensions: &[&str]) -> Vec<File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    let mut folders = vec![root.join(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        let paths = entries.map(|entry| entry.expect("a readable folder").path());
        for path in paths.collect::<Vec<PathBuf>>() {
            let extension = path.extension().and_then(|e| e.to_str());
            if path.is_dir() {
                folders.push(path);
            } else if extension.is_some_and(|e| extensions.contains(&e)) {
                let relative = path.strip_prefix(root).expect("below the root");
                found.push(File {
                    path: relative.to_str().expect("UTF-8").replace('\\', "/"),
                    text: fs::read_to_string(&path).expect("UTF-8"),
                });
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

fn assert_none(complaints: Vec<String>) {
    assert!(complaints.is_empty(), "\n  {}", complaints.join("\n  "));
}

/// Identifiers that follow `crate::`, those in `crate::{…}` included.
fn uses_of_crate(code: &str) -> Vec<String> {
    let identifier = |text: &str| -> String {
        let text = text.trim_start();
        let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_'));
        text[..end.unwrap_or(text.len())].to_owned()
    };
    let mut used = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let path = code[at + "crate::".len()..].trim_start();
        let Some(group) = path.strip_prefix('{') else {
            used.push(identifier(path));
            continue;
        };
        let mut depth = 0;
        let mut item = 0;
        for (end, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth > 0 => depth -= 1,
                ',' | '}' if depth == 0 => {
                    used.push(identifier(&group[item..end]));
                    item = end + 1;
                    if c == '}' {
                        break;
                    }
                }
                _ => {}
            }
        }
    }
    used.retain(|name| !name.is_empty());
    used
}

/// The module of the library that a file belongs to; `None` for `lib.rs` and the programs.
fn module_of(path: &str) -> Option<&str> {
    let path = path.strip_prefix("src/")?;
    let first = path.split('/').next()?;
    let module = first.strip_suffix(".rs").unwrap_or(first);
    (module != "lib" && module != "bin").then_some(module)
}

/// What is wrong with the modules that a file uses.
fn direction_complaints(path: &str, source: &str) -> Vec<String> {
    let Some(module) = module_of(path) else {
        return Vec::new();
    };
    let Some((_, allowed)) = MODULES.iter().find(|(name, _)| *name == module) else {
        return vec![format!(
            "{path}: module {module} is not in the list of modules"
        )];
    };
    let code = code_of(source);
    let mut complaints: Vec<String> = uses_of_crate(&code)
        .iter()
        .filter(|used| *used != module && !allowed.contains(&used.as_str()))
        .map(|used| match MODULES.iter().any(|(name, _)| name == used) {
            true => format!("{path}: {module} may not use {used}"),
            false => format!("{path}: crate::{used} does not name a module; use its own path"),
        })
        .collect();
    // So many `super::` lead out of the top-level module; in a test module at the end of a file, one more.
    let depth = path.matches('/').count() - usize::from(path.ends_with("/mod.rs"));
    let before_tests = code.split("mod tests").next().unwrap_or(&code);
    if before_tests.contains(&"super::".repeat(depth)) {
        complaints.push(format!("{path}: super leaves the module {module}"));
    }
    complaints
}

#[test]
fn modules_use_only_modules_below_them() {
    let sources = files("src", &["rs"]);
    assert!(sources.len() > 10, "the sources were found");
    let complaints = sources
        .iter()
        .flat_map(|file| direction_complaints(&file.path, &file.text));
    assert_none(complaints.collect());
}

#[test]
fn module_list_is_bottom_up() {
    for (place, (module, allowed)) in MODULES.iter().enumerate() {
        for used in *allowed {
            let below = MODULES[..place].iter().any(|(name, _)| name == used);
            assert!(below, "{module} uses {used}, which is not below it");
        }
    }
}

#[test]
fn programs_use_the_public_api_only() {
    let complaints = files("src/bin", &["rs"])
        .iter()
        .filter(|file| code_of(&file.text).contains("umbravox::shader"))
        .map(|file| format!("{}: shader is not part of the API", file.path))
        .collect();
    assert_none(complaints);
}

/// True when `unsafe` is used as a keyword.
fn has_unsafe(source: &str) -> bool {
    code_of(source)
        .split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .any(|word| word == "unsafe")
}

#[test]
fn unsafe_is_only_where_vulkan_is_called() {
    let complaints = files("src", &["rs"])
        .iter()
        .filter(|file| {
            !UNSAFE_ALLOWED
                .iter()
                .any(|place| file.path.starts_with(place))
        })
        .filter(|file| has_unsafe(&file.text))
        .map(|file| format!("{}: unsafe", file.path))
        .collect();
    assert_none(complaints);
}

#[test]
fn files_are_short() {
    let folders = ["src", "glsl", "tests", "bench", "xtask/src"];
    let complaints = folders
        .iter()
        .flat_map(|folder| files(folder, &["rs", "glsl", "comp"]))
        .filter_map(|file| {
            let is_pass = file.path.starts_with("glsl/") && file.path.ends_with(".comp");
            let limit = if is_pass {
                MAX_LINES_OF_PASS_SHADER
            } else {
                MAX_LINES
            };
            let lines = file.text.lines().count();
            (lines > limit).then(|| format!("{}: {lines} lines, at most {limit}", file.path))
        })
        .collect();
    assert_none(complaints);
}

/// What is missing in the header of a pass: its lines are `//! Reads …`, `//! Writes …` and so on, and the twin is a
/// file of the repository, or `none` with the reason.
fn header_complaints(path: &str, source: &str) -> Vec<String> {
    let header: Vec<&str> = source
        .lines()
        .map_while(|line| line.strip_prefix("//!"))
        .map(str::trim)
        .collect();
    let mut complaints = Vec::new();
    let mut from = 0;
    for label in PASS_HEADER {
        let place = header[from..].iter().position(|line| {
            line.strip_prefix(label)
                .is_some_and(|rest| rest.starts_with(' ') && !rest.trim().is_empty())
        });
        match place {
            Some(place) => from += place + 1,
            None => complaints.push(format!("{path}: the header has no line `//! {label} …`")),
        }
    }
    let twin = header.iter().find_map(|line| line.strip_prefix("Twin "));
    if let Some(twin) = twin.and_then(|text| text.split_whitespace().next())
        && twin.trim_end_matches(':') != "none"
        && !Path::new(env!("CARGO_MANIFEST_DIR")).join(twin).is_file()
    {
        complaints.push(format!("{path}: the twin {twin} does not exist"));
    }
    complaints
}

#[test]
fn passes_state_what_they_do() {
    let complaints = files("src/pass", &["rs"])
        .iter()
        .filter(|file| !file.path.ends_with("/mod.rs"))
        .flat_map(|file| header_complaints(&file.path, &file.text))
        .collect();
    assert_none(complaints);
}

/// The checks above notice what they are for.
mod checks {
    use super::*;

    #[test]
    fn forbidden_uses_are_named() {
        let complaints = |path, source| direction_complaints(path, source).join("; ");
        assert_eq!(
            complaints("src/io/nrrd.rs", "use crate::volume::Volume;"),
            ""
        );
        assert_eq!(complaints("src/io/nrrd.rs", "//! [`crate::gpu`]"), "");
        assert_eq!(
            complaints(
                "src/io/nrrd.rs",
                "use crate::{error::Error, gpu::{Image, Buffer}};"
            ),
            "src/io/nrrd.rs: io may not use gpu"
        );
        let by_path = complaints("src/gpu/image.rs", "fn f(v: &crate::volume::Volume) {}");
        assert_eq!(by_path, "src/gpu/image.rs: gpu may not use volume");
        let from_root = complaints("src/io/mod.rs", "use crate::Error;");
        assert!(from_root.contains("crate::Error"), "{from_root}");
        let unlisted = complaints("src/misc.rs", "");
        assert!(unlisted.contains("not in the list"), "{unlisted}");
    }

    #[test]
    fn super_may_not_leave_a_module() {
        let leaves = |path, source: &str| {
            let complaints = direction_complaints(path, source);
            complaints.iter().any(|c| c.contains("super leaves"))
        };
        assert!(leaves("src/io/mod.rs", "use super::volume::Volume;"));
        assert!(leaves(
            "src/io/nrrd.rs",
            "use super::super::volume::Volume;"
        ));
        assert!(!leaves("src/io/nrrd.rs", "use super::Format;"));
        assert!(!leaves("src/io/mod.rs", "mod tests { use super::*; }"));
    }

    #[test]
    fn unsafe_is_found_as_a_keyword_only() {
        assert!(has_unsafe("pub unsafe fn f() {}"));
        assert!(has_unsafe("fn f() { let x = unsafe{ g() }; }"));
        assert!(!has_unsafe("#![deny(unsafe_code)] // unsafe"));
        assert!(!has_unsafe("fn f() -> &'static str { \"unsafe\" }"));
    }

    #[test]
    fn an_incomplete_header_is_noticed() {
        let whole = "//! March.\n//!\n//! Reads   atlas\n//! Writes  color\n//! Grid    8x8\n\
                     //! Method  paper\n//! Limits  none\n//! Twin    src/error.rs\n";
        assert_eq!(header_complaints("p", whole), [""; 0]);
        let no_grid = whole.replace("//! Grid    8x8\n", "");
        assert_eq!(header_complaints("p", &no_grid).len(), 1);
        let no_twin = whole.replace("src/error.rs", "src/none.rs");
        assert_eq!(
            header_complaints("p", &no_twin),
            ["p: the twin src/none.rs does not exist"]
        );
    }
}
