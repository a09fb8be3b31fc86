//! Settings as the text of a file.

use std::fmt::Write as _;

use toml::{Table, Value};

use super::error::SettingsError;
use super::field::{Field, join};
use super::ranges;
use super::robot::RobotSettings;
use super::version::SETTINGS_VERSION;

/// Settings that follow from the person unless a file sets them.
const OF_THE_PERSON: [&str; 2] = ["controller.space.min", "controller.space.max"];

/// Largest width of a comment.
const WIDTH: usize = 100;

const HEADER: &str = "\
# Settings of MOCA's controller. Whatever is left out of this file, or made a comment, keeps its default.
# Lengths in metres, angles in radians, times in seconds, forces in newtons, torques in newton metres.
# \"none\" is for what is not to be used. Programs read it with --settings FILE.
";

impl RobotSettings {
    /// The text of a file with all settings and their meanings. The range of the person's hand is written as a comment,
    /// since it follows from the person's stature unless a file sets it.
    ///
    /// # Errors
    /// [`SettingsError::Write`] for values that TOML cannot represent, such as a count above 2⁶³.
    pub fn to_toml(&self) -> Result<String, SettingsError> {
        let fail = |error: toml::ser::Error| SettingsError::Write(error.to_string());
        let values = Table::try_from(self).map_err(fail)?;
        let defaults = Table::try_from(Self::default()).map_err(fail)?;
        let mut text = format!("{HEADER}\nversion = {SETTINGS_VERSION}\n");
        table(&mut text, Field::root(), "", &values, &defaults);
        Ok(text)
    }
}

/// Writes a table: its settings, then the tables within it.
fn table(text: &mut String, field: &Field, path: &str, values: &Table, defaults: &Table) {
    let fields = || ordered(field, values);
    let is_table = |field: &Field| matches!(values.get(&field.name), Some(Value::Table(_)));
    for field in fields().filter(|field| !is_table(field)) {
        let (name, value) = (&field.name, values.get(&field.name));
        text.push('\n');
        comment(text, &meaning(field, &join(path, name), defaults.get(name)));
        let value = value.map_or_else(|| "\"none\"".to_owned(), inline);
        let is_default = values.get(name) == defaults.get(name);
        let hidden = if is_default && OF_THE_PERSON.contains(&&*join(path, name)) {
            comment(text, "Follows from the person's stature and hand unless it is set here.");
            "# "
        } else {
            ""
        };
        line(text, format_args!("{hidden}{name} = {value}"));
    }
    for field in fields() {
        let Some(Value::Table(within)) = values.get(&field.name) else { continue };
        let path = join(path, &field.name);
        let empty = Table::new();
        let defaults = match defaults.get(&field.name) {
            Some(Value::Table(defaults)) => defaults,
            _ => &empty,
        };
        text.push('\n');
        comment(text, &meaning(field, &path, None));
        line(text, format_args!("[{path}]"));
        table(text, field, &path, within, defaults);
    }
}

/// The fields of a table in the order of the values, then those without values.
fn ordered<'a>(field: &'a Field, values: &'a Table) -> impl Iterator<Item = &'a Field> {
    let all = || field.fields.iter().flatten();
    let with_value = values.keys().filter_map(|name| field.get(name));
    with_value.chain(all().filter(|field| !values.contains_key(&field.name)))
}

/// The meaning of a setting, with its default and its choices if the documentation does not name them.
fn meaning(field: &Field, path: &str, default: Option<&Value>) -> String {
    let mut meaning = field.meaning.clone();
    let mut add = |sentence: String| {
        if !meaning.is_empty() {
            meaning.push(' ');
        }
        meaning += &sentence;
    };
    if !field.choices.is_empty() {
        add(format!("One of {}.", field.choices.join(", ")));
    }
    if let Some(default) = default
        && !field.meaning.contains("efault")
    {
        add(format!("Default {}.", inline(default)));
    }
    if let Some(range) = ranges::range_of(path) {
        add(format!("From {}.", ranges::words(range)).replace("From at", "At"));
    }
    if field.is_optional {
        add("May be \"none\".".to_owned());
    }
    meaning
}

/// A value in TOML, with long lists over several lines.
fn inline(value: &Value) -> String {
    match value {
        Value::Array(items) if items.iter().any(|item| item.is_table() || item.is_array()) => {
            let items = items.iter().map(|item| format!("    {},\n", inline(item)));
            format!("[\n{}]", items.collect::<String>())
        }
        Value::Table(table) => {
            let entries = table.iter().map(|(name, value)| format!("{name} = {}", inline(value)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
        value => value.to_string(),
    }
}

fn comment(text: &mut String, words: &str) {
    let mut column = 0;
    for word in words.split_whitespace() {
        if column > 0 && column + 1 + word.chars().count() > WIDTH {
            text.push('\n');
            column = 0;
        }
        let lead = if column == 0 { "# " } else { " " };
        text.push_str(lead);
        text.push_str(word);
        column += lead.len() + word.chars().count();
    }
    if column > 0 {
        text.push('\n');
    }
}

fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{line}");
}
