//! The figures as a table and as JSON.

use std::path::Path;

use serde::Serialize;
use umbravox::headless::DeviceInfo;
use umbravox::{Error, Result, output};

use crate::measure::{Measured, Plan};

/// Prints two Markdown tables.
pub(crate) fn print(device: &DeviceInfo, plan: &Plan, results: &[Measured]) {
    let Plan {
        size,
        image,
        repeats,
        ..
    } = plan;
    println!("{} ({})", device.name, device.driver);
    println!(
        "procedural volumes {size}^3, pictures {image} x {image}, median (min–max) of {repeats}"
    );
    println!();
    println!(
        "| field | visible | picture | step | frame ms | march ms | samples | Msamples/s | of the limit |"
    );
    println!("| --- | --: | --- | --: | --: | --: | --: | --: | --: |");
    for measured in results {
        for picture in &measured.pictures {
            let march = &picture.march_ms;
            println!(
                "| {} | {:.2} % | {} | {} | {:.2} | {:.2} ({:.2}–{:.2}) | {} | {:.1} | {:.0} % of {:.1} |",
                measured.field,
                100.0 * measured.visible,
                picture.kind,
                picture.step,
                picture.frame_ms.median,
                march.median,
                march.min,
                march.max,
                picture.samples,
                picture.rate() * 1e-6,
                100.0 * picture.rate() / picture.limit(),
                picture.limit() * 1e-6,
            );
        }
    }
    println!();
    println!("| field | lit voxels | LAO ms a ray | ms a ray and million voxels |");
    println!("| --- | --: | --: | --: |");
    for measured in results {
        if let Some(light) = &measured.light {
            println!(
                "| {} | {} | {:.2} | {:.2} |",
                measured.field,
                light.voxels,
                light.ms_per_ray,
                light.ms_per_million_voxels()
            );
        }
    }
}

/// Writes every figure.
///
/// # Errors
/// [`Error::Io`].
pub(crate) fn write_json(
    path: &Path,
    device: &DeviceInfo,
    plan: &Plan,
    results: &[Measured],
) -> Result<()> {
    #[derive(Serialize)]
    struct Report<'a> {
        device: &'a str,
        driver: &'a str,
        plan: &'a Plan,
        fields: &'a [Measured],
    }
    let report = Report {
        device: &device.name,
        driver: &device.driver,
        plan,
        fields: results,
    };
    let text = serde_json::to_string_pretty(&report).map_err(|e| Error::Encode {
        path: path.to_path_buf(),
        message: e.to_string(),
    })?;
    output::write_bytes(path, text.as_bytes())
}
