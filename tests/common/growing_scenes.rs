//! Ambient light of rays whose samples lie farther apart the farther out they are.

use umbravox::scene::RaySampling;

use super::{TestScene, label_scenes, optics_scenes};

/// Scenes of uniform sampling by name, what they are called here, and their growth.
const GROWING: [(&str, &str, Option<f64>); 5] = [
    ("emissive_tissue", "growing_emissive_tissue", Some(1.0)),
    ("emission_in_light_only", "growing_by_error", None),
    (
        "weighted_icosahedron",
        "growing_weighted_icosahedron",
        Some(0.4),
    ),
    (
        "light_through_the_faces",
        "growing_light_through_the_faces",
        Some(0.25),
    ),
    (
        "labels_in_ambient_light",
        "growing_labels_in_ambient_light",
        Some(0.6),
    ),
];

pub(crate) fn scenes() -> Vec<TestScene> {
    let mut scenes = optics_scenes::ambient_light();
    scenes.extend(label_scenes::in_ambient_light());
    let growing = scenes.into_iter().filter_map(|mut test| {
        let (_, name, growth) = GROWING.iter().find(|(uniform, ..)| *uniform == test.name)?;
        let ao = test.scene.ambient_occlusion.as_mut()?;
        ao.sampling = RaySampling::Distance;
        ao.growth = *growth;
        // Long enough for several distances.
        ao.radius += 7.0;
        test.name = name;
        Some(test)
    });
    growing.collect()
}
