//! Checks keys, types and names of a scene's JSON against the scene's own JSON Schema.
//!
//! serde alone reports an unknown key inside a tagged enum without its place, and lists what it wants in Rust's
//! terms. The schema is derived from the same types, so what is published is what is enforced.
//! Only the keywords that `schemars` derives for the scene are interpreted.

use serde_json::{Map, Value};

use crate::error::{Error, Result};
use crate::scene::schema;

/// Checks a whole scene.
///
/// # Errors
/// [`Error::Invalid`] for the first unknown or missing key, wrong type or unknown name.
pub(super) fn check(scene: &Value) -> Result<()> {
    check_at(scene, schema::inlined(), "")
}

fn check_at(value: &Value, schema: &Value, at: &str) -> Result<()> {
    if let Some(choices) = alternatives(schema) {
        return check_alternatives(value, schema, choices, at);
    }
    if !types(schema).any(|t| has_type(value, t)) {
        return Err(mismatch(value, schema, at));
    }
    match value {
        Value::Object(object) => check_object(object, schema, at),
        Value::Array(items) => check_list(value, items, schema, at),
        _ => check_scalar(value, schema, at),
    }
}

/// Names, tagged variants, or "this or null".
fn check_alternatives(value: &Value, schema: &Value, choices: &[Value], at: &str) -> Result<()> {
    if choices.iter().any(|c| c.get("const") == Some(value)) {
        return Ok(());
    }
    // "These variants or null".
    let nested = choices.iter().find(|c| alternatives(c).is_some());
    if let Some(variants) = nested.filter(|_| !value.is_null()) {
        return check_at(value, variants, at);
    }
    if let Value::Object(object) = value {
        let objects: Vec<&Value> = choices
            .iter()
            .filter(|c| c["properties"].is_object())
            .collect();
        match objects[..] {
            [] => {}
            [only] if !tag_of(only).is_string() => return check_at(value, only, at),
            _ => return check_variant(object, value, &objects, at),
        }
    }
    let fits = |choice: &&Value| types(choice).any(|t| has_type(value, t));
    match choices
        .iter()
        .filter(|c| c.get("const").is_none())
        .find(fits)
    {
        Some(choice) => check_at(value, choice, at),
        None => Err(mismatch(value, schema, at)),
    }
}

/// An object whose `type` says which keys it has.
fn check_variant(
    object: &Map<String, Value>,
    value: &Value,
    variants: &[&Value],
    at: &str,
) -> Result<()> {
    let tags = || names(variants.iter().map(|v| tag_of(v)));
    let at_tag = join(at, "type");
    let Some(tag) = object.get("type") else {
        return Err(Error::invalid(
            at_tag,
            format!("missing; give one of {}", tags()),
        ));
    };
    match variants.iter().find(|v| tag_of(v) == tag) {
        Some(variant) => check_at(value, variant, at),
        None => Err(Error::invalid(
            at_tag,
            format!(
                "{} is not available; this version has {}",
                show(tag),
                tags()
            ),
        )),
    }
}

fn tag_of(variant: &Value) -> &Value {
    &variant["properties"]["type"]["const"]
}

fn check_object(object: &Map<String, Value>, schema: &Value, at: &str) -> Result<()> {
    let Some(properties) = schema["properties"].as_object() else {
        return check_entries(object, schema, at);
    };
    for (key, value) in object {
        match properties.get(key) {
            Some(property) => check_at(value, property, &join(at, key))?,
            None => return Err(unknown_key(key, properties, at)),
        }
    }
    let required = schema["required"].as_array().into_iter().flatten();
    for key in required.filter_map(Value::as_str) {
        if !object.contains_key(key) {
            let wanted = describe(&schema["properties"][key]);
            return Err(Error::invalid(
                join(at, key),
                format!("missing; give {wanted}"),
            ));
        }
    }
    Ok(())
}

/// Entries whose keys are whole numbers, the only kind of map that a scene has.
fn check_entries(object: &Map<String, Value>, schema: &Value, at: &str) -> Result<()> {
    let Some(entry) = schema["patternProperties"]
        .as_object()
        .and_then(|patterns| patterns.values().next())
    else {
        return Ok(());
    };
    object.iter().try_for_each(|(key, value)| {
        let place = join(at, key);
        if key.parse::<i32>().is_err() {
            return Err(Error::invalid(
                place,
                "unknown key; keys here are whole numbers of 32 bits",
            ));
        }
        check_at(value, entry, &place)
    })
}

fn check_list(value: &Value, items: &[Value], schema: &Value, at: &str) -> Result<()> {
    let count = items.len() as u64;
    let too_few = schema["minItems"].as_u64().is_some_and(|min| count < min);
    let too_many = schema["maxItems"].as_u64().is_some_and(|max| count > max);
    if too_few || too_many {
        return Err(mismatch(value, schema, at));
    }
    items
        .iter()
        .enumerate()
        .try_for_each(|(i, item)| check_at(item, &schema["items"], &join(at, &i.to_string())))
}

fn check_scalar(value: &Value, schema: &Value, at: &str) -> Result<()> {
    let below = |min: f64| value.as_f64().is_some_and(|v| v < min);
    let above = |max: f64| value.as_f64().is_some_and(|v| v > max);
    let listed = schema["enum"].as_array();
    if schema["minimum"].as_f64().is_some_and(below)
        || largest(schema).is_some_and(above)
        || listed.is_some_and(|names| !names.contains(value))
    {
        return Err(mismatch(value, schema, at));
    }
    Ok(())
}

fn unknown_key(key: &str, properties: &Map<String, Value>, at: &str) -> Error {
    let similarity = |valid: &str| strsim::damerau_levenshtein(&key.to_lowercase(), valid);
    let nearest = properties
        .keys()
        .min_by_key(|valid| similarity(valid))
        .map_or("", String::as_str);
    let valid: Vec<&str> = properties.keys().map(String::as_str).collect();
    Error::invalid(
        join(at, key),
        format!(
            "unknown key; did you mean \"{nearest}\"? Valid here: {}",
            valid.join(", ")
        ),
    )
}

fn mismatch(value: &Value, schema: &Value, at: &str) -> Error {
    let message = if value.is_string() && listed_names(schema).is_some() {
        // The names of other versions' models are no typing errors: say what there is, not what looks alike.
        let available = listed_names(schema).unwrap_or_default();
        format!(
            "{} is not available; this version has {available}",
            show(value)
        )
    } else {
        format!("{} is not valid; give {}", show(value), describe(schema))
    };
    Error::invalid(if at.is_empty() { "scene" } else { at }, message)
}

/// The names that a schema of names allows.
fn listed_names(schema: &Value) -> Option<String> {
    if let Some(listed) = schema["enum"].as_array() {
        return Some(names(listed.iter()));
    }
    let constants: Option<Vec<&Value>> = alternatives(schema)?
        .iter()
        .map(|c| c.get("const"))
        .collect();
    constants.map(|c| names(c.into_iter()))
}

/// What would be valid, in words.
fn describe(schema: &Value) -> String {
    if let Some(listed) = listed_names(schema) {
        let several = listed.contains(", ");
        return format!("{}{listed}", if several { "one of " } else { "" });
    }
    if let Some(choices) = alternatives(schema) {
        let variants = choices.iter().filter(|choice| tag_of(choice).is_string());
        let tags = names(variants.map(tag_of));
        if !tags.is_empty() {
            return format!("an object whose \"type\" is one of {tags}");
        }
        let words: Vec<String> = choices.iter().map(describe).collect();
        return words.join(" or ");
    }
    let words: Vec<String> = types(schema).map(|t| describe_type(t, schema)).collect();
    words.join(" or ")
}

fn describe_type(name: &str, schema: &Value) -> String {
    match name {
        "number" => "a number".into(),
        "integer" => match (schema["minimum"].as_i64(), largest(schema)) {
            (Some(min), Some(max)) => format!("a whole number from {min} to {max}"),
            (Some(min), None) => format!("a whole number >= {min}"),
            _ => "a whole number".into(),
        },
        "boolean" => "true or false".into(),
        "string" => "a string".into(),
        "array" => describe_list(schema),
        "object" => match schema["properties"].as_object() {
            Some(properties) => {
                let keys: Vec<&str> = properties.keys().map(String::as_str).collect();
                format!("an object with {}", keys.join(", "))
            }
            None => "an object".into(),
        },
        other => other.into(),
    }
}

fn describe_list(schema: &Value) -> String {
    let item = describe(&schema["items"]);
    let count = schema["minItems"].as_u64();
    let count = count.map(|count| format!("{count} ")).unwrap_or_default();
    match item.strip_prefix("a ") {
        Some(one) if one.contains("number") => {
            format!("a list of {count}{}", one.replacen("number", "numbers", 1))
        }
        _ => format!("a list of {count}items, each {item}"),
    }
}

fn alternatives(schema: &Value) -> Option<&[Value]> {
    let list = schema.get("oneOf").or_else(|| schema.get("anyOf"))?;
    list.as_array().map(Vec::as_slice)
}

fn types(schema: &Value) -> impl Iterator<Item = &str> {
    let one = schema["type"].as_str();
    let several = schema["type"].as_array().into_iter().flatten();
    one.into_iter().chain(several.filter_map(Value::as_str))
}

fn has_type(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    }
}

/// Upper bound of an integer; schemars states that of 32 bits by `format` alone.
fn largest(schema: &Value) -> Option<f64> {
    let of_format = match schema["format"].as_str() {
        Some("uint32") => Some(f64::from(u32::MAX)),
        Some("int32") => Some(f64::from(i32::MAX)),
        _ => None,
    };
    schema["maximum"].as_f64().or(of_format)
}

fn names<'a>(values: impl Iterator<Item = &'a Value>) -> String {
    values.map(Value::to_string).collect::<Vec<_>>().join(", ")
}

/// A value as the user wrote it, cut short.
pub(super) fn show(value: &Value) -> String {
    const LONGEST: usize = 60;
    let text = value.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((cut, _)) => format!("{}...", &text[..cut]),
        None => text,
    }
}

fn join(at: &str, key: &str) -> String {
    if at.is_empty() {
        key.to_owned()
    } else {
        format!("{at}.{key}")
    }
}
