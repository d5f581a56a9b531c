//! Ambient light of rays whose samples lie farther apart the farther out they are, beside that of samples in every part, on the
//! volumes of the repository: how far apart the two are, and how many samples each takes.

use std::path::Path;
use std::sync::Arc;

use umbravox::headless::{Headless, LightVolume, Options, Session};
use umbravox::io::{self, ReadOptions};
use umbravox::occlusion::{GROWTHS, RMS_ERROR};
use umbravox::scene::{AmbientOcclusion, Classification, Override, RaySampling, Scene};
use umbravox::volume::Volume;

/// Volumes with the presets that the bench draws them by.
const SHIPPED: [(&str, &str); 2] = [
    ("data/ct_aorta_stent.mha", "ct-bone"),
    ("data/ct_tooth.nrrd", "micro-ct"),
];
/// Times fewer samples than voxels, directions and parts of a ray: the goal of docs/performance.md.
const FEWER: f64 = 5.0;

fn headless() -> Headless {
    let options = Options {
        validation: true,
        ..Default::default()
    };
    Headless::new(&options).expect("a Vulkan device and the validation layer are installed")
}

fn lit(headless: &Headless, volume: &Arc<Volume>, preset: &str, ao: AmbientOcclusion) -> Session {
    let preset = Override::parse(&format!("transfer_function.preset={preset}")).unwrap();
    let mut scene = Scene::for_volume(Path::new("in-memory"), &[preset]).unwrap();
    scene.image.size = [16; 2];
    // As the bench counts: pre-integration lights voxels half a step farther out.
    scene.march.classification = Some(Classification::Post);
    scene.ambient_occlusion = Some(ao);
    let mut session = headless.load(Arc::clone(volume), &scene).unwrap();
    while session.refine_light().unwrap() {}
    session
}

/// RMS and largest difference of the channels of all voxels that have light.
fn difference(one: &LightVolume, other: &LightVolume) -> (f64, f64) {
    let (mut sum, mut count, mut largest) = (0.0, 0u32, 0f64);
    for (a, b) in one.rgba.iter().zip(&other.rgba) {
        assert_eq!(a[3] > 0.0, b[3] > 0.0, "the same voxels have light");
        if a[3] > 0.0 {
            for channel in 0..3 {
                let error = f64::from(a[channel]) - f64::from(b[channel]);
                sum += error * error;
                largest = largest.max(error.abs());
            }
            count += 3;
        }
    }
    assert!(count > 0, "something has light");
    ((sum / f64::from(count)).sqrt(), largest)
}

#[test]
fn growing_distances_keep_the_light_of_shipped_volumes_with_a_fifth_of_the_samples() {
    let headless = headless();
    for (path, preset) in SHIPPED {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        let volume = Arc::new(io::read(&path, &ReadOptions::default()).unwrap());
        let uniform = AmbientOcclusion::default();
        let distance = AmbientOcclusion {
            sampling: RaySampling::Distance,
            ..uniform.clone()
        };
        let mut expected = lit(&headless, &volume, preset, uniform.clone());
        let expected = expected.light_volume().unwrap();
        let mut session = lit(&headless, &volume, preset, distance);
        let (rms, largest) = difference(&session.light_volume().unwrap(), &expected);
        let growth = session.stats().unwrap().lao.expect("light is on").growth;
        let samples = session.count_light_samples().unwrap().expect("whole");
        let asked = volume.voxels().len() as f64
            * f64::from(uniform.rays)
            * f64::from(uniform.samples_per_ray());
        let fewer = asked / samples as f64;
        println!(
            "{preset}: growth {growth:?}, {fewer:.2} times fewer samples, {:.2}/255 RMS, {:.1}/255 at most",
            255.0 * rms,
            255.0 * largest
        );
        assert!(growth.is_some_and(|growth| GROWTHS.contains(&growth)));
        assert!(rms <= RMS_ERROR, "{preset}: {rms}");
        assert!(fewer >= FEWER, "{preset}: {fewer}");
    }
    assert_eq!(headless.validation_messages(), [""; 0]);
}

/// Uniform sampling, default settings and a growth that is given leave nothing to choose.
#[test]
fn the_scene_decides_where_it_says_so() {
    let headless = headless();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/ct_tooth.nrrd");
    let volume = Arc::new(io::read(&path, &ReadOptions::default()).unwrap());
    for (sampling, growth) in [
        (RaySampling::Uniform, None),
        (RaySampling::Distance, Some(0.05)),
        (RaySampling::Distance, Some(1.0)),
    ] {
        let ao = AmbientOcclusion {
            sampling,
            growth,
            rays: 1,
            ..Default::default()
        };
        let mut session = lit(&headless, &volume, "micro-ct", ao);
        let told = session.stats().unwrap().lao.expect("light is on").growth;
        assert_eq!(told, growth);
    }
    assert_eq!(headless.validation_messages(), [""; 0]);
}
