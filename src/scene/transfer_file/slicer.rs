//! 3D Slicer volume properties.
//!
//! `.vp` has nine lines (`vtkMRMLVolumePropertyStorageNode`): interpolation, shade, diffuse, ambient, specular, specular power, scalar opacity, gradient
//! opacity, colours. A function is the count of its numbers, then `value opacity` or `value red green blue` for each
//! point. `.vp.json` (volume property schema 1.0.0) names the same, with VTK's midpoint and sharpness, and the unit
//! distance. Colours are mixed as RGB. Slicer places opacities by the sample distance when a file gives none.

use serde_json::{Value, json};

use super::color_space::ColorSpace;
use super::map::{Map, Node};
use super::number::Place;
use super::{Content, TransferFile};
use crate::error::Result;

const LINES: [&str; 9] = [
    "interpolation",
    "shade",
    "diffuse",
    "ambient",
    "specular",
    "specular power",
    "scalar opacity",
    "gradient opacity",
    "colour",
];
/// What Slicer writes for a volume that is shaded and whose gradients do not matter.
const SHADING: &str = "1\n1\n0.9\n0.1\n0.2\n10\n";
const NO_GRADIENT: &str = "4 0 1 255 1";
const SCHEMA: &str = "https://raw.githubusercontent.com/Slicer/Slicer/main/Modules/Loadable/VolumeRendering/Resources/Schema/volume-property-schema-v1.0.0.json#";

pub(super) fn of_vp(text: &str, place: &Place) -> Result<TransferFile> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let line = |index: usize| {
        let at = place.at(&format!("line {} ({})", index + 1, LINES[index]));
        match lines.get(index) {
            Some(line) if !line.is_empty() => Ok((at, *line)),
            _ => Err(at.invalid("missing; a volume property has nine lines".into())),
        }
    };
    for index in 0..6 {
        let (at, text) = line(index)?;
        at.number(text)?;
    }
    let (at, opacity) = line(6)?;
    let opacities: Vec<Node<1>> = at.flat(&counted(opacity, &at)?)?;
    let (at, color) = line(8)?;
    let colors: Vec<Node<3>> = at.flat(&counted(color, &at)?)?;
    Ok(TransferFile {
        unit_distance: None,
        content: Content::Map(Map {
            space: ColorSpace::Rgb,
            colors,
            opacities,
        }),
    })
}

/// Numbers after their count.
fn counted(line: &str, place: &Place) -> Result<Vec<f64>> {
    let mut words = line.split_whitespace();
    let count = place.number(words.next().unwrap_or_default())?;
    let numbers = words
        .map(|word| place.number(word))
        .collect::<Result<Vec<f64>>>()?;
    if numbers.len() as f64 != count {
        return Err(place.invalid(format!(
            "announces {count} numbers and has {}",
            numbers.len()
        )));
    }
    Ok(numbers)
}

pub(super) fn of_json(value: &Value, place: &Place) -> Result<TransferFile> {
    let component = &value["volumeProperties"][0]["components"][0];
    let place = place.at("volumeProperties.0.components.0");
    if !component.is_object() {
        return Err(place.invalid("missing; an object with scalarOpacity is needed".into()));
    }
    let colors = nodes(component, "rgbTransferFunction", &place, |point, at| {
        let color = at.at("color").json_numbers(&point["color"])?;
        let given = color.len();
        <[f64; 3]>::try_from(color).map_err(|_| {
            at.at("color")
                .invalid(format!("has {given} numbers; a colour has 3"))
        })
    })?;
    let opacities = nodes(component, "scalarOpacity", &place, |point, at| {
        Ok([at.at("y").json_number(&point["y"])?])
    })?;
    let at = place.at("scalarOpacityUnitDistance");
    let unit_distance = match &component["scalarOpacityUnitDistance"] {
        Value::Null => None,
        unit => Some(at.json_number(unit)?),
    };
    if let Some(unit) = unit_distance.filter(|unit| *unit <= 0.0) {
        return Err(at.invalid(format!("{unit} is not a number > 0")));
    }
    Ok(TransferFile {
        unit_distance,
        content: Content::Map(Map {
            space: ColorSpace::Rgb,
            colors,
            opacities,
        }),
    })
}

fn nodes<const N: usize>(
    component: &Value,
    key: &str,
    place: &Place,
    y: impl Fn(&Value, &Place) -> Result<[f64; N]>,
) -> Result<Vec<Node<N>>> {
    let place = place.at(key).at("points");
    let Some(points) = component[key]["points"].as_array() else {
        return Err(place.invalid("missing; a list of points is needed".into()));
    };
    let node = |(i, point): (usize, &Value)| {
        let at = place.at(&i.to_string());
        let or = |key: &str, default: f64| match &point[key] {
            Value::Null => Ok(default),
            number => at.at(key).json_number(number),
        };
        Ok(Node {
            x: at.at("x").json_number(&point["x"])?,
            y: y(point, &at)?,
            midpoint: or("midpoint", 0.5)?,
            sharpness: or("sharpness", 0.0)?,
        })
    };
    let nodes = points.iter().enumerate().map(node).collect::<Result<_>>()?;
    place.nodes(nodes)
}

/// `map` is linear in display colours.
pub(super) fn to_vp(map: &Map) -> String {
    let line = |numbers: Vec<f64>| {
        let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
        format!("{} {}", words.len(), words.join(" "))
    };
    let opacities = map.opacities.iter().flat_map(|n| [n.x, n.y[0]]);
    let colors = map
        .colors
        .iter()
        .flat_map(|n| [n.x, n.y[0], n.y[1], n.y[2]]);
    let (opacities, colors) = (line(opacities.collect()), line(colors.collect()));
    format!("{SHADING}{opacities}\n{NO_GRADIENT}\n{colors}\n")
}

/// `map` is linear in display colours.
pub(super) fn to_json(map: &Map, unit_distance: Option<f64>) -> String {
    let shape = |n: &Value, midpoint: f64, sharpness: f64| {
        let mut point = n.clone();
        point["midpoint"] = json!(midpoint);
        point["sharpness"] = json!(sharpness);
        point
    };
    let colors = map
        .colors
        .iter()
        .map(|n| shape(&json!({ "x": n.x, "color": n.y }), n.midpoint, n.sharpness));
    let opacities = map
        .opacities
        .iter()
        .map(|n| shape(&json!({ "x": n.x, "y": n.y[0] }), n.midpoint, n.sharpness));
    let range = [map.colors.first(), map.colors.last()].map(|n| n.map_or(0.0, |n| n.x));
    let mut component = json!({
        "componentWeight": 1.0,
        "shade": true,
        "lighting": { "diffuse": 0.9, "ambient": 0.1, "specular": 0.2, "specularPower": 10.0 },
        "disableGradientOpacity": true,
        "rgbTransferFunction": { "type": "colorTransferFunction", "points": colors.collect::<Vec<_>>() },
        "scalarOpacity": { "type": "piecewiseLinearFunction", "points": opacities.collect::<Vec<_>>() },
    });
    if let Some(unit) = unit_distance {
        component["scalarOpacityUnitDistance"] = json!(unit);
    }
    let property = json!({
        "effectiveRange": range,
        "independentComponents": true,
        "interpolationType": "linear",
        "components": [component],
    });
    format!(
        "{:#}\n",
        json!({ "@schema": SCHEMA, "volumeProperties": [property] })
    )
}
