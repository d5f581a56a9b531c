//! Units of length, as files name them.

/// Millimetres in each: symbols, names and their plurals, and ways in which `µ` is written.
const UNITS: &[(&str, f64)] = &[
    ("angstrom", 1e-7),
    ("Å", 1e-7),
    ("pm", 1e-9),
    ("picometer", 1e-9),
    ("nm", 1e-6),
    ("nanometer", 1e-6),
    ("nanometers", 1e-6),
    ("um", 1e-3),
    ("µm", 1e-3),
    ("μm", 1e-3),
    ("\\u00B5m", 1e-3),
    ("micron", 1e-3),
    ("microns", 1e-3),
    ("micrometer", 1e-3),
    ("micrometers", 1e-3),
    ("mm", 1.0),
    ("millimeter", 1.0),
    ("millimeters", 1.0),
    ("cm", 10.0),
    ("centimeter", 10.0),
    ("centimeters", 10.0),
    ("dm", 100.0),
    ("decimeter", 100.0),
    ("m", 1000.0),
    ("meter", 1000.0),
    ("meters", 1000.0),
    ("km", 1e6),
    ("kilometer", 1e6),
    ("inch", 25.4),
    ("foot", 304.8),
];

/// Millimetres per unit; `None` of a name that is no length (pixels, for one).
pub(super) fn millimetres(unit: &str) -> Option<f64> {
    let known = UNITS.iter().find(|(name, _)| *name == unit);
    known.map(|&(_, mm)| mm)
}
