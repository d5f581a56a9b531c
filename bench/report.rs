//! A run as JSON, Markdown and a page of HTML.

use std::path::Path;

use umbravox::{Error, Result, output};

use crate::figures::Run;
use crate::peers::{self, FIXED_POINT, GPU, OURS, Peers};
use crate::{goals, plot, tables};

/// Of a folder that holds a run.
const FIGURES: &str = "figures.json";
const PEERS: &str = "peers.json";
const PAGE: &str = "report.html";

/// What the generated part of a document lies between.
const MARKS: [&str; 2] = ["<!-- figures -->\n", "<!-- end of figures -->\n"];

/// Prints the tables.
pub(crate) fn print(run: &Run) {
    for table in tables::of(run, None) {
        println!("{}", table.markdown());
    }
}

/// Writes `figures.json` and the page into `folder`, which is made where it is missing.
///
/// # Errors
/// [`Error::Io`].
pub(crate) fn write(folder: &Path, run: &Run) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    let path = folder.join(FIGURES);
    let text = serde_json::to_string_pretty(run).map_err(|e| Error::Encode {
        path: path.clone(),
        message: e.to_string(),
    })?;
    output::write_bytes(&path, (text + "\n").as_bytes())?;
    again(folder, None)
}

/// Writes the page of a folder from its figures and those of the peers, and the tables into `document`.
///
/// # Errors
/// [`Error::Io`] and [`Error::Invalid`] for files that are missing or of another form.
pub(crate) fn again(folder: &Path, document: Option<&Path>) -> Result<()> {
    let path = folder.join(FIGURES);
    let text = std::fs::read(&path).map_err(|e| Error::io(&path, e))?;
    let run: Run = serde_json::from_slice(&text)
        .map_err(|e| Error::invalid(path.display().to_string(), e.to_string()))?;
    let peers = peers::read(&folder.join(PEERS))?;
    output::write_bytes(&folder.join(PAGE), page(&run, peers.as_ref()).as_bytes())?;
    match document {
        Some(document) => fill(document, &run, peers.as_ref()),
        None => Ok(()),
    }
}

/// Replaces what lies between the marks of a document.
fn fill(document: &Path, run: &Run, peers: Option<&Peers>) -> Result<()> {
    let text = std::fs::read_to_string(document).map_err(|e| Error::io(document, e))?;
    let parts = text.split_once(MARKS[0]).and_then(|(before, rest)| {
        let (_, after) = rest.split_once(MARKS[1])?;
        Some((before, after))
    });
    let Some((before, after)) = parts else {
        return Err(Error::invalid(
            document.display().to_string(),
            format!("lacks the lines {MARKS:?}, in this order"),
        ));
    };
    let tables: Vec<String> = tables::of(run, peers)
        .iter()
        .map(|t| t.markdown())
        .collect();
    let text = format!(
        "{before}{}\n{}\n{}{after}",
        MARKS[0],
        tables.join("\n"),
        MARKS[1]
    );
    output::write_bytes(document, text.as_bytes())
}

/// One file that needs nothing else.
fn page(run: &Run, peers: Option<&Peers>) -> String {
    let tables: String = tables::of(run, peers).iter().map(|t| t.html()).collect();
    let missing = if run.absent.is_empty() {
        String::new()
    } else {
        format!(
            "<p>Not measured, because not at hand: {}.</p>\n",
            run.absent.join(", ")
        )
    };
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>umbravox bench</title>\n<style>{STYLE}</style></head>\n\
         <body>\n<h1>umbravox bench</h1>\n<p>{} ({}), {} cores, load average {}.</p>\n{missing}{}{tables}</body></html>\n",
        plot::escaped(&run.device),
        plot::escaped(&run.driver),
        run.cores,
        tables::load(run),
        plots(run, peers),
    )
}

const STYLE: &str = "body{font-family:sans-serif;max-width:1100px;margin:2em auto;color:#222}\
table{border-collapse:collapse;font-size:13px}td,th{border-bottom:1px solid #ccc;padding:2px 8px;text-align:right}\
td:first-child,th:first-child{text-align:left}";

fn plots(run: &Run, peers: Option<&Peers>) -> String {
    let rates: Vec<_> = run
        .pictures
        .iter()
        .map(|p| (goals::name(p), vec![p.march_ms.median, p.bare_ms.median]))
        .collect();
    let mut plots = format!(
        "<h2>March and its limit</h2>\n{}",
        plot::bars(&["march", "bare march"], &rates, "ms")
    );
    if let Some(peers) = peers {
        let rows: Vec<_> = peers
            .rows
            .iter()
            .map(|row| {
                let shaded = if row.shaded { ", shaded" } else { "" };
                let label = format!("{}, step {}{shaded}", row.scene, row.step);
                let times = [OURS, GPU, FIXED_POINT].map(|r| row.cpu_ms(r, peers.cores));
                (label, times.to_vec())
            })
            .collect();
        plots += "<h2>Beside VTK: processor time a frame over the cores</h2>\n";
        plots += &plot::bars(
            &["umbravox", "VTK GPU (llvmpipe)", "VTK FixedPoint"],
            &rows,
            "ms",
        );
    }
    let points: Vec<[f64; 2]> = run
        .effects
        .reductions
        .iter()
        .map(|p| [p.reached, p.ms()])
        .collect();
    if let (Some(last), first) = (points.last(), goals::of_figure_5(run).next()) {
        let linear = first.map(|p| {
            let [start, product] = [p.reached, p.reached * p.ms()];
            [start, last[0]].map(|reduction| [reduction, product / reduction])
        });
        plots += "<h2>Light by data reduction</h2>\n";
        plots += &plot::line(
            &points,
            linear,
            "data reduction",
            "reduction: ms a direction; both axes logarithmic; dashed: as many times faster as reduced",
        );
    }
    plots
}
