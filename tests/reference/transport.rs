//! Light transport against closed forms.

use glam::{DAffine3, DVec3};
use umbravox::reference::Ray;
use umbravox::reference::analytic::{self, LitSlab, extinction, slab_opacity, sphere_chord};
use umbravox::reference::transport::{
    Illumination, Medium, PathStart, PathTracer, absorbed, emitted, glowing, scattered_once,
};
use umbravox::scene::{Curve, CurvePoint, Light, Lighting, Optical, PhaseFunction};
use umbravox::volume::Volume;

use crate::fixtures::{assert_close, volume_of};

const FORWARD: PhaseFunction = PhaseFunction::HenyeyGreenstein { g: 0.6 };
/// Of the slab, mm.
const THICKNESS: f64 = 8.0;

/// So wide that no ray of a test meets its sides; light enters through z = 8 or z = 0.
fn slab() -> Volume {
    let scale = DAffine3::from_scale(DVec3::new(4000.0, 4000.0, 1.0));
    volume_of([3, 3, 9], scale, |_| 0.0)
}

/// One colour, opacity over 1 mm, and source everywhere.
fn uniform(color: [f64; 3], opacity: f64, source: [f64; 3]) -> Curve {
    let optical = Optical {
        color,
        opacity,
        emission: [0.0; 3],
        source,
    };
    Curve {
        unit_distance: 1.0,
        points: vec![CurvePoint {
            value: 0.0,
            optical,
        }],
    }
}

/// Through the middle of the slab; `z` of the direction tells from which side.
fn through(direction: DVec3) -> Ray {
    let direction = direction.normalize();
    let middle = DVec3::new(4000.0, 4000.0, 0.5 * THICKNESS);
    Ray {
        origin: middle - 100.0 * direction,
        direction,
    }
}

fn chromatic() -> Lighting {
    Lighting {
        extinction: [1.0, 0.5, 0.0],
        ..Lighting::default()
    }
}

#[test]
fn absorption_of_a_slab_by_channel() {
    let (volume, curve) = (slab(), uniform([1.0; 3], 0.2, [0.0; 3]));
    let medium = Medium::new(&volume, &curve, &chromatic()).expect("finite");
    let ray = through(DVec3::new(0.3, 0.1, 1.0));
    let length = THICKNESS / ray.direction.z;
    let light = absorbed(&medium, ray, 0.3);
    assert_eq!(light.radiance, DVec3::ZERO);
    for (channel, factor) in chromatic().extinction.into_iter().enumerate() {
        let expected = (-extinction(0.2, 1.0) * factor * length).exp();
        assert_close(light.transmittance[channel], expected, 1e-12);
    }
}

/// Without attenuation the glow grows with the length; with it, it saturates. A channel whose extinction is 0 glows all the same.
#[test]
fn glow_of_a_slab() {
    let (color, source) = ([0.5, 0.6, 0.7], [0.1, 0.2, 0.3]);
    let (volume, curve) = (slab(), uniform(color, 0.2, source));
    let medium = Medium::new(&volume, &curve, &chromatic()).expect("finite");
    let ray = through(DVec3::new(0.3, 0.1, 1.0));
    let length = THICKNESS / ray.direction.z;
    let [gas, attenuated] = [emitted(&medium, ray, 0.3), glowing(&medium, ray, 0.3)];
    assert_eq!(gas.transmittance, DVec3::ONE);
    for channel in 0..3 {
        let tau = extinction(0.2, 1.0) * chromatic().extinction[channel];
        let per_mm = color[channel] * tau + source[channel];
        assert_close(gas.radiance[channel], per_mm * length, 1e-12);
        let expected = analytic::glow(per_mm, 0.0, tau, length);
        assert_close(attenuated.radiance[channel], expected, 1e-12);
    }
    // The particle model, without a source, is eq. 8.
    let curve = uniform(color, 0.2, [0.0; 3]);
    let medium = Medium::new(&volume, &curve, &Lighting::default()).expect("finite");
    let opacity = slab_opacity(0.2, 1.0, length);
    let particles = glowing(&medium, ray, 0.3).radiance;
    assert_close(particles.x, color[0] * opacity, 1e-12);
}

/// The field is the distance from the middle, so what is trilinear of it is a sphere to `h^2 / 8 R`, 1e-3 of the radius here.
#[test]
fn a_sphere_absorbs_and_glows_by_its_chord() {
    let (middle, radius) = (DVec3::splat(16.0), 10.0);
    let volume = volume_of([33; 3], DAffine3::IDENTITY, |ix| {
        DVec3::from_array(ix.map(f64::from)).distance(middle)
    });
    let inside = uniform([0.8; 3], 0.1, [0.05; 3]).points[0].optical;
    let point = |value, optical| CurvePoint { value, optical };
    let curve = Curve {
        unit_distance: 1.0,
        points: vec![point(radius, inside), point(radius, Optical::default())],
    };
    let medium = Medium::new(&volume, &curve, &Lighting::default()).expect("finite");
    let tau = extinction(0.1, 1.0);
    for distance in [0.0, 3.3, 6.1, 8.7, 11.0] {
        let ray = Ray {
            origin: DVec3::new(16.0 + distance, 16.0, -5.0),
            direction: DVec3::Z,
        };
        let chord = sphere_chord(radius, distance);
        let light = glowing(&medium, ray, 0.002);
        assert_close(-light.transmittance.x.ln(), tau * chord, 5e-3);
        let expected = analytic::glow(0.8 * tau + 0.05, 0.0, tau, chord);
        assert_close(light.radiance.x, expected, 5e-3);
        let gas = emitted(&medium, ray, 0.002);
        assert_close(gas.radiance.x, (0.8 * tau + 0.05) * chord, 5e-3);
    }
}

/// Light from above, seen from above and from below, straight and at angles.
#[test]
fn light_scattered_once_by_a_slab() {
    let (volume, curve) = (slab(), uniform([0.9, 0.6, 0.3], 0.15, [0.0; 3]));
    let lighting = chromatic();
    let medium = Medium::new(&volume, &curve, &lighting).expect("finite");
    let to_light = DVec3::new(0.5, 0.2, 1.0).normalize();
    let irradiance = DVec3::new(3.0, 2.0, 1.0);
    let lights = [Light::Directional {
        direction: to_light.to_array(),
        irradiance: irradiance.to_array(),
    }];
    let illumination = Illumination {
        lights: &lights,
        surroundings: None,
        phase: &FORWARD,
    };
    let same_angle = DVec3::new(0.2, 0.5, 1.0);
    for towards_eye in [DVec3::Z, DVec3::new(-0.7, 0.1, 1.0), same_angle] {
        for side in [1.0, -1.0] {
            let eye = (towards_eye * DVec3::new(1.0, 1.0, side)).normalize();
            let ray = through(-eye);
            let lit = scattered_once(&medium, &illumination, ray, 0.01, true);
            let unshadowed = scattered_once(&medium, &illumination, ray, 0.01, false);
            for channel in 0..3 {
                let tau = extinction(0.15, 1.0) * lighting.extinction[channel];
                let phase = FORWARD.evaluate((-to_light).dot(eye));
                let form = LitSlab {
                    depth: tau * THICKNESS,
                    cos_light: to_light.z,
                    scattered: curve.points[0].optical.color[channel] * phase * irradiance[channel],
                };
                let expected = if side > 0.0 {
                    form.reflected(eye.z.abs())
                } else {
                    form.transmitted(eye.z.abs())
                };
                assert_close(lit.radiance[channel], expected, 1e-6);
                let opacity = -(-form.depth / eye.z.abs()).exp_m1();
                assert_close(
                    unshadowed.radiance[channel],
                    form.scattered * opacity,
                    1e-12,
                );
            }
        }
    }
}

/// Unshadowed light of 1 from everywhere is scattered as `albedo (1 - T)`, whatever the phase function.
#[test]
fn single_scattering_of_a_constant_environment() {
    let (volume, curve) = (slab(), uniform([0.9; 3], 0.15, [0.0; 3]));
    let medium = Medium::new(&volume, &curve, &Lighting::default()).expect("finite");
    let ray = through(DVec3::new(0.3, 0.2, 1.0));
    for phase in [PhaseFunction::Isotropic, PhaseFunction::Rayleigh, FORWARD] {
        let illumination = Illumination {
            lights: &[],
            surroundings: Some(&|_| DVec3::ONE),
            phase: &phase,
        };
        let light = scattered_once(&medium, &illumination, ray, 1.0, false);
        let expected = 0.9 * slab_opacity(0.15, 1.0, THICKNESS / ray.direction.z);
        assert_close(light.radiance.x, expected, 1e-12);
    }
}

/// Within four standard errors, which must be small ones.
fn assert_estimates((mean, variance): (DVec3, DVec3), expected: DVec3, error: f64) {
    for channel in 0..3 {
        let sigma = variance[channel].sqrt();
        assert!(sigma <= error * expected[channel], "{sigma} of {expected}");
        let z = (mean[channel] - expected[channel]) / sigma.max(1e-12);
        assert!(z.abs() < 4.0, "{mean}, expected {expected}, Z {z}");
    }
}

/// Particles that absorb nothing, in light of 1 from everywhere, cannot be seen: what is scattered is `1 - T`.
#[test]
fn white_furnace() {
    let volume = volume_of([9; 3], DAffine3::IDENTITY, |ix| f64::from(ix[0] % 3));
    let mut curve = uniform([1.0; 3], 0.3, [0.0; 3]);
    curve.points.push(CurvePoint {
        value: 2.0,
        optical: Optical {
            opacity: 0.8,
            ..curve.points[0].optical
        },
    });
    let medium = Medium::new(&volume, &curve, &chromatic()).expect("finite");
    let tracer = PathTracer {
        medium: &medium,
        illumination: Illumination {
            lights: &[],
            surroundings: Some(&|_| DVec3::ONE),
            phase: &FORWARD,
        },
        max_scatterings: u32::MAX,
        start: PathStart::Middle,
    };
    let ray = Ray {
        origin: DVec3::new(-5.0, 2.5, 3.3),
        direction: DVec3::new(1.0, 0.15, 0.2).normalize(),
    };
    let transmittance = absorbed(&medium, ray, 0.01).transmittance;
    let (mean, variance) = tracer.ray(ray, 20_000, 1);
    let expected = DVec3::ONE - transmittance;
    // The third channel's extinction is 0.
    assert_eq!((mean.z, expected.z), (0.0, 0.0));
    let grey = DVec3::new(mean.x, mean.y, mean.y);
    let variance = DVec3::new(variance.x, variance.y, variance.y);
    let expected = DVec3::new(expected.x, expected.y, expected.y);
    assert_estimates((grey, variance), expected, 0.02);
}

/// With one scattering at most, paths estimate the quadrature: lights, surroundings, glow and chromatic extinction.
#[test]
fn paths_of_one_scattering_estimate_the_quadrature() {
    let volume = volume_of([7, 8, 9], DAffine3::IDENTITY, |[i, j, k]| {
        f64::from((i * 5 + j * 3 + k * 7) % 4)
    });
    let mut curve = uniform([0.4, 0.6, 0.8], 0.0, [0.02, 0.01, 0.0]);
    curve.points.push(CurvePoint {
        value: 3.0,
        optical: Optical {
            color: [0.9, 0.7, 0.5],
            opacity: 0.4,
            emission: [0.1; 3],
            source: [0.0; 3],
        },
    });
    let lighting = Lighting {
        extinction: [1.0, 0.6, 0.3],
        ..Lighting::default()
    };
    let medium = Medium::new(&volume, &curve, &lighting).expect("finite");
    let lights = [
        Light::Point {
            position: [12.0, -3.0, 4.0],
            intensity: [90.0, 80.0, 70.0],
        },
        Light::Spot {
            position: [3.0, 3.0, 20.0],
            direction: [0.0, 0.05, -1.0],
            intensity: [300.0; 3],
            beam_angle: Some(5.0),
            cutoff_angle: 15.0,
        },
    ];
    let illumination = Illumination {
        lights: &lights,
        surroundings: Some(&|towards| DVec3::new(0.5, 0.6, 0.7) * (1.5 + towards.z)),
        phase: &PhaseFunction::Rayleigh,
    };
    let ray = Ray {
        origin: DVec3::new(-4.0, 2.0, 3.0),
        direction: DVec3::new(1.0, 0.2, 0.15).normalize(),
    };
    let expected = scattered_once(&medium, &illumination, ray, 0.05, true);
    let tracer = PathTracer {
        medium: &medium,
        illumination,
        max_scatterings: 1,
        start: PathStart::Middle,
    };
    let estimate = tracer.ray(ray, 40_000, 2);
    assert_estimates(estimate, expected.radiance, 0.01);
}

#[test]
fn opaque_media_are_refused() {
    let (volume, curve) = (slab(), uniform([1.0; 3], 1.0, [0.0; 3]));
    let refused = Medium::new(&volume, &curve, &Lighting::default()).err();
    let message = refused.expect("an infinite extinction").to_string();
    assert!(
        message.starts_with("transfer_function: is opaque"),
        "{message}"
    );
}
