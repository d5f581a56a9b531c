//! What changes no bit of a picture: skipping, beams, tiles, memory, repetition, a session beside it.

use umbravox::headless::Headless;
use umbravox::picture::Picture;

use crate::random::varied;
use crate::sessions::{Subject, assert_valid, device, shown};

/// Random scenes; `UMBRAVOX_CASES` for more.
fn cases() -> u64 {
    let wanted = std::env::var("UMBRAVOX_CASES").ok();
    wanted.and_then(|n| n.parse().ok()).unwrap_or(100)
}
/// Edges of tiles, pixels; the pictures are smaller than the last.
const TILES: [u32; 4] = [8, 16, 24, 64];

/// Radiance, opacity, depths and what else is measured of every pixel, bit by bit.
fn bits(picture: &Picture) -> Vec<[u32; 7]> {
    (0..picture.rgba.len())
        .map(|i| {
            let [r, g, b, a] = picture.rgba[i];
            let layers = [
                picture.depth[i],
                picture.median_depth[i],
                picture.measure[i],
            ];
            [r, g, b, a, layers[0], layers[1], layers[2]].map(f32::to_bits)
        })
        .collect()
}

/// Number of pixels that differ.
pub(crate) fn differing(a: &Picture, b: &Picture) -> usize {
    let (a, b) = (bits(a), bits(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).filter(|(a, b)| a != b).count()
}

fn without_skipping(subject: &Subject) -> Subject {
    subject.with(|scene| scene.march.empty_space_skipping = false)
}

fn without_beams(subject: &Subject) -> Subject {
    subject.with(|scene| scene.march.beams = false)
}

/// What is compared, besides skipping and beams, in turn.
fn variants() -> Vec<(String, Headless)> {
    let mut variants = vec![("run to run".to_owned(), device(|_| {}))];
    variants.extend(TILES.map(|tile| {
        let device = device(|options| options.tile = Some(tile));
        (format!("tiles of {tile}"), device)
    }));
    #[cfg(feature = "vk-mem")]
    {
        let vma = device(|options| options.memory = umbravox::headless::MemoryChoice::Vma);
        variants.push(("vma".into(), vma));
    }
    variants
}

#[test]
fn pictures_depend_on_the_scene_alone() {
    let plain = device(|_| {});
    let variants = variants();
    let mut complaints = Vec::new();
    let (mut visible, mut skipped, mut lit, mut beamed) = (0, 0, 0, 0);
    let cases = cases();
    for seed in 0..cases {
        let subject = varied(seed);
        let mut session = subject.session(&plain);
        let expected = session.frame().unwrap();
        // Both sessions live on one device.
        let mut other = without_skipping(&subject).session(&plain);
        let unskipped = other.frame().unwrap();
        if subject.scene.ambient_occlusion.is_some() {
            lit += 1;
            let light = [&mut session, &mut other].map(|s| s.light_volume().unwrap().rgba);
            if light[0] != light[1] {
                complaints.push(format!("case {seed}: light differs without skipping"));
            }
        }
        let mut compare = |name: &str, picture: &Picture| {
            let pixels = differing(picture, &expected);
            if pixels > 0 {
                complaints.push(format!("case {seed}, {name}: {pixels} pixels differ"));
            }
        };
        compare("skipping off", &unskipped);
        let by_itself = without_beams(&subject).picture(&plain);
        compare("beams off", &by_itself);
        compare("again", &session.frame().unwrap());
        let (name, device) = &variants[seed as usize % variants.len()];
        compare(name, &subject.picture(device));
        if subject.scene.storage.data_reduction == 1.0 {
            let mut settings = session.settings().clone();
            settings.storage.memory_budget_mib = 1e5;
            session.set_settings(settings).unwrap();
            compare("ample memory", &session.frame().unwrap());
        }
        visible += usize::from(shown(&expected) > 1.0);
        let count = |picture: &Picture| picture.samples.iter().sum::<u32>();
        skipped += usize::from(count(&expected) < count(&unskipped));
        beamed += usize::from(count(&expected) != count(&by_itself));
    }
    println!(
        "{cases} cases: {visible} visible, {skipped} with skipped samples, {lit} lit, {beamed} with other samples by beams"
    );
    for (_, device) in &variants {
        assert_valid(device);
    }
    assert_valid(&plain);
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
    let most = cases as usize;
    // Beams are cast where the processor is the device.
    let beams = plain.device().device_type == "cpu";
    assert!(!beams || beamed > 0, "beams are cast");
    // Runs of a fixed length look at samples that leaps alone would spare: in small volumes often at all of them.
    assert!(
        visible > most / 2 && skipped > most / 8 && lit > most / 8,
        "the cases are about something"
    );
}
