//! Which row a point has.

use super::candidate::{Candidate, PointId};

/// The rows of a block. A point keeps its row as long as it has one, so that a solver that begins with the rows
/// that were active last begins with the same points.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// The points that have rows, by row, now or in the tick before.
    points: Vec<Option<PointId>>,
    /// By row, the candidate that has it.
    candidates: Vec<Option<usize>>,
}

impl Places {
    /// For a block of so many rows.
    pub(super) fn new(rows: usize) -> Self {
        Self { points: vec![None; rows], candidates: vec![None; rows] }
    }

    /// Gives each of the candidates, of which there are no more than rows, a row.
    pub(super) fn assign(&mut self, candidates: &[Candidate]) {
        self.candidates.fill(None);
        let mut new = 0;
        for (index, candidate) in candidates.iter().enumerate() {
            let row = self.points.iter().position(|point| *point == Some(candidate.id));
            match row.and_then(|row| self.candidates.get_mut(row)) {
                Some(place) => *place = Some(index),
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
        for (index, candidate) in candidates.iter().enumerate() {
            if self.points.contains(&Some(candidate.id)) {
                continue;
            }
            while self.candidates.get(row).is_some_and(Option::is_some) {
                row += 1;
            }
            if let (Some(point), Some(place)) =
                (self.points.get_mut(row), self.candidates.get_mut(row))
            {
                (*point, *place) = (Some(candidate.id), Some(index));
            }
        }
    }

    /// By row, the index of the candidate that has it.
    pub(super) fn candidates(&self) -> impl Iterator<Item = Option<usize>> {
        self.candidates.iter().copied()
    }
}
