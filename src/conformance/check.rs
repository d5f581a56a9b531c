//! Figures against bounds.

use serde::Serialize;

use crate::headless::DeviceInfo;

/// One figure, and what it may be at most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Group and name, as in `homogeneous.opacity`.
    pub name: &'static str,
    /// What the figure is.
    pub what: &'static str,
    /// Of the figure.
    pub unit: &'static str,
    /// As measured; not a number where nothing was.
    pub figure: f64,
    /// What it may be at most; `None`: only noted, for comparison.
    pub bound: Option<f64>,
    /// True when the figure keeps its bound, or has none.
    pub passed: bool,
}

impl Check {
    /// A figure that must not exceed `bound`.
    pub fn new(
        name: &'static str,
        what: &'static str,
        unit: &'static str,
        figure: f64,
        bound: f64,
    ) -> Self {
        Self {
            name,
            what,
            unit,
            figure,
            bound: Some(bound),
            // False for what is not a number.
            passed: figure <= bound,
        }
    }

    /// A figure that says how others compare.
    pub fn noted(name: &'static str, what: &'static str, unit: &'static str, figure: f64) -> Self {
        Self {
            name,
            what,
            unit,
            figure,
            bound: None,
            passed: true,
        }
    }
}

/// All checks of a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Program and version.
    pub software: &'static str,
    /// Name of the device.
    pub device: String,
    /// Driver and its version.
    pub driver: String,
    /// In the order in which they ran.
    pub checks: Vec<Check>,
    /// True when every check passed.
    pub passed: bool,
}

impl Report {
    /// Puts checks together.
    pub fn new(device: &DeviceInfo, checks: Vec<Check>) -> Self {
        Self {
            software: concat!("umbravox ", env!("CARGO_PKG_VERSION")),
            device: device.name.clone(),
            driver: device.driver.clone(),
            passed: !checks.is_empty() && checks.iter().all(|check| check.passed),
            checks,
        }
    }
}

/// The largest of the differences that it is given.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Worst(Option<f64>);

impl Worst {
    /// One that is not a number counts as infinite.
    pub(super) fn add(&mut self, difference: f64) {
        let difference = if difference.is_nan() {
            f64::INFINITY
        } else {
            difference.abs()
        };
        self.0 = Some(self.0.map_or(difference, |worst| worst.max(difference)));
    }

    /// How far a number lies outside of a range.
    pub(super) fn add_beyond(&mut self, number: f64, [low, high]: [f64; 2]) {
        let inside = number >= low && number <= high;
        self.add(if inside {
            0.0
        } else {
            (low - number).max(number - high)
        });
    }

    /// Not a number when there was none: a check of nothing does not pass.
    pub(super) fn figure(self) -> f64 {
        self.0.unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(figures: &[f64]) -> Report {
        let device = DeviceInfo {
            index: 0,
            name: "device".into(),
            driver: "driver".into(),
            device_type: "cpu".into(),
            api_version: "1.2".into(),
            memory_mib: 1,
            usable: true,
            reason: None,
        };
        let check = |&figure| Check::new("a", "b", "c", figure, 1e-5);
        Report::new(&device, figures.iter().map(check).collect())
    }

    #[test]
    fn a_figure_beyond_its_bound_fails_the_report() {
        assert!(report(&[0.0, 1e-5]).passed);
        let broken = report(&[0.0, 1.1e-5, 1e-6]);
        assert!(!broken.passed);
        let passed: Vec<bool> = broken.checks.iter().map(|c| c.passed).collect();
        assert_eq!(passed, [true, false, true]);
        assert!(!report(&[f64::NAN]).passed);
        assert!(!report(&[f64::INFINITY]).passed);
        assert!(!report(&[]).passed);
    }

    #[test]
    fn what_was_not_measured_does_not_pass() {
        let mut worst = Worst::default();
        assert!(worst.figure().is_nan());
        worst.add(-2.0);
        worst.add(1.0);
        assert_eq!(worst.figure(), 2.0);
        worst.add_beyond(3.5, [1.0, 3.0]);
        assert_eq!(worst.figure(), 2.0);
        worst.add_beyond(-3.0, [1.0, 3.0]);
        assert_eq!(worst.figure(), 4.0);
        worst.add(f64::NAN);
        assert_eq!(worst.figure(), f64::INFINITY);
    }
}
