//! Numbers of transfer function files, checked where they stand.

use serde_json::Value;

use super::MAX_POINTS;
use super::map::Node;
use crate::error::{Error, Result};

/// A place in a file, for messages: `name.json: 0.RGBPoints.7`.
pub(super) struct Place {
    file: String,
    path: String,
}

impl Place {
    pub(super) fn root(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            path: String::new(),
        }
    }

    pub(super) fn at(&self, part: &str) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        Self {
            file: self.file.clone(),
            path: format!("{}{dot}{part}", self.path),
        }
    }

    pub(super) fn invalid(&self, message: String) -> Error {
        let at = match self.path.as_str() {
            "" => self.file.clone(),
            path => format!("{}: {path}", self.file),
        };
        Error::invalid(at, message.chars().take(400).collect::<String>())
    }

    /// An error of another check, with the file before its place.
    pub(super) fn around(&self, error: Error) -> Error {
        match error {
            Error::Invalid { at, message } => self.at(&at).invalid(message),
            other => other,
        }
    }

    /// A number in the file's text.
    pub(super) fn number(&self, text: &str) -> Result<f64> {
        let number = text.trim().parse().ok();
        number
            .filter(|n: &f64| n.abs() <= f64::from(f32::MAX))
            .ok_or_else(|| self.invalid(format!("{text:?} is not a finite number")))
    }

    /// A number in JSON.
    pub(super) fn json_number(&self, value: &Value) -> Result<f64> {
        let number = value.as_f64().filter(|n| n.abs() <= f64::from(f32::MAX));
        number.ok_or_else(|| self.invalid(format!("{value} is not a finite number")))
    }

    /// A list of numbers in JSON.
    pub(super) fn json_numbers(&self, value: &Value) -> Result<Vec<f64>> {
        let Some(items) = value.as_array() else {
            return Err(self.invalid(format!("{value} is not a list of numbers")));
        };
        let number = |(i, item)| self.at(&usize::to_string(&i)).json_number(item);
        items.iter().enumerate().map(number).collect()
    }

    /// Checks that there are points, that they ascend, and that `y`, midpoint and sharpness are shares.
    pub(super) fn nodes<const N: usize>(&self, nodes: Vec<Node<N>>) -> Result<Vec<Node<N>>> {
        if nodes.is_empty() || nodes.len() > MAX_POINTS {
            return Err(self.invalid(format!(
                "has {} points; valid are 1 to {MAX_POINTS}",
                nodes.len()
            )));
        }
        let mut previous = f64::NEG_INFINITY;
        for (i, node) in nodes.iter().enumerate() {
            let place = self.at(&i.to_string());
            if node.x < previous {
                return Err(place.invalid(format!(
                    "value {} is below {previous}, that of the point before; points ascend",
                    node.x
                )));
            }
            previous = node.x;
            let shares = node.y.iter().chain([&node.sharpness]);
            if let Some(wrong) = shares.into_iter().find(|y| !(0.0..=1.0).contains(*y)) {
                return Err(place.invalid(format!("{wrong} is not a number from 0 to 1")));
            }
            if !(node.midpoint > 0.0 && node.midpoint < 1.0) {
                return Err(
                    place.invalid(format!("midpoint {} is not between 0 and 1", node.midpoint))
                );
            }
        }
        Ok(nodes)
    }

    /// Nodes of a flat list `x y… x y…`.
    pub(super) fn flat<const N: usize>(&self, numbers: &[f64]) -> Result<Vec<Node<N>>> {
        if !numbers.len().is_multiple_of(N + 1) {
            return Err(self.invalid(format!(
                "has {} numbers; a point has {}",
                numbers.len(),
                N + 1
            )));
        }
        let nodes = numbers.chunks_exact(N + 1).filter_map(|point| {
            let (x, y) = point.split_first()?;
            Some(Node::linear(*x, y.try_into().ok()?))
        });
        self.nodes(nodes.collect())
    }
}
