//! What is measured, at which size.

use clap::ValueEnum;
use umbravox::scene::AmbientOcclusion;

use crate::fields::Field;
use crate::figures::Case;

/// How much is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Set {
    /// Everything once, tiny: that it runs.
    Smoke,
    /// About a minute, on volumes of the repository.
    #[default]
    Short,
    /// What is recorded in bench/runs: some minutes, with the larger volumes.
    Record,
}

/// Sizes of a set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    set: Set,
    /// Edge of the computed volumes, voxels.
    pub(crate) size: u32,
    /// Edge of the pictures, pixels.
    pub(crate) image: u32,
    /// Edge of the computed volumes that light is measured on, voxels.
    pub(crate) light_size: u32,
    /// Voxels of a volume that light is measured on, at most.
    pub(crate) light_voxels: u64,
    /// Measured frames of a kind, after one that is not counted.
    pub(crate) repeats: u32,
    /// Directions of light.
    pub(crate) rays: u32,
    /// The same where its errors are measured, which more directions average out.
    pub(crate) all_rays: u32,
}

impl Plan {
    pub(crate) fn new(set: Set) -> Self {
        let (size, image, light_size, repeats) = match set {
            Set::Smoke => (24, 16, 24, 1),
            Set::Short => (128, 256, 96, 3),
            Set::Record => (256, 512, 128, 3),
        };
        Self {
            set,
            size,
            image,
            light_size,
            light_voxels: if set == Set::Smoke { 1 << 16 } else { 1 << 24 },
            repeats,
            rays: 2,
            all_rays: match set {
                Set::Smoke => 2,
                Set::Short => 8,
                Set::Record => AmbientOcclusion::default().rays,
            },
        }
    }

    /// True where a field belongs to the set.
    pub(crate) fn takes(&self, field: &Field) -> bool {
        self.set == Set::Record || !field.is_larger()
    }

    /// Every picture, grouped by volume. Each differs in one thing from the first of its field.
    pub(crate) fn cases(&self, field: &Field) -> Vec<Case> {
        let base = Case {
            field: field.name.to_owned(),
            size: self.size,
            image: self.image,
            step: 1.0,
            shaded: false,
            preintegrated: false,
            rays: 0,
        };
        let mut cases = vec![
            base.clone(),
            Case {
                shaded: true,
                ..base.clone()
            },
        ];
        if self.set != Set::Short {
            cases.extend([
                Case {
                    step: 0.5,
                    ..base.clone()
                },
                Case {
                    preintegrated: true,
                    ..base.clone()
                },
                Case {
                    image: 2 * self.image,
                    ..base.clone()
                },
            ]);
        }
        if field.is_computed() {
            cases.push(Case {
                size: 2 * self.size,
                ..base
            });
        }
        cases
    }
}
