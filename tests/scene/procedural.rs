//! Volumes that are computed: the cloud.

use std::path::Path;

use umbravox::scene::{Cloud, Ellipsoid, Scene};
use umbravox::volume::Volume;

/// The volume of a scene file that says no more than this of it.
fn computed(procedural: &str) -> Volume {
    let json = format!(r#"{{"volume": {{"procedural": {procedural}}}}}"#);
    let scene = Scene::from_json(&json, Path::new("elsewhere"), &[]).expect("a valid scene");
    umbravox::io::volume_of(&scene.volume, &Default::default()).expect("a volume")
}

fn refusal(volume: &str) -> String {
    let json = format!(r#"{{"volume": {volume}}}"#);
    let error = Scene::from_json(&json, Path::new(""), &[]).expect_err("not valid");
    error.to_string()
}

fn values(volume: &Volume) -> Vec<f64> {
    (0..volume.voxels().len())
        .map(|at| volume.voxels().get(at))
        .collect()
}

#[test]
fn the_default_cloud_floats_free_and_has_a_dense_heart() {
    let cloud = computed(r#"{"type": "cloud"}"#);
    assert_eq!(cloud.size(), [96, 96, 72]);
    assert_eq!(cloud.spacing(), [1.0; 3]);
    assert_eq!(cloud.value_range(), [0.0, 1.0]);
    for k in 0..72 {
        for j in 0..96 {
            for i in 0..96 {
                let at_face = [i, j].iter().any(|n| [0, 95].contains(n)) || [0, 71].contains(&k);
                assert!(!at_face || cloud.value(i, j, k) == 0.0, "{i} {j} {k}");
            }
        }
    }
    let values = values(&cloud);
    let share = |test: fn(f64) -> bool| {
        values.iter().filter(|&&v| test(v)).count() as f64 / values.len() as f64
    };
    let [empty, full] = [share(|v| v == 0.0), share(|v| v == 1.0)];
    assert!((0.5..0.9).contains(&empty), "empty: {empty}");
    assert!((0.02..0.3).contains(&full), "full: {full}");
}

#[test]
fn a_seed_gives_the_same_cloud_again_and_another_one_another() {
    let of_seed = |seed: u32| {
        let size = "[24, 24, 18]";
        computed(&format!(
            r#"{{"type": "cloud", "size": {size}, "seed": {seed}}}"#
        ))
        .fingerprint()
    };
    assert_eq!(of_seed(5), of_seed(5));
    assert_ne!(of_seed(5), of_seed(6));
}

/// Without noise a given ellipsoid is its formula: `1 - q` inside.
#[test]
fn ellipsoids_are_what_they_say() {
    let cloud = computed(
        r#"{"type": "cloud", "size": [21, 11, 9], "spacing": [1, 2, 3], "turbulence": 0,
            "ellipsoids": [{"center": [0.5, 0.5, 0.5], "radii": [0.4, 0.3, 0.5], "density": 0.8}]}"#,
    );
    assert_eq!(cloud.spacing(), [1.0, 2.0, 3.0]);
    for [i, j, k] in [[10, 5, 4], [14, 5, 4], [10, 6, 3], [0, 5, 4], [18, 8, 4]] {
        let at = [f64::from(i) / 20.0, f64::from(j) / 10.0, f64::from(k) / 8.0];
        let q: f64 = at
            .iter()
            .zip([0.4, 0.3, 0.5])
            .map(|(x, r)| ((x - 0.5) / r).powi(2))
            .sum();
        let expected = 0.8 * (1.0 - q).max(0.0);
        let found = cloud.value(i, j, k);
        assert!((found - expected).abs() < 1e-7, "{i} {j} {k}: {found}");
    }
}

/// Noise takes away and never adds, most where the cloud is thin; more octaves make finer detail.
#[test]
fn noise_eats_into_the_edges() {
    let ball = |turbulence: f64, octaves: u32| {
        values(&computed(&format!(
            r#"{{"type": "cloud", "size": [40, 40, 40], "turbulence": {turbulence}, "octaves": {octaves}, "frequency": 3,
                "ellipsoids": [{{"center": [0.5, 0.5, 0.5], "radii": [0.5, 0.5, 0.5], "density": 2}}]}}"#
        )))
    };
    let smooth = ball(0.0, 5);
    let ragged = ball(2.0, 5);
    let soft = ball(2.0, 1);
    assert!(smooth.iter().zip(&ragged).all(|(s, r)| r <= s));
    assert!(
        smooth.iter().zip(&ragged).all(|(s, r)| *s < 1.0 || r == s),
        "the heart is whole"
    );
    // The noise itself, where it has not eaten everything: `n = (s - v) / (turbulence (1 - s))`.
    let noise = |values: &[f64]| -> Vec<Option<f64>> {
        let pairs = smooth.iter().zip(values);
        pairs
            .map(|(s, v)| (*s < 0.95 && *v > 0.0).then(|| (s - v) / (2.0 * (1.0 - s))))
            .collect()
    };
    // Mean squared second difference along x.
    let roughness = |values: &[f64]| -> f64 {
        let noise = noise(values);
        let triples = noise.windows(3);
        let bends: Vec<f64> = triples
            .filter_map(|n| Some((n[0]? - 2.0 * n[1]? + n[2]?).powi(2)))
            .collect();
        assert!(bends.len() > 1000, "{}", bends.len());
        bends.iter().sum::<f64>() / bends.len() as f64
    };
    assert!(
        noise(&ragged)
            .iter()
            .flatten()
            .all(|n| (0.0..=1.0).contains(n))
    );
    let [fine, coarse] = [roughness(&ragged), roughness(&soft)];
    assert!(fine > 1.5 * coarse, "{fine} and {coarse}");
}

#[test]
fn a_volume_is_a_file_or_a_formula() {
    let neither = refusal("{}");
    assert!(neither.starts_with("volume.path: missing"), "{neither}");
    let both = refusal(r#"{"path": "a.nrrd", "procedural": {"type": "cloud"}}"#);
    assert!(
        both.starts_with("volume.procedural: stands beside"),
        "{both}"
    );
}

#[test]
fn wrong_parameters_are_named() {
    for (parameters, place) in [
        (r#""size": [1, 8, 8]"#, "size.0"),
        (r#""size": [100000, 100000, 100000]"#, "size"),
        (r#""spacing": [1, 0, 1]"#, "spacing"),
        (r#""count": 0"#, "count"),
        (r#""octaves": 17"#, "octaves"),
        (r#""turbulence": -1"#, "turbulence"),
        (r#""frequency": 0"#, "frequency"),
        (r#""ellipsoids": []"#, "ellipsoids"),
        (
            r#""ellipsoids": [{"center": [0, 0, 0], "radii": [1, 0, 1]}]"#,
            "ellipsoids.0.radii",
        ),
        (r#""octave": 3"#, "octave"),
    ] {
        let message = refusal(&format!(
            r#"{{"procedural": {{"type": "cloud", {parameters}}}}}"#
        ));
        let place = format!("volume.procedural.{place}:");
        assert!(message.starts_with(&place), "{message}");
    }
    let message = refusal(r#"{"procedural": {"type": "fog"}}"#);
    assert!(message.contains("cloud"), "{message}");
}

#[test]
fn code_makes_the_same_cloud_as_a_scene_file() {
    let ellipsoid = Ellipsoid {
        center: [0.5; 3],
        radii: [0.4; 3],
        density: 1.0,
    };
    let cloud = Cloud {
        size: [16; 3],
        ellipsoids: Some(vec![ellipsoid]),
        ..Cloud::default()
    };
    let by_code = umbravox::scene::Procedural::Cloud(cloud)
        .volume()
        .expect("valid");
    let by_file = computed(
        r#"{"type": "cloud", "size": [16, 16, 16],
            "ellipsoids": [{"center": [0.5, 0.5, 0.5], "radii": [0.4, 0.4, 0.4]}]}"#,
    );
    assert_eq!(by_code.fingerprint(), by_file.fingerprint());
}
