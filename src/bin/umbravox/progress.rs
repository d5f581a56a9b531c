//! Progress on stderr, when it is a terminal.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};
use umbravox::Result;
use umbravox::headless::Session;

/// Traces every direction that is left, and calls `after_each` with the number traced so far.
pub(crate) fn complete_light(
    session: &mut Session,
    mut after_each: impl FnMut(&mut Session, u32) -> Result<()>,
) -> Result<()> {
    let rays = session.light_rays();
    if rays == 0 {
        return Ok(());
    }
    let bar = bar(
        rays.into(),
        "light {bar:40} {pos}/{len} directions, {eta} left",
    );
    let mut traced = 0;
    loop {
        let incomplete = session.refine_light()?;
        traced += 1;
        bar.set_position(traced.into());
        after_each(session, traced)?;
        if !incomplete {
            break;
        }
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
