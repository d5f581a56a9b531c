//! The shader compiler: the `glslc` program, or the shaderc library it is made of.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use anyhow::{Context as _, Result, bail};

use super::FLAGS;
use super::source::Shader;

/// A compiler that was found.
pub struct Compiler {
    version: String,
    #[cfg(feature = "shaderc")]
    library: shaderc::Compiler,
}

impl Compiler {
    /// Compiler and version, as the manifest records it.
    pub fn version(&self) -> &str {
        &self.version
    }
}

#[cfg(not(feature = "shaderc"))]
impl Compiler {
    /// The `glslc` on the path.
    pub fn find() -> Result<Self> {
        let output = Command::new("glslc").arg("--version").output().context(
            "cannot run glslc: install it (Debian, Ubuntu: `apt-get install glslc`), \
             or build the compiler from source with `cargo run -p xtask --features shaderc -- shaders`",
        )?;
        // Three lines: shaderc, spirv-tools and glslang, each with its version; then the default target.
        let text = String::from_utf8_lossy(&output.stdout);
        let parts: Vec<&str> = text.lines().take_while(|line| !line.is_empty()).collect();
        Ok(Self {
            version: format!("glslc ({})", parts.join(", ")),
        })
    }

    /// SPIR-V of a shader.
    pub fn compile(&self, shader: &Shader, include: &Path) -> Result<Vec<u8>> {
        let mut command = Command::new("glslc");
        command.args(FLAGS).args(["-fshader-stage=compute", "-I"]);
        command.arg(include);
        command.args(shader.defines.iter().map(|define| format!("-D{define}")));
        command.arg(&shader.path).args(["-o", "-"]);
        let output = command.output().context("cannot run glslc")?;
        succeeded("glslc", &shader.name, &output)?;
        Ok(output.stdout)
    }
}

#[cfg(feature = "shaderc")]
impl Compiler {
    /// The library, built from source.
    pub fn find() -> Result<Self> {
        let (version, revision) = shaderc::get_spirv_version();
        Ok(Self {
            version: format!("shaderc crate 0.10 (SPIR-V {version:#x}.{revision})"),
            library: shaderc::Compiler::new()?,
        })
    }

    /// SPIR-V of a shader.
    pub fn compile(&self, shader: &Shader, include: &Path) -> Result<Vec<u8>> {
        const {
            assert!(FLAGS.len() == 2, "the options below say the same as FLAGS");
        }
        let mut options = shaderc::CompileOptions::new()?;
        options.set_optimization_level(shaderc::OptimizationLevel::Zero);
        options.set_target_env(
            shaderc::TargetEnv::Vulkan,
            shaderc::EnvVersion::Vulkan1_2 as u32,
        );
        options.set_include_callback(|name, _kind, includer, _depth| {
            let path = super::source::resolve(name, Path::new(includer), include)
                .map_err(|error| error.to_string())?;
            let content = std::fs::read_to_string(&path).map_err(|error| error.to_string())?;
            Ok(shaderc::ResolvedInclude {
                resolved_name: path.display().to_string(),
                content,
            })
        });
        for define in &shader.defines {
            match define.split_once('=') {
                Some((name, value)) => options.add_macro_definition(name, Some(value)),
                None => options.add_macro_definition(define, None),
            }
        }
        let text = std::fs::read_to_string(&shader.path)?;
        let artifact = self.library.compile_into_spirv(
            &text,
            shaderc::ShaderKind::Compute,
            &shader.path.display().to_string(),
            "main",
            Some(&options),
        )?;
        Ok(artifact.as_binary_u8().to_vec())
    }
}

/// Runs `spirv-val` over a module where it is installed.
pub fn validate(spirv: &[u8], name: &str) -> Result<()> {
    let child = Command::new("spirv-val")
        .args(["--target-env", "vulkan1.2", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let Ok(mut child) = child else { return Ok(()) };
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(spirv).context("spirv-val")?;
    }
    let output = child.wait_with_output().context("spirv-val")?;
    succeeded("spirv-val", name, &output)
}

fn succeeded(program: &str, name: &str, output: &Output) -> Result<()> {
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!("{program} failed for {name:?}:\n{}", said.trim_end());
    }
    Ok(())
}
