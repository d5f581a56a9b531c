//! Transfer functions from files of other programs, and to them: ParaView colour maps (JSON and XML), 3D Slicer volume
//! properties (`.vp` and `.vp.json`), and the scene file's own form.
//!
//! What those programs have and we do not (gradient opacity, lighting, colours of values that are no numbers) is passed
//! over on reading and written with their defaults. Emission, which they have not, is lost on writing.

mod color_space;
mod map;
mod number;
mod paraview;
mod slicer;

use std::path::Path;

use serde_json::Value;

pub use map::TOLERANCE as TRANSFER_TOLERANCE;

use self::map::Map;
use self::number::Place;
use super::{ColorManagement, ControlPoint, TransferFunction};
use crate::error::{Error, Result};

/// Files above this are refused unread.
const MAX_BYTES: u64 = 16 << 20;
/// Most points of a function.
const MAX_POINTS: usize = 1 << 16;

/// Forms of transfer function files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransferFormat {
    /// `transfer_function` of a scene file: `points`, `unit_distance`.
    Scene,
    /// ParaView's preset JSON: a list of maps with `RGBPoints`, `Points` and `ColorSpace`.
    ParaviewJson,
    /// ParaView's `<ColorMap>` XML.
    ParaviewXml,
    /// 3D Slicer's volume property, `.vp`.
    SlicerVp,
    /// 3D Slicer's volume property, `.vp.json`.
    SlicerJson,
}

impl TransferFormat {
    /// Every form and what it is called.
    pub const ALL: [(&'static str, Self); 5] = [
        ("umbravox", Self::Scene),
        ("paraview-json", Self::ParaviewJson),
        ("paraview-xml", Self::ParaviewXml),
        ("slicer-vp", Self::SlicerVp),
        ("slicer-json", Self::SlicerJson),
    ];

    /// The form that a file name stands for: `.json` is the scene's own.
    ///
    /// # Errors
    /// [`Error::Invalid`] for another extension.
    pub fn of_path(path: &Path) -> Result<Self> {
        let name = path.to_string_lossy().to_lowercase();
        let endings = [
            (".vp.json", Self::SlicerJson),
            (".json", Self::Scene),
            (".xml", Self::ParaviewXml),
            (".vp", Self::SlicerVp),
        ];
        let known = endings
            .into_iter()
            .find(|(ending, _)| name.ends_with(ending));
        known.map(|(_, format)| format).ok_or_else(|| {
            Error::invalid(
                path.display().to_string(),
                "its extension is none of transfer functions; give .json, .xml, .vp or .vp.json",
            )
        })
    }
}

/// A transfer function from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFile {
    /// Length that its opacities refer to, mm, where the file says it.
    pub unit_distance: Option<f64>,
    content: Content,
}

#[derive(Clone, Debug, PartialEq)]
enum Content {
    /// Ours: colours are mixed as light.
    Points(Vec<ControlPoint>),
    Map(Map),
}

impl TransferFile {
    /// Control points as they are.
    pub fn of_points(points: Vec<ControlPoint>, unit_distance: Option<f64>) -> Self {
        Self {
            unit_distance,
            content: Content::Points(points),
        }
    }

    /// Reads a file of any of the forms, told by its content. Of several maps the first is taken.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Invalid`] with the file and the place in it when it is damaged, of
    /// no known form, too large, or asks for what cannot be followed (categories, logarithmic scales, CIEDE2000).
    pub fn read(path: &Path) -> Result<Self> {
        let io = |e| Error::io(path, e);
        let meta = std::fs::metadata(path).map_err(io)?;
        let name = path.display().to_string();
        if !meta.is_file() || meta.len() > MAX_BYTES {
            return Err(Error::invalid(
                name,
                format!("not a file of {MAX_BYTES} bytes at most, as transfer functions are"),
            ));
        }
        let bytes = std::fs::read(path).map_err(io)?;
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            Error::invalid(
                &name,
                format!(
                    "byte {} is not UTF-8; transfer functions are text",
                    e.valid_up_to()
                ),
            )
        })?;
        Self::parse(text, &name)
    }

    /// The same from text; `name` is what messages call it.
    ///
    /// # Errors
    /// [`Error::Invalid`] as for [`TransferFile::read`].
    pub fn parse(text: &str, name: &str) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let place = Place::root(name);
        match text.trim_start().chars().next() {
            Some('[' | '{') => {
                let value = serde_json::from_str(text)
                    .map_err(|e| place.invalid(format!("is not valid JSON: {e}")))?;
                Self::of_json(&value, &place)
            }
            Some('<') => paraview::of_xml(text, &place),
            Some('-' | '.' | '0'..='9') => slicer::of_vp(text, &place),
            _ => Err(place.invalid(
                "is no transfer function; read are JSON and XML of ParaView, .vp and .vp.json of 3D Slicer, \
                 and {\"points\": [...]} of a scene file"
                    .into(),
            )),
        }
    }

    fn of_json(value: &Value, place: &Place) -> Result<Self> {
        let is = |key: &str| value.get(key).is_some();
        if is("volumeProperties") {
            slicer::of_json(value, place)
        } else if is("points") || is("preset") {
            let function: TransferFunction = serde_path_to_error::deserialize(value.clone())
                .map_err(|e| {
                    place
                        .at(&e.path().to_string())
                        .invalid(e.inner().to_string())
                })?;
            function.validate().map_err(|e| place.around(e))?;
            let Some(points) = function.points else {
                return Err(place.invalid("has no \"points\"".into()));
            };
            Ok(Self::of_points(points, function.unit_distance))
        } else {
            paraview::of_json(value, place)
        }
    }

    /// Control points for a colour management; display colours and opacities follow the file within
    /// [`TRANSFER_TOLERANCE`].
    pub fn control_points(&self, management: ColorManagement) -> Vec<ControlPoint> {
        match &self.content {
            Content::Points(points) => points.clone(),
            Content::Map(map) => map.control_points(management),
        }
    }

    /// True when writing another form than [`TransferFormat::Scene`] loses something.
    pub fn emits(&self) -> bool {
        match &self.content {
            Content::Points(points) => points.iter().any(|p| p.emission != [0.0; 3]),
            Content::Map(_) => false,
        }
    }

    /// The text of a file. `name` is what it is called inside, where the form has names. Colours of control points are
    /// taken as mixed under `management`.
    pub fn to_text(
        &self,
        format: TransferFormat,
        name: &str,
        management: ColorManagement,
    ) -> String {
        if format == TransferFormat::Scene {
            let function = TransferFunction {
                unit_distance: self.unit_distance,
                points: Some(self.control_points(management)),
                ..TransferFunction::default()
            };
            // Numbers and keys always become JSON.
            return serde_json::to_string_pretty(&function).unwrap_or_default() + "\n";
        }
        let points = self.control_points(management);
        let map = Map::of_control_points(&points, management);
        match format {
            TransferFormat::ParaviewXml => paraview::to_xml(&map, name),
            TransferFormat::SlicerVp => slicer::to_vp(&map),
            TransferFormat::SlicerJson => slicer::to_json(&map, self.unit_distance),
            TransferFormat::ParaviewJson | TransferFormat::Scene => {
                paraview::to_json(&map, name, self.unit_distance)
            }
        }
    }
}

/// Moves values linearly from the range of the points onto another, as ParaView rescales its presets to the data.
pub(super) fn stretch(points: &mut [ControlPoint], [low, high]: [f64; 2]) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return;
    };
    let (from, width) = (first.value, last.value - first.value);
    for point in points {
        let share = if width > 0.0 {
            (point.value - from) / width
        } else {
            0.0
        };
        point.value = low + (high - low) * share;
    }
}
