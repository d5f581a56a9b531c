//! Changes to a scene before it is parsed: `march.step=0.25`.

use serde_json::{Map, Value};

use super::shape::show;
use crate::error::{Error, Result};

/// One value put into the JSON of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    keys: Vec<String>,
    value: Value,
}

impl Override {
    /// Parses `PLACE=VALUE`. The place is dotted (`transfer_function.points.0.opacity`) or a JSON pointer
    /// (RFC 6901, `/march/step`); the value is JSON, or else taken as a string.
    ///
    /// # Errors
    /// [`Error::Invalid`] without `=` or with an empty key.
    pub fn parse(text: &str) -> Result<Self> {
        let usage = |wrong: &str| {
            Error::invalid(
                format!("--set {text}"),
                format!("{wrong}; give PLACE=VALUE, as in march.step=0.25 or /march/step=0.25"),
            )
        };
        let (place, value) = text
            .split_once('=')
            .ok_or_else(|| usage("there is no \"=\""))?;
        let keys: Vec<String> = match place.strip_prefix('/') {
            Some(pointer) => pointer
                .split('/')
                .map(|key| key.replace("~1", "/").replace("~0", "~"))
                .collect(),
            None => place.split('.').map(str::to_owned).collect(),
        };
        if keys.iter().any(String::is_empty) {
            return Err(usage("the place has an empty key"));
        }
        let value = serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.to_owned()));
        Ok(Self { keys, value })
    }

    /// Whether it sets the value at a place.
    pub(super) fn is_at(&self, keys: &[&str]) -> bool {
        self.keys == keys
    }

    /// Puts the value in its place. Objects that are missing or `null` on the way there are created.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the way leads through a number, string or boolean, or outside of a list.
    pub(super) fn apply(&self, root: &mut Value) -> Result<()> {
        let mut place = root;
        for (depth, key) in self.keys.iter().enumerate() {
            let reached = || self.keys[..depth].join(".");
            if place.is_null() {
                *place = Value::Object(Map::new());
            }
            place = match place {
                Value::Object(object) => object.entry(key.clone()).or_insert(Value::Null),
                Value::Array(items) => {
                    let count = items.len();
                    key.parse::<usize>()
                        .ok()
                        .and_then(|index| items.get_mut(index))
                        .ok_or_else(|| {
                            Error::invalid(
                                reached(),
                                format!(
                                    "{key:?} is not an item of this list; it has {count}, counted from 0"
                                ),
                            )
                        })?
                }
                scalar => {
                    return Err(Error::invalid(
                        reached(),
                        format!("{} has no part {key:?}; set it as a whole", show(scalar)),
                    ));
                }
            };
        }
        *place = self.value.clone();
        Ok(())
    }
}
