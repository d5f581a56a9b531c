//! Levels of detail agree where they must: every level reproduces linear fields, so a ramp looks the same at any mixture of
//! levels, without a step where bricks or levels meet.

use glam::DVec3;
use umbravox::picture::Picture;
use umbravox::scene::{Camera, ControlPoint, Shading};
use umbravox::volume::{Rescale, VoxelType};

use crate::fields::{placed, ramp, sampled};
use crate::random::Random;
use crate::sessions::{Subject, assert_valid, bounds, device, point, shown};

/// Values are rounded to 32 bits before they are filtered and after; the transfer functions below rise by about 5 over the
/// range of the values, and rays pass some hundred samples.
const ROUNDING: f64 = 3e-5;
/// Value of a spike; ramps go from 0 to 1.
const SPIKE: f64 = 2.0;
/// Edge of a block, voxels.
const BLOCK: f64 = 16.0;

/// Bands of one colour each with clear space between them, and spikes.
fn bands(random: &mut Random) -> Vec<ControlPoint> {
    let mut points = vec![point(0.0, [0.0; 3], 0.0)];
    for band in 0..4 {
        let middle = (f64::from(band) + random.between(0.4, 0.6)) / 4.0;
        let color = [random.unit(), random.unit(), random.unit()];
        points.push(point(middle - 0.06, color, 0.0));
        points.push(point(middle, color, 0.3));
        points.push(point(middle + 0.06, color, 0.0));
    }
    points.push(point(1.2, [0.0; 3], 0.0));
    points.push(point(SPIKE, [1.0; 3], 0.5));
    points
}

/// A ramp in a random direction. With `spikes`, about every third block has one in its middle: coarse levels would lose it, so
/// such blocks are kept at the finest, beside coarse ones.
fn subject(random: &mut Random, spikes: bool) -> Subject {
    let along = random.direction();
    let size = [(); 3].map(|()| random.pick(&[33u32, 40, 49, 58]));
    let spacing = [(); 3].map(|()| random.between(0.7, 1.4));
    let placement = placed(spacing, [0.0, 0.0, 1.0], 30.0, [0.0; 3]);
    let plain = Rescale::default();
    let last = DVec3::from_array(size.map(|n| f64::from(n - 1)));
    let spiked: Vec<bool> = (0..64).map(|_| spikes && random.chance(0.35)).collect();
    let field = |p: DVec3| {
        let voxel = (p * last).round();
        let block = (voxel / BLOCK).floor();
        let middle = (voxel - block * BLOCK - 0.5 * BLOCK).abs().max_element() < 1.5;
        let number = block.dot(DVec3::new(1.0, 4.0, 16.0)) as usize;
        if middle && spiked[number] {
            SPIKE
        } else {
            ramp(p, along)
        }
    };
    let volume = sampled(VoxelType::F32, size, placement, plain, [0.0, 1.0], field);
    let (middle, radius) = bounds(&volume);
    let eye = middle + random.direction() * (2.5 * radius);
    let camera = Camera::Perspective {
        eye: eye.to_array(),
        target: middle.to_array(),
        up: (eye - middle).any_orthonormal_vector().to_array(),
        fov_y: 45.0,
    };
    let mut subject = Subject::new(volume, camera, [40, 34], 1.0, bands(random));
    if random.chance(0.5) {
        subject.scene.lighting.shading = Shading::Diffuse;
        subject.scene.lighting.direction = Some(DVec3::ONE.to_array());
        // Stored gradients, which mixed levels do not have, are halves.
        subject.scene.lighting.stored_gradients = false;
    }
    subject
}

fn difference(a: &Picture, b: &Picture) -> f64 {
    let channels = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    channels
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn a_ramp_looks_the_same_at_mixed_levels() {
    let device = device(|_| {});
    let mut random = Random::new(77);
    let mut worst = 0f64;
    // Blocks at each level, over all pictures, and pictures of several levels.
    let (mut by_level, mut mixed) = ([0; 5], 0);
    for case in 0..12 {
        let spikes = case % 2 == 0;
        let subject = subject(&mut random, spikes);
        let mut session = subject.session(&device);
        let expected = session.frame().unwrap();
        assert!(shown(&expected) > 20.0, "case {case} shows something");
        // Where there are spikes, enough for them at the finest level; elsewhere less and less.
        let reductions: &[f64] = if spikes {
            &[1.2, 1.5]
        } else {
            &[40.0, 120.0, 400.0]
        };
        for &data_reduction in reductions {
            let mut settings = session.settings().clone();
            settings.storage.data_reduction = data_reduction;
            session.set_settings(settings).unwrap();
            let picture = session.frame().unwrap();
            let blocks = session.stats().unwrap().blocks;
            let difference = difference(&picture, &expected);
            println!(
                "case {case}, reduction {data_reduction}: {difference:.1e}, blocks by level {:?}",
                blocks.by_level
            );
            assert_eq!(blocks.dropped, 0, "case {case}");
            mixed += usize::from(blocks.by_level.iter().filter(|&&n| n > 0).count() > 1);
            for (sum, n) in by_level.iter_mut().zip(blocks.by_level) {
                *sum += n;
            }
            worst = worst.max(difference);
        }
    }
    println!("ramps at mixed levels {by_level:?}: {worst:.1e}");
    assert_valid(&device);
    assert!(worst <= ROUNDING, "{worst:e}");
    let [level_0, level_1, level_2, _, finest] = by_level;
    assert!(
        mixed > 10 && [level_0, level_1, level_2, finest].iter().all(|&n| n > 10),
        "levels are mixed: {by_level:?}"
    );
}
