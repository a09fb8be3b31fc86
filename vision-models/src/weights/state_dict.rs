//! Finds the state dict in the saved object.

use std::collections::BTreeMap;

use super::{
    budget::Budget,
    error::{of_tensor, refused},
    pickle::{Pickle, Value, View},
};
use crate::error::Error;
use crate::excerpt::Excerpt;

/// The keys under which training programs save a state dict.
const WRAPPERS: &[&str] = &["state_dict", "model_state", "model_state_dict", "model"];
/// Largest number of reported other entries, and of characters of their names.
const TOLD: usize = 64;

/// The tensors of a state dict, by name.
#[derive(Debug, Default)]
pub(super) struct StateDict {
    pub(super) tensors: BTreeMap<String, View>,
    /// The keys under which it was found.
    pub(super) wrappers: Vec<&'static str>,
    /// The other contents of the file.
    pub(super) others: Vec<String>,
    /// Names of other entries among the tensors.
    pub(super) unread: Vec<String>,
}

impl StateDict {
    /// Searches the result of a pickle for the state dict.
    pub(super) fn find(pickle: &Pickle, budget: &mut Budget) -> Result<Self, Error> {
        let mut found = Self::default();
        let mut dict = pickle.root();
        // A wrapper that contains itself would never end.
        while found.wrappers.len() < WRAPPERS.len() {
            let inner = WRAPPERS.iter().find_map(|&wrapper| {
                let entry = pickle.entry(dict, wrapper)?;
                matches!(entry, Value::Dict(_)).then_some((wrapper, entry))
            });
            let Some((wrapper, entry)) = inner else { break };
            found.note_others(pickle, dict, |name, _| name != wrapper);
            found.wrappers.push(wrapper);
            dict = entry;
        }
        let outside = found.others.len();
        found.note_others(pickle, dict, |_, value| !matches!(value, Value::Tensor(_)));
        found.unread = found.others.get(outside..).unwrap_or_default().to_vec();
        found.collect(pickle, dict, budget)?;
        if found.tensors.is_empty() {
            let held = describe(dict, &found.others);
            return Err(refused(
                "no state dict",
                format_args!(
                    "the file holds {}; save it with torch.save(model.state_dict(), path), bare or \
                     under one of the keys {WRAPPERS:?}",
                    Excerpt(&held)
                ),
            ));
        }
        Ok(found)
    }

    fn collect(&mut self, pickle: &Pickle, dict: &Value, budget: &mut Budget) -> Result<(), Error> {
        let Value::Dict(entries) = dict else { return Ok(()) };
        for &(key, value) in entries {
            let (Value::Text(name), Value::Tensor(view)) = (pickle.value(key), pickle.value(value))
            else {
                continue;
            };
            if self.tensors.contains_key(&**name) {
                return Err(of_tensor(name, "two tensors have this name"));
            }
            let heap = 2 * name.len() + size_of_val(&*view.shape) + size_of_val(&*view.strides);
            budget.take_entry::<String, View>(heap)?;
            self.tensors.insert(name.to_string(), View::clone(view));
        }
        Ok(())
    }

    fn note_others(
        &mut self,
        pickle: &Pickle,
        dict: &Value,
        is_other: impl Fn(&str, &Value) -> bool,
    ) {
        let Value::Dict(entries) = dict else { return };
        let names = entries.iter().filter_map(|&(key, value)| match pickle.value(key) {
            Value::Text(name) if is_other(name, pickle.value(value)) => {
                Some(name.chars().take(TOLD).collect())
            }
            _ => None,
        });
        let room = TOLD.saturating_sub(self.others.len());
        self.others.extend(names.take(room));
    }
}

fn describe(value: &Value, keys: &[String]) -> String {
    match value {
        Value::Dict(_) => format!("a dict without tensors, with the keys {keys:?}"),
        Value::List(_) | Value::Tuple(_) => "a list".into(),
        Value::Tensor(_) => "a single tensor".into(),
        Value::Inert => "an object of a class that is not interpreted".into(),
        _ => "a plain value".into(),
    }
}
