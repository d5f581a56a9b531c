//! The scene file's JSON Schema (draft 2020-12).

use std::sync::OnceLock;

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use super::Scene;

/// The key by which a scene file names its schema to editors.
pub(super) const SCHEMA_KEY: &str = "$schema";

/// JSON Schema of the scene file, with descriptions and defaults. Ranges stand in the descriptions;
/// [`Scene::validate`] enforces them.
pub fn schema() -> Value {
    of_scene(SchemaSettings::draft2020_12())
}

fn of_scene(settings: SchemaSettings) -> Value {
    let mut schema = settings
        .into_generator()
        .into_root_schema_for::<Scene>()
        .to_value();
    schema["properties"][SCHEMA_KEY] = json!({
        "type": "string",
        "format": "uri-reference",
        "description": "Where this schema lies, for editors.",
    });
    schema
}

/// The same without references, for walking along with a value.
pub(super) fn inlined() -> &'static Value {
    static INLINED: OnceLock<Value> = OnceLock::new();
    INLINED.get_or_init(|| {
        of_scene(SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true))
    })
}
