//! Pixels and points are probed.

use glam::DVec3;
use serde_json::{Value, json};

use crate::workplace::Workplace;

const SIZE: [u32; 2] = [24, 16];

/// Camera of a scene file, by the book: where a point of the world is seen, pixels.
struct Pinhole {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    /// Vertical angle in degrees, or height of a parallel view.
    extent: Result<f64, f64>,
}

impl Pinhole {
    fn json(&self) -> String {
        let [eye, target, up] = [self.eye, self.target, self.up].map(|v| v.to_array());
        let camera = match self.extent {
            Ok(fov_y) => {
                json!({ "type": "perspective", "eye": eye, "target": target, "up": up, "fov_y": fov_y })
            }
            Err(height) => {
                json!({ "type": "orthographic", "eye": eye, "target": target, "up": up, "height": height })
            }
        };
        format!("camera={camera}")
    }

    fn pixel(&self, world: DVec3) -> [f64; 2] {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        let up = right.cross(forward);
        let p = world - self.eye;
        let half = match self.extent {
            Ok(fov_y) => p.dot(forward) * (0.5 * fov_y.to_radians()).tan(),
            Err(height) => 0.5 * height,
        };
        let [width, height] = SIZE.map(f64::from);
        let aspect = width / height;
        [
            width * 0.5 * (1.0 + p.dot(right) / half / aspect),
            height * 0.5 * (1.0 - p.dot(up) / half),
        ]
    }
}

fn vector(value: &Value) -> DVec3 {
    let numbers: Vec<f64> = serde_json::from_value(value.clone()).unwrap();
    DVec3::from_slice(&numbers)
}

/// From outside of the volume and from inside, both projections.
fn cameras() -> Vec<Pinhole> {
    // Middle of the ball.
    let target = DVec3::new(10.0, 9.0, 12.0);
    let up = DVec3::new(0.0, 0.2, 1.0);
    let outside = target + DVec3::new(30.0, -40.0, 15.0);
    // In the air before the ball, inside the field.
    let inside = target + DVec3::new(-8.5, -7.5, 1.0);
    [
        (outside, Ok(25.0)),
        (outside, Err(18.0)),
        (inside, Ok(50.0)),
        (inside, Err(9.0)),
    ]
    .map(|(eye, extent)| Pinhole {
        eye,
        target,
        up,
        extent,
    })
    .into()
}

#[test]
fn what_a_pixel_shows_is_seen_at_that_pixel() {
    let place = Workplace::new();
    let mut worst = 0f64;
    for camera in cameras() {
        for [x, y] in [[12, 8], [9, 6], [14, 10]] {
            for projection in ["composite", "isosurface"] {
                let args = [
                    "probe".to_owned(),
                    "scene.json".into(),
                    "--json".into(),
                    "--validation".into(),
                    format!("--pixel={x},{y}"),
                    format!("--set={}", camera.json()),
                    format!("--set=march.projection={projection}"),
                    "--set=march.isosurfaces=[{\"value\":250}]".into(),
                    "--set=ambient_occlusion=null".into(),
                ];
                let mut args: Vec<&str> = args.iter().map(String::as_str).collect();
                if projection == "composite" {
                    args.retain(|arg| !arg.contains("isosurfaces"));
                }
                let probe: Value = serde_json::from_str(&place.succeed(&args)).unwrap();
                let hit = &probe["hit"];
                assert!(hit.is_object(), "{probe}");
                let world = vector(&hit["world"]);
                let seen = camera.pixel(world);
                for (seen, asked) in seen.into_iter().zip([x, y]) {
                    worst = worst.max((seen - f64::from(asked) - 0.5).abs());
                }
                let spacing = DVec3::new(1.0, 1.0, 1.5);
                assert!((vector(&hit["voxel"]) * spacing).distance(world) < 1e-6);
                // The surface of the ball, of radius 6 voxels: values rise towards the middle.
                let value = hit["value"].as_f64().unwrap();
                let inwards = DVec3::new(10.0, 9.0, 12.0) - world;
                assert!(vector(&hit["gradient"]).dot(inwards) > 0.0, "{probe}");
                assert!((3.0..10.0).contains(&inwards.length()), "{probe}");
                if projection == "isosurface" {
                    assert!((value - 250.0).abs() < 1.0, "{value}");
                }
                assert!(probe["opacity"].as_f64().unwrap() >= 0.05);
                let depth = hit["depth"].as_f64().unwrap();
                assert!(probe["expected_depth"].as_f64().unwrap() >= depth - 1e-3);
            }
        }
    }
    println!("projected back to {worst:.1e} px");
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn pixels_without_a_hit_say_so() {
    let place = Workplace::new();
    let probe = |args: &[&str]| -> Value {
        let base = [
            "probe",
            "scene.json",
            "--json",
            "--validation",
            "--pixel",
            "0,0",
        ];
        serde_json::from_str(&place.succeed(&[&base[..], args].concat())).unwrap()
    };
    // The corner of the picture misses the ball.
    let missed = probe(&[]);
    assert_eq!(missed["hit"], Value::Null, "{missed}");
    assert_eq!(missed["median_depth"], Value::Null);
    assert_eq!(missed["expected_depth"], Value::Null);
    assert_eq!(missed["opacity"], 0.0);
    let text = place.succeed(&["probe", "scene.json", "--pixel", "0,0"]);
    assert!(text.contains("hit"), "{text}");
    // A mean has a value and no depth; X-rays have a depth where they get that opaque.
    let unlit = ["--set", "ambient_occlusion=null", "--pixel", "12,8"];
    let through = |projection: &str| -> Value {
        let set = format!("march.projection={projection}");
        let args = [
            &["probe", "scene.json", "--json", "--set", &set][..],
            &unlit,
        ]
        .concat();
        serde_json::from_str(&place.succeed(&args)).unwrap()
    };
    let mean = through("mean");
    assert_eq!(mean["hit"], Value::Null, "{mean}");
    let value = mean["projected_value"].as_f64().unwrap();
    assert!((-1000.0..1000.0).contains(&value), "{mean}");
    let xray = through("xray");
    assert!(xray["hit"].is_object() && xray["optical_depth"].as_f64().unwrap() > 0.0);
    let maximum = through("maximum");
    assert_eq!(maximum["projected_value"], 1000.0, "{maximum}");
    assert_eq!(maximum["hit"]["value"], 1000.0, "{maximum}");
}

#[test]
fn bad_places_are_refused() {
    let place = Workplace::new();
    for (args, expected) in [
        (&["--pixel", "24,0"][..], "24,0 is outside of the picture"),
        (&["--pixel", "1"], "give a column and a row"),
        (&["--pixel", "-1,2"], "-1"),
        (
            &["--pixel", "1,2", "--world", "1,2,3"],
            "cannot be used with",
        ),
        (&[], "--world"),
    ] {
        let message = place.refuse(&[&["probe", "scene.json"], args].concat());
        assert!(message.contains(expected), "{message}");
    }
}
