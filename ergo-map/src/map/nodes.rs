//! Data of the nodes of a map.

use crate::joints::DOF;

/// Score and joint angles of each reachable node. An unreachable node takes four bytes.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Nodes {
    /// Index of each node in the lists below, or [`Self::NOWHERE`].
    places: Vec<u32>,
    /// Score `e_s`.
    scores: Vec<f64>,
    angles: Vec<[f64; DOF]>,
}

impl Nodes {
    const NOWHERE: u32 = u32::MAX;

    /// Creates an empty list with room for these numbers of nodes and of reachable nodes.
    pub(crate) fn with_capacity(nodes: usize, reachable: usize) -> Self {
        Self {
            places: Vec::with_capacity(nodes),
            scores: Vec::with_capacity(reachable),
            angles: Vec::with_capacity(reachable),
        }
    }

    /// Adds the next node, with its score and joint angles if it is reachable.
    pub(crate) fn push(&mut self, node: Option<(f64, [f64; DOF])>) {
        // There are at most `MAX_NODES`.
        let place = u32::try_from(self.scores.len()).unwrap_or(Self::NOWHERE);
        self.places.push(if node.is_some() { place } else { Self::NOWHERE });
        if let Some((score, angles)) = node {
            self.scores.push(score);
            self.angles.push(angles);
        }
    }

    /// Number of reachable nodes.
    pub(crate) fn reachable(&self) -> usize {
        self.scores.len()
    }

    /// Returns score and joint angles of a node. `None` if the hand cannot reach it.
    pub(crate) fn get(&self, node: usize) -> Option<(f64, &[f64; DOF])> {
        let place = self.places.get(node).copied().and_then(|place| usize::try_from(place).ok())?;
        Some((*self.scores.get(place)?, self.angles.get(place)?))
    }

    /// Returns the score of a node, NaN if the hand cannot reach it.
    pub(crate) fn score(&self, node: usize) -> f64 {
        let place = self.places.get(node).copied().and_then(|place| usize::try_from(place).ok());
        place.and_then(|place| self.scores.get(place)).copied().unwrap_or(f64::NAN)
    }

    /// Iterates over all nodes, in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Option<(f64, &[f64; DOF])>> {
        (0..self.places.len()).map(|node| self.get(node))
    }
}

impl FromIterator<Option<(f64, [f64; DOF])>> for Nodes {
    fn from_iter<I: IntoIterator<Item = Option<(f64, [f64; DOF])>>>(nodes: I) -> Self {
        let mut all = Self::default();
        nodes.into_iter().for_each(|node| all.push(node));
        all
    }
}
