//! OpenEXR: linear radiance and layers of data, one part, 32-bit float.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, MetaData, Text,
    WritableImage, attribute::AttributeValue,
};

use super::{Backdrop, Provenance, atomic};
use crate::error::{Error, Result};
use crate::picture::{Measured, Picture};

/// Name of the attribute with the provenance, a JSON object.
const ATTRIBUTE: &str = "umbravox";

/// First bytes of every file (OpenEXR file layout).
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Keywords and texts of our attribute in the first part.
///
/// # Errors
/// What is wrong with the file.
pub(super) fn read_attribute(path: &Path) -> Result<Vec<(String, String)>, String> {
    let meta =
        MetaData::read_from_file(path, false).map_err(|e| format!("is not a readable EXR: {e}"))?;
    let attributes = meta.headers.iter().take(1);
    let text = attributes
        .flat_map(|header| &header.own_attributes.other)
        .find_map(|(name, value)| match value {
            AttributeValue::Text(text) if name.eq(ATTRIBUTE) => Some(text.to_string()),
            _ => None,
        })
        .ok_or_else(|| {
            format!("has no attribute {ATTRIBUTE:?}; give one that this program wrote")
        })?;
    let entries: BTreeMap<String, String> = serde_json::from_str(&text)
        .map_err(|e| format!("has a damaged attribute {ATTRIBUTE:?}: {e}"))?;
    Ok(entries.into_iter().collect())
}

/// The same JSON in ASCII: attributes hold one byte a character, and what is not ASCII in JSON is inside of strings.
fn ascii_json(json: &str) -> String {
    let mut text = String::new();
    for c in json.chars() {
        if c.is_ascii() {
            text.push(c);
        } else {
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                // Writing to a string does not fail.
                let _ = write!(text, "\\u{unit:04x}");
            }
        }
    }
    text
}

pub(super) fn write(
    path: &Path,
    picture: &Picture,
    backdrop: &Backdrop,
    provenance: Provenance,
) -> Result<()> {
    let mut attributes = LayerAttributes::default();
    // One attribute for all: the encoder writes several in random order, and equal pictures are to be equal files.
    let entries: BTreeMap<_, _> = provenance.iter().map(|(k, v)| (*k, v.as_str())).collect();
    let text = ascii_json(&serde_json::to_string(&entries).unwrap_or_default());
    // Text that an EXR attribute cannot hold is left out: the picture is worth more than its label.
    if let (Some(name), Some(text)) = (Text::new_or_none(ATTRIBUTE), Text::new_or_none(&text)) {
        attributes.other.insert(name, AttributeValue::Text(text));
    }
    let [width, height] = picture.size.map(|n| n as usize);
    let layer = Layer::new(
        (width, height),
        attributes,
        Encoding::SMALL_LOSSLESS,
        channels(picture, backdrop),
    );
    let image = exr::image::Image::from_layer(layer);
    atomic::write(path, |file| {
        image.write().to_buffered(file).map_err(|e| match e {
            exr::error::Error::Io(source) => Error::io(path, source),
            other => Error::Encode {
                path: path.to_path_buf(),
                message: other.to_string(),
            },
        })
    })
}

fn channels(picture: &Picture, backdrop: &Backdrop) -> AnyChannels<FlatSamples> {
    let linear: Vec<[f64; 3]> = picture.composited(1.0, |i| backdrop.at(i)).collect();
    let radiance = |axis: usize| {
        let channel = linear.iter().map(|c| c[axis] as f32);
        channel.collect::<Vec<f32>>()
    };
    let opacity: Vec<f32> = picture.rgba.iter().map(|p| p[3]).collect();
    // Exact up to 2^24 samples a ray; some readers want one type for all channels.
    let samples = picture.samples.iter().map(|&n| n as f32).collect();
    let list = [
        ("R", radiance(0)),
        ("G", radiance(1)),
        ("B", radiance(2)),
        ("A", opacity.clone()),
        ("depth.Z", picture.depth.clone()),
        ("median_depth.Z", picture.median_depth.clone()),
        ("opacity.Y", opacity),
        ("samples.Y", samples),
        (
            match picture.measured {
                Measured::ExpectedDepth => "expected_depth.Z",
                Measured::OpticalDepth => "optical_depth.Y",
                Measured::Value => "value.Y",
            },
            picture.measure.clone(),
        ),
    ];
    let variance = |axis: usize| {
        let variance = picture.variance.as_ref();
        variance.map(|v| v.iter().map(|c| c[axis]).collect::<Vec<f32>>())
    };
    let variances = [("variance.R", 0), ("variance.G", 1), ("variance.B", 2)];
    let variances = variances
        .into_iter()
        .filter_map(|(name, axis)| Some((name, variance(axis)?)));
    let channels = list
        .into_iter()
        .chain(variances)
        .map(|(name, values)| AnyChannel::new(name, FlatSamples::F32(values)));
    AnyChannels::sort(channels.collect())
}
