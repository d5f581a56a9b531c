//! Goals, and how far a run is from each.

use umbravox::occlusion::RMS_ERROR;

use crate::figures::{Growing, Light, Picture, Reduction, Run, Spread};
use crate::peers::{FIXED_POINT, GPU, Peers, Row};

/// One goal.
pub(crate) struct Goal {
    pub(crate) what: String,
    bound: Bound,
    pub(crate) measured: f64,
    /// The case that decides, where there are several.
    pub(crate) decided_by: String,
}

#[derive(Clone, Copy)]
enum Bound {
    AtLeast(f64),
    AtMost(f64),
}
use Bound::{AtLeast, AtMost};

impl Goal {
    pub(crate) fn bound(&self) -> String {
        match self.bound {
            AtLeast(bound) => format!("≥ {bound}"),
            AtMost(bound) => format!("≤ {bound}"),
        }
    }

    pub(crate) fn is_reached(&self) -> bool {
        match self.bound {
            AtLeast(bound) => self.measured >= bound,
            AtMost(bound) => self.measured <= bound,
        }
    }
}

/// The goal that the worst of some cases decides; `None` where there is no case.
fn worst(what: &str, bound: Bound, cases: impl Iterator<Item = (String, f64)>) -> Option<Goal> {
    let further = |a: &(String, f64), b: &(String, f64)| match bound {
        AtLeast(_) => a.1.total_cmp(&b.1),
        AtMost(_) => b.1.total_cmp(&a.1),
    };
    let (decided_by, measured) = cases.min_by(further)?;
    Some(Goal {
        what: what.to_owned(),
        bound,
        measured,
        decided_by,
    })
}

/// Every goal that the figures say something of.
pub(crate) fn of(run: &Run, peers: Option<&Peers>) -> Vec<Goal> {
    let mut goals = of_march(run);
    goals.extend(of_light_and_rest(run));
    goals.extend(peers.map(of_peers).unwrap_or_default());
    goals
}

/// Pictures that differ from `like` in what `change` does to their case alone: pairs of both.
fn pairs<'a>(
    run: &'a Run,
    change: impl Fn(&mut crate::figures::Case) + 'a,
) -> impl Iterator<Item = (&'a Picture, &'a Picture)> {
    run.pictures.iter().filter_map(move |one| {
        let mut wanted = one.case.clone();
        change(&mut wanted);
        let other = run.pictures.iter().find(|p| p.case == wanted)?;
        (other.case != one.case).then_some((one, other))
    })
}

fn of_march(run: &Run) -> Vec<Goal> {
    let plain = |p: &&Picture| !p.case.shaded && !p.case.preintegrated;
    let fogs = run.pictures.iter().filter(|p| p.case.field == "fog");
    let ratio = |a: &Spread, b: &Spread| a.median / b.median;
    let limit = fogs.filter(plain).map(|p| (name(p), p.rate() / p.limit()));
    let sparse = pairs(run, |case| case.field = "fog".into())
        .filter(|(one, _)| one.case.field == "sparse" && plain(one))
        .map(|(sparse, fog)| (name(sparse), ratio(&fog.march_ms, &sparse.march_ms)));
    let shaded = pairs(run, |case| case.shaded = true)
        .map(|(plain, shaded)| (name(plain), ratio(&shaded.march_ms, &plain.march_ms)));
    let voxels = pairs(run, |case| case.size *= 2)
        .map(|(small, large)| (name(large), ratio(&large.march_ms, &small.march_ms)));
    // A step is one of the volume's own voxels: half as long in space, in twice the voxels along it.
    let as_many_samples = pairs(run, |case| {
        case.size *= 2;
        case.step *= 2.0;
    })
    .map(|(small, large)| (name(large), ratio(&large.march_ms, &small.march_ms)));
    // Small volumes say nothing of memory: tables weigh more than voxels.
    let large = run.pictures.iter().filter(|p| p.voxel_bytes >= 1 << 24);
    let resident = |of: fn(&Picture) -> u64| {
        let plain = large.clone().filter(plain);
        plain.map(move |p| (name(p), of(p) as f64 / p.voxel_bytes as f64))
    };
    let effects = &run.effects;
    let skipping = effects.skipping.iter().map(|[on, off]| ratio(on, off));
    let edit = effects
        .edit
        .iter()
        .map(|[plain, edited]| ratio(edited, plain));
    let alone = |value| (String::new(), value);
    [
        worst(
            "fog: march, samples per second of the bare march's",
            AtLeast(0.85),
            limit,
        ),
        worst("sparse: times faster than fog", AtLeast(10.0), sparse),
        worst(
            "fog: time with skipping, of that without",
            AtMost(1.05),
            skipping.map(alone),
        ),
        worst("shaded: time of unshaded", AtMost(1.6), shaded),
        worst("eight times the voxels: time", AtMost(2.0), voxels),
        worst(
            "the same, of the same samples (256³ at step 0.5)",
            AtMost(2.0),
            as_many_samples,
        ),
        worst(
            "new transfer function to first right frame, plain frames",
            AtMost(1.3),
            edit.map(alone),
        ),
        worst(
            "bytes on the device, of the voxels' bytes, packed corners apart",
            AtMost(1.25),
            resident(|p| p.resident_bytes),
        ),
        worst(
            "the same, with the packed corners of drivers that filter on the processor",
            AtMost(1.25),
            resident(|p| p.resident_bytes + p.packed_bytes),
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The points that figure 5 of Hernell, Ljung and Ynnerman (2007) has.
pub(crate) fn of_figure_5(run: &Run) -> impl Iterator<Item = &Reduction> {
    run.effects
        .reductions
        .iter()
        .filter(|p| p.asked > 1.0 && p.size > 0)
}

fn of_light_and_rest(run: &Run) -> Vec<Goal> {
    let faster = of_figure_5(run).take(1).flat_map(|first| {
        let others = of_figure_5(run).skip(1);
        others.map(move |p| {
            let name = format!("blobs {}³, {:.1}", p.size, p.reached);
            (name, first.ms() / p.ms() / (p.reached / first.reached))
        })
    });
    let lights = || run.lights.iter();
    let limit = lights().map(|l| (l.field.clone(), l.rate() / l.limit()));
    // Growing distances count where they keep the light; uniform sampling has no error.
    let fewer = |l: &Light| {
        let within = l.growing.iter().filter(|g| g.rms_error <= RMS_ERROR);
        within.map(Growing::fewer).fold(l.fewer(), f64::max)
    };
    let brute = lights().filter(|l| l.field != "fog");
    let brute = brute.map(|l| (l.field.clone(), fewer(l)));
    let process = run.effects.process.iter();
    let process = process.map(|p| (String::new(), p.render_ms.median / p.parts_ms.median));
    [
        worst(
            "LAO: samples per second of the bare light's",
            AtLeast(0.7),
            limit.filter(|(field, _)| field == "fog"),
        ),
        worst(
            "LAO: times fewer samples than equation 2 asks for, within 1/255 RMS of its light (sampling \"distance\"), fog aside",
            AtLeast(5.0),
            brute,
        ),
        worst(
            "LAO by data reduction: times faster than at 8.5, of times reduced",
            AtLeast(1.0),
            faster,
        ),
        worst(
            "compressed file to PNG, of gunzip, frame and LAO passes",
            AtMost(1.5),
            process,
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// How many times FixedPoint's time others took, unshaded and shaded, at 512^2 and step 1 on one machine (2 cores, AVX2): they
/// are not on PyPI, and are compared through it.
const THROUGH_FIXED_POINT: [(&str, [f64; 2], f64); 2] = [
    ("Open VKL 2.0.1", [344.0 / 247.0, 523.0 / 541.0], 3.0),
    ("OSPRay 3.2 scivis", [534.0 / 247.0, 745.0 / 541.0], 5.0),
];

fn of_peers(peers: &Peers) -> Vec<Goal> {
    let rows = |scenes: &'static [&str], shaded: bool| {
        let rows = peers.rows.iter();
        rows.filter(move |row| row.shaded == shaded && scenes.contains(&row.scene.as_str()))
    };
    let over = |renderer: &'static str, scenes: &'static [&str], shaded| {
        rows(scenes, shaded).map(move |row| (label(row), row.times_ours(renderer)))
    };
    const FULL: &[&str] = &["fog"];
    const BLOBS: &[&str] = &["blobs"];
    const SKIPPABLE: &[&str] = &["sparse", "aorta", "head", "chest"];
    const ALL: &[&str] = &["fog", "sparse", "blobs", "aorta", "head", "chest", "engine"];
    let mut goals = vec![
        worst(
            "VTK GPU mapper on llvmpipe: its time of ours, sparse and CT",
            AtLeast(5.0),
            over(GPU, SKIPPABLE, false),
        ),
        worst("the same, fog", AtLeast(2.5), over(GPU, FULL, false)),
        worst(
            "VTK FixedPoint: its time of ours, sparse and CT",
            AtLeast(3.0),
            over(FIXED_POINT, SKIPPABLE, false),
        ),
        worst(
            "the same, fog",
            AtLeast(2.0),
            over(FIXED_POINT, FULL, false),
        ),
        worst(
            "the same, shaded, everywhere",
            AtLeast(3.0),
            over(FIXED_POINT, ALL, true),
        ),
    ];
    for (name, factors, goal) in THROUGH_FIXED_POINT {
        let through = [false, true].into_iter().zip(factors);
        let cases = through.flat_map(|(shaded, factor)| {
            let blobs = over(FIXED_POINT, BLOBS, shaded);
            blobs.map(move |(row, times)| (row, times * factor))
        });
        let what = format!("{name}, through FixedPoint: its time of ours");
        goals.push(worst(&what, AtLeast(goal), cases));
    }
    goals.into_iter().flatten().collect()
}

fn label(row: &Row) -> String {
    let shaded = if row.shaded { ", shaded" } else { "" };
    format!("{}, step {}{shaded}", row.scene, row.step)
}

/// A case in few words.
pub(crate) fn name(picture: &Picture) -> String {
    let case = &picture.case;
    let [x, y, z] = picture.size;
    let size = if x == y && y == z {
        format!("{x}³")
    } else {
        format!("{x} × {y} × {z}")
    };
    let mut name = format!("{} {size}, {}², step {}", case.field, case.image, case.step);
    if case.shaded {
        name += ", shaded";
    }
    if case.preintegrated {
        name += ", pre-integrated";
    }
    name
}
