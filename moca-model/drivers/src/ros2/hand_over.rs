//! Lists from thread to thread, without locks and without waiting.

use rtrb::{Consumer, Producer, RingBuffer};

/// How many lists may wait to be taken.
const WAITING: usize = 64;

/// Where lists of numbers are given.
#[derive(Debug)]
pub(super) struct Giver<T> {
    elements: Producer<T>,
}

/// Where the newest list is taken.
#[derive(Debug)]
pub(super) struct Taker<T> {
    elements: Consumer<T>,
    newest: Vec<T>,
}

/// For lists of `length` numbers, at least one.
pub(super) fn hand_over<T: Copy + Default>(length: usize) -> (Giver<T>, Taker<T>) {
    let (given, taken) = RingBuffer::new(WAITING * length);
    (Giver { elements: given }, Taker { elements: taken, newest: vec![T::default(); length] })
}

impl<T: Copy> Giver<T> {
    /// Gives a list. Nobody has taken any for long if there is no room for it: then it is lost.
    pub(super) fn give(&mut self, list: &[T]) {
        let _ = self.elements.push_entire_slice(list);
    }

    /// Returns true if nobody can take lists any more.
    pub(super) fn is_abandoned(&self) -> bool {
        self.elements.is_abandoned()
    }
}

impl<T: Copy> Taker<T> {
    /// The newest list and how many older ones it replaces, if one has come.
    pub(super) fn take(&mut self) -> Option<(&[T], u64)> {
        let mut taken = 0;
        while self.elements.pop_entire_slice(&mut self.newest).is_ok() {
            taken += 1;
        }
        (taken > 0).then(|| (self.newest.as_slice(), taken - 1))
    }

    /// Returns true if nobody can give lists any more.
    pub(super) fn is_abandoned(&self) -> bool {
        self.elements.is_abandoned()
    }
}
