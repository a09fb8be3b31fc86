//! The points with the least headroom, in order.

use super::candidate::Candidate;

/// The candidates with the least headroom. Among equal ones those with the least room count. A
/// candidate keeps its slot, and only short ranks are moved.
#[derive(Debug, Clone)]
pub(super) struct Ranking {
    capacity: usize,
    ranks: Vec<Rank>,
    slots: Vec<Candidate>,
}

/// The keys of a candidate and its slot.
#[derive(Debug, Clone, Copy)]
struct Rank {
    headroom: f64,
    room: f64,
    slot: usize,
}

impl Ranking {
    /// Creates a ranking of at most this many candidates.
    pub(super) fn new(capacity: usize) -> Self {
        let (ranks, slots) = (Vec::with_capacity(capacity), Vec::with_capacity(capacity));
        Self { capacity, ranks, slots }
    }

    pub(super) fn clear(&mut self) {
        self.ranks.clear();
        self.slots.clear();
    }

    /// Returns the largest headroom of a full ranking \[m/s\].
    pub(super) fn worst(&self) -> Option<f64> {
        let is_full = self.ranks.len() == self.capacity;
        self.ranks.last().filter(|_| is_full).map(|rank| rank.headroom)
    }

    /// Inserts a candidate. Returns the one that has no place.
    pub(super) fn insert(&mut self, candidate: Candidate) -> Option<Candidate> {
        let Candidate { headroom, room, .. } = candidate;
        let is_before = |rank: &Rank| (rank.headroom, rank.room) <= (headroom, room);
        let place = self.ranks.partition_point(is_before);
        if place >= self.capacity {
            return Some(candidate);
        }
        let last = if self.ranks.len() == self.capacity { self.ranks.pop() } else { None };
        let slot = last.map_or(self.slots.len(), |rank| rank.slot);
        self.ranks.insert(place, Rank { headroom, room, slot });
        let Some(own) = self.slots.get_mut(slot) else {
            self.slots.push(candidate);
            return None;
        };
        Some(std::mem::replace(own, candidate))
    }

    /// Returns the candidates with their slots, least headroom first.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &Candidate)> {
        self.ranks.iter().filter_map(|rank| Some((rank.slot, self.slots.get(rank.slot)?)))
    }

    /// Returns the candidate of a slot.
    pub(super) fn get(&self, slot: usize) -> Option<&Candidate> {
        self.slots.get(slot)
    }
}
