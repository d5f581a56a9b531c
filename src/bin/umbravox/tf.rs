//! `umbravox tf`.

use std::path::Path;

use serde::Serialize;
use umbravox::io::{self, ReadOptions};
use umbravox::output::{self, PlotHistogram};
use umbravox::scene::{ColorManagement, Curve, PRESETS, TransferFile, TransferFormat};
use umbravox::volume::{Summary, Volume};
use umbravox::{Error, Result};

use crate::args::{TfArgs, TfCommand, TfConvertArgs, TfPlotArgs, TfSource};
use crate::{input, terminal};

/// Length of presets without a volume, mm.
const UNIT: f64 = 1.0;

pub(crate) fn run(args: &TfArgs) -> Result<()> {
    match &args.command {
        None => list(false),
        Some(TfCommand::List(args)) => list(args.json),
        Some(TfCommand::Convert(args)) => convert(args),
        Some(TfCommand::Plot(args)) => plot(args),
    }
}

/// A row of the list.
#[derive(Serialize)]
struct Row {
    name: &'static str,
    description: &'static str,
    /// It follows the values of a volume.
    needs_volume: bool,
}

fn list(json: bool) -> Result<()> {
    let rows: Vec<Row> = PRESETS
        .iter()
        .map(|preset| Row {
            name: preset.name,
            description: preset.description,
            needs_volume: preset.fixed_points().is_none(),
        })
        .collect();
    if json {
        return terminal::print_json(&rows);
    }
    let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let text: String = rows
        .iter()
        .map(|row| format!("{:width$}  {}\n", row.name, row.description))
        .collect();
    terminal::print(&text)
}

fn convert(args: &TfConvertArgs) -> Result<()> {
    check_output(&args.output, &args.source)?;
    let format = match &args.format {
        Some(name) => format_of_name(name)?,
        None => TransferFormat::of_path(&args.output)?,
    };
    let colors = args.source.colors();
    let (file, _) = read(&args.source)?;
    if file.emits() && format != TransferFormat::Scene {
        tracing::warn!("emission is lost: {} has none", args.output.display());
    }
    let name = args.source.input.rsplit(['/', '\\']).next();
    let name = name.and_then(|n| n.split('.').next()).unwrap_or_default();
    let text = file.to_text(format, name, colors);
    output::write_bytes(&args.output, text.as_bytes())
}

fn format_of_name(name: &str) -> Result<TransferFormat> {
    let known = TransferFormat::ALL.iter().find(|(known, _)| *known == name);
    known.map(|&(_, format)| format).ok_or_else(|| {
        let names = TransferFormat::ALL.map(|(name, _)| name).join(", ");
        Error::invalid(
            "--format",
            format!("{name:?} is not a form; valid are {names}"),
        )
    })
}

fn plot(args: &TfPlotArgs) -> Result<()> {
    check_output(&args.output, &args.source)?;
    let is_png = args
        .output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"));
    if !is_png {
        let at = args.output.display().to_string();
        return Err(Error::invalid(
            at,
            "plots are PNG; give a name that ends in .png",
        ));
    }
    let colors = args.source.colors();
    let (file, volume) = read(&args.source)?;
    let default_unit = volume.as_ref().map_or(UNIT, Volume::min_spacing);
    let unit = file.unit_distance.unwrap_or(default_unit);
    let curve = Curve::new(unit, &file.control_points(colors), colors);
    let histogram = volume.as_ref().map(|volume| Summary::of(volume).histogram);
    let histogram = histogram.as_ref().map(|h| PlotHistogram {
        range: h.range,
        counts: &h.counts,
    });
    output::write_plot(&args.output, &args.source.input, &curve, colors, histogram)
}

fn check_output(output: &Path, source: &TfSource) -> Result<()> {
    output::check_place(output)?;
    let inputs = [Some(Path::new(&source.input)), source.volume.as_deref()];
    input::check_no_input(output, inputs.into_iter().flatten())
}

/// A preset or a file, and the volume beside it.
fn read(source: &TfSource) -> Result<(TransferFile, Option<Volume>)> {
    let volume = source.volume.as_ref();
    let volume = volume
        .map(|path| io::read(path, &ReadOptions::default()))
        .transpose()?;
    let path = Path::new(&source.input);
    let Some(preset) = PRESETS.iter().find(|p| p.name == source.input) else {
        if !path.exists() {
            let names: Vec<&str> = PRESETS.iter().map(|p| p.name).collect();
            return Err(Error::invalid(
                &source.input,
                format!(
                    "is neither a file nor one of the presets {}",
                    names.join(", ")
                ),
            ));
        }
        return Ok((TransferFile::read(path)?, volume));
    };
    let points = match &volume {
        Some(volume) => Some(preset.control_points(volume)),
        None => preset.fixed_points(),
    };
    let points = points.ok_or_else(|| {
        Error::invalid(
            &source.input,
            "follows the values of a volume; give one with --volume FILE",
        )
    })?;
    let unit = volume.as_ref().map(Volume::min_spacing);
    Ok((TransferFile::of_points(points, unit), volume))
}

impl TfSource {
    fn colors(&self) -> ColorManagement {
        if self.unmanaged {
            ColorManagement::None
        } else {
            ColorManagement::Linear
        }
    }
}
