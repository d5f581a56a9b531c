//! Rays through media whose picture is known.

use glam::{DAffine3, DVec3};
use umbravox::reference::analytic::{emission_absorption, slab_opacity};
use umbravox::reference::{Light, LightGrid, Segment, Setup, Span, march};
use umbravox::scene::{Classification, Lighting, March, Shading};

use crate::fixtures::{ORTHOGRAPHIC, Tracer, assert_close, curve, homogeneous, medium, volume_of};

const STEPS: [f64; 8] = [0.05, 0.1, 0.3, 0.5, 0.7, 1.0, 1.7, 2.0];
const SPACINGS: [f64; 5] = [1e-3, 0.04, 1.0, 70.0, 1e3];

/// Through two opposite faces at an angle: the length inside is the thickness over the cosine.
#[test]
fn homogeneous_slab() {
    let color = [0.9, 0.5, 0.1];
    for spacing in SPACINGS {
        for step in STEPS {
            let volume = homogeneous(9, spacing);
            let tracer = Tracer::new(volume, medium(1.3 * spacing, 0.2, color), step);
            let direction = DVec3::new(1.0, 0.2, -0.3);
            let origin = DVec3::new(-5.0, 3.0, 6.0) * spacing;
            let pixel = tracer.ray(origin, direction);
            let length = 8.0 * spacing * direction.length();
            let opacity = slab_opacity(0.2, 1.3 * spacing, length);
            assert_close(pixel.rgba[3], opacity, 1e-12);
            for (channel, c) in color.into_iter().enumerate() {
                assert_close(pixel.rgba[channel], c * opacity, 1e-12);
            }
            let segments = (length / (step * spacing)).ceil();
            assert_eq!(f64::from(pixel.samples), segments);
        }
    }
}

/// The smallest spacing is what steps are given in; extinction is per mm in every direction.
#[test]
fn anisotropic_slab() {
    let spacing = DVec3::new(0.5, 2.0, 3.0);
    for (axis, thickness) in [(DVec3::X, 2.0), (DVec3::Y, 8.0), (DVec3::Z, 12.0)] {
        let volume = volume_of([5; 3], DAffine3::from_scale(spacing), |_| 0.0);
        let tracer = Tracer::new(volume, medium(4.0, 0.3, [1.0; 3]), 1.0);
        let pixel = tracer.ray(DVec3::splat(0.9) - 10.0 * axis, axis);
        assert_close(pixel.rgba[3], slab_opacity(0.3, 4.0, thickness), 1e-12);
        assert_eq!(f64::from(pixel.samples), thickness / 0.5);
    }
}

#[test]
fn jitter_leaves_a_homogeneous_medium_alone() {
    let tracer = Tracer::new(homogeneous(7, 1.0), medium(2.0, 0.4, [1.0; 3]), 0.8);
    let [origin, direction] = [DVec3::new(-3.0, 1.0, 2.0), DVec3::new(1.0, 0.3, 0.2)];
    let plain = tracer.ray(origin, direction);
    for shift in [0.01, 0.25, 0.5, 0.93, 0.9999] {
        let pixel = tracer.jittered(origin, direction, shift);
        assert_close(pixel.rgba[3], plain.rgba[3], 1e-13);
    }
    // 6.38 mm of 0.8: 8 segments, or one more when the first is short enough.
    assert_eq!(plain.samples, 8);
    assert_eq!(tracer.jittered(origin, direction, 0.01).samples, 8);
    assert_eq!(tracer.jittered(origin, direction, 0.25).samples, 9);
}

#[test]
fn segments_end_where_the_span_does() {
    let cut = |enter: f64, length: f64, step, shift| -> Vec<[f64; 2]> {
        let exit = enter + length;
        Span { enter, exit }
            .segments(step, shift)
            .map(|s| [s.start, s.end])
            .collect()
    };
    assert_eq!(
        cut(4.0, 2.5, 1.0, 0.0),
        [[4.0, 5.0], [5.0, 6.0], [6.0, 6.5]]
    );
    assert_eq!(
        cut(0.0, 2.5, 1.0, 0.25),
        [[0.0, 0.75], [0.75, 1.75], [1.75, 2.5]]
    );
    assert_eq!(
        cut(0.0, 1.0, 0.5, 0.5),
        [[0.0, 0.25], [0.25, 0.75], [0.75, 1.0]]
    );
    assert_eq!(cut(1.0, 3.0, 4.0, 0.0), [[1.0, 4.0]]);
    assert_eq!(cut(1.0, 0.0, 1.0, 0.0), [[0.0; 2]; 0]);
    // Remainders of rounding size belong to the last whole step; larger ones stand for themselves.
    let [last_end, longer] = [3.0 + 0.9e-4, 3.0 + 1.1e-4];
    assert_eq!(
        cut(0.0, last_end, 1.0, 0.0),
        [[0.0, 1.0], [1.0, 2.0], [2.0, last_end]]
    );
    assert_eq!(cut(0.0, longer, 1.0, 0.0).len(), 4);
    assert_eq!(cut(0.0, 0.9e-4, 1.0, 0.0), [[0.0; 2]; 0]);
    let segment = Segment {
        start: 2.0,
        end: 2.5,
    };
    assert_eq!((segment.middle(), segment.length()), (2.25, 0.5));
}

#[test]
fn emission_and_absorption_over_a_background() {
    let (color, emission, background) = ([0.3, 0.6, 0.2], [0.0, 1.5, 0.25], [0.7, 0.1, 1.0]);
    for step in STEPS {
        let curve = curve(1.0, &[(0.0, color, 0.15, emission)]);
        let tracer = Tracer::new(homogeneous(11, 1.0), curve, step);
        let pixel = tracer.ray(DVec3::new(4.2, 5.1, 30.0), DVec3::NEG_Z);
        let transparency = 0.85f64.powi(10);
        for channel in 0..3 {
            let over = pixel.rgba[channel] + (1.0 - pixel.rgba[3]) * background[channel];
            let source = color[channel] + emission[channel];
            let expected = emission_absorption(source, background[channel], transparency);
            assert_close(over, expected, 1e-13);
        }
    }
}

#[test]
fn a_ray_from_inside_starts_at_the_eye() {
    let tracer = Tracer::new(homogeneous(11, 2.0), medium(3.0, 0.25, [1.0; 3]), 0.5);
    let pixel = tracer.ray(DVec3::new(7.3, 4.0, 5.0), DVec3::X);
    assert_close(pixel.rgba[3], slab_opacity(0.25, 3.0, 20.0 - 7.3), 1e-13);
    assert_eq!(pixel.samples, 13);
    // Behind the eye there is nothing.
    assert_eq!(tracer.ray(DVec3::new(20.5, 4.0, 5.0), DVec3::X).samples, 0);
}

#[test]
fn rays_that_miss_or_graze_take_no_samples() {
    let tracer = Tracer::new(homogeneous(5, 1.0), medium(1.0, 0.5, [1.0; 3]), 0.5);
    for (origin, direction) in [
        (DVec3::new(-3.0, 4.5, 2.0), DVec3::X),
        (DVec3::new(-3.0, 2.0, 2.0), DVec3::NEG_X),
        // Through the edge x = 0, y = 4 in one point.
        (DVec3::new(-2.0, 2.0, 2.0), DVec3::new(1.0, 1.0, 0.0)),
    ] {
        let pixel = tracer.ray(origin, direction);
        assert_eq!((pixel.rgba, pixel.samples), ([0.0; 4], 0));
        assert!(pixel.depth.is_infinite());
    }
    // Along a face is inside.
    let along = tracer.ray(DVec3::new(-3.0, 4.0, 2.0), DVec3::X);
    assert_close(along.rgba[3], 1.0 - 0.5f64.powi(4), 1e-13);
}

/// `1 - 0.5^n` passes 0.95 at n = 5; what follows is not composited.
#[test]
fn early_termination_keeps_the_sample_that_reaches_it() {
    let mut tracer = Tracer::new(homogeneous(21, 1.0), medium(1.0, 0.5, [1.0; 3]), 1.0);
    tracer.march.early_termination = 0.95;
    let pixel = tracer.ray(DVec3::new(-1.0, 2.0, 2.0), DVec3::X);
    assert_eq!(pixel.samples, 5);
    assert_close(pixel.rgba[3], 1.0 - 0.5f64.powi(5), 1e-15);
    tracer.march.early_termination = 1.0 - 0.5f64.powi(7);
    assert_eq!(tracer.ray(DVec3::new(-1.0, 2.0, 2.0), DVec3::X).samples, 7);
}

/// After three steps of 0.02 the opacity is 0.0588: the third segment is the first past 0.05.
#[test]
fn depth_is_the_middle_of_the_segment_that_reaches_the_threshold() {
    let mut tracer = Tracer::new(homogeneous(9, 3.0), medium(3.0, 0.02, [1.0; 3]), 1.0);
    let origin = DVec3::new(5.0, -10.0, 6.0);
    assert_close(tracer.ray(origin, DVec3::Y).depth, 10.0 + 2.5 * 3.0, 1e-12);
    tracer.depth_threshold = 0.01;
    assert_close(tracer.ray(origin, DVec3::Y).depth, 10.0 + 0.5 * 3.0, 1e-12);
    tracer.depth_threshold = 0.9;
    assert!(tracer.ray(origin, DVec3::Y).depth.is_infinite());
}

#[test]
fn half_steps_compose_to_whole_ones() {
    let [origin, direction] = [DVec3::new(-2.0, 1.5, 2.5), DVec3::new(1.0, 0.1, 0.2)];
    let pixel = |step| {
        Tracer::new(
            homogeneous(8, 1.0),
            medium(0.7, 0.35, [0.2, 0.4, 0.8]),
            step,
        )
        .ray(origin, direction)
        .rgba
    };
    let (whole, half) = (pixel(1.0), pixel(0.5));
    for channel in 0..4 {
        assert_close(half[channel], whole[channel], 1e-14);
    }
}

/// Field and colour vary linearly along x and z, and the first sample is opaque: each pixel shows the
/// value where its ray's first segment has its middle.
#[test]
fn pixels_are_where_the_view_says() {
    let volume = volume_of([8, 5, 8], DAffine3::IDENTITY, |[i, _, k]| {
        f64::from(i + 10 * k)
    });
    let curve = curve(
        1.0,
        &[
            (0.0, [0.0; 3], 1.0, [0.0; 3]),
            (100.0, [1.0; 3], 1.0, [0.0; 3]),
        ],
    );
    let mut view = ORTHOGRAPHIC;
    view.eye = DVec3::new(3.5, -2.0, 3.5);
    let settings = March {
        classification: Some(Classification::Post),
        ..Default::default()
    };
    let setup = Setup {
        volume: &volume,
        view: &view,
        size: [4, 2],
        curve: &curve,
        march: &settings,
        surfaces: &[],
        lighting: &Lighting::default(),
        light: None,
        data_color: None,
        labels: None,
        depth_threshold: 0.05,
        jitter: Some(&|[x, _]| if x == 3 { 0.5 } else { 0.0 }),
        end: None,
    };
    let picture = march(&setup);
    assert_eq!(picture.size, [4, 2]);
    for (y, z) in [(0, 4.0), (1, 3.0)] {
        for (x, wx) in [(0, 2.0), (1, 3.0), (2, 4.0), (3, 5.0)] {
            let at = x + 4 * y;
            assert_close(picture.rgba[at][0], (wx + 10.0 * z) / 100.0, 1e-12);
            assert_eq!(picture.samples[at], 1);
            // Half a step of 0.5 after the face; half of that where the first segment is halved.
            let depth = if x == 3 { 2.125 } else { 2.25 };
            assert_close(picture.depth[at], depth, 1e-12);
        }
    }
}

#[test]
fn ambient_light_falls_on_color_and_not_on_emission() {
    let (color, emission) = ([0.5, 0.4, 0.3], [0.1, 0.0, 0.2]);
    let curve = curve(1.0, &[(0.0, color, 0.2, emission)]);
    let mut tracer = Tracer::new(homogeneous(5, 1.0), curve, 0.5);
    let rgb = [0.25, 0.5, 2.0];
    tracer.light = Some(LightGrid::from_fn([5; 3], |_| Light { rgb, grey: 9.0 }));
    let pixel = tracer.ray(DVec3::new(-1.0, 2.0, 2.0), DVec3::X);
    let opacity = slab_opacity(0.2, 1.0, 4.0);
    for channel in 0..3 {
        let source = color[channel] * rgb[channel] + emission[channel];
        assert_close(pixel.rgba[channel], source * opacity, 1e-14);
    }
}

/// What emits and is not to be seen still lights its surroundings, through the light volume.
#[test]
fn emission_can_be_left_out_of_the_picture() {
    let (color, emission) = ([0.5, 0.4, 0.3], [0.1, 0.0, 0.2]);
    let curve = curve(1.0, &[(0.0, color, 0.2, emission)]);
    let mut tracer = Tracer::new(homogeneous(5, 1.0), curve, 0.5);
    let rgb = [1.5, 1.25, 2.0];
    tracer.light = Some(LightGrid::from_fn([5; 3], |_| Light { rgb, grey: 1.0 }));
    tracer.lighting.emission = false;
    let pixel = tracer.ray(DVec3::new(-1.0, 2.0, 2.0), DVec3::X);
    let opacity = slab_opacity(0.2, 1.0, 4.0);
    for channel in 0..3 {
        assert_close(
            pixel.rgba[channel],
            color[channel] * rgb[channel] * opacity,
            1e-14,
        );
    }
}

/// One opaque sample in the middle of a segment shows the light at that place.
#[test]
fn ambient_light_is_trilinear_between_voxels() {
    let mut tracer = Tracer::new(homogeneous(5, 1.0), medium(1.0, 1.0, [1.0; 3]), 1.0);
    tracer.light = Some(LightGrid::from_fn([5; 3], |[i, j, k]| Light {
        rgb: [f64::from(i), f64::from(j), f64::from(j * k)],
        grey: 0.0,
    }));
    let pixel = tracer.ray(DVec3::new(-1.0, 2.25, 3.5), DVec3::X);
    for (channel, expected) in [0.5, 2.25, 2.25 * 3.5, 1.0].into_iter().enumerate() {
        assert_close(pixel.rgba[channel], expected, 1e-14);
    }
}

#[test]
fn diffuse_shading_follows_the_angle_to_the_light() {
    let placement = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
    let gradient = DVec3::new(1.0, 2.0, -2.0);
    let volume = volume_of([6; 3], placement, |v| {
        let p = placement.transform_point3(DVec3::from_array(v.map(f64::from)));
        p.dot(gradient)
    });
    let mut tracer = Tracer::new(volume, medium(1.0, 0.3, [1.0; 3]), 0.5);
    let origin = DVec3::new(-1.0, 5.0, 2.5);
    let opacity = slab_opacity(0.3, 1.0, 5.0);
    tracer.lighting = Lighting {
        shading: Shading::Diffuse,
        ambient: 0.2,
        diffuse: 0.9,
        ..Default::default()
    };
    // Headlight: against +x, and the unit gradient is (1, 2, -2)/3. The side of the surface does not matter.
    let headlight = tracer.ray(origin, DVec3::X).rgba[0];
    assert_close(headlight, (0.2 + 0.9 / 3.0) * opacity, 1e-12);
    for (direction, cosine) in [
        ([0.0, 0.0, -7.0], 2.0 / 3.0),
        ([0.0, 0.0, 7.0], 2.0 / 3.0),
        ([3.0, 4.0, 0.0], 11.0 / 15.0),
        ([0.0, 1.0, 1.0], 0.0),
    ] {
        tracer.lighting.direction = Some(direction);
        let lit = tracer.ray(origin, DVec3::X).rgba[0];
        assert_close(lit, (0.2 + 0.9 * cosine) * opacity, 1e-12);
    }
}

#[test]
fn where_the_gradient_is_zero_there_is_no_surface() {
    let mut tracer = Tracer::new(homogeneous(5, 1.0), medium(1.0, 0.3, [1.0; 3]), 0.5);
    tracer.lighting.shading = Shading::Diffuse;
    let pixel = tracer.ray(DVec3::new(-1.0, 2.0, 2.0), DVec3::X);
    assert_close(pixel.rgba[0], slab_opacity(0.3, 1.0, 4.0), 1e-14);
}
