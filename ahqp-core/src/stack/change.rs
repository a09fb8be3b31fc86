//! A change of the stack under way: how much of it has been made.

use super::plan::Entry;
use super::ramp::Ramp;
use crate::problem::ids::LevelId;

/// A difference between stacks, and how much of the thresholds has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) difference: Difference,
    pub(super) share: Ramp,
    pub(super) end: End,
}

/// What tells the stacks with and without the change apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Difference {
    /// The level is active or not.
    Activation(LevelId),
    /// The two levels stand in each other's place or in their own.
    Exchange(LevelId, LevelId),
}

/// What becomes of a change whose share has reached 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// It is over.
    Settles,
    /// It is over, and its level gone.
    Removes,
    /// It waits to be directed elsewhere.
    Waits,
}

impl Change {
    /// Whether one of the two stacks has the whole weight from now on; if so, whether it is the
    /// one with the difference.
    pub(super) fn outcome(&self) -> Option<bool> {
        let over = self.share.is_over() && self.end != End::Waits;
        match self.share.target() {
            1.0 if over => Some(true),
            0.0 if over => Some(false),
            _ => None,
        }
    }

    pub(super) fn removes(&self, id: LevelId) -> bool {
        self.end == End::Removes && self.difference == Difference::Activation(id)
    }
}

impl Difference {
    pub(super) fn is_exchange_of(self, a: LevelId, b: LevelId) -> bool {
        self == Self::Exchange(a, b) || self == Self::Exchange(b, a)
    }

    /// Makes or unmakes the difference in an order without it.
    pub(super) fn apply(self, made: bool, order: &mut [Entry]) {
        match self {
            Self::Activation(id) => {
                for entry in order.iter_mut().filter(|entry| entry.id == id) {
                    entry.active = made;
                }
            }
            Self::Exchange(a, b) if made => {
                let place = |id| order.iter().position(|entry: &Entry| entry.id == id);
                if let (Some(i), Some(j)) = (place(a), place(b)) {
                    order.swap(i, j);
                }
            }
            Self::Exchange(..) => {}
        }
    }
}
