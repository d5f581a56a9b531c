//! Is a device fit to render? Checks on volumes made for them, against closed forms and against itself.
//!
//! Needs no file. `docs/conformance.md` says what each check means.

mod check;
mod closed_forms;
mod cubic;
mod depth;
mod gradients;
mod invariants;
mod levels;
mod light;
mod projections;
mod shell;
mod surfaces;
#[doc(hidden)] // shared with the tests; not part of the API
pub mod synthetic;

pub use check::{Check, Report};

use crate::error::Result;
use crate::headless::{Headless, Options};

/// Every check, on the device of `options`. Devices are opened once more for tiles, so one report needs a few.
///
/// # Errors
/// What opening a device or rendering fails with. A check that fails is no error.
pub fn run(options: &Options) -> Result<Report> {
    let device = Headless::new(options)?;
    let mut checks = Vec::new();
    checks.extend(closed_forms::checks(&device)?);
    checks.extend(invariants::checks(&device, options)?);
    checks.extend(levels::checks(&device)?);
    checks.extend(shell::checks(&device)?);
    checks.extend(cubic::checks(&device)?);
    checks.extend(gradients::checks(&device)?);
    checks.extend(projections::checks(&device)?);
    checks.extend(surfaces::checks(&device)?);
    checks.extend(depth::checks(&device)?);
    checks.extend(light::checks(&device)?);
    if options.validation {
        let messages = device.validation_messages().len() as f64;
        let what = "messages of the validation layer";
        checks.push(Check::new("validation", what, "messages", messages, 0.0));
    }
    Ok(Report::new(&device.device(), checks))
}
