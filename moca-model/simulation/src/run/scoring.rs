//! Scores of the person's posture with the hand at the tool.

use std::borrow::Borrow;

use ergo_map::{Conditions, ErgonomicsMap, PersonFrame, Region};
use nalgebra::Vector3;

/// Number of steps from the tool towards the best posture, in which the nearest reachable point is searched.
const STEPS: u8 = 40;

/// A score, and whether the hand reached the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandScore {
    /// e_s, the continuous score of the posture, 0 (good) to 4.25.
    pub score: f64,
    /// The integer REBA score of the same posture, 1 (good) to 15.
    pub reba: u8,
    /// True if the hand can reach the tool. If not, the score is that with the hand as far towards the tool as it
    /// reaches.
    pub reached: bool,
}

/// Scores hand positions by the person's true map, not by the quadratic that the controller minimises.
#[derive(Debug, Clone)]
pub struct Scorer<M> {
    map: M,
    /// Place of the best posture, in the person's frame \[m\].
    middle: Vector3<f64>,
}

impl<M: Borrow<ErgonomicsMap>> Scorer<M> {
    /// Scores by this map, whatever the controller knows of it.
    pub fn new(map: M) -> Self {
        let known = map.borrow();
        let zone = Region::work_zone(known.stature(), known.side());
        let best = known
            .nodes()
            .filter(|node| zone.contains(&node.position))
            .min_by(|a, b| a.score.total_cmp(&b.score));
        let middle = best.map_or((zone.min() + zone.max()) * 0.5, |node| node.position);
        Self { map, middle }
    }

    /// The score of `person` with the hand at `tool` \[m, world\]; `None` if not even the path there is in the map.
    pub fn score(&self, person: &PersonFrame, tool: &Vector3<f64>) -> Option<HandScore> {
        let hand = person.to_person(tool);
        (0..STEPS).find_map(|step| {
            let back = f64::from(step) / f64::from(STEPS);
            let point = hand + (self.middle - hand) * back;
            let map = self.map.borrow();
            let sample = map.sample(&point).ok()?;
            let reba = map.assess(&point, &Conditions::default()).ok()?;
            Some(HandScore { score: sample.score, reba: reba.reba, reached: step == 0 })
        })
    }
}
