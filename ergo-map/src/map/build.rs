//! Construction of the map from predicted postures.

use core::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;
use rayon::prelude::*;

use super::ErgonomicsMap;
use super::grid::Grid;
use crate::error::Result;
use crate::joints::JointAngles;
use crate::person::Person;
use crate::predict::{EffortWeights, HandTarget, PosturePredictor};
use crate::reba::{Conditions, Mode, ergonomics_score};
use crate::region::Region;
use crate::side::Side;

/// Options for building a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapOptions {
    /// The working hand.
    pub side: Side,
    /// Distance between nodes, in statures.
    pub spacing: f64,
    /// Region of the nodes, in the person's frame \[m\]. `None` stands for
    /// [`Region::surroundings`].
    pub region: Option<Region>,
    /// Conversion of the printed classes to continuous scores.
    pub mode: Mode,
    /// Weights of the effort that a posture minimises.
    pub weights: EffortWeights,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            side: Side::Right,
            spacing: 0.05,
            region: None,
            mode: Mode::Graded,
            weights: EffortWeights::default(),
        }
    }
}

impl ErgonomicsMap {
    /// Predicts and scores the posture at every node, in parallel on rayon's current thread pool.
    /// The result does not depend on the number of threads.
    ///
    /// `progress` is called occasionally, from any thread, with the number of nodes done and the
    /// total.
    ///
    /// # Errors
    /// [`crate::Error::Value`] and others if an option is invalid. A node out of reach is not an
    /// error.
    pub fn build(
        person: &Person,
        options: &MapOptions,
        progress: Option<&(dyn Fn(usize, usize) + Sync)>,
    ) -> Result<Self> {
        let predictor = PosturePredictor::with_weights(person, options.side, &options.weights)?;
        let stature = person.stature();
        let region = match options.region {
            Some(region) => region.scaled(1.0 / stature),
            None => Region::surroundings(1.0, options.side),
        };
        let grid = Grid::covering(&region, options.spacing)?;
        let (done, all) = (AtomicUsize::new(0), grid.len());
        let nodes: Vec<_> = (0..all)
            .into_par_iter()
            .map(|index| {
                let node = score_node(&predictor, &(grid.node(index) * stature), options.mode);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                if let Some(progress) = progress
                    && (done.is_multiple_of(64) || done == all)
                {
                    progress(done, all);
                }
                node
            })
            .collect();
        let nodes = nodes.into_iter().collect();
        Ok(Self { person: person.clone(), side: options.side, mode: options.mode, grid, nodes })
    }
}

/// Returns score and joint angles at a hand position. `None` if the hand cannot reach it.
fn score_node(
    predictor: &PosturePredictor,
    position: &Vector3<f64>,
    mode: Mode,
) -> Option<(f64, [f64; JointAngles::LEN])> {
    let prediction = predictor.predict(&HandTarget::point(*position)).ok()?;
    let score = ergonomics_score(&prediction.angles.posture(), &Conditions::default(), mode);
    Some((score, prediction.angles.to_array()))
}
