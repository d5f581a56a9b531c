//! Where index space lies: the maps of a grid's transform.

use glam::{DAffine3, DMat3, DVec3};

use super::bytes::Bytes;
use crate::error::Result;

/// Vectors that follow a scale and are derived from it.
const DERIVED_OF_SCALE: usize = 4;

/// World from index space.
pub(super) fn read(bytes: &mut Bytes<'_>) -> Result<DAffine3> {
    let name = bytes.text()?;
    match name.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            Ok(DAffine3::from_mat3(DMat3::from_diagonal(scale(bytes)?)))
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let translation = bytes.vector()?;
            let scale = DMat3::from_diagonal(scale(bytes)?);
            Ok(DAffine3::from_mat3_translation(scale, translation))
        }
        "TranslationMap" => Ok(DAffine3::from_translation(bytes.vector()?)),
        "AffineMap" | "UnitaryMap" => affine(bytes),
        other => Err(bytes.bad(format!(
            "transform {other:?} is not read; valid are maps of scale, translation, rotation and shear"
        ))),
    }
}

fn scale(bytes: &mut Bytes<'_>) -> Result<DVec3> {
    let scale = bytes.vector()?;
    for _ in 0..DERIVED_OF_SCALE {
        bytes.vector()?;
    }
    Ok(scale)
}

/// Four rows of four numbers, which a row vector is multiplied with.
fn affine(bytes: &mut Bytes<'_>) -> Result<DAffine3> {
    let mut row = || -> Result<DVec3> {
        let row = bytes.vector()?;
        bytes.number::<f64>()?;
        Ok(row)
    };
    Ok(DAffine3::from_cols(row()?, row()?, row()?, row()?))
}
