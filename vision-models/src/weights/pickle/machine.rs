//! The stack machine that runs a pickle.

mod stack;

use std::fmt::Display;
use std::{collections::HashMap, io::BufRead};

use super::Pickle;
use crate::error::Error;
use crate::weights::budget::Budget;
use crate::weights::error::{beyond, in_pickle};
use crate::weights::input::Input;
use crate::weights::pickle::value::{Global, Id, Value};

/// Largest number of values, enough for 100,000 tensors.
const MAX_VALUES: usize = 1 << 21;

/// Runs one pickle up to its `STOP`. It creates the values of [`Value`]. Any other import, call or
/// object becomes [`Value::Inert`].
///
/// # Errors
/// [`Error::Checkpoint`] if the pickle is rejected.
pub(in crate::weights) fn run<R: BufRead>(
    input: &mut Input<R>,
    budget: &mut Budget,
) -> Result<Pickle, Error> {
    let mut machine = Machine {
        start: input.position(),
        input,
        budget,
        values: Vec::new(),
        stack: Vec::new(),
        marks: Vec::new(),
        memo: HashMap::new(),
        copied: 0,
    };
    loop {
        if let Some(root) = machine.step()? {
            return Ok(Pickle { values: machine.values, root });
        }
    }
}

pub(super) struct Machine<'a, R> {
    input: &'a mut Input<R>,
    budget: &'a mut Budget,
    start: u64,
    pub(super) values: Vec<Value>,
    stack: Vec<Id>,
    marks: Vec<usize>,
    memo: HashMap<u64, Id>,
    copied: usize,
}

impl<R: BufRead> Machine<'_, R> {
    /// Executes one opcode. Returns the result at `STOP`.
    #[allow(clippy::too_many_lines, clippy::match_same_arms)] // one line per opcode, in groups
    fn step(&mut self) -> Result<Option<Id>, Error> {
        let opcode = self.input.byte("pickle")?;
        match opcode {
            b'.' => return self.pop().map(Some),
            0x80 => self.protocol()?,
            0x95 => self.input.skip(8, "frame")?,

            // Values
            b'N' => self.push(Value::Inert)?,
            0x88 => self.push(Value::Bool(true))?,
            0x89 => self.push(Value::Bool(false))?,
            b'K' => self.integer::<1>()?,
            b'M' => self.integer::<2>()?,
            b'J' => self.signed_integer()?,
            0x8a => self.long::<1>()?,
            0x8b => self.long::<4>()?,
            b'G' => self.inert(8)?,
            b'X' => self.text::<4>()?,
            0x8c => self.text::<1>()?,
            0x8d => self.text::<8>()?,
            // A str of Python 2.
            b'U' => self.text_or_bytes::<1>()?,
            b'T' => self.text_or_bytes::<4>()?,
            b'C' => self.bytes::<1>()?,
            b'B' => self.bytes::<4>()?,
            0x8e | 0x96 => self.bytes::<8>()?,

            // Containers
            b'(' => self.mark()?,
            b')' => self.push(Value::Tuple(Vec::new()))?,
            0x85 => self.tuple(1)?,
            0x86 => self.tuple(2)?,
            0x87 => self.tuple(3)?,
            b't' => {
                let items = self.pop_to_mark()?;
                self.push(Value::Tuple(items))?;
            }
            b']' => self.push(Value::List(Vec::new()))?,
            b'l' => {
                let items = self.pop_to_mark()?;
                self.push(Value::List(items))?;
            }
            b'a' => {
                let item = self.pop()?;
                self.extend(vec![item])?;
            }
            b'e' => {
                let items = self.pop_to_mark()?;
                self.extend(items)?;
            }
            b'}' => self.push(Value::Dict(Vec::new()))?,
            b'd' => {
                let items = self.pop_to_mark()?;
                self.push(Value::Dict(Vec::new()))?;
                self.set_items(&items)?;
            }
            b's' => {
                let value = self.pop()?;
                let key = self.pop()?;
                self.set_items(&[key, value])?;
            }
            b'u' => {
                let items = self.pop_to_mark()?;
                self.set_items(&items)?;
            }
            0x8f => self.push(Value::Inert)?, // a set
            0x90 => self.discard_to_mark()?,
            0x91 => self.inert_from_mark()?,

            // The stack and the memo
            b'0' => self.discard(1)?,
            b'1' => self.discard_to_mark()?,
            b'2' => {
                let top = self.top()?;
                self.push_id(top)?;
            }
            b'h' => self.recall::<1>()?,
            b'j' => self.recall::<4>()?,
            b'q' => self.memoise::<1>()?,
            b'r' => self.memoise::<4>()?,
            0x94 => self.store(self.memo.len() as u64)?,

            // Objects
            b'c' => self.global_by_lines()?,
            0x93 => self.global_by_stack()?,
            b'Q' => self.persistent()?,
            b'R' | 0x81 => self.apply()?,
            0x92 => {
                self.discard(3)?;
                self.push(Value::Inert)?;
            }
            b'o' => self.inert_from_mark()?,
            b'b' => self.discard(1)?, // attributes of an object, which weights do not have
            0x82 => self.inert(1)?,
            0x83 => self.inert(2)?,
            0x84 => self.inert(4)?,
            _ => {
                return Err(self.problem(format_args!(
                    "0x{opcode:02x} is no opcode of pickle protocols 1 to 5"
                )));
            }
        }
        Ok(None)
    }

    fn protocol(&mut self) -> Result<(), Error> {
        match self.input.byte("pickle protocol")? {
            0..=5 => Ok(()),
            protocol => {
                Err(self.problem(format_args!("pickle protocol {protocol}: only 0 to 5 exist")))
            }
        }
    }

    fn integer<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let value = self.unsigned::<SIZE>()?;
        self.push(i64::try_from(value).map_or(Value::Inert, Value::Int))
    }

    fn signed_integer(&mut self) -> Result<(), Error> {
        let value = i32::from_le_bytes(self.input.array("integer")?);
        self.push(Value::Int(i64::from(value)))
    }

    /// Reads an integer of any length, two's complement, little-endian.
    fn long<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let length = self.unsigned::<SIZE>()?;
        self.take_bytes(length)?;
        let bytes = self.input.bytes(length, "integer")?;
        if bytes.len() > 8 {
            return self.push(Value::Inert);
        }
        let fill = if bytes.last().is_some_and(|&byte| byte >= 128) { 255 } else { 0 };
        let mut padded = [fill; 8];
        for (place, byte) in padded.iter_mut().zip(bytes) {
            *place = byte;
        }
        self.push(Value::Int(i64::from_le_bytes(padded)))
    }

    fn text<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let length = self.unsigned::<SIZE>()?;
        self.take_bytes(length)?;
        let text = String::from_utf8(self.input.bytes(length, "text")?)
            .map_err(|_| self.problem("text that is not UTF-8"))?;
        self.push(Value::Text(text.into()))
    }

    fn text_or_bytes<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let length = self.unsigned::<SIZE>()?;
        self.take_bytes(length)?;
        let text = String::from_utf8(self.input.bytes(length, "text")?);
        self.push(text.map_or(Value::Inert, |text| Value::Text(text.into())))
    }

    fn bytes<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let length = self.unsigned::<SIZE>()?;
        self.inert(length)
    }

    /// Charges the memory of bytes that are read and then kept as a text. More bytes than there are
    /// will not be read.
    fn take_bytes(&mut self, length: u64) -> Result<(), Error> {
        let length = usize::try_from(length.min(self.input.remaining())).unwrap_or(usize::MAX);
        self.budget.take(length.saturating_mul(2).saturating_add(2 * size_of::<usize>()))
    }

    /// Adds a value whose bytes are ignored.
    fn inert(&mut self, length: u64) -> Result<(), Error> {
        self.input.skip(length, "value")?;
        self.push(Value::Inert)
    }

    fn inert_from_mark(&mut self) -> Result<(), Error> {
        self.discard_to_mark()?;
        self.push(Value::Inert)
    }

    fn tuple(&mut self, size: usize) -> Result<(), Error> {
        let start = self.floor_for(size)?;
        let items = self.cut_off(start)?;
        self.push(Value::Tuple(items))
    }

    /// Appends to the list on top of the stack.
    fn extend(&mut self, items: Vec<Id>) -> Result<(), Error> {
        let top = self.top()?;
        self.budget.take(size_of::<Id>() * (4 + 3 * items.len()))?;
        match self.values.get_mut(top.0) {
            Some(Value::List(list)) => list.extend(items),
            Some(Value::Inert) => {}
            _ => return Err(self.expected("a list to append to")),
        }
        Ok(())
    }

    /// Adds keys and values, in turn, to the dict on top of the stack.
    fn set_items(&mut self, items: &[Id]) -> Result<(), Error> {
        let top = self.top()?;
        self.budget.take(size_of::<Id>() * (8 + 3 * items.len()))?;
        let (pairs, rest) = items.as_chunks();
        match self.values.get_mut(top.0) {
            Some(Value::Dict(dict)) if rest.is_empty() => {
                dict.extend(pairs.iter().map(|&[key, value]| (key, value)));
            }
            Some(Value::Inert) => {}
            _ => return Err(self.expected("a dict, keys and values")),
        }
        Ok(())
    }

    fn recall<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let index = self.unsigned::<SIZE>()?;
        match self.memo.get(&index) {
            Some(&id) => self.push_id(id),
            None => Err(self.problem(format_args!("memo {index} is empty"))),
        }
    }

    fn memoise<const SIZE: usize>(&mut self) -> Result<(), Error> {
        let index = self.unsigned::<SIZE>()?;
        self.store(index)
    }

    fn store(&mut self, index: u64) -> Result<(), Error> {
        let top = self.top()?;
        Self::within_limit(self.memo.len())?;
        // A hash table that is between 7/16 and 7/8 full, and in memory twice while it grows.
        self.budget.take(4 * size_of::<(u64, Id)>())?;
        self.memo.insert(index, top);
        Ok(())
    }

    fn global_by_lines(&mut self) -> Result<(), Error> {
        let module = self.input.line("name")?;
        let name = self.input.line("name")?;
        self.global(&String::from_utf8_lossy(&module), &String::from_utf8_lossy(&name))
    }

    fn global_by_stack(&mut self) -> Result<(), Error> {
        let name = self.pop()?;
        let module = self.pop()?;
        let (Value::Text(module), Value::Text(name)) = (self.value(module), self.value(name))
        else {
            return Err(self.expected("a module's and a class's name"));
        };
        let (module, name) = (module.clone(), name.clone());
        self.global(&module, &name)
    }

    fn global(&mut self, module: &str, name: &str) -> Result<(), Error> {
        self.push(Global::from_name(module, name).map_or(Value::Inert, Value::Global))
    }

    /// Reads a reference to an object outside the pickle, which is a storage in a checkpoint.
    fn persistent(&mut self) -> Result<(), Error> {
        let id = self.pop()?;
        let storage = self.storage(id)?;
        self.push(storage)
    }

    /// Replaces a callable and its arguments by the result.
    fn apply(&mut self) -> Result<(), Error> {
        let arguments = self.pop()?;
        let callable = self.pop()?;
        match self.value(callable) {
            &Value::Global(global) => {
                let result = self.rebuild(global, arguments)?;
                self.push_id(result)
            }
            _ => self.push(Value::Inert),
        }
    }

    pub(super) fn add(&mut self, value: Value) -> Result<Id, Error> {
        Self::within_limit(self.values.len())?;
        self.budget.push(&mut self.values, value)?;
        Ok(Id(self.values.len() - 1))
    }

    pub(super) fn value(&self, id: Id) -> &Value {
        self.values.get(id.0).unwrap_or(&Value::Inert)
    }

    fn unsigned<const SIZE: usize>(&mut self) -> Result<u64, Error> {
        let bytes: [u8; SIZE] = self.input.array("pickle")?;
        Ok(bytes.iter().rev().fold(0, |value, &byte| value << 8 | u64::from(byte)))
    }

    /// Counts copies from one value to another. A pickle can request the same copy many times in a
    /// few bytes.
    pub(super) fn charge(&mut self, copied: usize) -> Result<(), Error> {
        self.budget.take(3 * size_of::<(Id, Id)>() * copied)?;
        self.copied = self.copied.saturating_add(copied);
        Self::within_limit(self.copied)
    }

    /// Charges the memory to which a value points.
    pub(super) fn charge_bytes(&mut self, bytes: usize) -> Result<(), Error> {
        self.budget.take(bytes)
    }

    fn within_limit(count: usize) -> Result<(), Error> {
        if count < MAX_VALUES {
            return Ok(());
        }
        Err(beyond("values in the pickle", count as u64 + 1, MAX_VALUES as u64))
    }

    pub(super) fn problem(&self, problem: impl Display) -> Error {
        in_pickle(self.input.position() - self.start, problem)
    }

    pub(super) fn expected(&self, what: &str) -> Error {
        self.problem(format_args!("expected {what}"))
    }
}
