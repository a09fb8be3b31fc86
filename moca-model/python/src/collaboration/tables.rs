//! Tables of settings from and to Python.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};
use toml::{Table, Value};

use crate::failure::{Failure, Result};

/// The word for a setting that is not used.
const NONE: &str = "none";

/// Reads a table: a dict, or the path of a settings file.
pub(super) fn read(settings: &Bound<'_, PyAny>) -> Result<Table> {
    if let Ok(dict) = settings.cast::<PyDict>() {
        return table(dict);
    }
    let path: std::path::PathBuf = settings.extract().map_err(|_| {
        Failure::type_of_argument("settings must be a dict of tables, or the path of a file")
    })?;
    let text = std::fs::read_to_string(&path)?;
    text.parse::<Table>().map_err(|error| {
        Failure::value(format!("{}: {}", path.display(), error.to_string().trim_end()))
    })
}

fn table(dict: &Bound<'_, PyDict>) -> Result<Table> {
    let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract()?;
        let value = value_of(&key, &value)?;
        Ok((key, value))
    };
    dict.iter().map(entry).collect()
}

fn value_of(name: &str, value: &Bound<'_, PyAny>) -> Result<Value> {
    if value.is_none() {
        return Ok(Value::String(NONE.to_owned()));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(Value::Table(table(dict)?));
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    if let Ok(number) = value.extract::<i64>() {
        return Ok(Value::Integer(number));
    }
    if let Ok(number) = value.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    let Ok(items) = value.try_iter() else {
        let kind = value.get_type();
        let text = format!("setting {name} is a {kind}; give a number, a word, a list or a dict");
        return Err(Failure::type_of_argument(text));
    };
    Ok(Value::Array(items.map(|item| value_of(name, &item?)).collect::<Result<_>>()?))
}

/// Replaces values of a table by those of another one. The word "none" removes a value.
pub(super) fn overlay(base: &mut Table, over: Table) {
    for (name, value) in over {
        match (base.get_mut(&name), value) {
            (_, Value::String(word)) if word == NONE => {
                base.remove(&name);
            }
            (Some(Value::Table(base)), Value::Table(over)) => overlay(base, over),
            (_, value) => {
                base.insert(name, value);
            }
        }
    }
}

/// Converts a value to Python.
pub(super) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Float(number) => number.into_pyobject(py)?.into_any(),
        Value::Boolean(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        Value::Datetime(time) => time.to_string().into_pyobject(py)?.into_any(),
        Value::Array(items) => {
            let items = items.iter().map(|item| to_python(py, item));
            items.collect::<PyResult<Vec<_>>>()?.into_pyobject(py)?.into_any()
        }
        Value::Table(table) => {
            let dict = PyDict::new(py);
            for (name, value) in table {
                dict.set_item(name, to_python(py, value)?)?;
            }
            dict.into_any()
        }
    })
}
