//! `umbravox formats`.

use serde::Serialize;
use umbravox::Result;
use umbravox::io::{FORMATS, Format};

use crate::args::FormatsArgs;
use crate::terminal;

/// What is no format of its own.
const BESIDES: &str = "\
Headerless files are read as `volume.raw` describes them, or as their name does (head_256x256x128_uint8.raw).
Any of these may be packed: .gz, .xz, .zip, .tar, .tar.gz, .tar.xz. docs/formats.md says what is read of each.
";

/// A row of the table.
#[derive(Serialize)]
struct Row {
    name: &'static str,
    extensions: &'static [&'static str],
    files: bool,
    folders_and_archives: bool,
    reads: &'static str,
}

impl From<&Format> for Row {
    fn from(format: &Format) -> Self {
        Self {
            name: format.name,
            extensions: format.extensions,
            files: format.reads_files(),
            folders_and_archives: format.reads_folders(),
            reads: format.reads,
        }
    }
}

pub(crate) fn run(args: &FormatsArgs) -> Result<()> {
    let rows: Vec<Row> = FORMATS.iter().map(Row::from).collect();
    if args.json {
        return terminal::print_json(&rows);
    }
    let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let text: String = rows
        .iter()
        .map(|row| {
            let endings = row.extensions.join(" .");
            format!(
                "{:width$}  .{endings}\n{:width$}  {}\n",
                row.name, "", row.reads
            )
        })
        .collect();
    terminal::print(&format!("{text}{BESIDES}"))
}
