//! Local ambient occlusion against sums worked out by hand.

use glam::{DAffine3, DVec3};
use umbravox::reference::{Light, light, light_at};
use umbravox::scene::{AmbientOcclusion, Curve, DirectionSet};
use umbravox::volume::Volume;

use crate::fixtures::{assert_close, curve, homogeneous, medium, volume_of};
use crate::scenes;

/// Four samples, 1.5 to 4.5 voxels away.
fn four_samples() -> AmbientOcclusion {
    AmbientOcclusion {
        radius: 5.0,
        ..Default::default()
    }
}

/// 0 up to x = 3 and 1 from x = 4 on; half of that opaque over 1 mm, and glowing.
fn half_space(spacing: [f64; 3]) -> (Volume, Curve) {
    let placement = DAffine3::from_scale(DVec3::from_array(spacing));
    let volume = volume_of([10, 3, 3], placement, |[i, _, _]| {
        f64::from(u32::from(i >= 4))
    });
    let curve = curve(
        1.0,
        &[
            (0.0, [1.0; 3], 0.0, [0.0; 3]),
            (1.0, [1.0; 3], 0.5, [2.0, 0.0, 0.5]),
        ],
    );
    (volume, curve)
}

fn along(
    volume: &Volume,
    curve: &Curve,
    settings: &AmbientOcclusion,
    direction: [f64; 3],
) -> Light {
    light_at(
        volume,
        curve,
        settings,
        None,
        [1, 1, 1],
        &[(direction, 1.0)],
    )
}

const TO_MATTER: [f64; 3] = [1.0, 0.0, 0.0];

#[track_caller]
fn assert_light(actual: Light, rgb: [f64; 3], grey: f64) {
    for (channel, expected) in rgb.into_iter().enumerate() {
        assert_close(actual.rgb[channel], expected, 1e-14);
    }
    assert_close(actual.grey, grey, 1e-14);
}

#[test]
fn empty_space_is_fully_lit() {
    let volume = homogeneous(4, 0.7);
    let settings = AmbientOcclusion {
        bias: 0.25,
        ..Default::default()
    };
    let grid = light(&volume, &medium(1.0, 0.0, [1.0; 3]), &settings, None);
    assert_eq!(grid.size(), [4; 3]);
    assert_eq!(grid.voxels().len(), 64);
    for &voxel in grid.voxels() {
        assert_light(voxel, [1.25; 3], 1.25);
    }
}

/// Samples at x = 2.5, 3.5, 4.5, 5.5: opacities 0, 1/4, 1/2, 1/2; transparency before each 1, 1, 3/4, 3/8;
/// emission 0, 1/2, 1, 1 of the full one.
#[test]
fn half_space_by_hand() {
    let (volume, curve) = half_space([1.0; 3]);
    let lit = along(&volume, &curve, &four_samples(), TO_MATTER);
    let red = (1.0 + 2.0 + 0.75 * 3.0 + 0.375 * 3.0) / 4.0;
    let grey = (1.0 + 1.0 + 0.75 + 0.375) / 4.0;
    let blue = (1.0 + 1.25 + 0.75 * 1.5 + 0.375 * 1.5) / 4.0;
    assert_light(lit, [red, grey, blue], grey);
    // Away from it the ray leaves the field, where nothing absorbs.
    let away = along(&volume, &curve, &four_samples(), [-1.0, 0.0, 0.0]);
    assert_light(away, [1.0; 3], 1.0);
    let unlit = AmbientOcclusion {
        emission: false,
        ..four_samples()
    };
    assert_light(along(&volume, &curve, &unlit, TO_MATTER), [grey; 3], grey);
}

#[test]
fn gamma_is_an_exponent_on_transparency() {
    let (volume, curve) = half_space([1.0; 3]);
    for gamma in [0.0, 0.5, 2.0] {
        let settings = AmbientOcclusion {
            gamma,
            ..four_samples()
        };
        let lit = along(&volume, &curve, &settings, TO_MATTER);
        let through = [1.0, 1.0, 0.75, 0.375].map(|t: f64| t.powf(gamma));
        assert_close(lit.grey, through.iter().sum::<f64>() / 4.0, 1e-14);
    }
}

/// Lengths are in voxels of the smallest spacing and isotropic in mm; opacity is per mm.
#[test]
fn lengths_are_isotropic_in_millimetres() {
    // 2 mm voxels: the same places, each sample twice as long.
    let (volume, curve) = half_space([2.0; 3]);
    let lit = along(&volume, &curve, &four_samples(), TO_MATTER);
    assert_close(
        lit.grey,
        (1.0 + 1.0 + 0.75f64.powi(2) + 0.375f64.powi(2)) / 4.0,
        1e-14,
    );
    // x twice as coarse as y: samples at x = 1.75, 2.25, 2.75, 3.25 voxels, the last a quarter dense.
    let (volume, curve) = half_space([2.0, 1.0, 1.0]);
    let lit = along(&volume, &curve, &four_samples(), TO_MATTER);
    assert_close(lit.grey, 1.0, 1e-14);
    assert_close(lit.rgb[0], (4.0 + 0.25 * 2.0) / 4.0, 1e-14);
}

/// Parts are equal and at most a step long: 3 voxels in steps of 0.8 are four parts of 0.75.
#[test]
fn parts_divide_the_way_evenly() {
    let (volume, curve) = half_space([1.0; 3]);
    let settings = AmbientOcclusion {
        radius: 4.0,
        step: 0.8,
        ..Default::default()
    };
    assert_eq!(settings.samples_per_ray(), 4);
    // x = 2.375, 3.125, 3.875, 4.625: values 0, 1/8, 7/8, 1.
    let clear = [1.0 - 0.125 * 0.5, 1.0 - 0.875 * 0.5].map(|t: f64| t.powf(0.75));
    let expected = (2.0 + clear[0] + clear[0] * clear[1]) / 4.0;
    assert_close(
        along(&volume, &curve, &settings, TO_MATTER).grey,
        expected,
        1e-14,
    );
    for (radius, offset, step, samples) in [
        (16.0, 1.0, 1.0, 15),
        (16.0, 0.0, 1.0, 16),
        (2.0, 1.0, 0.3, 4),
        (2.0, 1.0, 5.0, 1),
    ] {
        let settings = AmbientOcclusion {
            radius,
            offset,
            step,
            ..Default::default()
        };
        assert_eq!(settings.samples_per_ray(), samples);
    }
}

/// In a homogeneous medium eq. 2 is a geometric series; with many samples it tends to the integral of eq. 1.
#[test]
fn homogeneous_medium_sums_to_a_geometric_series() {
    let volume = homogeneous(17, 1.0);
    let curve = medium(1.0, 0.1, [1.0; 3]);
    let at_center = |step: f64| {
        let settings = AmbientOcclusion {
            radius: 7.0,
            step,
            ..Default::default()
        };
        let directions = settings.weighted_directions();
        light_at(&volume, &curve, &settings, None, [8; 3], &directions).grey
    };
    let q: f64 = 0.9;
    assert_close(at_center(1.0), (1.0 - q.powi(6)) / (1.0 - q) / 6.0, 1e-13);
    let depth = -6.0 * q.ln();
    let integral = (1.0 - (-depth).exp()) / depth;
    // A sum that takes each part's transparency at its near end is off by half a part.
    let half_part = |samples: f64| (1.0 - (-depth).exp()) / (2.0 * samples);
    assert_close(at_center(0.01) - integral, half_part(600.0), 1e-6);
}

/// Opaque matter lets in the first of M samples only; outside of it all of them arrive.
#[test]
fn corner_of_an_opaque_block() {
    let volume = homogeneous(9, 1.0);
    let curve = medium(1.0, 1.0, [1.0; 3]);
    let settings = AmbientOcclusion {
        directions: DirectionSet::Octahedron,
        rays: 6,
        ..four_samples()
    };
    let grid = light(&volume, &curve, &settings, None);
    let at = |i, j, k| grid.voxels()[volume.offset(i, j, k)].grey;
    assert_close(at(4, 4, 4), 1.0 / 4.0, 1e-14);
    assert_close(at(0, 4, 4), (1.0 + 5.0 / 4.0) / 6.0, 1e-14);
    assert_close(at(0, 8, 0), (3.0 + 3.0 / 4.0) / 6.0, 1e-14);
    // Three voxels from the face: 1.5 and 2.5 are inside, the ray is dark before it leaves.
    assert_close(at(4, 3, 4), 1.0 / 4.0, 1e-14);
    // One voxel from it: the first sample is outside already.
    assert_close(at(4, 1, 4), (1.0 + 5.0 / 4.0) / 6.0, 1e-14);
}

/// `I = bias + (1/K) sum w_k I_k`: K counts the directions, not their weights.
#[test]
fn weights_select_directions() {
    let (volume, curve) = half_space([1.0; 3]);
    let directions = vec![[3.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.5, 0.0]];
    let dark = (1.0 + 1.0 + 0.75 + 0.375) / 4.0;
    for (weights, sum) in [
        (None, dark + 2.0),
        (Some(vec![1.0, 0.0, 0.0]), dark),
        (Some(vec![0.5, 0.25, 0.0]), 0.5 * dark + 0.25),
        (Some(vec![0.0, 0.0, 0.0]), 0.0),
    ] {
        let settings = AmbientOcclusion {
            explicit_directions: Some(directions.clone()),
            weights,
            bias: 0.125,
            emission: false,
            ..four_samples()
        };
        let grid = light(&volume, &curve, &settings, None);
        let expected = 0.125 + sum / 3.0;
        assert_light(
            grid.voxels()[volume.offset(1, 1, 1)],
            [expected; 3],
            expected,
        );
    }
}

#[test]
fn voxels_are_stored_x_fastest() {
    let (volume, curve) = half_space([1.0; 3]);
    let settings = four_samples();
    let grid = light(&volume, &curve, &settings, None);
    let directions = settings.weighted_directions();
    for voxel in [[0, 0, 0], [3, 2, 0], [9, 0, 2], [5, 1, 2]] {
        let [i, j, k] = voxel;
        let expected = light_at(&volume, &curve, &settings, None, voxel, &directions);
        assert_eq!(grid.voxels()[volume.offset(i, j, k)], expected);
        let ix = DVec3::from_array(voxel.map(f64::from));
        assert_eq!(grid.sample(ix).unwrap().to_array(), expected.rgb);
    }
    assert!(grid.sample(DVec3::new(9.1, 0.0, 0.0)).is_none());
}

/// Few directions against the 2562 vertices of an icosahedron subdivided four times.
#[test]
fn the_error_falls_with_the_number_of_directions() {
    let scene = scenes::all()
        .into_iter()
        .find(|s| s.name == "emissive_tissue")
        .unwrap();
    let all = AmbientOcclusion {
        directions: DirectionSet::Icosahedron,
        rays: 2562,
        ..Default::default()
    };
    let voxels: Vec<[u32; 3]> = (0..125)
        .map(|n| [n % 5, n / 5 % 5, n / 25])
        .map(|v| [v[0] * 5 + 3, v[1] * 6 + 3, v[2] * 4 + 3])
        .collect();
    let light_with = |settings: &AmbientOcclusion| -> Vec<Light> {
        let directions = settings.weighted_directions();
        let at = |&v| {
            light_at(
                &scene.volume,
                &scene.curve,
                settings,
                scene.labels.as_ref(),
                v,
                &directions,
            )
        };
        voxels.iter().map(at).collect()
    };
    let truth = light_with(&all);
    let mut last = f64::INFINITY;
    for rays in [8, 16, 32, 64, 128] {
        let few = light_with(&AmbientOcclusion {
            rays,
            ..Default::default()
        });
        let errors = few.iter().zip(&truth).map(|(a, b)| (a.grey - b.grey).abs());
        let (sum, worst) = errors.fold((0.0, 0.0), |(s, w): (f64, f64), e| (s + e, w.max(e)));
        let mean = sum / voxels.len() as f64;
        println!("{rays:4} directions: mean error {mean:.5}, largest {worst:.5}");
        assert!(mean < last, "{rays} directions are worse than half as many");
        last = mean;
    }
    assert!(
        last < 1.0 / 255.0,
        "128 directions are off by {last} on average"
    );
}
