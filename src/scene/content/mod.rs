//! What a volume holds: as its file says, or else as its values suggest.

mod labels;

use serde::Serialize;

pub(super) use labels::label_values;

use super::histogram::ValueHistogram;
use crate::volume::{Content, Volume, Voxel, VoxelType, with_typed};

/// How a volume was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Modality {
    /// Computed tomography in Hounsfield units.
    Ct,
    /// X-ray computed tomography on a scale of its own: industrial, of specimens, 8-bit copies.
    MicroCt,
    /// Magnetic resonance.
    Mr,
    /// Tracer uptake.
    Nuclear,
    /// Ultrasound.
    Ultrasound,
    /// Fluorescence or other microscopy.
    Microscopy,
    /// A computed or measured field that is smooth.
    Simulation,
    /// Signed distances from a surface, negative inside.
    LevelSet,
    /// Photographs of sections, and whatever else has colours of its own.
    Color,
    /// Each value names a segment.
    Labels,
}

impl Modality {
    /// The transfer function that suits it.
    pub const fn preset(self) -> &'static str {
        match self {
            Self::Ct => "ct-bone",
            Self::Mr => "mr-default",
            Self::MicroCt | Self::Ultrasound => "boundaries",
            Self::Microscopy => "microscopy",
            Self::Simulation | Self::Nuclear => "simulation",
            Self::LevelSet => "level-set",
            Self::Color => "colors",
            Self::Labels => "labels",
        }
    }
}

/// What a volume is taken for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Guess {
    /// How it was made.
    pub modality: Modality,
    /// What it was guessed from.
    pub reason: String,
    /// The transfer function that suits it.
    pub preset: &'static str,
}

/// Hounsfield units reach down to air, and not much farther; padding outside of the scanner's circle is as low as -3024.
const AIR: [f64; 2] = [-4096.0, -900.0];
/// CT that was cut out of a body may hold no air, but fat.
const FAT: f64 = -50.0;
/// Share of the voxels that tissue fills in a picture of a patient.
const MIN_TISSUE: f64 = 0.2;
/// How much a peak of the histogram must rise above the valley before it.
const PEAK_RISE: f64 = 1.5;
/// Ratio of second to first differences above which values are noisy; white noise has 1.7.
const MAX_SMOOTH: f64 = 0.8;

impl Guess {
    /// Looks at the file's own word first, then at the values.
    pub fn of(volume: &Volume) -> Self {
        let [lowest, highest] = volume.value_range();
        let range = format!("values from {lowest} to {highest}");
        let guess = |modality: Modality, reason: String| Self {
            modality,
            reason,
            preset: modality.preset(),
        };
        let is_hounsfield = looks_like_hounsfield(volume);
        if let Some((content, key)) = &volume.metadata().content {
            let modality = match content {
                Content::Ct if is_hounsfield || lowest < FAT => Modality::Ct,
                Content::Ct => Modality::MicroCt,
                Content::Mr => Modality::Mr,
                Content::Nuclear => Modality::Nuclear,
                Content::Ultrasound => Modality::Ultrasound,
                Content::Microscopy => Modality::Microscopy,
                Content::Simulation => Modality::Simulation,
                Content::LevelSet => Modality::LevelSet,
                Content::Labels => Modality::Labels,
            };
            let unscaled = *content == Content::Ct && modality == Modality::MicroCt;
            let but = if unscaled {
                ", but no Hounsfield units"
            } else {
                ""
            };
            return guess(modality, format!("the file says so: {key}{but}"));
        }
        if volume.colors().is_some() {
            return guess(Modality::Color, "voxels are colours".into());
        }
        if let Some(reason) = labels::reason(volume) {
            return guess(Modality::Labels, reason);
        }
        if is_hounsfield {
            return guess(Modality::Ct, format!("{range}, as Hounsfield units"));
        }
        let histogram = ValueHistogram::of(volume);
        let tissue = 1.0 - histogram.background_share();
        let filled = format!("{:.0} % of the voxels above the background", 100.0 * tissue);
        let fills = (MIN_TISSUE..1.0).contains(&tissue);
        if volume.metadata().patient_axes && lowest >= 0.0 && fills {
            let reason = format!("a patient's axes, no value below 0, {filled}");
            return guess(Modality::Mr, reason);
        }
        if volume.voxels().voxel_type() == VoxelType::F32 {
            return guess(Modality::Simulation, format!("real numbers, {range}"));
        }
        let smooth = roughness(volume) <= MAX_SMOOTH;
        match (histogram.has_second_peak(PEAK_RISE), smooth) {
            (true, _) => guess(
                Modality::MicroCt,
                format!("a peak above the background, {filled}"),
            ),
            (false, true) => guess(Modality::Simulation, format!("smooth, {filled}")),
            (false, false) => guess(
                Modality::Microscopy,
                format!("noisy, no peak above the background, {filled}"),
            ),
        }
    }
}

fn looks_like_hounsfield(volume: &Volume) -> bool {
    let [lowest, highest] = volume.value_range();
    let wide = !matches!(volume.voxels().voxel_type(), VoxelType::U8 | VoxelType::I8);
    wide && (AIR[0]..=AIR[1]).contains(&lowest) && highest > 0.0
}

/// Sum of second differences along x over that of central first differences, where either is not 0.
fn roughness(volume: &Volume) -> f64 {
    with_typed!(volume.voxels(), voxels => roughness_of(voxels, volume.size()[0] as usize))
}

fn roughness_of<V: Voxel>(voxels: &[V], row: usize) -> f64 {
    const TRIPLES: usize = 1 << 20;
    let (mut first, mut second) = (0.0, 0.0);
    for row in voxels
        .chunks_exact(row)
        .step_by((voxels.len() / TRIPLES).max(1))
    {
        for triple in row.windows(3) {
            let [a, b, c] = [0, 1, 2].map(|i| f64::from(triple[i].to_f32()));
            first += (c - a).abs();
            second += (a - 2.0 * b + c).abs();
        }
    }
    second / first.max(f64::MIN_POSITIVE)
}
