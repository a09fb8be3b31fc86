//! The machine's stack and its marks.

use std::io::BufRead;

use super::Machine;
use crate::error::Error;
use crate::weights::pickle::value::{Id, Value};

impl<R: BufRead> Machine<'_, R> {
    pub(super) fn mark(&mut self) -> Result<(), Error> {
        Self::within_limit(self.marks.len())?;
        self.budget.push(&mut self.marks, self.stack.len())
    }

    pub(super) fn pop_to_mark(&mut self) -> Result<Vec<Id>, Error> {
        let mark = self.marks.pop().ok_or_else(|| self.problem("there is no mark on the stack"))?;
        self.cut_off(mark)
    }

    /// Removes all values from `start` on from the stack.
    pub(super) fn cut_off(&mut self, start: usize) -> Result<Vec<Id>, Error> {
        let count = self.stack.len().saturating_sub(start);
        self.budget.take(size_of::<Id>() * count)?;
        Ok(self.stack.drain(start.min(self.stack.len())..).collect())
    }

    pub(super) fn discard_to_mark(&mut self) -> Result<(), Error> {
        let mark = self.marks.pop().ok_or_else(|| self.problem("there is no mark on the stack"))?;
        self.stack.truncate(mark);
        Ok(())
    }

    pub(super) fn discard(&mut self, count: usize) -> Result<(), Error> {
        let start = self.floor_for(count)?;
        self.stack.truncate(start);
        Ok(())
    }

    pub(super) fn pop(&mut self) -> Result<Id, Error> {
        let top = self.top()?;
        self.stack.pop();
        Ok(top)
    }

    pub(super) fn top(&self) -> Result<Id, Error> {
        let index = self.floor_for(1)?;
        self.stack.get(index).copied().ok_or_else(|| self.problem("the stack is empty"))
    }

    /// Returns where the topmost `count` values start. They must not reach below the last mark.
    pub(super) fn floor_for(&self, count: usize) -> Result<usize, Error> {
        let mark = self.marks.last().copied().unwrap_or(0);
        self.stack
            .len()
            .checked_sub(count)
            .filter(|&start| start >= mark)
            .ok_or_else(|| self.problem("the stack is empty"))
    }

    pub(super) fn push(&mut self, value: Value) -> Result<(), Error> {
        let id = self.add(value)?;
        self.push_id(id)
    }

    pub(super) fn push_id(&mut self, id: Id) -> Result<(), Error> {
        Self::within_limit(self.stack.len())?;
        self.budget.push(&mut self.stack, id)
    }
}
