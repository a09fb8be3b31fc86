//! The ergonomics of one person over the points that a hand can reach.

mod build;
mod file;
mod fit;
mod grid;
mod measured;
mod nodes;
mod samples;

use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::joints::JointAngles;
use crate::person::Person;
use crate::reba::{Conditions, Mode, Reba, Worksheet};
use crate::side::Side;
pub use build::MapOptions;
use grid::Grid;
pub use measured::{MeasuredOptions, Validation};
use nodes::Nodes;
pub use samples::{MeasuredSample, read_samples};

/// The score and its gradient at a hand position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapSample {
    /// The paper's score `e_s`, 0 to 4.25.
    pub score: f64,
    /// Derivative of the score with respect to the hand's position in the person's frame \[1/m\].
    pub gradient: Vector3<f64>,
}

/// A node of the map: a hand position with its posture and score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapNode {
    /// Hand position in the person's frame \[m\].
    pub position: Vector3<f64>,
    /// The posture.
    pub angles: JointAngles,
    /// The paper's score `e_s`.
    pub score: f64,
}

/// The map of one person: posture and score over the reachable volume.
///
/// Positions are those of the working hand in the person's frame H, in metres. The origin of H is
/// on the floor below the pelvis of the person standing upright. x points forward, y left, and z
/// up.
///
/// Internally the map is in statures. Between nodes the score is trilinear. A point is outside the
/// domain if one of its eight surrounding nodes is not reachable.
///
/// ```
/// use ergo_map::{Conditions, ErgonomicsMap, MapOptions, Person};
/// use nalgebra::Vector3;
/// let options = MapOptions { spacing: 0.08, ..Default::default() };
/// let map = ErgonomicsMap::build(&Person::average(), &options, None)?;
/// let hand = Vector3::new(0.35, -0.15, 1.05);
/// let sample = map.sample(&hand)?;
/// let reba = map.assess(&hand, &Conditions::default())?;
/// assert!(sample.score < 0.5 && reba.reba <= 3);
/// assert!(map.sample(&Vector3::new(2.0, 0.0, 1.0)).is_err());
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ErgonomicsMap {
    person: Person,
    side: Side,
    mode: Mode,
    grid: Grid,
    nodes: Nodes,
}

impl ErgonomicsMap {
    /// Stature of the person \[m\].
    pub fn stature(&self) -> f64 {
        self.person.stature()
    }

    /// The person of the map.
    pub fn person(&self) -> &Person {
        &self.person
    }

    /// The working hand.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Conversion of the printed classes to continuous scores.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Returns the map for a person of the same proportions and another stature \[m\].
    ///
    /// # Errors
    /// Those of [`crate::Person::new`].
    pub fn for_stature(&self, stature: f64) -> Result<Self> {
        Ok(Self { person: self.person.clone().with_stature(stature)?, ..self.clone() })
    }

    /// Number of nodes that the hand can reach.
    pub fn len(&self) -> usize {
        self.nodes.reachable()
    }

    /// Returns true if the hand can reach no node.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes that the hand can reach, x slowest, z fastest.
    pub fn nodes(&self) -> impl Iterator<Item = MapNode> + '_ {
        self.nodes.iter().enumerate().filter_map(|(index, node)| {
            let (score, &angles) = node?;
            let position = self.grid.node(index) * self.stature();
            Some(MapNode { position, angles: JointAngles::from_array(angles), score })
        })
    }

    /// Returns true if the hand position is in the map's domain.
    pub fn contains(&self, hand: &Vector3<f64>) -> bool {
        self.sample(hand).is_ok()
    }

    /// Returns the score and its gradient. Allocates nothing and takes constant time.
    ///
    /// # Errors
    /// [`Error::OutOfDomain`] if the position is outside the reachable volume, or NaN.
    pub fn sample(&self, hand: &Vector3<f64>) -> Result<MapSample> {
        let (cell, mut score, mut gradient) = (self.cell(hand)?, 0.0, Vector3::zeros());
        for corner in 0..8 {
            let value = self.nodes.score(cell.corner(corner));
            let (weight, slope) = cell.weight(corner);
            score += weight * value;
            gradient += slope * value;
        }
        if score.is_nan() {
            return Err(out_of_domain(hand));
        }
        Ok(MapSample { score, gradient: gradient / self.stature() })
    }

    /// Returns the posture for a hand position, trilinear between nodes. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::OutOfDomain`] if the position is outside the reachable volume, or NaN.
    pub fn posture(&self, hand: &Vector3<f64>) -> Result<JointAngles> {
        self.sample(hand)?;
        let cell = self.cell(hand)?;
        let mut angles = [0.0; JointAngles::LEN];
        for corner in 0..8 {
            let (weight, _) = cell.weight(corner);
            if let Some((_, node)) = self.nodes.get(cell.corner(corner)) {
                for (sum, angle) in angles.iter_mut().zip(node) {
                    *sum += weight * angle;
                }
            }
        }
        Ok(JointAngles::from_array(angles))
    }

    /// Returns the integer REBA of the posture for a hand position. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::OutOfDomain`] outside the reachable volume. [`Error::Value`] if the load is
    /// invalid.
    pub fn assess(&self, hand: &Vector3<f64>, conditions: &Conditions) -> Result<Reba> {
        let posture = self.posture(hand)?.posture();
        Worksheet::from_posture(&posture, *conditions).score()
    }

    fn cell(&self, hand: &Vector3<f64>) -> Result<grid::Cell> {
        self.grid.cell(&(hand / self.stature())).ok_or_else(|| out_of_domain(hand))
    }
}

fn out_of_domain(hand: &Vector3<f64>) -> Error {
    Error::OutOfDomain { x: hand.x, y: hand.y, z: hand.z }
}
