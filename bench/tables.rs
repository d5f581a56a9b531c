//! The figures as tables: a heading, column titles and rows, for Markdown and HTML alike.

use umbravox::scene::AmbientOcclusion;

use crate::figures::{Light, Picture, Reduction, Run, Spread};
use crate::goals::{self, Goal};
use crate::peers::{FIXED_POINT, GPU, OURS, Peers, Row};

pub(crate) struct Table {
    pub(crate) title: &'static str,
    /// What a reader must know of the columns.
    pub(crate) note: String,
    columns: &'static [&'static str],
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let titles: Vec<String> = self.columns.iter().map(|c| (*c).to_owned()).collect();
        // All but the first column hold figures.
        let rule: Vec<String> = (0..titles.len())
            .map(|at| if at == 0 { "---" } else { "--:" }.to_owned())
            .collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!(
            "### {}\n\n{}\n\n{}{}{rows}",
            self.title,
            self.note,
            line(&titles),
            line(&rule)
        )
    }

    pub(crate) fn html(&self) -> String {
        let cells = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
            let cells: String = cells
                .map(|c| format!("<{tag}>{}</{tag}>", crate::plot::escaped(c)))
                .collect();
            format!("<tr>{cells}</tr>\n")
        };
        let head = cells("th", &mut self.columns.iter().copied());
        let rows: String = self
            .rows
            .iter()
            .map(|row| cells("td", &mut row.iter().map(String::as_str)))
            .collect();
        format!(
            "<h2>{}</h2>\n<p>{}</p>\n<table>\n{head}{rows}</table>\n",
            self.title,
            crate::plot::escaped(&self.note)
        )
    }
}

/// All of them, the goals first.
pub(crate) fn of(run: &Run, peers: Option<&Peers>) -> Vec<Table> {
    let mut tables = vec![goals(&goals::of(run, peers)), pictures(run), counters(run)];
    if !run.lights.is_empty() {
        tables.push(lights(run));
        tables.extend(growing(run));
    }
    if !run.effects.reductions.is_empty() {
        tables.push(reductions(run));
    }
    tables.extend(peers.map(|peers| others(run, peers)));
    tables
}

fn goals(goals: &[Goal]) -> Table {
    let rows = goals.iter().map(|goal| {
        vec![
            goal.what.clone(),
            goal.bound(),
            format!("{:.2}", goal.measured),
            if goal.is_reached() { "yes" } else { "no" }.to_owned(),
            goal.decided_by.clone(),
        ]
    });
    Table {
        title: "Goals",
        note: "Ratios of medians, the two sides measured in turn. Where several cases count, the worst decides.".into(),
        columns: &["goal", "bound", "measured", "reached", "decided by"],
        rows: rows.collect(),
    }
}

fn pictures(run: &Run) -> Table {
    let row = |p: &Picture| {
        vec![
            goals::name(p),
            format!("{:.1}", p.frame_ms.median),
            spread(&p.march_ms),
            spread(&p.bare_ms),
            format!("{:.1}", p.rate() * 1e-6),
            format!("{:.1}", p.limit() * 1e-6),
            format!("{:.2}", p.rate() / p.limit()),
            format!("{:.2}", p.march_ms.median / p.bare_ms.median),
        ]
    };
    Table {
        title: "Pictures",
        note: format!(
            "Median (min–max) of {} frames on {} ({} cores, load average {}). Frame: wall time. March and bare march: the device's time; \
             where the device is the processor, processor time over the cores, which other load does not stretch. The bare march takes every sample of the same \
             rays, each one texture read and one look-up, and does nothing else. Where little is sampled the rate says little, and \
             the time of the bare march is what to compare with.",
            run.repeats,
            run.device,
            run.cores,
            load(run)
        ),
        columns: &[
            "picture",
            "frame ms",
            "march ms",
            "bare ms",
            "Msamples/s",
            "bare Msamples/s",
            "of the limit",
            "time of bare",
        ],
        rows: run.pictures.iter().map(row).collect(),
    }
}

fn counters(run: &Run) -> Table {
    let row = |p: &Picture| {
        vec![
            goals::name(p),
            format!("{:.2} %", 100.0 * p.visible),
            p.samples.to_string(),
            format!("{:.3}", p.samples as f64 / p.bare_samples as f64),
            format!("{:.2}", p.uploaded_bytes as f64 / p.voxel_bytes as f64),
            format!("{:.2}", p.resident_bytes as f64 / p.voxel_bytes as f64),
            format!("{:.2}", p.packed_bytes as f64 / p.voxel_bytes as f64),
        ]
    };
    Table {
        title: "Counters",
        note: "They are the same on every machine, but for rounding at borders of cells, and for samples that show nothing where \
               there are beams, which are cast where the processor is the device. Bytes staged and bytes on the device \
               are in multiples of the voxels' bytes; pictures are not counted, and packed corners, which only drivers that \
               filter on the processor have, stand apart."
            .into(),
        columns: &["picture", "visible", "samples", "of all", "staged", "resident", "packed"],
        rows: run.pictures.iter().map(row).collect(),
    }
}

fn lights(run: &Run) -> Table {
    let rows = run.lights.iter().map(|l| {
        vec![
            name_and_size(l),
            spread(&l.trace_ms),
            spread(&l.bare_ms),
            l.voxels.to_string(),
            (l.samples / u64::from(l.rays)).to_string(),
            format!("{:.1}", l.rate() * 1e-6),
            format!("{:.1}", l.limit() * 1e-6),
            format!("{:.2}", l.rate() / l.limit()),
            format!("{:.2}", l.fewer()),
        ]
    });
    Table {
        title: "Local ambient occlusion",
        note: "Of one direction of 15 samples. The bare light takes 15 samples for every voxel of the work list, each one texture \
               read and one look-up. Fewer: samples of equation 2 (every voxel, direction and sample) over those taken."
            .into(),
        columns: &[
            "field",
            "ms a direction",
            "bare ms",
            "voxels lit",
            "samples",
            "Msamples/s",
            "bare Msamples/s",
            "of the limit",
            "fewer",
        ],
        rows: rows.collect(),
    }
}

fn growing(run: &Run) -> Option<Table> {
    let measured = run
        .lights
        .iter()
        .filter_map(|l| Some((l, l.growing.as_ref()?)));
    let rows: Vec<Vec<String>> = measured
        .map(|(l, g)| {
            vec![
                name_and_size(l),
                g.rays.to_string(),
                g.growth.map_or("none".into(), |growth| growth.to_string()),
                spread(&g.trace_ms),
                spread(&g.uniform_ms),
                format!("{:.2}", g.trace_ms.median / g.uniform_ms.median),
                (g.samples / u64::from(g.rays)).to_string(),
                format!("{:.2}", g.fewer()),
                format!("{:.2}", 255.0 * g.rms_error),
                format!("{:.1}", 255.0 * g.largest_error),
            ]
        })
        .collect();
    (!rows.is_empty()).then(|| Table {
        title: "Local ambient occlusion, distances growing",
        note: "The same rays with `ambient_occlusion.sampling` `distance`, each direction in turn with uniform sampling. The renderer \
               chooses the growth. Errors: of the light of all directions beside uniform sampling's, in 1/255."
            .into(),
        columns: &[
            "field",
            "directions",
            "growth",
            "ms a direction",
            "uniform ms",
            "of uniform",
            "samples",
            "fewer",
            "RMS",
            "largest",
        ],
        rows,
    })
}

fn name_and_size(light: &Light) -> String {
    format!(
        "{} {}",
        light.field,
        light.size.map(|n| n.to_string()).join(" × ")
    )
}

fn reductions(run: &Run) -> Table {
    let points = &run.effects.reductions;
    // Runs that were stored before joining was timed have no size.
    let size = points.iter().map(|p| p.size).find(|&size| size > 0);
    let first = goals::of_figure_5(run).next();
    let of_first = |ratio: fn(&Reduction, &Reduction) -> f64, p| {
        first.map_or(String::new(), |first| format!("{:.2}", ratio(first, p)))
    };
    let rows = points.iter().map(|p| {
        vec![
            format!("{}", p.asked),
            format!("{:.1}", p.reached),
            format!("{:.1}", p.ms_per_ray),
            size.map_or(String::new(), |_| format!("{:.1}", p.join_ms)),
            of_first(|first, p| p.reached / first.reached, p),
            of_first(|first, p| first.ms() / p.ms(), p),
            p.voxels.to_string(),
        ]
    });
    let note = size.map_or("Of a run in which joining bricks was not timed apart.".to_owned(), |size| {
        format!(
            "On blobs {size}³: the reductions of figure 5 of Hernell, Ljung and Ynnerman (2007), which begins at 8.5, and the least that \
             the budget has room for. Bricks are joined once, after the last direction, by a pass that is compiled then; times faster count a share of that, of {}.",
            AmbientOcclusion::default().rays
        )
    });
    Table {
        title: "Light by data reduction",
        note,
        columns: &[
            "reduction asked",
            "reached",
            "ms a direction",
            "ms to join",
            "of that at 8.5",
            "times faster than that",
            "voxels lit",
        ],
        rows: rows.collect(),
    }
}

/// What a row's samples take at the rate of the bare march, ms; of pictures that take no other samples.
fn limit_ms(run: &Run, row: &Row) -> Option<f64> {
    let same = run.pictures.iter().filter(|p| {
        let case = &p.case;
        case.field == row.scene && [case.image; 2] == row.image && case.step == row.step
    });
    let plain = same.filter(|p| !p.case.shaded && !p.case.preintegrated && !row.shaded);
    let smallest = plain.min_by_key(|p| p.voxel_bytes)?;
    Some(smallest.samples as f64 / smallest.limit() * 1e3)
}

fn others(run: &Run, peers: &Peers) -> Table {
    let cores = peers.cores;
    let rows = peers.rows.iter().map(|row| {
        let time = |renderer| {
            format!(
                "{:.0} / {:.0}",
                row.cpu_ms(renderer, cores),
                row.wall_ms(renderer)
            )
        };
        let psnr: Vec<String> = [GPU, FIXED_POINT, "between_theirs"]
            .iter()
            .map(|of| match row.psnr_db.get(*of) {
                Some(Some(db)) => format!("{db:.0}"),
                _ => "equal".into(),
            })
            .collect();
        let [width, height] = row.image;
        vec![
            format!(
                "{}, {width} × {height}, step {}{}",
                row.scene,
                row.step,
                if row.shaded { ", shaded" } else { "" }
            ),
            time(OURS),
            limit_ms(run, row)
                .map(|ms| format!("{ms:.0}"))
                .unwrap_or_default(),
            time(GPU),
            format!("{:.2}", row.times_ours(GPU)),
            time(FIXED_POINT),
            format!("{:.2}", row.times_ours(FIXED_POINT)),
            psnr.join(" / "),
        ]
    });
    Table {
        title: "Beside VTK",
        note: format!(
            "VTK {}: its GPU mapper on llvmpipe and its fixed-point mapper, in turn with ours, frame by frame; voxels, transfer \
             function, camera, step and classification are the same. Median milliseconds a frame: processor time over \
             {cores} cores / wall time. Our limit: what our samples take at the rate of the bare march. PSNR in dB of ours with either, and of the two with each other.",
            peers.vtk
        ),
        columns: &[
            "scene",
            "ours",
            "our limit",
            "VTK GPU",
            "of ours",
            "VTK FixedPoint",
            "of ours",
            "PSNR",
        ],
        rows: rows.collect(),
    }
}

fn spread(spread: &Spread) -> String {
    let Spread { min, median, max } = spread;
    format!("{median:.1} ({min:.1}–{max:.1})")
}

/// Load average before and after, as far as it is known.
pub(crate) fn load(run: &Run) -> String {
    let figures = run.load.iter().flatten().map(|load| format!("{load:.1}"));
    let figures: Vec<String> = figures.collect();
    if figures.is_empty() {
        "unknown".into()
    } else {
        figures.join(" to ")
    }
}
