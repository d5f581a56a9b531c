//! The command line.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum, value_parser};
use umbravox::headless;

use crate::terminal;

/// Volume renderer on Vulkan compute.
#[derive(Parser)]
#[command(version, about)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Log more to stderr; twice: still more.
    #[arg(short, long, action = ArgAction::Count, global = true)]
    pub(crate) verbose: u8,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Render a scene, or a volume with a camera, transfer function and light that suit it.
    Render(RenderArgs),
    /// Tell what a volume holds.
    Info(InfoArgs),
    /// Tell the value at a point of the world, or what a pixel shows.
    Probe(ProbeArgs),
    /// List the formats that are read.
    Formats(FormatsArgs),
    /// List, convert and plot transfer functions.
    Tf(TfArgs),
    /// Export the light volume of local ambient occlusion.
    Light(LightArgs),
    /// Time frames of an orbit.
    Bench(BenchArgs),
    /// Check a device: closed forms, invariants and gradients, on volumes made for it.
    Conformance(ConformanceArgs),
    /// List Vulkan devices, and why each is or is not usable.
    Devices(DevicesArgs),
    /// Print the JSON Schema of the scene file.
    Schema,
}

#[derive(Args)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) input: RenderInputArgs,
    /// Picture to write, .png or .exr; may be repeated. A number pattern (frame_%04d.png) gets one picture for each
    /// direction of ambient occlusion, as the light refines.
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    pub(crate) outputs: Vec<PathBuf>,
    /// Statistics to write, JSON.
    #[arg(long, value_name = "STATS.json")]
    pub(crate) stats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Args)]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
#[command(group(clap::ArgGroup::new("place").required(true).args(["world", "pixel"])))]
pub(crate) struct ProbeArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// A point, in millimetres (LPS).
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub(crate) world: Option<[f64; 3]>,
    /// A pixel: column and row, from 0, 0 at the top left.
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true)]
    pub(crate) pixel: Option<[u32; 2]>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Args)]
pub(crate) struct ConformanceArgs {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Args)]
pub(crate) struct FormatsArgs {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct TfArgs {
    #[command(subcommand)]
    pub(crate) command: Option<TfCommand>,
}

#[derive(Subcommand)]
pub(crate) enum TfCommand {
    /// List the presets (what `tf` alone does).
    List(TfListArgs),
    /// Write a preset or a file in another form.
    Convert(TfConvertArgs),
    /// Draw a preset or a file, with the histogram of a volume behind it.
    Plot(TfPlotArgs),
}

#[derive(Args)]
pub(crate) struct TfListArgs {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct TfConvertArgs {
    #[command(flatten)]
    pub(crate) source: TfSource,
    /// File to write: .json (a scene's transfer_function), .xml (ParaView), .vp or .vp.json (3D Slicer).
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Form to write, whatever the extension: umbravox, paraview-json, paraview-xml, slicer-vp, slicer-json.
    #[arg(long, value_name = "FORM")]
    pub(crate) format: Option<String>,
}

#[derive(Args)]
pub(crate) struct TfPlotArgs {
    #[command(flatten)]
    pub(crate) source: TfSource,
    /// Picture to write, .png.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
}

/// A transfer function.
#[derive(Args)]
pub(crate) struct TfSource {
    /// Name of a preset, or a file: of a scene's transfer_function, ParaView or 3D Slicer.
    #[arg(value_name = "PRESET|FILE")]
    pub(crate) input: String,
    /// Volume whose values the presets follow, and whose histogram is drawn.
    #[arg(long, value_name = "FILE")]
    pub(crate) volume: Option<PathBuf>,
    /// Take colours as they are, as `"color_management": "none"` does in a scene.
    #[arg(long)]
    pub(crate) unmanaged: bool,
}

#[derive(Args)]
pub(crate) struct LightArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// Light volume to write, .nrrd: float RGBA on the full grid.
    #[arg(short, long, value_name = "LIGHT.nrrd")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Args)]
pub(crate) struct BenchArgs {
    #[command(flatten)]
    pub(crate) input: InputArgs,
    /// Frames to time.
    #[arg(long, default_value_t = 20, value_parser = value_parser!(u32).range(1..=1_000_000), allow_negative_numbers = true)]
    pub(crate) frames: u32,
    /// Frames before those.
    #[arg(long, default_value_t = 3, allow_negative_numbers = true)]
    pub(crate) warmup: u32,
    /// Degrees that the camera turns about the volume from frame to frame.
    #[arg(long, default_value_t = 5.0, value_name = "DEGREES", value_parser = finite, allow_negative_numbers = true)]
    pub(crate) orbit: f64,
    /// Draw a frame for each line on stdin and answer with its times, a line of JSON, so that another program can take turns
    /// frame by frame; --frames does not matter then. The report follows the last line.
    #[arg(long)]
    pub(crate) paced: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

#[derive(Args)]
pub(crate) struct DevicesArgs {
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// A scene or volume, and changes to the scene.
#[derive(Args)]
pub(crate) struct InputArgs {
    /// Scene file, or volume.
    #[arg(value_name = "SCENE.json|VOLUME")]
    pub(crate) path: PathBuf,
    /// Change the scene, as in march.step=0.25; may be repeated. The value is JSON, or else a string.
    #[arg(long = "set", value_name = "JSON.POINTER=VALUE")]
    pub(crate) overrides: Vec<String>,
}

/// What to render.
#[derive(Args)]
pub(crate) struct RenderInputArgs {
    /// Scene file, or volume.
    #[arg(
        value_name = "SCENE.json|VOLUME",
        required_unless_present = "reproduce"
    )]
    path: Option<PathBuf>,
    /// Change the scene, as in march.step=0.25; may be repeated. The value is JSON, or else a string.
    #[arg(long = "set", value_name = "JSON.POINTER=VALUE")]
    overrides: Vec<String>,
    /// Render a picture of this program again, from what its file says of its origin.
    #[arg(long, value_name = "PICTURE", conflicts_with_all = ["path", "overrides"])]
    reproduce: Option<PathBuf>,
    /// With --reproduce: where the data of that picture is now.
    #[arg(long, value_name = "VOLUME")]
    pub(crate) volume: Option<PathBuf>,
}

/// What [`RenderInputArgs`] come down to.
pub(crate) enum RenderInput {
    Scene(InputArgs),
    /// A picture to render again.
    Picture(PathBuf),
}

impl RenderInputArgs {
    pub(crate) fn resolve(&self) -> RenderInput {
        match &self.reproduce {
            Some(picture) => RenderInput::Picture(picture.clone()),
            None => RenderInput::Scene(InputArgs {
                path: self.path.clone().unwrap_or_default(),
                overrides: self.overrides.clone(),
            }),
        }
    }
}

#[derive(Args)]
pub(crate) struct DeviceArgs {
    /// Device to render on, as `umbravox devices` lists them.
    #[arg(long, value_name = "NAME|INDEX")]
    device: Option<String>,
    /// Neither read nor write the cache of compiled pipelines.
    #[arg(long)]
    no_pipeline_cache: bool,
    /// Turn on Vulkan validation.
    #[arg(long)]
    validation: bool,
    /// Edge of the tiles that a picture is rendered in, pixels; changes no pixel.
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..))]
    tile: Option<u32>,
    /// Where device memory comes from.
    #[arg(long, value_enum, default_value_t)]
    memory: Memory,
}

/// Memory back ends.
#[derive(Clone, Copy, Default, ValueEnum)]
enum Memory {
    /// The gpu-allocator crate.
    #[default]
    GpuAllocator,
    /// AMD's Vulkan Memory Allocator.
    #[cfg(feature = "vk-mem")]
    Vma,
}

impl DeviceArgs {
    pub(crate) fn options(&self) -> headless::Options {
        headless::Options {
            device: self.device.clone(),
            validation: self.validation,
            pipeline_cache: !self.no_pipeline_cache,
            tile: self.tile,
            memory: match self.memory {
                Memory::GpuAllocator => headless::MemoryChoice::GpuAllocator,
                #[cfg(feature = "vk-mem")]
                Memory::Vma => headless::MemoryChoice::Vma,
            },
        }
    }
}

fn point(text: &str) -> Result<[f64; 3], String> {
    let numbers = text
        .split(',')
        .map(|number| finite(number.trim()))
        .collect::<Result<Vec<f64>, _>>();
    numbers
        .ok()
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| "give three finite numbers, as in 12.5,-3,40".into())
}

fn pixel(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split(',').map(|number| number.trim().parse());
    let numbers: Result<Vec<u32>, _> = numbers.collect();
    numbers
        .ok()
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| "give a column and a row, as in 120,80".into())
}

fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("give a finite number".into()),
    }
}

/// Parses the command line; help and mistakes are printed here.
///
/// # Errors
/// The exit status, when there is nothing left to do.
pub(crate) fn parse() -> Result<Cli, ExitCode> {
    Cli::try_parse().map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // Help that cannot be printed leaves nobody to tell.
            let _ = error.print();
            ExitCode::from(error.exit_code() as u8)
        }
        _ => {
            let text = error.to_string();
            let message = text.lines().take_while(|line| !line.starts_with("Usage:"));
            terminal::report_usage(message)
        }
    })
}
