//! What goes to stdout and stderr.

use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use serde::Serialize;
use serde_json::Value;
use tracing::Level;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::prelude::*;
use umbravox::{Error, Result};

const BAD_INPUT: u8 = 2;
const FAILED: u8 = 1;

/// Sends log messages to stderr: warnings, or more. Of other crates, whose warnings come once for each file, one level less.
pub(crate) fn log_to_stderr(verbosity: u8) {
    let levels = [Level::ERROR, Level::WARN, Level::INFO, Level::DEBUG];
    let others = usize::from(verbosity).min(levels.len() - 1);
    let own = levels.get(others + 1).copied().unwrap_or(Level::TRACE);
    let targets = Targets::new()
        .with_default(levels[others])
        .with_target("umbravox", own);
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal())
        .without_time();
    tracing_subscriber::registry()
        .with(lines.with_filter(targets))
        .init();
}

/// Prints an error on one line; returns the exit status for its kind.
pub(crate) fn report(error: &Error) -> ExitCode {
    print_error(error.to_string().lines());
    ExitCode::from(if error.is_bad_input() {
        BAD_INPUT
    } else {
        FAILED
    })
}

/// The exit status of what was done and found wanting.
pub(crate) fn failed() -> ExitCode {
    ExitCode::from(FAILED)
}

/// Prints what is wrong with the command line on one line.
pub(crate) fn report_usage<'a>(message: impl Iterator<Item = &'a str>) -> ExitCode {
    print_error(message);
    ExitCode::from(BAD_INPUT)
}

/// Prints what may be wrong, on one line.
pub(crate) fn warn(message: &str) {
    // As for errors: with stderr closed there is nobody to tell.
    let _ = writeln!(io::stderr(), "warning: {message}");
}

fn print_error<'a>(lines: impl Iterator<Item = &'a str>) {
    let words: Vec<&str> = lines.map(str::trim).filter(|l| !l.is_empty()).collect();
    let message = words.join(" ").replace(" tip: ", "; ");
    let message = message.strip_prefix("error: ").unwrap_or(&message);
    // With stderr closed there is nobody to tell; the exit status still says it.
    let _ = writeln!(io::stderr(), "error: {message}");
}

/// Prints results. A reader that has seen enough (`| head`) is no error.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Error::io("standard output", e)),
        _ => Ok(()),
    }
}

/// Prints indented JSON.
pub(crate) fn print_json(value: &impl Serialize) -> Result<()> {
    print(&(to_json(value, "standard output")? + "\n"))
}

/// Indented JSON, for `path`.
pub(crate) fn to_json(value: &impl Serialize, path: &str) -> Result<String> {
    serde_json::to_string_pretty(value).map_err(|e| Error::Encode {
        path: path.into(),
        message: e.to_string(),
    })
}

/// Prints `key  value` lines; keys of nested objects are dotted, long lists shortened.
pub(crate) fn print_table(value: &impl Serialize) -> Result<()> {
    let value = serde_json::to_value(value).map_err(|e| Error::Encode {
        path: "standard output".into(),
        message: e.to_string(),
    })?;
    let mut rows = Vec::new();
    collect_rows("", &value, &mut rows);
    let width = rows.iter().map(|(key, _)| key.len()).max().unwrap_or(0);
    let text = rows.iter().fold(String::new(), |mut text, (key, value)| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{key:width$}  {value}");
        text
    });
    print(&text)
}

fn collect_rows(at: &str, value: &Value, rows: &mut Vec<(String, String)>) {
    const LONGEST: usize = 16;
    match value {
        Value::Object(object) => {
            for (key, part) in object {
                let dot = if at.is_empty() { "" } else { "." };
                collect_rows(&format!("{at}{dot}{key}"), part, rows);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            for (i, item) in items.iter().enumerate() {
                collect_rows(&format!("{at}.{i}"), item, rows);
            }
        }
        Value::Array(items) if items.len() > LONGEST => {
            rows.push((
                at.to_owned(),
                format!("{} values (see --json)", items.len()),
            ));
        }
        Value::String(text) => rows.push((at.to_owned(), text.clone())),
        other => rows.push((at.to_owned(), other.to_string())),
    }
}
