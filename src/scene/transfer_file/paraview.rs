//! ParaView colour maps.
//!
//! JSON as ParaView exports presets: a list of objects with `RGBPoints` (value, red, green, blue, …), `Points` (value, opacity, midpoint,
//! sharpness, …) and `ColorSpace`; `ScalarOpacityUnitDistance` is taken where it stands beside them. XML: `<ColorMap
//! space="…">` with `<Point x o r g b/>`. Maps without opacities get ParaView's default, from 0 to 1 over their range.

use std::fmt::Write as _;

use roxmltree::{Document, Node as Element};
use serde_json::{Value, json};

use super::color_space::ColorSpace;
use super::map::{Map, Node};
use super::number::Place;
use super::{Content, TransferFile};
use crate::error::Result;

const SPACES: [(&str, ColorSpace); 6] = [
    ("RGB", ColorSpace::Rgb),
    ("HSV", ColorSpace::Hsv),
    ("Wrapped", ColorSpace::HsvWrapped),
    ("Lab", ColorSpace::Lab),
    ("Diverging", ColorSpace::Diverging),
    ("Step", ColorSpace::Step),
];

fn space(name: &str, place: &Place) -> Result<ColorSpace> {
    let known = SPACES.iter().find(|(known, _)| *known == name);
    known.map(|&(_, space)| space).ok_or_else(|| {
        let names: Vec<&str> = SPACES.iter().map(|(name, _)| *name).collect();
        place.invalid(format!(
            "{name:?} is not followed; valid are {}",
            names.join(", ")
        ))
    })
}

/// ParaView's opacities where a map has none.
fn default_opacities(colors: &[Node<3>]) -> Vec<Node<1>> {
    let ends = [(colors.first(), 0.0), (colors.last(), 1.0)];
    ends.into_iter()
        .filter_map(|(node, opacity)| Some(Node::linear(node?.x, [opacity])))
        .collect()
}

pub(super) fn of_json(value: &Value, place: &Place) -> Result<TransferFile> {
    let (map, place) = match value.as_array() {
        Some(maps) => match maps.first() {
            Some(first) => (first, place.at("0")),
            None => return Err(place.invalid("an empty list; a colour map is needed".into())),
        },
        None => (value, place.at("")),
    };
    let Some(rgb) = map.get("RGBPoints") else {
        let why = match map.get("IndexedColors") {
            Some(_) => "names colours of categories; a map with \"RGBPoints\" is needed",
            None => "has no \"RGBPoints\", \"points\" or \"volumeProperties\"",
        };
        return Err(place.invalid(why.into()));
    };
    let log = ["UseLogScale", "UseLogScaleX"].into_iter().find(|key| {
        let set = map.get(*key);
        set.is_some_and(|v| v.as_bool() == Some(true) || v.as_f64().is_some_and(|n| n != 0.0))
    });
    if let Some(key) = log {
        return Err(place
            .at(key)
            .invalid("logarithmic scales are not followed".into()));
    }
    let at = place.at("RGBPoints");
    let colors: Vec<Node<3>> = at.flat(&at.json_numbers(rgb)?)?;
    let opacities = match map.get("Points") {
        Some(Value::Null) | None => default_opacities(&colors),
        Some(points) => {
            let at = place.at("Points");
            let nodes: Vec<Node<3>> = shaped(&at.json_numbers(points)?, &at)?;
            let nodes = nodes.into_iter().map(|n| Node {
                x: n.x,
                y: [n.y[0]],
                midpoint: n.y[1],
                sharpness: n.y[2],
            });
            at.nodes(nodes.collect())?
        }
    };
    let at = place.at("ColorSpace");
    let mut space = match map.get("ColorSpace") {
        Some(name) => space(name.as_str().unwrap_or_default(), &at)?,
        None => ColorSpace::Rgb,
    };
    let wraps = map.get("HSVWrap").and_then(Value::as_f64).unwrap_or(0.0) != 0.0;
    if wraps && space == ColorSpace::Hsv {
        space = ColorSpace::HsvWrapped;
    }
    let at = place.at("ScalarOpacityUnitDistance");
    let unit_distance = map.get("ScalarOpacityUnitDistance");
    let unit_distance = unit_distance.map(|unit| at.json_number(unit)).transpose()?;
    if let Some(unit) = unit_distance.filter(|unit| *unit <= 0.0) {
        return Err(at.invalid(format!("{unit} is not a number > 0")));
    }
    Ok(TransferFile {
        unit_distance,
        content: Content::Map(Map {
            space,
            colors,
            opacities,
        }),
    })
}

/// Quadruples, unchecked but for their number.
fn shaped(numbers: &[f64], place: &Place) -> Result<Vec<Node<3>>> {
    if !numbers.len().is_multiple_of(4) {
        return Err(place.invalid(format!("has {} numbers; a point has 4", numbers.len())));
    }
    let nodes = numbers.chunks_exact(4).filter_map(|point| match *point {
        [x, opacity, midpoint, sharpness] => Some(Node::linear(x, [opacity, midpoint, sharpness])),
        _ => None,
    });
    Ok(nodes.collect())
}

pub(super) fn of_xml(text: &str, place: &Place) -> Result<TransferFile> {
    let document =
        Document::parse(text).map_err(|e| place.invalid(format!("is not valid XML: {e}")))?;
    let map = document
        .descendants()
        .find(|e| e.has_tag_name("ColorMap"))
        .ok_or_else(|| place.invalid("has no <ColorMap>".into()))?;
    let place = place.at("ColorMap");
    if map.attribute("indexedlookup") == Some("true")
        || map.attribute("indexedLookup") == Some("true")
    {
        return Err(place.invalid("names colours of categories; a map of values is needed".into()));
    }
    let points: Vec<Element> = map.children().filter(|e| e.has_tag_name("Point")).collect();
    let mut colors = Vec::new();
    let mut opacities = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let place = place.at(&format!("Point {i}"));
        let number = |key: &str| match point.attribute(key) {
            Some(text) => place.at(key).number(text),
            None => Err(place.at(key).invalid("missing; a number is needed".into())),
        };
        let x = number("x")?;
        colors.push(Node::linear(x, [number("r")?, number("g")?, number("b")?]));
        if point.attribute("o").is_some() {
            opacities.push(Node::linear(x, [number("o")?]));
        }
    }
    let colors = place.nodes(colors)?;
    let opacities = match opacities.len() {
        0 => default_opacities(&colors),
        _ => place.nodes(opacities)?,
    };
    let space = match map.attribute("space") {
        Some(name) => space(name, &place.at("space"))?,
        None => ColorSpace::Rgb,
    };
    Ok(TransferFile {
        unit_distance: None,
        content: Content::Map(Map {
            space,
            colors,
            opacities,
        }),
    })
}

/// `map` is linear in display colours.
pub(super) fn to_json(map: &Map, name: &str, unit_distance: Option<f64>) -> String {
    let rgb: Vec<f64> = map
        .colors
        .iter()
        .flat_map(|n| [n.x, n.y[0], n.y[1], n.y[2]])
        .collect();
    let points: Vec<f64> = map
        .opacities
        .iter()
        .flat_map(|n| [n.x, n.y[0], n.midpoint, n.sharpness])
        .collect();
    let mut preset = json!({
        "Name": name,
        "ColorSpace": "RGB",
        "RGBPoints": rgb,
        "Points": points,
    });
    if let Some(unit) = unit_distance {
        preset["ScalarOpacityUnitDistance"] = json!(unit);
    }
    format!("{:#}\n", json!([preset]))
}

pub(super) fn to_xml(map: &Map, name: &str) -> String {
    let name = name
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;");
    let mut text = format!("<ColorMaps>\n<ColorMap name=\"{name}\" space=\"RGB\">\n");
    for (color, opacity) in map.colors.iter().zip(&map.opacities) {
        let ([r, g, b], [o]) = (color.y, opacity.y);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "<Point x=\"{}\" o=\"{o}\" r=\"{r}\" g=\"{g}\" b=\"{b}\"/>",
            color.x
        );
    }
    text + "</ColorMap>\n</ColorMaps>\n"
}
