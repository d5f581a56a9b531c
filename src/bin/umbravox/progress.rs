//! Progress on stderr, when it is a terminal.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};
use umbravox::Result;
use umbravox::headless::Session;

/// Traces every direction of a fresh session.
pub(crate) fn complete_light(session: &mut Session) -> Result<()> {
    trace_light(session, session.light_rays(), |_, _| Ok(()))
}

/// Traces the first `directions` of a fresh session, at most all, and calls `after_each` with the number traced so far.
pub(crate) fn trace_light(
    session: &mut Session,
    directions: u32,
    mut after_each: impl FnMut(&mut Session, u32) -> Result<()>,
) -> Result<()> {
    if directions == 0 {
        return Ok(());
    }
    let bar = bar(
        directions.into(),
        "light {bar:40} {pos}/{len} directions, {eta} left",
    );
    for traced in 1..=directions {
        session.refine_light()?;
        bar.set_position(traced.into());
        after_each(session, traced)?;
    }
    bar.finish_and_clear();
    Ok(())
}

/// A bar for bytes of voxels, whose number is not known yet.
pub(crate) fn reading() -> ProgressBar {
    bar(0, "read {bar:40} {bytes}/{total_bytes}, {eta} left")
}

fn bar(length: u64, template: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}
