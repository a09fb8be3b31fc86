//! Reads the pickles of PyTorch's checkpoints without executing anything.
//!
//! A pickle is a program for a stack machine, which may import and call anything that Python has.
//! The machine here creates numbers, texts, tuples, lists and dicts. It knows the imported names
//! that a state dict needs, and interprets them as data. All other objects are inert.
//! <https://docs.python.org/3/library/pickletools.html> lists the opcodes.

mod machine;
mod rebuild;
mod value;

pub(super) use machine::run;
pub(super) use value::{Id, Storage, Value, View};

/// Values that a pickle created, and its result.
#[derive(Debug)]
pub(super) struct Pickle {
    values: Vec<Value>,
    root: Id,
}

impl Pickle {
    pub(super) fn root(&self) -> &Value {
        self.value(self.root)
    }

    pub(super) fn value(&self, id: Id) -> &Value {
        self.values.get(id.0).unwrap_or(&Value::Inert)
    }

    /// Returns the value of a text key in a dict, the last one if there are several.
    pub(super) fn entry<'a>(&'a self, dict: &Value, name: &str) -> Option<&'a Value> {
        let Value::Dict(entries) = dict else {
            return None;
        };
        entries
            .iter()
            .rev()
            .find(|&&(key, _)| matches!(self.value(key), Value::Text(key) if &**key == name))
            .map(|&(_, value)| self.value(value))
    }

    /// Returns every storage that the pickle names.
    pub(super) fn storages(&self) -> impl Iterator<Item = &Storage> {
        self.values.iter().filter_map(|value| match value {
            Value::Storage(storage) => Some(&**storage),
            _ => None,
        })
    }
}
