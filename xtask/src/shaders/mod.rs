//! Compiles `glsl/` into `spirv/` and `src/shader/generated.rs`, and checks that both are up to date.
//!
//! SPIR-V is kept in the repository, so that users need no shader compiler. The manifest beside it records
//! hashes of every source with its includes and of every output: staleness is found without a compiler.

mod compiler;
mod generated;
mod manifest;
mod source;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use compiler::Compiler;
use manifest::{Manifest, ModuleRecord, sha256};
use source::Shader;

/// Optimisation removes the names of struct members, by which host mirrors are checked.
const FLAGS: [&str; 2] = ["-O0", "--target-env=vulkan1.2"];

/// Where everything lies.
struct Paths {
    glsl: PathBuf,
    spirv: PathBuf,
    manifest: PathBuf,
    generated: PathBuf,
}

impl Paths {
    fn new(root: &Path) -> Self {
        Self {
            glsl: root.join("glsl"),
            spirv: root.join("spirv"),
            manifest: root.join("spirv/MANIFEST.toml"),
            generated: root.join("src/shader/generated.rs"),
        }
    }

    fn module(&self, name: &str) -> PathBuf {
        self.spirv.join(format!("{name}.spv"))
    }
}

/// Compiles every shader; writes SPIR-V, manifest and Rust table.
pub fn build(root: &Path) -> Result<String> {
    let paths = Paths::new(root);
    let shaders = source::discover(&paths.glsl)?;
    let rust = generate_rust(&paths, &shaders)?;
    let compiler = Compiler::find()?;

    // Everything compiles before anything is written: a syntax error leaves the checked-in files whole.
    let mut outputs = BTreeMap::new();
    for shader in &shaders {
        let spirv = compiler.compile(shader, &paths.glsl.join("include"))?;
        compiler::validate(&spirv, &shader.name)?;
        outputs.insert(shader.name.clone(), spirv);
    }

    fs::create_dir_all(&paths.spirv).context("spirv/")?;
    for stale in stored_modules(&paths.spirv)? {
        if !outputs.contains_key(&stale) {
            fs::remove_file(paths.module(&stale))?;
        }
    }
    for (name, spirv) in &outputs {
        fs::write(paths.module(name), spirv).with_context(|| format!("spirv/{name}.spv"))?;
    }
    let modules = shaders.iter().map(|shader| {
        let record = ModuleRecord::new(shader, &outputs[&shader.name]);
        (shader.name.clone(), record)
    });
    let manifest = Manifest {
        compiler: compiler.version().to_owned(),
        flags: FLAGS.map(str::to_owned).to_vec(),
        modules: modules.collect(),
    };
    manifest.write(&paths.manifest)?;
    fs::write(&paths.generated, rust).context("src/shader/generated.rs")?;
    Ok(format!(
        "{} modules compiled by {}",
        outputs.len(),
        compiler.version()
    ))
}

/// Compares what is stored with the sources; fails with a list of everything that is out of date.
pub fn check(root: &Path) -> Result<String> {
    let paths = Paths::new(root);
    let shaders = source::discover(&paths.glsl)?;
    let manifest = Manifest::read(&paths.manifest)?;
    let mut stale = compare_manifest(&paths, &manifest, &shaders)?;

    if fs::read_to_string(&paths.generated).unwrap_or_default() != generate_rust(&paths, &shaders)?
    {
        stale.push("src/shader/generated.rs: differs from glsl/".to_owned());
    }

    let bytes = match Compiler::find() {
        Ok(compiler) if compiler.version() == manifest.compiler => {
            for shader in &shaders {
                let spirv = compiler.compile(shader, &paths.glsl.join("include"))?;
                if fs::read(paths.module(&shader.name)).unwrap_or_default() != spirv {
                    stale.push(format!("{}: compiling it gives other bytes", shader.name));
                }
            }
            "sources and bytes".to_owned()
        }
        Ok(compiler) => format!(
            "sources only; {} is here, {} compiled them",
            compiler.version(),
            manifest.compiler
        ),
        Err(_) => "sources only; no compiler here".to_owned(),
    };

    if !stale.is_empty() {
        bail!(
            "out of date, run `cargo xtask shaders`:\n  {}",
            stale.join("\n  ")
        );
    }
    Ok(format!(
        "{} modules up to date (compared: {bytes})",
        shaders.len()
    ))
}

/// Differences between the manifest, the sources and the stored SPIR-V.
fn compare_manifest(paths: &Paths, manifest: &Manifest, shaders: &[Shader]) -> Result<Vec<String>> {
    let mut stale = Vec::new();
    if manifest.flags != FLAGS {
        stale.push(format!(
            "flags: compiled with {:?}, now {FLAGS:?}",
            manifest.flags
        ));
    }
    for shader in shaders {
        let name = &shader.name;
        let Some(record) = manifest.modules.get(name) else {
            stale.push(format!("{name}: never compiled"));
            continue;
        };
        if !record.matches_source(shader) {
            stale.push(format!(
                "{name}: {} or what it includes has changed",
                shader.source
            ));
        }
        match fs::read(paths.module(name)) {
            Ok(spirv) if sha256(&spirv) == record.spirv_sha256 => {}
            Ok(_) => stale.push(format!("{name}: spirv/{name}.spv was changed by hand")),
            Err(error) => stale.push(format!("{name}: spirv/{name}.spv: {error}")),
        }
    }
    let is_built = |name: &String| shaders.iter().any(|s| s.name == *name);
    let recorded = manifest.modules.keys().cloned();
    let mut orphans: Vec<String> = recorded.chain(stored_modules(&paths.spirv)?).collect();
    orphans.retain(|name| !is_built(name));
    orphans.sort();
    orphans.dedup();
    stale.extend(
        orphans
            .iter()
            .map(|name| format!("{name}: no source in glsl/")),
    );
    Ok(stale)
}

fn generate_rust(paths: &Paths, shaders: &[Shader]) -> Result<String> {
    let bindings = paths.glsl.join("include/bindings.glsl");
    let ids = match fs::read_to_string(&bindings) {
        Ok(text) => generated::parse_ids(&text).context("glsl/include/bindings.glsl")?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(error).context("glsl/include/bindings.glsl"),
    };
    let names: Vec<&str> = shaders.iter().map(|s| s.name.as_str()).collect();
    Ok(generated::render(&names, &ids))
}

/// Names of the `.spv` files in a folder; none when there is no folder.
fn stored_modules(spirv: &Path) -> Result<Vec<String>> {
    if !spirv.is_dir() {
        return Ok(Vec::new());
    }
    source::names_with_extension(spirv, "spv")
}

#[cfg(test)]
mod tests;
