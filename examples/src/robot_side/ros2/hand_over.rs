//! Numbers from thread to thread, without locks and without waiting.

use rtrb::{Consumer, Producer, RingBuffer};

/// How many lists of numbers may wait to be taken.
const WAITING: usize = 64;

/// Where lists of numbers are given.
#[derive(Debug)]
pub(super) struct Giver {
    numbers: Producer<f64>,
}

/// Where the newest list is taken.
#[derive(Debug)]
pub(super) struct Taker {
    numbers: Consumer<f64>,
    newest: Vec<f64>,
}

/// For lists of `length` numbers, at least one.
pub(super) fn hand_over(length: usize) -> (Giver, Taker) {
    let (given, taken) = RingBuffer::new(WAITING * length);
    (Giver { numbers: given }, Taker { numbers: taken, newest: vec![0.0; length] })
}

impl Giver {
    /// Gives a list. Nobody has taken any for long if there is no room for it: then it is lost.
    pub(super) fn give(&mut self, list: &[f64]) {
        let _ = self.numbers.push_entire_slice(list);
    }

    /// Returns true if nobody can take lists any more.
    pub(super) fn is_abandoned(&self) -> bool {
        self.numbers.is_abandoned()
    }
}

impl Taker {
    /// The newest list and how many older ones it replaces, if one has come.
    pub(super) fn take(&mut self) -> Option<(&[f64], u64)> {
        let mut taken = 0;
        while self.numbers.pop_entire_slice(&mut self.newest).is_ok() {
            taken += 1;
        }
        (taken > 0).then(|| (self.newest.as_slice(), taken - 1))
    }

    /// Returns true if nobody can give lists any more.
    pub(super) fn is_abandoned(&self) -> bool {
        self.numbers.is_abandoned()
    }
}
