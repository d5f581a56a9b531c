//! `umbravox conformance`.

use umbravox::Result;
use umbravox::conformance::{self, Check, Report};

use crate::args::ConformanceArgs;
use crate::terminal;

/// True when every check passed.
pub(crate) fn run(args: &ConformanceArgs) -> Result<bool> {
    let report = conformance::run(&args.device.options())?;
    if args.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&table(&report))?;
    }
    Ok(report.passed)
}

fn table(report: &Report) -> String {
    let width = |of: fn(&Check) -> usize| report.checks.iter().map(of).max().unwrap_or(0);
    let (names, units) = (width(|c| c.name.len()), width(|c| c.unit.len()));
    let rows = report.checks.iter().map(|check| {
        let verdict = match check.bound {
            None => "noted",
            Some(_) if check.passed => "pass",
            Some(_) => "FAIL",
        };
        let bound = check.bound.map_or("-".into(), |b| format!("{b:.1e}"));
        format!(
            "{verdict:5}  {:names$}  {:>8.1e}  {bound:>8}  {:units$}  {}\n",
            check.name, check.figure, check.unit, check.what
        )
    });
    let head = format!(
        "{} ({}), {}\n",
        report.device, report.driver, report.software
    );
    let count = report.checks.iter().filter(|c| !c.passed).count();
    let end = match count {
        0 => "all checks passed\n".to_owned(),
        n => format!("{n} of {} checks failed\n", report.checks.len()),
    };
    head + &rows.collect::<String>() + &end
}
