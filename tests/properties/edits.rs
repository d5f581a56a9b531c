//! A session whose settings were changed shows, bit by bit, what one shows that was started with them.

use umbravox::headless::Session;
use umbravox::renderer::Settings;
use umbravox::scene::{Classification, ControlPoint, Interpolation, RayProjection};

use crate::bits::differing;
use crate::random::{Random, varied};
use crate::sessions::{Subject, assert_valid, device, shown};

/// Random scenes, each with all edits; `UMBRAVOX_CASES` for more.
fn cases() -> u64 {
    let wanted = std::env::var("UMBRAVOX_CASES").ok();
    wanted.and_then(|n| n.parse().ok()).unwrap_or(6)
}

fn with_points(subject: &Subject, change: impl FnMut(&mut ControlPoint)) -> Subject {
    subject.with(|scene| {
        let points = scene.transfer_function.points.iter_mut().flatten();
        points.for_each(change);
    })
}

/// One after the other, each from the scene before it.
fn edits(subject: &Subject, random: &mut Random) -> Vec<(&'static str, Subject)> {
    let mut edits = vec![];
    let mut now = subject.clone();
    let mut push = |name, next: &Subject| edits.push((name, next.clone()));
    // What is visible stays: some opacity becomes another that is not 0.
    now = with_points(&now, |point| point.opacity *= 0.75);
    push("less opaque", &now);
    // Other places show something, sometimes none.
    let shift = random.between(-0.3, 0.3);
    now = with_points(&now, |point| point.value = (point.value + shift).max(0.0));
    push("points moved", &now);
    let shown = random.between(0.0, 0.6);
    now = with_points(&now, |point| point.opacity = point.opacity.max(shown));
    push("more opaque", &now);
    now = with_points(&now, |point| {
        point.emission = [0.0; 3];
        point.color.reverse();
    });
    push("other colours", &now);
    now = now.with(|scene| scene.march.step *= 0.7);
    push("shorter steps", &now);
    let march = &now.scene.march;
    let composite = march.projection == RayProjection::Composite;
    if composite && march.field_is_continuous() {
        let other = match march.classification() {
            Classification::Preintegrated => Classification::Post,
            _ => Classification::Preintegrated,
        };
        now = now.with(|scene| scene.march.classification = Some(other));
        push("the other classification", &now);
    }
    if composite {
        let plain = now.with(|scene| {
            scene.march.interpolation = Interpolation::Linear;
            scene.march.classification = None;
        });
        push("linear interpolation", &plain);
        now = plain.with(|scene| scene.march.interpolation = Interpolation::Bspline);
        now = now.with(|scene| scene.march.inter_block_interpolation = true);
        push("a wide filter", &now);
    }
    now = now.with(|scene| scene.storage.packed_cells = !scene.storage.packed_cells);
    push("voxels read in another way", &now);
    push("as it was", subject);
    edits
}

fn change(session: &mut Session, to: &Subject) {
    let settings = Settings::of_scene(&to.scene, &to.volume).unwrap();
    session.set_settings(settings).unwrap();
    while session.refine_light().unwrap() {}
}

#[test]
fn an_edited_session_is_as_one_that_was_started_so() {
    let device = device(|_| {});
    let mut complaints = Vec::new();
    let (mut compared, mut visible, mut moved, mut lit) = (0, 0, 0, 0);
    for seed in 0..cases() {
        let subject = varied(seed);
        let mut session = subject.session(&device);
        let mut before = session.frame().unwrap();
        for (name, edited) in edits(&subject, &mut Random::new(seed ^ 0x5eed)) {
            change(&mut session, &edited);
            let picture = session.frame().unwrap();
            let mut fresh = edited.session(&device);
            let expected = fresh.frame().unwrap();
            let pixels = differing(&picture, &expected);
            if pixels > 0 || picture.samples != expected.samples {
                complaints.push(format!("case {seed}, {name}: {pixels} pixels differ"));
            }
            if edited.scene.ambient_occlusion.is_some() {
                let light = [&mut session, &mut fresh].map(|s| s.light_volume().unwrap().rgba);
                if light[0] != light[1] {
                    complaints.push(format!("case {seed}, {name}: light differs"));
                }
                lit += 1;
            }
            compared += 1;
            visible += usize::from(shown(&expected) > 1.0);
            moved += usize::from(before.samples != expected.samples);
            before = expected;
        }
    }
    println!("{compared} edits: {visible} visible, {moved} of what is sampled, {lit} lit");
    assert_valid(&device);
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
    assert!(
        visible > compared / 3
            && (compared / 5..compared * 4 / 5).contains(&moved)
            && lit > compared / 8,
        "the edits are about something"
    );
}
