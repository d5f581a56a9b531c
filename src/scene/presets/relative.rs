//! Transfer functions for data without a scale of their own: points stand at shares of the voxels above the
//! background, so that they follow the values of each file.

use super::{Points, Preset, Scale};

/// What also serves where nothing is known of the data.
pub(super) const RAMP: Points = &[
    (0.00, [0.25, 0.07, 0.05], 0.0),
    (0.30, [0.50, 0.20, 0.13], 0.01),
    (0.60, [0.76, 0.44, 0.29], 0.08),
    (0.90, [0.93, 0.78, 0.60], 0.40),
    (0.995, [1.0, 0.98, 0.93], 0.90),
];

pub(super) const PRESETS: [Preset; 6] = [
    Preset {
        name: "mr-default",
        description: "magnetic resonance: tissue as a surface, what is bright the more opaque",
        scale: Scale::Foreground(RAMP),
    },
    Preset {
        name: "colors",
        description: "voxels with colours of their own: a solid surface where the background ends",
        scale: Scale::Foreground(&[
            (0.05, [0.5, 0.5, 0.5], 0.0),
            (0.25, [0.7, 0.7, 0.7], 0.10),
            (0.50, [0.9, 0.9, 0.9], 0.85),
        ]),
    },
    Preset {
        name: "mr-angio",
        description: "magnetic resonance angiography: only the brightest, as a maximum projection shows it",
        scale: Scale::Foreground(&[
            (0.90, [0.30, 0.05, 0.03], 0.0),
            (0.96, [0.70, 0.18, 0.10], 0.02),
            (0.985, [0.92, 0.45, 0.28], 0.20),
            (0.999, [1.0, 0.94, 0.84], 0.95),
        ]),
    },
    Preset {
        name: "micro-ct",
        description: "X-ray CT without Hounsfield units: materials from light to dense, dense ones opaque",
        scale: Scale::Foreground(&[
            (0.00, [0.40, 0.30, 0.22], 0.0),
            (0.15, [0.55, 0.42, 0.30], 0.02),
            (0.50, [0.78, 0.64, 0.46], 0.20),
            (0.85, [0.93, 0.86, 0.72], 0.60),
            (0.995, [1.0, 1.0, 0.97], 0.95),
        ]),
    },
    Preset {
        name: "microscopy",
        description: "fluorescence: a glow in green that is opaque only where it is brightest",
        scale: Scale::Foreground(&[
            (0.20, [0.00, 0.10, 0.08], 0.0),
            (0.60, [0.02, 0.45, 0.25], 0.03),
            (0.90, [0.20, 0.85, 0.40], 0.20),
            (0.995, [0.90, 1.0, 0.80], 0.70),
        ]),
    },
    Preset {
        name: "simulation",
        description: "fields of simulations: blue to red through white, the highest values opaque",
        scale: Scale::Field(&[
            (0.10, [0.12, 0.20, 0.60], 0.0),
            (0.50, [0.35, 0.55, 0.90], 0.02),
            (0.80, [0.85, 0.87, 0.90], 0.06),
            (0.95, [0.95, 0.60, 0.35], 0.25),
            (0.995, [0.80, 0.10, 0.10], 0.75),
        ]),
    },
];
