//! A change of the stack in progress, and the share of it that has been made.

use super::plan::Entry;
use super::ramp::Ramp;
use crate::problem::ids::LevelId;

/// A difference between stacks, and the share of the thresholds at which it is made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) difference: Difference,
    pub(super) share: Ramp,
    pub(super) end: End,
}

/// Difference between the stacks with and without the change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Difference {
    /// The level is active.
    Activation(LevelId),
    /// The two levels are exchanged.
    Exchange(LevelId, LevelId),
}

/// Action when the share of a change has reached 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// The change ends.
    Settles,
    /// The change ends, and its level is removed.
    Removes,
    /// The change waits for a new target.
    Waits,
}

impl Change {
    /// Returns whether the difference stays, if one of the two stacks has the whole weight from now
    /// on. None otherwise.
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

    /// Applies or reverts the difference in an order that does not include it.
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
