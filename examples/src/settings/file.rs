//! Reading of settings files.

use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::error::SettingsError;
use super::field::Field;
use super::ranges::{self, OutOfRange};
use super::robot::RobotSettings;
use super::version::SETTINGS_VERSION;
use crate::program::read_text;

/// Largest settings file: a hundred times one with all settings (bytes).
const LARGEST: u64 = 4 << 20;
/// The word for a setting that is not used.
const NONE: &str = "none";

/// The content of a settings file.
#[derive(Clone, Debug, PartialEq)]
pub struct SettingsFile {
    entries: Vec<Entry>,
}

/// A setting.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    names: Vec<String>,
    line: usize,
    /// The value; `None` if the setting is not used.
    value: Option<Value>,
}

/// Reads a file along the tree of fields.
struct Walk {
    lines: Lines,
    root: &'static Field,
    entries: Vec<Entry>,
}

impl SettingsFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`SettingsError::Read`], and those of [`parse`](Self::parse).
    pub fn read(path: &Path) -> Result<Self, SettingsError> {
        let fail = |source| SettingsError::Read { path: path.to_owned(), source };
        Self::parse(&read_text(path, LARGEST).map_err(fail)?)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// An error with its line: text that is not TOML, another version, an unknown setting, or a value of the wrong
    /// kind.
    pub fn parse(text: &str) -> Result<Self, SettingsError> {
        let lines = Lines::of(text);
        let fail = |error: toml::de::Error| SettingsError::Syntax {
            line: lines.at(&error.span().unwrap_or_default()),
            message: error.message().to_owned(),
        };
        let document = DeTable::parse(text).map_err(fail)?;
        let values: Table = toml::from_str(text).map_err(fail)?;
        check_version(&lines, document.get_ref(), &values)?;
        let root = Field::root();
        let mut walk = Walk { lines, root, entries: Vec::new() };
        walk.table(document.get_ref(), &values, root, &[])?;
        let file = Self { entries: walk.entries };
        file.check_kinds()?;
        Ok(file)
    }

    /// The settings `base` with the values of the file, checked.
    ///
    /// # Errors
    /// [`SettingsError::Range`] for a value outside its range, and for values that do not fit together.
    pub fn over(&self, base: &RobotSettings) -> Result<RobotSettings, SettingsError> {
        let settings = self.unchecked_over(base)?;
        let table = as_table(&settings)?;
        let range = |error: moca_model::Error| {
            let reason = error.to_string();
            match (self.line_of(&reason), ranges::check(&table)) {
                // If the error does not name the setting, the setting's range does.
                (None, Err(OutOfRange { path, reason })) => {
                    SettingsError::Range { line: self.line_of(&path), reason }
                }
                (line, _) => SettingsError::Range { line, reason },
            }
        };
        settings.validate().map_err(range)?;
        // Checks the given values and those that depend on them.
        ranges::check(&table).map_err(|OutOfRange { path, reason }| SettingsError::Range {
            line: self.line_of(&path),
            reason,
        })?;
        Ok(settings)
    }

    /// The settings `base` with the values of the file, not checked: lists may be those of a robot with other joints.
    ///
    /// # Errors
    /// [`SettingsError::Range`] for values that do not fit together.
    pub fn unchecked_over(&self, base: &RobotSettings) -> Result<RobotSettings, SettingsError> {
        let mut table = as_table(base)?;
        for entry in &self.entries {
            entry.put(&mut table);
        }
        RobotSettings::deserialize(Value::Table(table))
            .map_err(|error| SettingsError::Range { line: None, reason: error.to_string() })
    }

    /// True if the file has this setting, or one of this table.
    pub fn has(&self, path: &str) -> bool {
        let names: Vec<&str> = path.split('.').collect();
        self.entries
            .iter()
            .any(|entry| entry.names.iter().map(String::as_str).take(names.len()).eq(names.clone()))
    }

    /// Checks each value alone over the defaults, so that an error has its line.
    fn check_kinds(&self) -> Result<(), SettingsError> {
        let defaults = as_table(&RobotSettings::default())?;
        let mut all = defaults.clone();
        self.entries.iter().for_each(|entry| entry.put(&mut all));
        if RobotSettings::deserialize(Value::Table(all)).is_ok() {
            return Ok(());
        }
        for entry in &self.entries {
            let mut table = defaults.clone();
            entry.put(&mut table);
            if let Err(error) = RobotSettings::deserialize(Value::Table(table)) {
                return Err(SettingsError::Value {
                    line: entry.line,
                    path: entry.names.join("."),
                    reason: error.message().to_owned(),
                });
            }
        }
        Ok(())
    }

    /// The line of the setting that a message names, by the end of its path.
    fn line_of(&self, message: &str) -> Option<usize> {
        let named = |entry: &&Entry| {
            let ends = |count: usize| {
                let start = entry.names.len().checked_sub(count)?;
                message.contains(&entry.names.get(start..)?.join(".")).then_some(count)
            };
            (1..=entry.names.len()).filter_map(ends).max()
        };
        let entry = self.entries.iter().filter(|entry| named(entry).is_some()).max_by_key(named)?;
        Some(entry.line)
    }
}

impl Entry {
    /// Writes the value into a table of all settings.
    fn put(&self, table: &mut Table) {
        let Some((last, path)) = self.names.split_last() else { return };
        let mut place = table;
        for name in path {
            let within = place.entry(name.clone()).or_insert_with(|| Value::Table(Table::new()));
            let Value::Table(within) = within else { return };
            place = within;
        }
        match (&self.value, place.get_mut(last)) {
            (None, _) => {
                place.remove(last);
            }
            (Some(Value::Table(new)), Some(Value::Table(old))) => old.extend(new.clone()),
            (Some(value), _) => {
                place.insert(last.clone(), value.clone());
            }
        }
    }
}

impl Walk {
    fn table(
        &mut self,
        document: &DeTable<'_>,
        values: &Table,
        field: &Field,
        above: &[String],
    ) -> Result<(), SettingsError> {
        for (key, place) in document {
            let name: &str = key.get_ref();
            if above.is_empty() && name == "version" {
                continue;
            }
            let line = self.lines.at(&key.span());
            let names: Vec<String> = above.iter().cloned().chain([name.to_owned()]).collect();
            let Some(field) = field.get(name) else {
                let path = names.join(".");
                let nearest = self.nearest(&path);
                return Err(SettingsError::Unknown { line, path, nearest });
            };
            let Some(value) = values.get(name) else { continue };
            self.field(line, place, value, field, names)?;
        }
        Ok(())
    }

    fn field(
        &mut self,
        line: usize,
        place: &Spanned<DeValue<'_>>,
        value: &Value,
        field: &Field,
        names: Vec<String>,
    ) -> Result<(), SettingsError> {
        if field.is_optional && value.as_str() == Some(NONE) {
            self.entries.push(Entry { names, line, value: None });
            return Ok(());
        }
        match (&field.fields, place.get_ref(), value) {
            (Some(_), DeValue::Table(document), Value::Table(values)) => {
                let from = self.entries.len();
                self.table(document, values, field, &names)?;
                // An optional table is replaced as a whole.
                if field.is_optional {
                    self.entries.truncate(from);
                    self.entries.push(Entry { names, line, value: Some(value.clone()) });
                }
                Ok(())
            }
            (Some(_), ..) => Err(SettingsError::NotATable { line, path: names.join(".") }),
            (None, ..) => {
                self.entries.push(Entry { names, line, value: Some(value.clone()) });
                Ok(())
            }
        }
    }

    /// The known path that is most similar to an unknown one.
    fn nearest(&self, path: &str) -> String {
        let distance = |known: &String| {
            let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
            // The name has precedence, so that a setting in the wrong table is found.
            let name = strsim::damerau_levenshtein(&last(known), &last(path));
            (name, strsim::damerau_levenshtein(known, path))
        };
        self.root.paths("").into_iter().min_by_key(distance).unwrap_or_default()
    }
}

fn as_table(settings: &RobotSettings) -> Result<Table, SettingsError> {
    Table::try_from(settings).map_err(|error| SettingsError::Write(error.to_string()))
}

fn check_version(
    lines: &Lines,
    document: &DeTable<'_>,
    values: &Table,
) -> Result<(), SettingsError> {
    let Some((key, _)) = document.iter().find(|(key, _)| key.get_ref() == "version") else {
        return Err(SettingsError::NoVersion);
    };
    match values.get("version") {
        Some(Value::Integer(SETTINGS_VERSION)) => Ok(()),
        found => Err(SettingsError::Version {
            line: lines.at(&key.span()),
            found: found.map(ToString::to_string).unwrap_or_default(),
        }),
    }
}

/// The line ends of a text.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(place, _)| place).collect())
    }

    /// The line in which a part of the text begins, from 1.
    fn at(&self, span: &Range<usize>) -> usize {
        self.0.partition_point(|&end| end < span.start) + 1
    }
}
