//! Phase functions: normalisation, moments and quantiles by quadrature over the sphere.

use std::f64::consts::PI;

use umbravox::scene::PhaseFunction;

fn all() -> Vec<PhaseFunction> {
    let mut all = vec![
        PhaseFunction::Isotropic,
        PhaseFunction::Rayleigh,
        PhaseFunction::LambertSphere,
        PhaseFunction::DoubleHenyeyGreenstein {
            g1: 0.8,
            g2: -0.45,
            weight: 0.7,
        },
        PhaseFunction::Table {
            values: vec![0.5, 0.0, 0.2, 1.0, 4.0],
        },
    ];
    for g in [-0.9, -0.3, 0.0, 1e-9, 0.5, 0.99] {
        all.push(PhaseFunction::HenyeyGreenstein { g });
        all.push(PhaseFunction::Schlick { k: g });
    }
    all
}

/// `integral f(cos) 2 pi d cos` by Simpson's rule over angles.
fn over_sphere(f: impl Fn(f64) -> f64) -> f64 {
    const PANELS: u32 = 200_000;
    let step = PI / f64::from(PANELS);
    let at = |half_steps: u32| {
        let angle = 0.5 * f64::from(half_steps) * step;
        f(angle.cos()) * angle.sin()
    };
    let sum: f64 = (0..PANELS)
        .map(|i| (at(2 * i) + 4.0 * at(2 * i + 1) + at(2 * i + 2)) / 6.0)
        .sum();
    2.0 * PI * step * sum
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: impl std::fmt::Debug) {
    let error = (found - expected).abs();
    assert!(
        error <= tolerance,
        "{what:?}: {found}, expected {expected}, {error:e} apart"
    );
}

#[test]
fn every_function_integrates_to_one() {
    for phase in all() {
        let integral = over_sphere(|cos| phase.evaluate(cos));
        assert_near(integral, 1.0, 1e-7, &phase);
        assert_near(phase.moment(0), 1.0, 1e-9, &phase);
    }
}

#[test]
fn moments_are_integrals_of_legendre_polynomials() {
    let polynomials: [fn(f64) -> f64; 4] = [
        |_| 1.0,
        |x| x,
        |x| 0.5 * (3.0 * x * x - 1.0),
        |x| 0.5 * x * (5.0 * x * x - 3.0),
    ];
    for phase in all() {
        for (l, polynomial) in (0..).zip(polynomials) {
            let integral = over_sphere(|cos| phase.evaluate(cos) * polynomial(cos));
            assert_near(phase.moment(l), integral, 1e-7, (l, &phase));
        }
    }
}

/// The sum of `(2l + 1) / (4 pi) chi_l P_l(cos)` is the function itself; at the poles `P_l = (+-1)^l`.
#[test]
fn moments_sum_up_to_the_function() {
    for phase in [
        PhaseFunction::Rayleigh,
        PhaseFunction::HenyeyGreenstein { g: 0.6 },
        PhaseFunction::Schlick { k: -0.5 },
    ] {
        for (cos, sign) in [(1.0, 1.0), (-1.0, -1.0_f64)] {
            let sum: f64 = (0..100_u32)
                .map(|l| f64::from(2 * l + 1) * phase.moment(l) * sign.powi(l as i32))
                .sum();
            assert_near(sum / (4.0 * PI), phase.evaluate(cos), 1e-8, (cos, &phase));
        }
    }
}

#[test]
fn the_cumulative_share_is_the_integral_so_far() {
    for phase in all() {
        assert_near(phase.cumulative(-1.0), 0.0, 1e-14, &phase);
        assert_near(phase.cumulative(1.0), 1.0, 1e-14, &phase);
        for cos in [-0.97, -0.6, 0.1, 0.25, 0.9] {
            let rise = phase.cumulative(cos + 1e-5) - phase.cumulative(cos - 1e-5);
            let density = 2.0 * PI * phase.evaluate(cos);
            assert_near(rise / 2e-5, density, 1e-6 * (1.0 + density), (cos, &phase));
        }
    }
}

#[test]
fn quantiles_invert_the_cumulative_share() {
    for phase in all() {
        for share in [0.001, 0.1, 0.37, 0.5, 0.75, 0.999] {
            let cos = phase.quantile(share);
            assert_near(phase.cumulative(cos), share, 1e-12, (cos, &phase));
        }
    }
}

#[test]
fn equally_likely_cosines_run_from_back_to_front() {
    for phase in all() {
        let places = phase.equal_probability_cosines(64);
        assert_eq!(places.len(), 65);
        assert_eq!((places[0], places[64]), (-1.0, 1.0), "{phase:?}");
        assert!(places.windows(2).all(|p| p[0] < p[1]), "{phase:?}");
        let shares = places
            .windows(2)
            .map(|p| phase.cumulative(p[1]) - phase.cumulative(p[0]));
        for share in shares {
            // Rounding of a cosine near 1, times a density that reaches 1e4.
            assert_near(share, 1.0 / 64.0, 1e-11, &phase);
        }
    }
}

#[test]
fn henyey_greenstein_is_forward_for_positive_g() {
    let phase = PhaseFunction::HenyeyGreenstein { g: 0.5 };
    // (1 - g^2) / (1 -+ g)^3 / 4 pi.
    assert_near(phase.evaluate(1.0), 6.0 / (4.0 * PI), 1e-12, "forward");
    assert_near(
        phase.evaluate(-1.0),
        0.75 / 3.375 / (4.0 * PI),
        1e-12,
        "back",
    );
}

/// A planet: full when the light is behind the eye, dark when it is in front. Blinn's table has 8/3 and 0, and
/// 8/(3 pi) at a right angle.
#[test]
fn a_lambert_sphere_is_bright_towards_the_light() {
    let phase = PhaseFunction::LambertSphere;
    let relative = |cos| 4.0 * PI * phase.evaluate(cos);
    assert_near(relative(-1.0), 8.0 / 3.0, 1e-12, "full");
    assert_near(relative(0.0), 8.0 / (3.0 * PI), 1e-12, "half");
    assert_near(relative(1.0), 0.0, 1e-12, "new");
    assert_near(phase.moment(1), -4.0 / 9.0, 1e-10, "mean cosine");
}

/// How far Schlick's stand-in is from what it stands in for, largest over all angles, as a share of the peak.
#[test]
fn schlick_comes_close_to_henyey_greenstein() {
    for (g, apart) in [(0.0, 1e-12), (0.3, 0.05), (0.6, 0.12), (-0.6, 0.12)] {
        let k = 1.55 * g - 0.55 * g * g * g;
        let stand_in = PhaseFunction::Schlick { k };
        let original = PhaseFunction::HenyeyGreenstein { g };
        let peak = original.evaluate(f64::signum(g));
        for i in 0..=200 {
            let cos = f64::from(i) / 100.0 - 1.0;
            let error = (stand_in.evaluate(cos) - original.evaluate(cos)).abs();
            assert!(error <= apart * peak, "g {g}, cos {cos}: {}", error / peak);
        }
    }
}

#[test]
fn a_table_is_linear_between_its_values_whatever_their_scale() {
    let [small, large] = [1.0, 1000.0].map(|scale: f64| PhaseFunction::Table {
        values: [0.0, 1.0, 3.0].map(|v| v * scale).to_vec(),
    });
    // Means of the two cells are 0.5 and 2, so the integral over cosines is 2.5.
    for (cos, value) in [(-1.0, 0.0), (-0.5, 0.5), (0.0, 1.0), (0.5, 2.0), (1.0, 3.0)] {
        assert_near(small.evaluate(cos), value / (5.0 * PI), 1e-14, cos);
        assert_near(large.evaluate(cos), value / (5.0 * PI), 1e-14, cos);
    }
    assert_near(small.cumulative(0.0), 0.2, 1e-14, "share of the back");
}

#[test]
fn wrong_parameters_are_named() {
    let refused = [
        (
            PhaseFunction::HenyeyGreenstein { g: 1.0 },
            "lighting.phase.g:",
        ),
        (PhaseFunction::Schlick { k: f64::NAN }, "lighting.phase.k:"),
        (
            PhaseFunction::DoubleHenyeyGreenstein {
                g1: 0.5,
                g2: -0.5,
                weight: 1.5,
            },
            "lighting.phase.weight:",
        ),
        (
            PhaseFunction::Table { values: vec![1.0] },
            "lighting.phase.values:",
        ),
        (
            PhaseFunction::Table {
                values: vec![1.0, -1.0],
            },
            "lighting.phase.values.1:",
        ),
        (
            PhaseFunction::Table {
                values: vec![0.0; 3],
            },
            "lighting.phase.values:",
        ),
    ];
    for (phase, place) in refused {
        let message = phase.validate().expect_err("out of range").to_string();
        assert!(message.starts_with(place), "{phase:?}: {message}");
    }
    for phase in all() {
        phase.validate().expect("within range");
    }
}

#[test]
fn json_names_the_type() {
    let parse = |json: &str| serde_json::from_str::<PhaseFunction>(json);
    let phase = parse(r#"{"type": "henyey_greenstein", "g": 0.85}"#).expect("valid");
    assert_eq!(phase, PhaseFunction::HenyeyGreenstein { g: 0.85 });
    let phase = parse(r#"{"type": "lambert_sphere"}"#).expect("valid");
    assert_eq!(phase, PhaseFunction::LambertSphere);
    parse(r#"{"type": "henyey_greenstein", "k": 0.85}"#).expect_err("no such key");
}
