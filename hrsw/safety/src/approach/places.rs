//! Assignment of points to rows.

use super::candidate::PointId;
use super::ranking::Ranking;

/// Assignment of points to the rows of a block. A point keeps its row as long as it has one. A
/// solver that starts from the last active set then starts with the same points.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// Point of each row, now or in the tick before.
    points: Vec<Option<PointId>>,
    /// Slot of each row's candidate.
    candidates: Vec<Option<usize>>,
}

impl Places {
    /// Creates the assignment for a block of this many rows.
    pub(super) fn new(rows: usize) -> Self {
        Self { points: vec![None; rows], candidates: vec![None; rows] }
    }

    /// Assigns a row to each candidate. There are no more candidates than rows.
    pub(super) fn assign(&mut self, candidates: &Ranking) {
        self.candidates.fill(None);
        let mut new = 0;
        for (slot, candidate) in candidates.iter() {
            let row = self.points.iter().position(|point| *point == Some(candidate.id));
            match row.and_then(|row| self.candidates.get_mut(row)) {
                Some(place) => *place = Some(slot),
                None => new += 1,
            }
        }
        for (point, candidate) in self.points.iter_mut().zip(&self.candidates) {
            if candidate.is_none() {
                *point = None;
            }
        }
        if new == 0 {
            return;
        }
        let mut row = 0;
        for (slot, candidate) in candidates.iter() {
            if self.points.contains(&Some(candidate.id)) {
                continue;
            }
            while self.candidates.get(row).is_some_and(Option::is_some) {
                row += 1;
            }
            if let (Some(point), Some(place)) =
                (self.points.get_mut(row), self.candidates.get_mut(row))
            {
                (*point, *place) = (Some(candidate.id), Some(slot));
            }
        }
    }

    /// Iterates over the rows, with the slot of each row's candidate.
    pub(super) fn candidates(&self) -> impl Iterator<Item = Option<usize>> {
        self.candidates.iter().copied()
    }
}
