//! What it takes to make a picture again.

use std::path::Path;

use super::Session;
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Where a picture came from. Goes into a picture's file as [`Provenance::entries`].
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Program and version.
    pub software: String,
    /// [`crate::volume::Volume::fingerprint`] of the data.
    pub data: String,
    /// What was drawn, and how.
    pub scene: Scene,
    /// [`crate::scene::Curve::fingerprint`] of what the scene's transfer function was: a file or a preset may change. `None` of
    /// pictures that do not say it.
    pub transfer_function: Option<String>,
    /// Directions of ambient occlusion that were traced.
    pub light_directions: u32,
    /// Name of the device.
    pub device: String,
    /// Driver and its version.
    pub driver: String,
    /// Blocks on the device by level: 1^3, 2^3, 4^3, 8^3, 16^3 voxels.
    pub blocks_by_level: [usize; 5],
}

/// Keywords in files.
mod keyword {
    pub(super) const SOFTWARE: &str = "Software";
    pub(super) const SOURCE: &str = "Source";
    pub(super) const DATA: &str = "Data";
    pub(super) const SCENE: &str = "Scene";
    pub(super) const TRANSFER_FUNCTION: &str = "TransferFunction";
    pub(super) const LIGHT: &str = "Light";
    pub(super) const DEVICE: &str = "Device";
    pub(super) const DRIVER: &str = "Driver";
    pub(super) const LEVELS: &str = "Levels";
}

impl Provenance {
    /// Keywords and text. A scene whose volume path is not UTF-8 cannot stand in JSON and is left out.
    pub fn entries(&self) -> Vec<(&'static str, String)> {
        let mut entries = vec![
            (keyword::SOFTWARE, self.software.clone()),
            (keyword::SOURCE, self.scene.volume.name()),
            (keyword::DATA, self.data.clone()),
            (keyword::LIGHT, self.light_directions.to_string()),
            (keyword::DEVICE, self.device.clone()),
            (keyword::DRIVER, self.driver.clone()),
            (
                keyword::LEVELS,
                self.blocks_by_level.map(|n| n.to_string()).join(" "),
            ),
        ];
        if let Some(curve) = &self.transfer_function {
            entries.push((keyword::TRANSFER_FUNCTION, curve.clone()));
        }
        if let Ok(scene) = serde_json::to_string(&self.scene) {
            entries.push((keyword::SCENE, scene));
        }
        entries
    }

    /// Reads what [`Provenance::entries`] wrote; `at` names the file in messages. Other keywords are ignored.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a keyword is missing or its text is not what it should be.
    pub fn from_entries(entries: &[(String, String)], at: &str) -> Result<Self> {
        let text = |keyword: &str| {
            let entry = entries.iter().find(|(name, _)| name == keyword);
            let text = entry.map(|(_, text)| text.as_str());
            text.ok_or_else(|| {
                let message = format!(
                    "its metadata has no {keyword:?}; give a picture whose origin this program recorded"
                );
                Error::invalid(at, message)
            })
        };
        let number = |keyword: &str, text: &str| {
            text.parse().map_err(|_| {
                let message = format!("its metadata has {keyword:?} {text:?}, which is no count");
                Error::invalid(at, message)
            })
        };
        let levels = text(keyword::LEVELS)?
            .split(' ')
            .map(|n| number(keyword::LEVELS, n).map(|n: u32| n as usize))
            .collect::<Result<Vec<usize>>>()?;
        let scene = Scene::from_json(text(keyword::SCENE)?, Path::new(""), &[]).map_err(|e| {
            Error::invalid(at, format!("the scene in its metadata is not valid: {e}"))
        })?;
        Ok(Self {
            software: text(keyword::SOFTWARE)?.to_owned(),
            data: text(keyword::DATA)?.to_owned(),
            scene,
            transfer_function: text(keyword::TRANSFER_FUNCTION).ok().map(str::to_owned),
            light_directions: number(keyword::LIGHT, text(keyword::LIGHT)?)?,
            device: text(keyword::DEVICE)?.to_owned(),
            driver: text(keyword::DRIVER)?.to_owned(),
            blocks_by_level: levels.try_into().map_err(|levels: Vec<_>| {
                let message = format!("its metadata names {} levels; there are 5", levels.len());
                Error::invalid(at, message)
            })?,
        })
    }

    /// What is not as it was when `self` was recorded and may change pixels, one sentence each. Data and scene are not
    /// looked at.
    pub fn differences(&self, now: &Self) -> Vec<String> {
        let levels = |p: &Self| format!("{:?}", p.blocks_by_level);
        let curve =
            |of: &Self, other: &Self| match (&of.transfer_function, &other.transfer_function) {
                (Some(curve), Some(_)) => curve.clone(),
                _ => "not recorded".into(),
            };
        [
            ("program", self.software.clone(), now.software.clone()),
            ("device", self.device.clone(), now.device.clone()),
            ("driver", self.driver.clone(), now.driver.clone()),
            ("transfer function", curve(self, now), curve(now, self)),
            ("blocks by level", levels(self), levels(now)),
            (
                "directions of light",
                self.light_directions.to_string(),
                now.light_directions.to_string(),
            ),
        ]
        .into_iter()
        .filter(|(_, then, now)| then != now)
        .map(|(what, then, now)| format!("{what}: was {then}, is {now}"))
        .collect()
    }
}

impl Session {
    /// Where a picture taken now comes from. `scene` is what the session was loaded by. Reads every voxel.
    pub fn provenance(&self, scene: &Scene) -> Provenance {
        let device = self.device_info();
        let loaded = self.renderer.loaded();
        Provenance {
            software: concat!("umbravox ", env!("CARGO_PKG_VERSION")).to_owned(),
            data: loaded.store().volume.fingerprint(),
            scene: scene.clone(),
            transfer_function: Some(loaded.settings().curve.fingerprint()),
            light_directions: loaded.light_progress().0,
            device: device.name,
            driver: device.driver,
            blocks_by_level: loaded.residency().selection.by_level,
        }
    }
}
