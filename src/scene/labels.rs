//! Labels beside a volume, and what they do to its picture.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::validate::{Number, is_share, numbers, require};
use super::{ColorManagement, Scene, palette};
use crate::error::{Error, Result};
use crate::volume::{LabelMap, Volume};

/// Labels that a message lists at most.
const LISTED: usize = 12;

/// A segmentation beside the volume: which of its segments are drawn, and in which colours. What has no label, and what lies
/// beyond the segmentation's grid, has the label 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LabelSource {
    /// File, relative to the scene file, with a whole number at each voxel. Its grid may differ from the volume's: the nearest
    /// label counts.
    pub path: PathBuf,
    /// Which series or grid of the file; as in `volume`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<String>,
    /// Which layer of a file that holds several, from 0: segments that overlap lie in layers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<u32>,
    /// Labels that are drawn; all others are left out. Default: all are drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub show: Option<Vec<i32>>,
    /// Labels that are left out, instead of `show`; `[0]` leaves what has no label.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hide: Option<Vec<i32>>,
    /// Display colours by label; other labels keep the transfer function's. Default: a colour of its own for each label but 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colors: Option<BTreeMap<i32, [f64; 3]>>,
    /// Share of the label's colour in place of the transfer function's, 0 to 1. Default 1.
    #[serde(default = "one")]
    pub tint: f64,
}

fn one() -> f64 {
    1.0
}

impl LabelSource {
    /// Every label drawn, each but 0 in a colour of its own.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            series: None,
            channel: None,
            show: None,
            hide: None,
            colors: None,
            tint: 1.0,
        }
    }

    /// Checks what does not need the labels.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the key that is wrong.
    pub fn validate(&self) -> Result<()> {
        if self.path.as_os_str().is_empty() {
            return Err(Error::invalid("volume.labels.path", "empty; give a file"));
        }
        if self.show.is_some() && self.hide.is_some() {
            return Err(Error::invalid(
                "volume.labels",
                "has both \"show\" and \"hide\"; give one of them, or neither to draw every label",
            ));
        }
        for (label, &color) in self.colors.iter().flatten() {
            require(
                color.into_iter().all(is_share),
                &format!("volume.labels.colors.{label}"),
                numbers(color),
                "three numbers from 0 to 1",
            )?;
        }
        require(
            is_share(self.tint),
            "volume.labels.tint",
            Number(self.tint),
            "a number from 0 to 1",
        )
    }
}

/// What a label does to the samples that have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelStyle {
    /// Samples that are not shown have no opacity, whatever the transfer function says: they are neither seen nor in the way of
    /// light.
    pub shown: bool,
    /// Linear colour.
    pub color: [f64; 3],
    /// Share of `color` in place of the transfer function's, from 0 to 1.
    pub tint: f64,
}

impl LabelStyle {
    /// As without labels.
    pub const PLAIN: Self = Self {
        shown: true,
        color: [0.0; 3],
        tint: 0.0,
    };
}

/// A segmentation with the style of each of its labels.
#[derive(Clone, Debug)]
pub struct Labels {
    map: Arc<LabelMap>,
    styles: Vec<LabelStyle>,
}

impl Labels {
    /// `styles`: one for each of [`LabelMap::labels`], in their order.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there are more or fewer, a colour is negative or not finite, or a tint is not from 0 to 1.
    pub fn new(map: Arc<LabelMap>, styles: Vec<LabelStyle>) -> Result<Self> {
        if styles.len() != map.labels().len() {
            let message = format!("{} styles for {} labels", styles.len(), map.labels().len());
            return Err(Error::invalid("volume.labels", message));
        }
        for (label, style) in map.labels().iter().zip(&styles) {
            let color = |c: &f64| (0.0..=f64::from(f32::MAX)).contains(c);
            require(
                style.color.iter().all(color) && is_share(style.tint),
                &format!("volume.labels.colors.{label}"),
                style,
                "colours >= 0 and a tint from 0 to 1",
            )?;
        }
        Ok(Self { map, styles })
    }

    /// What a scene says, for a volume with its labels; `None` when it says nothing.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the volume was read without its labels, or the scene names a label that there is not.
    pub fn of_scene(scene: &Scene, volume: &Volume) -> Result<Option<Self>> {
        let Some(source) = &scene.volume.labels else {
            return Ok(None);
        };
        let Some(map) = volume.labels() else {
            return Err(Error::invalid(
                "volume.labels",
                "the volume has none; read them, and give them to Volume::with_labels",
            ));
        };
        Self::styled(source, map.clone(), scene.image.color_management).map(Some)
    }

    fn styled(
        source: &LabelSource,
        map: Arc<LabelMap>,
        management: ColorManagement,
    ) -> Result<Self> {
        source.validate()?;
        let index = |key: &str, label: i32| {
            map.index_of(label)
                .ok_or_else(|| unknown(source, &map, key, label))
        };
        let mut styles = vec![LabelStyle::PLAIN; map.labels().len()];
        if let Some(show) = &source.show {
            styles.iter_mut().for_each(|style| style.shown = false);
            for &label in show {
                styles[index("show", label)?].shown = true;
            }
        }
        for &label in source.hide.iter().flatten() {
            styles[index("hide", label)?].shown = false;
        }
        let mut paint = |at: usize, color: [f64; 3]| {
            styles[at].color = management.decode(color);
            styles[at].tint = source.tint;
        };
        match &source.colors {
            Some(colors) => {
                for (&label, &color) in colors {
                    paint(index("colors", label)?, color);
                }
            }
            None => {
                for (at, label) in map.labels().iter().enumerate().skip(1) {
                    paint(at, palette::of_label(label.unsigned_abs().into()));
                }
            }
        }
        Self::new(map, styles)
    }

    /// The segmentation.
    pub fn map(&self) -> &Arc<LabelMap> {
        &self.map
    }

    /// The style of each of [`LabelMap::labels`].
    pub fn styles(&self) -> &[LabelStyle] {
        &self.styles
    }

    /// The style at an index position in the map's grid.
    pub fn style_at(&self, map_ix: DVec3) -> LabelStyle {
        self.styles[self.map.index_at(map_ix)]
    }

    /// True when some label is left out.
    pub fn hide_some(&self) -> bool {
        self.styles.iter().any(|style| !style.shown)
    }

    /// True when both leave out the same places.
    pub(crate) fn hide_the_same(&self, other: &Self) -> bool {
        let shown = |labels: &Self| labels.styles.iter().map(|s| s.shown).collect::<Vec<_>>();
        Arc::ptr_eq(&self.map, &other.map) && shown(self) == shown(other)
    }
}

/// The same map, not an equal one.
impl PartialEq for Labels {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.map, &other.map) && self.styles == other.styles
    }
}

fn unknown(source: &LabelSource, map: &LabelMap, key: &str, label: i32) -> Error {
    let labels = map.labels();
    let listed: Vec<String> = labels.iter().take(LISTED).map(i32::to_string).collect();
    let more = match labels.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Error::invalid(
        format!("volume.labels.{key}"),
        format!(
            "label {label} is not in {}; it has {}{more}",
            source.path.display(),
            listed.join(", ")
        ),
    )
}
