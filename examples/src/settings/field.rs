//! The tree of settings with their meanings, derived from the types.

use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};

use super::robot::RobotSettings;

/// A setting, or a table of settings.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) name: String,
    /// The first paragraph of its documentation.
    pub(super) meaning: String,
    /// True if it may be "none".
    pub(super) is_optional: bool,
    /// The possible words of a choice.
    pub(super) choices: Vec<String>,
    /// The fields of a table; `None` for a setting.
    pub(super) fields: Option<Vec<Field>>,
}

impl Field {
    /// The table of all settings.
    pub(super) fn root() -> &'static Self {
        static ROOT: LazyLock<Field> = LazyLock::new(|| {
            let mut settings = SchemaSettings::draft2020_12();
            settings.inline_subschemas = true;
            let schema = settings.into_generator().into_root_schema_for::<RobotSettings>();
            Field::new("", schema.as_value(), false)
        });
        &ROOT
    }

    fn new(name: &str, schema: &Value, is_optional: bool) -> Self {
        let text = |key: &str| schema.get(key).and_then(Value::as_str).unwrap_or_default();
        let meaning = plain(text("description"));
        // An optional table is one of two alternatives, one of which is null.
        if let Some(kinds) = schema.get("anyOf").and_then(Value::as_array)
            && let Some(table) = kinds.iter().find(|kind| kind.get("properties").is_some())
        {
            return Self { meaning, ..Self::new(name, table, true) };
        }
        let nullable = |kinds: &Vec<Value>| kinds.iter().any(|kind| kind == "null");
        let is_optional =
            is_optional || schema.get("type").and_then(Value::as_array).is_some_and(nullable);
        let of = |(name, schema): (&String, &Value)| Self::new(name, schema, false);
        let fields = |map: &Map<String, Value>| map.iter().map(of).collect();
        Self {
            name: name.to_owned(),
            meaning,
            is_optional,
            choices: choices(schema),
            fields: schema.get("properties").and_then(Value::as_object).map(fields),
        }
    }

    /// The field of the table with this name.
    pub(super) fn get(&self, name: &str) -> Option<&Self> {
        self.fields.iter().flatten().find(|field| field.name == name)
    }

    /// The paths of all settings below, each after `prefix`.
    pub(super) fn paths(&self, prefix: &str) -> Vec<String> {
        let below = |field: &Self| {
            let path = join(prefix, &field.name);
            let own = std::iter::once(path.clone());
            own.chain(field.paths(&path)).collect::<Vec<_>>()
        };
        self.fields.iter().flatten().flat_map(below).collect()
    }
}

/// The path extended by one name.
pub(super) fn join(prefix: &str, name: &str) -> String {
    if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") }
}

fn choices(schema: &Value) -> Vec<String> {
    let word = |value: &Value| value.as_str().map(str::to_owned);
    let constant = |kind: &Value| kind.get("const").and_then(word);
    let listed = schema.get("enum").and_then(Value::as_array);
    let described = schema.get("oneOf").and_then(Value::as_array);
    match (listed, described) {
        (Some(words), _) => words.iter().filter_map(word).collect(),
        (None, Some(kinds)) => kinds.iter().filter_map(constant).collect(),
        (None, None) => Vec::new(),
    }
}

/// The first paragraph of documentation as plain text without links and escapes.
fn plain(documentation: &str) -> String {
    let paragraph = documentation.split("\n\n").next().unwrap_or_default();
    let words: Vec<&str> = paragraph.split_whitespace().collect();
    let text = words.join(" ").replace("\\[", "[").replace("\\]", "]").replace('`', "");
    unlinked(&text)
}

/// Replaces [text](place) by text, and [`name`] by name; brackets around units stay.
fn unlinked(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        plain.push_str(before);
        let Some((inside, behind)) = after.split_once(']') else {
            rest = after;
            continue;
        };
        let target = behind.strip_prefix('(').and_then(|place| place.split_once(')'));
        let is_name = inside.len() > 3
            && inside.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | ':'))
            && !inside.contains("rad");
        match target {
            Some((_, behind)) => {
                plain.push_str(inside);
                rest = behind;
            }
            None if is_name => {
                plain.push_str(inside);
                rest = behind;
            }
            None => {
                plain.push('[');
                plain.push_str(inside);
                plain.push(']');
                rest = behind;
            }
        }
    }
    plain + rest
}
