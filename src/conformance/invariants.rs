//! What changes no bit of a picture, and what no picture does.

use super::check::{Check, Worst};
use super::synthetic::{Subject, difference, placed, point, sampled};
use crate::error::Result;
use crate::headless::{Headless, Options};
use crate::picture::Picture;
use crate::scene::{AmbientOcclusion, Classification, Isosurface, RayProjection, Scene, Shading};

const SIZE: [u32; 2] = [40, 34];
/// Edges of tiles, pixels; the last is larger than the picture.
const TILES: [u32; 4] = [8, 16, 24, 64];
/// Opacity at which rays end, of the check of early termination.
const TERMINATION: f64 = 0.99;
/// Of sums of a hundred or so samples.
const ROUNDING: f64 = 1e-6;

pub(super) fn checks(device: &Headless, options: &Options) -> Result<Vec<Check>> {
    let mut checks = bits(device, options)?;
    checks.push(early_termination(device)?);
    checks.push(premultiplied(device)?);
    Ok(checks)
}

/// Waves, clear in the lower half of their values.
fn waves() -> Result<Subject> {
    let placement = placed([1.0, 1.2, 0.9], [1.0, 1.0, 2.0], 30.0, [0.0; 3]);
    let volume = sampled([40, 36, 44], placement, |ix| {
        let p = 0.3 * ix;
        0.5 + 0.25 * (p.x.sin() + (p.y + 1.0).sin() * p.z.cos())
    })?;
    let points = vec![
        point(0.0, [0.0; 3], 0.0),
        point(0.55, [0.9, 0.5, 0.2], 0.0),
        point(0.7, [0.9, 0.5, 0.2], 0.35),
        point(1.0, [0.2, 0.6, 1.0], 0.8),
    ];
    Ok(Subject::new(volume, SIZE, 1.0, points))
}

fn light(scene: &mut Scene) {
    scene.lighting.shading = Shading::Diffuse;
    scene.ambient_occlusion = Some(AmbientOcclusion {
        rays: 4,
        radius: 5.0,
        ..Default::default()
    });
}

/// Every way of rendering.
fn scenes() -> Result<Vec<Subject>> {
    let waves = waves()?;
    Ok(vec![
        waves.with(light),
        waves.with(|scene| {
            light(scene);
            scene.storage.data_reduction = 4.0;
            scene.march.classification = Some(Classification::Post);
        }),
        waves.with(|scene| scene.march.projection = RayProjection::Maximum),
        waves.with(|scene| {
            scene.march.projection = RayProjection::Isosurface;
            scene.march.isosurfaces = [0.6, 0.75]
                .map(|value| Isosurface {
                    value,
                    color: None,
                    opacity: 0.5,
                })
                .to_vec();
        }),
    ])
}

/// Pixels that differ in any bit of colour, opacity or depths.
fn differing(a: &Picture, b: &Picture) -> f64 {
    let bits = |p: &Picture, at: usize| {
        let [r, g, b, a] = p.rgba[at];
        let all = [r, g, b, a, p.depth[at], p.median_depth[at], p.measure[at]];
        all.map(f32::to_bits)
    };
    if a.size != b.size {
        return f64::INFINITY;
    }
    (0..a.rgba.len())
        .filter(|&at| bits(a, at) != bits(b, at))
        .count() as f64
}

fn bits(device: &Headless, options: &Options) -> Result<Vec<Check>> {
    let [mut skipping, mut repeat, mut tiles] = [Worst::default(); 3];
    let tiled = TILES
        .into_iter()
        .map(|tile| {
            let options = Options {
                tile: Some(tile),
                ..options.clone()
            };
            Headless::new(&options)
        })
        .collect::<Result<Vec<_>>>()?;
    let scenes = scenes()?;
    for subject in &scenes {
        let mut session = subject.session(device)?;
        let expected = session.frame()?;
        repeat.add(differing(&expected, &session.frame()?));
        repeat.add(differing(&expected, &subject.picture(device)?));
        let unskipped = subject.with(|scene| scene.march.empty_space_skipping = false);
        skipping.add(differing(&expected, &unskipped.picture(device)?));
        for device in &tiled {
            tiles.add(differing(&expected, &subject.picture(device)?));
        }
    }
    let messages = tiled
        .iter()
        .map(|device| device.validation_messages().len());
    // Nobody else asks these devices.
    tiles.add(messages.sum::<usize>() as f64);
    let of = |name, what, worst: Worst| Check::new(name, what, "pixels", worst.figure(), 0.0);
    Ok(vec![
        of("bits.repeat", "pixels that differ from run to run", repeat),
        of(
            "bits.skipping",
            "pixels that empty space skipping changes",
            skipping,
        ),
        of("bits.tiles", "pixels that the size of tiles changes", tiles),
    ])
}

/// A ray that ends at opacity `e` misses at most `1 - e` of the brightest colour.
fn early_termination(device: &Headless) -> Result<Check> {
    let whole = waves()?;
    let ended = whole.with(|scene| scene.march.early_termination = TERMINATION);
    let missed = difference(&whole.picture(device)?, &ended.picture(device)?);
    Ok(Check::new(
        "termination.missed",
        "what rays that end at opacity 0.99 miss",
        "linear",
        missed,
        1.0 - TERMINATION,
    ))
}

/// Premultiplied colour is at most opacity times the brightest colour, 1 here.
fn premultiplied(device: &Headless) -> Result<Check> {
    let mut worst = Worst::default();
    for classification in [
        Classification::Pre,
        Classification::Post,
        Classification::Preintegrated,
    ] {
        let subject = waves()?.with(|scene| scene.march.classification = Some(classification));
        subject.each_picture(device, &[0.2, 1.0], |_, picture, _| {
            for &[r, g, b, a] in &picture.rgba {
                worst.add(f64::from((r.max(g).max(b) - a).max(0.0)));
            }
        })?;
    }
    Ok(Check::new(
        "premultiplied.excess",
        "colour above opacity times the brightest colour",
        "linear",
        worst.figure(),
        ROUNDING,
    ))
}
