//! Passes lists between threads without locks and without waiting.

use rtrb::{Consumer, Producer, RingBuffer};

/// Number of lists that may wait.
const WAITING: usize = 64;

/// Sending end for lists of numbers.
#[derive(Debug)]
pub(super) struct Giver<T> {
    elements: Producer<T>,
}

/// Receiving end: it returns the newest list.
#[derive(Debug)]
pub(super) struct Taker<T> {
    elements: Consumer<T>,
    newest: Vec<T>,
}

/// Creates both ends for lists of `length` numbers, at least one.
pub(super) fn hand_over<T: Copy + Default>(length: usize) -> (Giver<T>, Taker<T>) {
    let (given, taken) = RingBuffer::new(WAITING * length);
    (Giver { elements: given }, Taker { elements: taken, newest: vec![T::default(); length] })
}

impl<T: Copy> Giver<T> {
    /// Sends a list. The list is lost if the queue is full, because nobody has taken any for long.
    pub(super) fn give(&mut self, list: &[T]) {
        let _ = self.elements.push_entire_slice(list);
    }

    /// Returns true if the receiving end is gone.
    pub(super) fn is_abandoned(&self) -> bool {
        self.elements.is_abandoned()
    }
}

impl<T: Copy> Taker<T> {
    /// Returns the newest list and the number of older ones that it replaces; `None` if no list has come.
    pub(super) fn take(&mut self) -> Option<(&[T], u64)> {
        let mut taken = 0;
        while self.elements.pop_entire_slice(&mut self.newest).is_ok() {
            taken += 1;
        }
        (taken > 0).then(|| (self.newest.as_slice(), taken - 1))
    }

    /// Returns true if the sending end is gone.
    pub(super) fn is_abandoned(&self) -> bool {
        self.elements.is_abandoned()
    }
}
