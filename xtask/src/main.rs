//! Developer tasks, run as `cargo xtask TASK`.

mod shaders;

use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask shaders            compile glsl/ into spirv/ and src/shader/generated.rs
       cargo xtask shaders --check    fail when spirv/ or src/shader/generated.rs is out of date
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let outcome = match args[..] {
        ["shaders"] => shaders::build(&root),
        ["shaders", "--check"] => shaders::check(&root),
        _ => {
            eprint!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(summary) => {
            println!("{summary}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
