//! Transfer functions for CT in Hounsfield units.
//!
//! Anchors on the scale: air -1000, lung -850…-500, fat -120…-60, water 0, muscle 30…70, blood with contrast
//! agent 150…450, spongy bone 150…500, compact bone 500…2000, metal above.

use super::{Preset, Scale};

pub(super) const PRESETS: [Preset; 5] = [
    Preset {
        name: "ct-bone",
        description: "skeleton, with vessels and organs that hold contrast agent, in ivory",
        scale: Scale::Hounsfield(&[
            (150.0, [0.55, 0.22, 0.14], 0.0),
            (220.0, [0.80, 0.50, 0.36], 0.10),
            (350.0, [0.93, 0.80, 0.64], 0.45),
            (700.0, [0.99, 0.95, 0.86], 0.85),
            (1800.0, [1.0, 1.0, 0.98], 0.95),
        ]),
    },
    Preset {
        name: "ct-angio",
        description: "vessels with contrast agent in red, bone in ivory, metal in steel blue",
        scale: Scale::Hounsfield(&[
            (160.0, [0.45, 0.03, 0.03], 0.0),
            (220.0, [0.72, 0.10, 0.07], 0.25),
            (380.0, [0.88, 0.30, 0.18], 0.50),
            (520.0, [0.94, 0.80, 0.62], 0.65),
            (1000.0, [1.0, 0.96, 0.88], 0.90),
            (2000.0, [1.0, 1.0, 0.98], 0.95),
            (2400.0, [0.62, 0.72, 0.82], 0.98),
        ]),
    },
    Preset {
        name: "ct-soft-tissue",
        description: "organs and muscle, fat as a veil, bone through it",
        scale: Scale::Hounsfield(&[
            (-140.0, [0.85, 0.66, 0.42], 0.0),
            (-90.0, [0.88, 0.70, 0.45], 0.008),
            (-20.0, [0.80, 0.50, 0.38], 0.01),
            (30.0, [0.70, 0.28, 0.22], 0.06),
            (80.0, [0.78, 0.32, 0.24], 0.12),
            (180.0, [0.85, 0.45, 0.32], 0.25),
            (350.0, [0.95, 0.84, 0.68], 0.60),
            (1000.0, [1.0, 0.97, 0.90], 0.92),
        ]),
    },
    Preset {
        name: "ct-muscle-and-skin",
        description: "the body's surface: skin over muscle, opaque",
        scale: Scale::Hounsfield(&[
            (-500.0, [0.80, 0.55, 0.42], 0.0),
            (-250.0, [0.87, 0.64, 0.51], 0.15),
            (-100.0, [0.90, 0.68, 0.54], 0.35),
            (20.0, [0.78, 0.36, 0.28], 0.60),
            (150.0, [0.84, 0.46, 0.36], 0.75),
            (400.0, [0.97, 0.90, 0.78], 0.92),
        ]),
    },
    Preset {
        name: "ct-lung",
        description: "lung, its vessels brighter; the body around it is a faint shell",
        scale: Scale::Hounsfield(&[
            // Faint everywhere: lungs are deep, and the skin, which passes through their values too, is not.
            (-930.0, [0.25, 0.36, 0.50], 0.0),
            (-880.0, [0.38, 0.46, 0.60], 0.012),
            (-780.0, [0.62, 0.50, 0.55], 0.02),
            (-620.0, [0.90, 0.58, 0.48], 0.035),
            (-480.0, [1.0, 0.80, 0.66], 0.03),
            (-350.0, [1.0, 0.85, 0.75], 0.0),
        ]),
    },
];
