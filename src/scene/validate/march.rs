//! Ranges of the march's settings, and which of them cannot go together.

use super::{
    MAX_ISOSURFACES, Number, check_step, finite, is_share, numbers, positive_share, require,
};
use crate::error::{Error, Result};
use crate::scene::{Classification, March, RayProjection};

pub(super) fn check_march(march: &March) -> Result<()> {
    check_step("march.step", march.step)?;
    require(
        positive_share(march.early_termination),
        "march.early_termination",
        Number(march.early_termination),
        "a number > 0 and <= 1 (opacity; 1: never early)",
    )?;
    require(
        march.inter_block_interpolation || !march.interpolation.is_cubic(),
        "march.inter_block_interpolation",
        false,
        "true with cubic interpolation: its support reaches into the next block",
    )?;
    check_classification(march)?;
    check_isosurfaces(march)
}

/// Refuses orders of classification that the rest of the march has no meaning for.
fn check_classification(march: &March) -> Result<()> {
    let Some(classification) = march.classification else {
        return Ok(());
    };
    let refuse = |why: &str| Err(Error::invalid("march.classification", why));
    match march.projection {
        RayProjection::Composite | RayProjection::Xray => {}
        _ => {
            return refuse(
                "only the projections \"composite\" and \"xray\" integrate the transfer function; leave it out for this one",
            );
        }
    }
    match classification {
        Classification::Preintegrated if !march.field_is_continuous() => refuse(
            "\"preintegrated\" needs a field without jumps: interpolation other than \"nearest\", and \
             inter_block_interpolation on; give \"post\"",
        ),
        Classification::Pre if march.interpolation.is_cubic() => refuse(
            "\"pre\" interpolates classified voxels; give interpolation \"linear\" or \"nearest\", or classification \"post\"",
        ),
        _ => Ok(()),
    }
}

fn check_isosurfaces(march: &March) -> Result<()> {
    let at = "march.isosurfaces";
    let count = march.isosurfaces.len();
    if march.projection != RayProjection::Isosurface {
        return require(
            count == 0,
            at,
            format_args!("a list of {count}"),
            "isosurfaces with the projection \"isosurface\" only",
        );
    }
    require(
        (1..=MAX_ISOSURFACES).contains(&count),
        at,
        format_args!("a list of {count}"),
        &format!("1 to {MAX_ISOSURFACES} surfaces for the projection \"isosurface\""),
    )?;
    require(
        march.field_is_continuous(),
        "march.projection",
        "isosurface",
        "one that needs no continuous field, or interpolation other than \"nearest\" and inter_block_interpolation on",
    )?;
    for (i, surface) in march.isosurfaces.iter().enumerate() {
        let at = |key: &str| format!("march.isosurfaces.{i}.{key}");
        require(
            finite(surface.value),
            &at("value"),
            Number(surface.value),
            "a finite number",
        )?;
        require(
            positive_share(surface.opacity),
            &at("opacity"),
            Number(surface.opacity),
            "a number > 0 and <= 1",
        )?;
        if let Some(color) = surface.color {
            require(
                color.into_iter().all(is_share),
                &at("color"),
                numbers(color),
                "three numbers from 0 to 1",
            )?;
        }
    }
    Ok(())
}
