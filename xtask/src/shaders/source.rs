//! Finds the shaders to compile and expands their includes.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

/// One SPIR-V module to be.
#[derive(Debug, PartialEq, Eq)]
pub struct Shader {
    /// Name of the module: the file's, or the permutation's.
    pub name: String,
    /// File name in `glsl/`.
    pub source: String,
    /// Full path of the source.
    pub path: PathBuf,
    /// `NAME` or `NAME=VALUE`, in the order given.
    pub defines: Vec<String>,
    /// Source with every include replaced by its text, conditions not evaluated.
    pub expanded: String,
}

/// Every `glsl/*.comp` and every line of `glsl/permutations.txt`, by name ascending.
pub fn discover(glsl: &Path) -> Result<Vec<Shader>> {
    let sources = if glsl.is_dir() {
        names_with_extension(glsl, "comp")?
    } else {
        Vec::new()
    };
    let mut wanted: Vec<(String, String, Vec<String>)> = sources
        .iter()
        .map(|stem| (stem.clone(), format!("{stem}.comp"), Vec::new()))
        .collect();
    let permutations = glsl.join("permutations.txt");
    if permutations.is_file() {
        let text = fs::read_to_string(&permutations)?;
        wanted.extend(parse_permutations(&text).context("glsl/permutations.txt")?);
    }
    wanted.sort();
    if let Some(pair) = wanted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        bail!("two modules are named {:?}", pair[0].0);
    }
    let shader = |(name, source, defines): (String, String, Vec<String>)| {
        let path = glsl.join(&source);
        let expanded = expand(&path, &glsl.join("include"), &mut Vec::new())
            .with_context(|| format!("module {name:?}"))?;
        Ok(Shader {
            name,
            source,
            path,
            defines,
            expanded,
        })
    };
    wanted.into_iter().map(shader).collect()
}

/// Lines `output_name source -DNAME -DNAME=VALUE …`; `#` starts a comment.
fn parse_permutations(text: &str) -> Result<Vec<(String, String, Vec<String>)>> {
    let mut permutations = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split('#').next().unwrap_or("").split_whitespace();
        let Some(name) = words.next() else { continue };
        let Some(source) = words.next() else {
            bail!("line {number}: expected `output_name source -DNAME…`, found only {name:?}");
        };
        let defines = words.map(|word| match word.strip_prefix("-D") {
            Some(define) if !define.is_empty() => Ok(define.to_owned()),
            _ => bail!("line {number}: expected -DNAME or -DNAME=VALUE, found {word:?}"),
        });
        permutations.push((
            name.to_owned(),
            source.to_owned(),
            defines.collect::<Result<_>>()?,
        ));
    }
    Ok(permutations)
}

/// The text of a file with every `#include "…"` replaced by the expanded text of that file. `open` holds the files
/// that are being expanded, to find cycles.
fn expand(path: &Path, include: &Path, open: &mut Vec<PathBuf>) -> Result<String> {
    if open.iter().any(|p| p == path) {
        bail!("{} includes itself", path.display());
    }
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    open.push(path.to_owned());
    let mut expanded = String::with_capacity(text.len());
    for line in text.lines() {
        match included(line) {
            Some(name) => {
                let file = resolve(name, path, include)
                    .with_context(|| format!("{}: {line}", path.display()))?;
                expanded += &expand(&file, include, open)?;
            }
            None => {
                expanded += line;
                expanded.push('\n');
            }
        }
    }
    open.pop();
    Ok(expanded)
}

/// `x.glsl` of a line `#include "x.glsl"`.
fn included(line: &str) -> Option<&str> {
    let directive = line.trim_start().strip_prefix('#')?.trim_start();
    let name = directive
        .strip_prefix("include")?
        .trim_start()
        .strip_prefix('"')?;
    name.split_once('"').map(|(name, _)| name)
}

/// The file that an include means: beside the including file, else in the include folder, as glslc does.
pub fn resolve(name: &str, includer: &Path, include: &Path) -> Result<PathBuf> {
    let beside = includer.parent().map(|folder| folder.join(name));
    let candidates = beside.into_iter().chain([include.join(name)]);
    let mut found = candidates.filter(|path| path.is_file());
    found
        .next()
        .with_context(|| format!("{name:?} is neither beside it nor in {}", include.display()))
}

/// Stems of the files of one extension in a folder, ascending.
pub fn names_with_extension(folder: &Path, extension: &str) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == extension)
            && let Some(stem) = path.file_stem().and_then(|s| s.to_str())
        {
            names.push(stem.to_owned());
        }
    }
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_are_read_and_bad_lines_named() {
        let text = "# comment\n\nmarch_u8 march.comp -DVOXEL_U8 -DBITS=8 # narrow\n";
        let expected = (
            "march_u8".to_owned(),
            "march.comp".to_owned(),
            vec!["VOXEL_U8".to_owned(), "BITS=8".to_owned()],
        );
        assert_eq!(parse_permutations(text).unwrap(), [expected]);

        let message = |text| parse_permutations(text).unwrap_err().to_string();
        assert!(message("\nmarch_u8").starts_with("line 2:"));
        assert!(message("a a.comp VOXEL_U8").contains("VOXEL_U8"));
        assert!(message("a a.comp -D").contains("\"-D\""));
    }

    #[test]
    fn include_directives_are_recognised() {
        assert_eq!(included("#include \"ray.glsl\""), Some("ray.glsl"));
        assert_eq!(included("  # include \"a/b.glsl\" // x"), Some("a/b.glsl"));
        assert_eq!(included("// #include \"ray.glsl\""), None);
        assert_eq!(
            included("#extension GL_GOOGLE_include_directive : require"),
            None
        );
    }

    #[test]
    fn includes_are_expanded_and_cycles_refused() {
        let folder = tempfile::tempdir().unwrap();
        let include = folder.path().join("include");
        fs::create_dir(&include).unwrap();
        fs::write(include.join("a.glsl"), "#include \"b.glsl\"\na\n").unwrap();
        fs::write(include.join("b.glsl"), "b\n").unwrap();
        fs::write(include.join("loop.glsl"), "#include \"loop.glsl\"\n").unwrap();
        let main = folder.path().join("main.comp");

        fs::write(&main, "#include \"a.glsl\"\nmain\n").unwrap();
        let expanded = expand(&main, &include, &mut Vec::new()).unwrap();
        assert_eq!(expanded, "b\na\nmain\n");

        fs::write(&main, "#include \"loop.glsl\"\n").unwrap();
        let error = expand(&main, &include, &mut Vec::new()).unwrap_err();
        assert!(error.to_string().contains("includes itself"), "{error}");

        fs::write(&main, "#include \"none.glsl\"\n").unwrap();
        let error = expand(&main, &include, &mut Vec::new()).unwrap_err();
        assert!(format!("{error:#}").contains("none.glsl"), "{error:#}");
    }
}
