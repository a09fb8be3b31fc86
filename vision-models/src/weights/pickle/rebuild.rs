//! Creates the few objects that a checkpoint needs from their pickled arguments.

use std::{io::BufRead, rc::Rc};

use super::machine::Machine;
use crate::error::Error;
use crate::weights::pickle::value::{Global, Id, Storage, Value, View};
use crate::weights::shape::MAX_AXES;

/// Longest key of a storage (bytes).
const MAX_KEY: usize = 64;

impl<R: BufRead> Machine<'_, R> {
    /// Creates a storage from its description: `("storage", class, key, device, elements)`. Files
    /// from before PyTorch 0.4 have a sixth item, for a storage that is a part of another.
    pub(super) fn storage(&mut self, id: Id) -> Result<Value, Error> {
        const FORM: &str = "(\"storage\", class, key, device, elements)";
        self.charge_bytes(2 * size_of::<Storage>() + 2 * MAX_KEY)?;
        let Value::Tuple(items) = self.value(id) else {
            return Err(self.expected(FORM));
        };
        let &[tag, class, key, _, elements, ref rest @ ..] = items.as_slice() else {
            return Err(self.expected(FORM));
        };
        if !matches!(self.value(tag), Value::Text(tag) if &**tag == "storage") {
            return Err(self.expected(FORM));
        }
        // `None` is inert too.
        if !rest.iter().all(|&part| matches!(self.value(part), Value::Inert)) {
            return Err(self.expected("a storage that is no part of another"));
        }
        let &Value::Global(Global::Storage(element)) = self.value(class) else {
            return Ok(Value::Inert);
        };
        let key = match self.value(key) {
            Value::Text(key) if key.len() <= MAX_KEY => Rc::clone(key),
            Value::Int(key) => key.to_string().into(),
            _ => return Err(self.expected(FORM)),
        };
        let elements = self.size(elements)?;
        Ok(Value::Storage(Rc::new(Storage { key, element, elements })))
    }

    /// Returns the object that the callable named by `global` would create from its arguments.
    pub(super) fn rebuild(&mut self, global: Global, arguments: Id) -> Result<Id, Error> {
        let Value::Tuple(arguments) = self.value(arguments) else {
            return Err(self.expected("a tuple of arguments"));
        };
        match (global, arguments.as_slice()) {
            (Global::OrderedDict, []) => self.add(Value::Dict(Vec::new())),
            (Global::OrderedDict, &[pairs]) => self.dict(pairs),
            (Global::RebuildTensor, &[storage, offset, shape, strides, ..]) => {
                let tensor = self.tensor(storage, offset, shape, strides)?;
                self.add(tensor)
            }
            (Global::RebuildParameter, &[tensor, ..]) => Ok(tensor),
            (Global::RebuildFromType, &[callable, _, arguments, ..]) => {
                match *self.value(callable) {
                    Value::Global(Global::RebuildFromType) | Value::Inert => self.add(Value::Inert),
                    Value::Global(global) => self.rebuild(global, arguments),
                    _ => Err(self.expected("a callable")),
                }
            }
            (Global::Storage(_), _) => self.add(Value::Inert),
            _ => Err(self.expected("more arguments")),
        }
    }

    /// Creates an ordered dict of Python 2: a list of lists of a key and a value.
    fn dict(&mut self, pairs: Id) -> Result<Id, Error> {
        const FORM: &str = "a list of keys and values";
        let length = match self.value(pairs) {
            Value::List(pairs) => pairs.len(),
            _ => return Err(self.expected(FORM)),
        };
        self.charge(length)?;
        let items = match self.value(pairs) {
            Value::List(pairs) => pairs.as_slice(),
            _ => &[],
        };
        let entries = items
            .iter()
            .map(|&pair| match self.value(pair) {
                Value::List(pair) | Value::Tuple(pair) => match *pair.as_slice() {
                    [key, value] => Ok((key, value)),
                    _ => Err(self.expected(FORM)),
                },
                _ => Err(self.expected(FORM)),
            })
            .collect::<Result<_, _>>()?;
        self.add(Value::Dict(entries))
    }

    fn tensor(&mut self, storage: Id, offset: Id, shape: Id, strides: Id) -> Result<Value, Error> {
        self.charge_bytes(size_of::<View>() + 2 * MAX_AXES * size_of::<usize>())?;
        let storage = match self.value(storage) {
            Value::Storage(storage) => Rc::clone(storage),
            Value::Inert => return Ok(Value::Inert),
            _ => return Err(self.expected("a storage")),
        };
        let offset = self.size(offset)?;
        let (shape, strides) = (self.sizes(shape)?, self.sizes(strides)?);
        if shape.len() != strides.len() {
            return Err(self.expected("as many strides as axes"));
        }
        Ok(Value::Tensor(Box::new(View { storage, offset, shape, strides })))
    }

    fn sizes(&self, id: Id) -> Result<Vec<usize>, Error> {
        match self.value(id) {
            Value::Tuple(items) | Value::List(items) if items.len() <= MAX_AXES => {
                items.iter().map(|&item| self.size(item)).collect()
            }
            _ => Err(self.expected("a tuple of at most eight sizes")),
        }
    }

    fn size(&self, id: Id) -> Result<usize, Error> {
        match *self.value(id) {
            Value::Int(value) => usize::try_from(value).ok(),
            _ => None,
        }
        .ok_or_else(|| self.expected("a size, zero or more"))
    }
}
