//! Ranges of the lighting, and what the optical models can and cannot use.

use super::{Number, check_direction, is_share, not_negative, numbers, positive_share, require};
use crate::error::{Error, Result};
use crate::scene::scattering::check_scattering;
use crate::scene::{
    AmbientOcclusion, Classification, Lighting, MAX_LIGHTS, March, OpticalModel, PhaseFunction,
    RayProjection, Reflectance, ScatteringMethod, Shading,
};

pub(super) fn check_lighting(lighting: &Lighting) -> Result<()> {
    if let Some(direction) = lighting.direction {
        check_direction("lighting.direction", direction)?;
    }
    for (key, share) in [
        ("ambient", lighting.ambient),
        ("diffuse", lighting.diffuse),
        ("strength", lighting.strength),
        ("specular", lighting.specular),
    ] {
        let at = format!("lighting.{key}");
        require(not_negative(share), &at, Number(share), "a number >= 0")?;
    }
    require(
        (1.0..=1e4).contains(&lighting.shininess),
        "lighting.shininess",
        Number(lighting.shininess),
        "a number from 1 to 10000",
    )?;
    require(
        positive_share(lighting.roughness),
        "lighting.roughness",
        Number(lighting.roughness),
        "a number > 0 and <= 1",
    )?;
    require(
        lighting.extinction.into_iter().all(not_negative)
            && lighting.extinction.into_iter().any(|e| e > 0.0),
        "lighting.extinction",
        numbers(lighting.extinction),
        "three numbers >= 0, not all 0",
    )?;
    require(
        lighting.albedo.into_iter().all(is_share),
        "lighting.albedo",
        numbers(lighting.albedo),
        "three numbers from 0 to 1",
    )?;
    lighting.phase.validate()?;
    let count = lighting.lights.len();
    require(
        count <= MAX_LIGHTS,
        "lighting.lights",
        format_args!("a list of {count}"),
        &format!("{MAX_LIGHTS} lights at most"),
    )?;
    for (i, light) in lighting.lights.iter().enumerate() {
        light.validate(i)?;
    }
    if let Some(environment) = &lighting.environment {
        environment.validate()?;
    }
    check_scattering(lighting)?;
    check_model(lighting)
}

/// Refuses settings that the optical model has no use for, and models that lack what they need.
fn check_model(lighting: &Lighting) -> Result<()> {
    let refuse = |key: &str, why: &str| Err(Error::invalid(format!("lighting.{key}"), why));
    let scatters = lighting.model.scatters();
    if scatters && lighting.lights.is_empty() && lighting.environment.is_none() {
        return refuse(
            "model",
            "there is nothing to scatter; give \"lights\" or an \"environment\"",
        );
    }
    if !scatters && !lighting.lights.is_empty() {
        return refuse("lights", ONLY_SCATTERING);
    }
    if !scatters && lighting.environment.is_some() {
        return refuse("environment", ONLY_SCATTERING);
    }
    if scatters && lighting.shading != Shading::None {
        return refuse(
            "shading",
            "models that scatter take surfaces from \"reflectance\"; give \"none\"",
        );
    }
    let single = matches!(
        lighting.model,
        OpticalModel::SingleScattering | OpticalModel::ShadowedScattering
    );
    if lighting.reflectance != Reflectance::Particles {
        if !single {
            return refuse(
                "reflectance",
                "only the models \"single_scattering\" and \"shadowed_scattering\" have surfaces; give \"particles\"",
            );
        }
        if lighting.environment.is_some() {
            return refuse(
                "environment",
                "surfaces are lit by \"lights\" alone; leave it out, or give the reflectance \"particles\"",
            );
        }
    }
    let zonal = lighting.model == OpticalModel::MultipleScattering
        && lighting.scattering.method == ScatteringMethod::Zonal;
    if zonal && lighting.phase != PhaseFunction::Isotropic {
        return refuse(
            "phase",
            "the zonal method knows isotropic media alone; give {\"type\": \"isotropic\"} or another method",
        );
    }
    Ok(())
}

const ONLY_SCATTERING: &str = "only the models \"single_scattering\", \"shadowed_scattering\" and \"multiple_scattering\" have lights; leave it out";

/// Refuses what parts of a scene cannot mean together.
pub(crate) fn check_together(
    march: &March,
    lighting: &Lighting,
    occlusion: Option<&AmbientOcclusion>,
) -> Result<()> {
    if lighting.model != OpticalModel::EmissionAbsorption {
        return check_model_with(march, lighting, occlusion);
    }
    if matches!(
        march.projection,
        RayProjection::Composite | RayProjection::Isosurface
    ) {
        return Ok(());
    }
    let lit = "needs light, which only the projections \"composite\" and \"isosurface\" have";
    if lighting.shading != Shading::None {
        return Err(Error::invalid(
            "lighting.shading",
            format!("{lit}; give \"none\""),
        ));
    }
    if occlusion.is_some() {
        return Err(Error::invalid(
            "ambient_occlusion",
            format!("{lit}; give null"),
        ));
    }
    Ok(())
}

/// Refuses what optical models but the default one cannot be combined with.
fn check_model_with(
    march: &March,
    lighting: &Lighting,
    occlusion: Option<&AmbientOcclusion>,
) -> Result<()> {
    if march.projection != RayProjection::Composite {
        return Err(Error::invalid(
            "march.projection",
            "optical models but \"emission_absorption\" are integrals along rays; give \"composite\"",
        ));
    }
    if march
        .classification
        .is_some_and(|c| c != Classification::Post)
    {
        return Err(Error::invalid(
            "march.classification",
            "optical models but \"emission_absorption\" classify after interpolation; give \"post\" or leave it out",
        ));
    }
    if occlusion.is_some() {
        return Err(Error::invalid(
            "ambient_occlusion",
            "belongs to the model \"emission_absorption\"; give null (\"shadowed_scattering\" and \
             \"multiple_scattering\" occlude by themselves)",
        ));
    }
    if lighting.shading != Shading::None {
        return Err(Error::invalid(
            "lighting.shading",
            "belongs to the model \"emission_absorption\"; give \"none\"",
        ));
    }
    Ok(())
}
