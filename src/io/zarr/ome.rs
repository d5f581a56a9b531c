//! The images of an OME-Zarr store: axes, levels, and where they lie.

use glam::DVec3;
use serde::Deserialize;
use serde_json::Value;

use super::metadata::{Array, volume_of};
use super::store::Store;
use crate::error::Result;
use crate::io::units::millimetres;
use crate::io::{Limits, ReadOptions};

/// An image in several resolutions, the finest first.
#[derive(Deserialize)]
pub(super) struct Multiscale {
    #[serde(default)]
    pub(super) axes: Vec<Axis>,
    pub(super) datasets: Vec<Dataset>,
    #[serde(default, rename = "coordinateTransformations")]
    transforms: Vec<Transform>,
}

#[derive(Clone, Deserialize)]
pub(super) struct Axis {
    name: String,
    #[serde(rename = "type")]
    kind: Option<String>,
    unit: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct Dataset {
    pub(super) path: String,
    #[serde(default, rename = "coordinateTransformations")]
    transforms: Vec<Transform>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum Transform {
    Identity,
    Scale { scale: Vec<f64> },
    Translation { translation: Vec<f64> },
}

/// What each axis of an array is.
pub(super) struct Axes {
    /// Axes that are x, y and z.
    pub(super) space: [usize; 3],
    pub(super) channel: Option<usize>,
    pub(super) time: Option<usize>,
    /// Millimetres in the units of x, y and z.
    pub(super) unit: DVec3,
    /// Whether each of them has one.
    pub(super) has_units: bool,
}

/// The image of a store, after entering the group it is in; `None` where there is an array alone.
pub(super) fn image(
    store: &mut Store<'_>,
    options: &ReadOptions<'_>,
) -> Result<Option<Multiscale>> {
    let mut attributes = attributes(store)?;
    // One file of a microscope, converted whole: images are groups with numbers for names.
    let whole = attributes.get("bioformats2raw.layout").is_some();
    if whole && attributes.get("multiscales").is_none() {
        store.enter(options.series.as_deref().unwrap_or("0"));
        attributes = self::attributes(store)?;
    }
    let key = "attributes";
    let Some(images) = attributes.get("multiscales").and_then(Value::as_array) else {
        return match ["plate", "well"]
            .iter()
            .find(|&&kind| attributes.get(kind).is_some())
        {
            Some(kind) => Err(store.bad(
                key,
                format!("this is a {kind} of many images; give the folder of one"),
            )),
            None => Ok(None),
        };
    };
    let Some(first) = images.first() else {
        return Err(store.bad(key, "multiscales is empty; one image is needed".into()));
    };
    Multiscale::deserialize(first)
        .map(Some)
        .map_err(|e| store.bad(key, format!("multiscales: {e}")))
}

/// The attributes of the group, those of OME at their top.
fn attributes(store: &Store<'_>) -> Result<Value> {
    if let Some(group) = store.json::<Value>("zarr.json")? {
        let attributes = group.get("attributes").cloned().unwrap_or_default();
        return Ok(attributes.get("ome").cloned().unwrap_or(attributes));
    }
    Ok(store.json(".zattrs")?.unwrap_or_default())
}

impl Axes {
    /// From the names of the axes; without them, by their number: the last three are z, y and x.
    pub(super) fn of(store: &Store<'_>, axes: &[Axis], count: usize) -> Result<Self> {
        let bad = |what: &str| Err(store.bad("axes", what.into()));
        if !axes.is_empty() && axes.len() != count {
            return bad(&format!("{} axes of an array that has {count}", axes.len()));
        }
        let of_kind = |kind: &str, name: &str| {
            let found = axes
                .iter()
                .enumerate()
                .filter(|(_, axis)| match &axis.kind {
                    Some(other) => other == kind,
                    None => axis.name == name,
                });
            found.map(|(i, _)| i).collect::<Vec<usize>>()
        };
        let named = |name: &str| {
            let is = |axis: &Axis| {
                axis.name == name && axis.kind.as_deref().is_none_or(|k| k == "space")
            };
            axes.iter().position(is)
        };
        let space = match (axes, [named("x"), named("y"), named("z")]) {
            ([], _) => (0..count).rev().take(3).collect(),
            (_, [Some(x), Some(y), Some(z)]) => vec![x, y, z],
            _ => of_kind("space", "").into_iter().rev().collect(),
        };
        let Ok(space) = <[usize; 3]>::try_from(space) else {
            return bad("three axes of space are needed");
        };
        let [mut channel, mut time] = [
            of_kind("channel", "c").first().copied(),
            of_kind("time", "t").first().copied(),
        ];
        if axes.is_empty() {
            // t, c, z, y, x
            channel = count.checked_sub(4);
            time = count.checked_sub(5);
        }
        let unit = space.map(|axis| axes.get(axis)?.unit.as_deref().and_then(millimetres));
        Ok(Self {
            space,
            channel,
            time,
            unit: DVec3::from_array(unit.map(|mm| mm.unwrap_or(1.0))),
            has_units: unit.iter().all(Option::is_some),
        })
    }
}

impl Axes {
    /// Voxels on x, y and z.
    pub(super) fn sizes(&self, array: &Array) -> [u64; 3] {
        let size = |axis| array.shape.get(axis).copied().unwrap_or(0);
        self.space.map(size)
    }

    /// Whether a volume of the array is within the limits.
    pub(super) fn fit(&self, array: &Array, limits: &Limits) -> bool {
        let voxels = volume_of(&self.sizes(array)).filter(|&n| n <= limits.max_voxels);
        let bytes = voxels.and_then(|n| n.checked_mul(array.element.bytes()));
        bytes.is_some_and(|n| n <= limits.max_bytes)
    }
}

impl Multiscale {
    /// Step and origin of a level, in the units of the axes x, y and z.
    pub(super) fn placement(
        &self,
        store: &Store<'_>,
        level: &Dataset,
        axes: &Axes,
        count: usize,
    ) -> Result<[DVec3; 2]> {
        let [mut step, mut origin] = [DVec3::ONE, DVec3::ZERO];
        for transform in level.transforms.iter().chain(&self.transforms) {
            let vector = |numbers: &[f64]| {
                let all = axes.space.map(|axis| numbers.get(axis).copied());
                match all {
                    [Some(x), Some(y), Some(z)] if numbers.len() == count => {
                        Ok(DVec3::new(x, y, z))
                    }
                    _ => Err(store.bad(
                        "coordinateTransformations",
                        format!("{numbers:?}: {count} numbers are needed"),
                    )),
                }
            };
            match transform {
                Transform::Identity => {}
                Transform::Scale { scale } => {
                    let scale = vector(scale)?;
                    step *= scale;
                    origin *= scale;
                }
                Transform::Translation { translation } => origin += vector(translation)?,
            }
        }
        Ok([step, origin])
    }
}
