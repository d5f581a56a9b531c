//! The pictures: a scene each, with what it changes.

use std::path::Path;

use umbravox::headless::Headless;
use umbravox::scene::{Override, Scene};
use umbravox::{Result, output};

use crate::{Loaded, load, picture};

const SYNTHETIC: &str = "examples/synthetic.json";
const AORTA: &str = "examples/aorta.json";
const MARSCHNER_LOBB: &str = "examples/marschner_lobb.json";
const SHELLS: &str = "examples/shells.json";

/// A picture in `docs/figures/`.
struct Figure {
    name: &'static str,
    scene: &'static str,
    overrides: &'static [&'static str],
}

const fn figure(
    name: &'static str,
    scene: &'static str,
    overrides: &'static [&'static str],
) -> Figure {
    Figure {
        name,
        scene,
        overrides,
    }
}

const DIFFUSE: &str =
    r#"lighting={"shading":"diffuse","direction":[-0.5,-0.6,0.8],"ambient":0.15,"diffuse":0.85}"#;
const HEADLIGHT: &str = r#"lighting={"shading":"diffuse","ambient":0.1,"diffuse":0.9}"#;
const NO_EMISSION: &str = "lighting.emission=false";
const TO_THE_LIGHT: &str = r#"ambient_occlusion={"explicit_directions":[[-0.5,-0.6,0.8]],"radius":24,"bias":0.08,"emission":false}"#;
/// The light and seven directions 48 degrees around it.
const AROUND_THE_LIGHT: &str = r#"ambient_occlusion={"radius":24,"bias":0.08,"emission":false,"explicit_directions":
    [[-0.5,-0.6,0.8], [-0.87,0.12,0.48], [-0.92,-0.38,0.07], [-0.5,-0.86,-0.03], [0.07,-0.96,0.25], [0.36,-0.61,0.7], [0.16,-0.07,0.98], [-0.39,0.26,0.88]]}"#;
const UNSHADED: &str = "lighting.shading=none";
const SMALL: &str = "image.size=[256,256]";
const CLOSE_UP: &str = "camera.zoom=3.2";

// The cloud of Max's figures 2 to 6 and 8.
const CLOUD: &str = "examples/cloud.json";
const OVER_GROUND: &str = r#"image={"size":[384,288],"background_image":"../out/ground.png"}"#;
const NEARER: &str = "camera.zoom=1.9";
const BRIGHTER: &str = "image.exposure=1";
const SINGLE: &str = r#"lighting={"model":"single_scattering","albedo":[0.99,0.99,0.99],"phase":{"type":"henyey_greenstein","g":0.5},
    "lights":[{"type":"directional","direction":[-0.75,0.25,0.6],"irradiance":[4,3.9,3.7]}]}"#;
const SHADOWED: &str = r#"lighting={"model":"shadowed_scattering","albedo":[0.99,0.99,0.99],"phase":{"type":"henyey_greenstein","g":0.5},
    "lights":[{"type":"directional","direction":[-0.75,0.25,0.6],"irradiance":[4,3.9,3.7]}],"shadows":{"spacing":2}}"#;
const MULTIPLE: &str = r#"lighting={"model":"multiple_scattering","albedo":[0.99,0.99,0.99],"phase":{"type":"henyey_greenstein","g":0.5},
    "lights":[{"type":"directional","direction":[-0.75,0.25,0.6],"irradiance":[4,3.9,3.7]}],"shadows":{"spacing":2},
    "scattering":{"resolution":24,"tolerance":0.001}}"#;

const FIGURES: &[Figure] = &[
    figure(
        "cloud_absorption",
        CLOUD,
        &[OVER_GROUND, NEARER, r#"lighting={"model":"absorption"}"#],
    ),
    figure(
        "cloud_emission",
        CLOUD,
        &[
            OVER_GROUND,
            NEARER,
            "image.exposure=-4",
            r#"lighting={"model":"emission"}"#,
        ],
    ),
    figure("cloud_emission_absorption", CLOUD, &[OVER_GROUND, NEARER]),
    figure(
        "cloud_single_scattering",
        CLOUD,
        &[OVER_GROUND, NEARER, BRIGHTER, SINGLE],
    ),
    figure(
        "cloud_shadowed_scattering",
        CLOUD,
        &[OVER_GROUND, NEARER, BRIGHTER, SHADOWED],
    ),
    figure(
        "cloud_multiple_scattering",
        CLOUD,
        &[OVER_GROUND, NEARER, BRIGHTER, MULTIPLE],
    ),
    figure(
        "fig3_diffuse",
        SYNTHETIC,
        &["ambient_occlusion=null", DIFFUSE, NO_EMISSION],
    ),
    figure(
        "fig3_one_direction",
        SYNTHETIC,
        &[NO_EMISSION, TO_THE_LIGHT],
    ),
    figure(
        "fig3_eight_directions",
        SYNTHETIC,
        &[NO_EMISSION, AROUND_THE_LIGHT],
    ),
    figure(
        "fig4_march",
        SYNTHETIC,
        &["ambient_occlusion.emission=false"],
    ),
    figure("fig4_light", SYNTHETIC, &["lighting.emission=false"]),
    figure("fig4_both", SYNTHETIC, &[]),
    figure(
        "fig8_diffuse",
        AORTA,
        &[SMALL, "ambient_occlusion=null", HEADLIGHT],
    ),
    figure("fig8_lao", AORTA, &[SMALL, UNSHADED]),
    figure(
        "fig8_diffuse_close",
        AORTA,
        &[SMALL, CLOSE_UP, "ambient_occlusion=null", HEADLIGHT],
    ),
    figure("fig8_lao_close", AORTA, &[SMALL, CLOSE_UP, UNSHADED]),
    figure("aorta", AORTA, &[]),
    figure("filter_linear", MARSCHNER_LOBB, &[]),
    figure(
        "filter_linear_bspline_gradient",
        MARSCHNER_LOBB,
        &["lighting.gradient=bspline"],
    ),
    figure(
        "filter_bspline",
        MARSCHNER_LOBB,
        &["march.interpolation=bspline", "lighting.gradient=bspline"],
    ),
    figure(
        "filter_catmull_rom",
        MARSCHNER_LOBB,
        &[
            "march.interpolation=catmull_rom",
            "lighting.gradient=catmull_rom",
        ],
    ),
    figure("shells_post", SHELLS, &["march.classification=post"]),
    figure("shells_preintegrated", SHELLS, &[]),
];

/// Renders those whose name holds `only` into `folder`.
///
/// # Errors
/// When a scene, a volume or the device fails.
pub(crate) fn render(headless: &Headless, folder: &Path, only: &str) -> Result<()> {
    for figure in FIGURES.iter().filter(|f| f.name.contains(only)) {
        let overrides = figure
            .overrides
            .iter()
            .map(|text| Override::parse(text))
            .collect::<Result<Vec<_>>>()?;
        let scene = Scene::read(Path::new(figure.scene), &overrides)?;
        let Loaded { mut session, .. } = load(headless, &scene)?;
        let path = folder.join(format!("{}.png", figure.name));
        output::write(&path, &picture(&mut session)?, &scene.image, &[])?;
        println!("{}", path.display());
    }
    Ok(())
}
