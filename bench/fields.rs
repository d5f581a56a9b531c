//! What is measured: volumes computed here, the same on every machine, and real ones where they are at hand.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use umbravox::io::{self, ReadOptions};
use umbravox::scene::{ControlPoint, TransferFunction};
use umbravox::volume::Volume;
use umbravox::{Error, Result};

use crate::procedural;

/// Where the voxels come from.
enum Source {
    /// A cube of so many 8-bit voxels of 1 mm.
    Computed(fn(u32) -> Result<Volume>),
    /// A file of the repository.
    File(&'static str),
    /// A file of the larger volumes, which are no part of it.
    Larger(&'static str),
}

/// What makes it visible.
enum Shown {
    /// Opacities over 1 mm at two values, linear between.
    Ramp([f64; 2], [f64; 2]),
    Preset(&'static str),
}

/// A volume with what makes it visible.
pub(crate) struct Field {
    pub(crate) name: &'static str,
    /// What it stands for.
    pub(crate) about: &'static str,
    source: Source,
    shown: Shown,
}

/// Names the folder of the larger volumes; without it, that is `../shared/data` beside the repository.
const LARGER: &str = "UMBRAVOX_LARGER_VOLUMES";

pub(crate) const FIELDS: [Field; 10] = [
    Field {
        name: "fog",
        about: "thin everywhere: nothing to skip, no ray ends early",
        source: Source::Computed(procedural::fog),
        shown: Shown::Ramp([0.0, 255.0], [0.001, 0.004]),
    },
    Field {
        name: "sparse",
        about: "small spheres in 0.14 % of the space: nearly all is skipped",
        source: Source::Computed(procedural::sparse),
        shown: Shown::Ramp([100.0, 200.0], [0.0, 0.6]),
    },
    Field {
        name: "blobs",
        about: "smooth bodies in 20 % of the space, opaque inside",
        source: Source::Computed(procedural::blobs),
        shown: Shown::Ramp([170.0, 210.0], [0.0, 0.5]),
    },
    Field {
        name: "shell",
        about: "a hollow sphere one voxel thick",
        source: Source::Computed(procedural::shell),
        shown: Shown::Ramp([100.0, 255.0], [0.0, 0.3]),
    },
    Field {
        name: "aorta",
        about: "CT angiography of a chest, bone and vessels",
        source: Source::File("data/ct_aorta_stent.mha"),
        shown: Shown::Preset("ct-bone"),
    },
    Field {
        name: "tooth",
        about: "micro-CT of a tooth",
        source: Source::File("data/ct_tooth.nrrd"),
        shown: Shown::Preset("micro-ct"),
    },
    Field {
        name: "head",
        about: "CT of a head, bone",
        source: Source::Larger("ct_head_visible_human_png.zip"),
        shown: Shown::Ramp([90.0, 180.0], [0.0, 0.6]),
    },
    Field {
        name: "chest",
        about: "CT of a chest, lung and airways",
        source: Source::Larger("ct_chest_lidc0314_dicom.tar.xz"),
        shown: Shown::Preset("ct-lung"),
    },
    Field {
        name: "engine",
        about: "industrial CT of an engine block",
        source: Source::Larger("ct_engine_256x256x128_uint8.raw.gz"),
        shown: Shown::Preset("micro-ct"),
    },
    Field {
        name: "mr",
        about: "MR of a head, T1",
        source: Source::Larger("mr_t1_head_colin27_ch2.nii.gz"),
        shown: Shown::Preset("mr-default"),
    },
];

impl Field {
    /// True when its size can be chosen.
    pub(crate) fn is_computed(&self) -> bool {
        matches!(self.source, Source::Computed(_))
    }

    /// True when it is no part of the repository.
    pub(crate) fn is_larger(&self) -> bool {
        matches!(self.source, Source::Larger(_))
    }

    /// Where one of the larger volumes should be and is not.
    pub(crate) fn absent(&self) -> Option<PathBuf> {
        match self.source {
            Source::Larger(name) => Some(larger(name)).filter(|path| !path.exists()),
            _ => None,
        }
    }

    /// The volume; `size` voxels on an edge where that can be chosen.
    ///
    /// # Errors
    /// As [`io::read`].
    pub(crate) fn volume(&self, size: u32) -> Result<Arc<Volume>> {
        match self.source {
            Source::Computed(make) => make(size),
            Source::File(path) => io::read(&in_repository(path), &ReadOptions::default()),
            Source::Larger(name) => io::read(&larger(name), &ReadOptions::default()),
        }
        .map(Arc::new)
    }

    pub(crate) fn transfer_function(&self) -> TransferFunction {
        match self.shown {
            Shown::Ramp(values, opacities) => ramp(values, opacities),
            Shown::Preset(name) => TransferFunction {
                preset: Some(name.to_owned()),
                ..Default::default()
            },
        }
    }
}

fn larger(name: &str) -> PathBuf {
    match std::env::var_os(LARGER) {
        Some(folder) => Path::new(&folder).join(name),
        None => in_repository("../shared/data").join(name),
    }
}

fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// In ivory.
fn ramp(values: [f64; 2], opacities: [f64; 2]) -> TransferFunction {
    let point = |at: usize| ControlPoint {
        value: values[at],
        color: [0.95, 0.88, 0.76],
        opacity: opacities[at],
        emission: [0.0; 3],
        source: [0.0; 3],
    };
    TransferFunction {
        unit_distance: Some(1.0),
        points: Some(vec![point(0), point(1)]),
        ..Default::default()
    }
}

/// The field of this name.
///
/// # Errors
/// [`Error::Invalid`] where there is none.
pub(crate) fn find(name: &str) -> Result<&'static Field> {
    let found = FIELDS.iter().find(|field| field.name == name);
    found.ok_or_else(|| Error::invalid(name, "is no field of the bench"))
}
