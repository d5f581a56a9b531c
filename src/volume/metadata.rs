//! What a file says of its content, beyond voxels and placement.

use std::collections::BTreeMap;

/// What voxels measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Computed tomography.
    Ct,
    /// Magnetic resonance.
    Mr,
    /// Tracer uptake: positron emission or single photon tomography.
    Nuclear,
    /// Ultrasound.
    Ultrasound,
    /// Light or electron microscopy.
    Microscopy,
    /// A computed field: smoke, say.
    Simulation,
    /// Signed distances from a surface, negative inside.
    LevelSet,
    /// Labels: each value names a segment.
    Labels,
}

/// What the reader of a file learned from its header.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// What the voxels measure, and where the file says so (`DICOM Modality CT`).
    pub content: Option<(Content, String)>,
    /// The file ties the axes of the world to a patient: left, posterior, superior.
    pub patient_axes: bool,
    /// Names of labels.
    pub label_names: BTreeMap<i32, String>,
}

impl Metadata {
    /// A file that says what it holds under `key`, by one of some names; others say nothing.
    pub fn stated(key: &str, value: &str, names: &[(&str, Content)]) -> Self {
        let known = names.iter().find(|(name, _)| *name == value);
        Self {
            content: known.map(|&(name, content)| (content, format!("{key} {name}"))),
            ..Self::default()
        }
    }

    /// The same, with axes of a patient or not.
    pub fn with_patient_axes(self, patient_axes: bool) -> Self {
        Self {
            patient_axes,
            ..self
        }
    }
}
