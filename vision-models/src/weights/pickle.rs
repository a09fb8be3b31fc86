//! The pickles of PyTorch's checkpoints, read without running anything.
//!
//! A pickle is a program for a stack machine, which may import and call whatever Python has. The
//! machine here makes numbers, text, tuples, lists and dicts; of the names that a pickle imports it
//! knows those that a state dict takes, and interprets them as data. Everything else is inert.
//! <https://docs.python.org/3/library/pickletools.html> lists the opcodes.

mod machine;
mod rebuild;
mod value;

pub(super) use machine::run;
pub(super) use value::{Id, Storage, Value, View};

/// All values that a pickle made, and which of them is its result.
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

    /// The value of a text key in a dict, the last one if there are several.
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

    /// Every storage that the pickle names.
    pub(super) fn storages(&self) -> impl Iterator<Item = &Storage> {
        self.values.iter().filter_map(|value| match value {
            Value::Storage(storage) => Some(&**storage),
            _ => None,
        })
    }
}
