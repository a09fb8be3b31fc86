//! Maps from recordings, and comparison of a map with recordings.

use nalgebra::{Matrix4, SMatrix, Vector3, Vector4};
use rayon::prelude::*;

use super::ErgonomicsMap;
use super::grid::Grid;
use super::samples::MeasuredSample;
use crate::error::{Error, Result, finite, within};
use crate::joints::{DOF, JointAngles};
use crate::person::Person;
use crate::quadratic::{correlation, ranks};
use crate::reba::{Conditions, Mode, ergonomics_score};
use crate::region::Region;
use crate::side::Side;

/// Smallest number of samples around a node, for a linear model in three variables.
const FEWEST: usize = 6;
/// Largest distance of the samples' centre from the node, in radii. A larger one would extrapolate.
const OFF_CENTRE: f64 = 0.5;
/// Weight of a zero slope relative to the samples, so that few samples cannot tilt a node.
const RIDGE: f64 = 1e-3;

/// Options for maps from recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredOptions {
    /// The working hand.
    pub side: Side,
    /// Distance between nodes, in statures.
    pub spacing: f64,
    /// Radius around a node within which samples count for it, in statures.
    pub radius: f64,
    /// Conversion of the printed classes to continuous scores.
    pub mode: Mode,
}

impl Default for MeasuredOptions {
    fn default() -> Self {
        Self { side: Side::Right, spacing: 0.05, radius: 0.09, mode: Mode::Graded }
    }
}

/// Agreement of a map with recordings from which it was not made.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// Number of samples within the map's domain.
    pub samples: usize,
    /// Number of samples outside the map's domain, which no other field counts.
    pub outside: usize,
    /// Root mean square difference of `e_s`.
    pub score_rmse: f64,
    /// Mean of `e_s` of the map minus that of the measurement.
    pub score_bias: f64,
    /// Spearman's rank correlation of `e_s`.
    pub spearman: f64,
    /// Root mean square difference of each joint \[rad\].
    pub joint_rmse: JointAngles,
}

impl ErgonomicsMap {
    /// Creates the map of a person from recorded postures instead of predicted ones (as the paper's
    /// authors did).
    ///
    /// Each node gets the joint angles of a linear model of the samples around it, weighted by (1 -
    /// (distance / radius)²)². A node is outside the domain if fewer than six samples are around
    /// it, or only on one side.
    ///
    /// # Errors
    /// [`Error::Value`] if stature, options or samples are invalid. [`Error::TooFewSamples`] if no
    /// node has enough samples.
    pub fn from_samples(
        stature: f64,
        samples: &[MeasuredSample],
        options: &MeasuredOptions,
    ) -> Result<Self> {
        Self::from_samples_of(&Person::new(stature)?, samples, options)
    }

    /// Creates the map of a person whose segments were measured too, which the map stores.
    ///
    /// # Errors
    /// Those of [`Self::from_samples`].
    pub fn from_samples_of(
        person: &Person,
        samples: &[MeasuredSample],
        options: &MeasuredOptions,
    ) -> Result<Self> {
        let stature = person.stature();
        let radius =
            within("radius", options.radius, [options.spacing.max(1e-3), 0.5], "statures")?;
        for sample in samples {
            sample.hand.iter().try_for_each(|x| finite("hand of a sample", *x).map(drop))?;
            sample.angles.validate()?;
        }
        let too_few = Error::TooFewSamples {
            what: "a measured map (within one radius of a node)",
            got: samples.len(),
            wanted: FEWEST,
        };
        if samples.len() < FEWEST {
            return Err(too_few);
        }
        let samples: Vec<(Vector3<f64>, [f64; DOF])> =
            samples.iter().map(|s| (s.hand / stature, s.angles.to_array())).collect();
        let around = Region::around(samples.iter().map(|(hand, _)| *hand));
        let grid = Grid::covering(&around.grown(0.5 * options.spacing), options.spacing)?;
        let nodes: Vec<_> = (0..grid.len())
            .into_par_iter()
            .map(|index| {
                let angles = local_posture(&samples, &grid.node(index), radius)?;
                let posture = JointAngles::from_array(angles).posture();
                let score = ergonomics_score(&posture, &Conditions::default(), options.mode);
                Some((score, angles))
            })
            .collect();
        let nodes = nodes.into_iter().collect();
        let (person, side, mode) = (person.clone(), options.side, options.mode);
        let map = Self { person, side, mode, grid, nodes };
        if map.is_empty() { Err(too_few) } else { Ok(map) }
    }

    /// Returns the agreement of this map with recordings. To validate predictions, predict for the
    /// person, record them at other hand positions than those of the map, and compare.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] if fewer than two samples lie in the domain.
    pub fn validate(&self, samples: &[MeasuredSample]) -> Result<Validation> {
        let (mut ours, mut theirs, mut squares) = (Vec::new(), Vec::new(), [0.0; DOF]);
        for sample in samples {
            let (Ok(angles), Ok(score)) = (self.posture(&sample.hand), self.sample(&sample.hand))
            else {
                continue;
            };
            let posture = sample.angles.posture();
            ours.push(score.score);
            theirs.push(ergonomics_score(&posture, &Conditions::default(), self.mode));
            let pairs = angles.to_array().into_iter().zip(sample.angles.to_array());
            for (sum, (a, b)) in squares.iter_mut().zip(pairs) {
                *sum += (a - b) * (a - b);
            }
        }
        let count = ours.len();
        if count < 2 {
            return Err(Error::TooFewSamples { what: "validation", got: count, wanted: 2 });
        }
        let n = count as f64;
        let differences = || ours.iter().zip(&theirs).map(|(a, b)| a - b);
        Ok(Validation {
            samples: count,
            outside: samples.len() - count,
            score_rmse: (differences().map(|d| d * d).sum::<f64>() / n).sqrt(),
            score_bias: differences().sum::<f64>() / n,
            spearman: correlation(&ranks(&ours), &ranks(&theirs)),
            joint_rmse: JointAngles::from_array(squares.map(|sum| (sum / n).sqrt())),
        })
    }
}

/// Returns the joint angles at a point by weighted linear regression over the samples around it.
fn local_posture(
    samples: &[(Vector3<f64>, [f64; DOF])],
    at: &Vector3<f64>,
    radius: f64,
) -> Option<[f64; DOF]> {
    let (mut count, mut centre, mut total) = (0, Vector3::zeros(), 0.0);
    let mut normal = Matrix4::zeros();
    let mut right = SMatrix::<f64, 4, DOF>::zeros();
    for (hand, angles) in samples {
        let offset = (hand - at) / radius;
        let left = 1.0 - offset.norm_squared();
        if left <= 0.0 {
            continue;
        }
        let weight = left * left;
        let basis = Vector4::new(1.0, offset.x, offset.y, offset.z);
        normal += basis * basis.transpose() * weight;
        for (mut column, angle) in right.column_iter_mut().zip(angles) {
            column += basis * (weight * angle);
        }
        count += 1;
        total += weight;
        centre += offset * weight;
    }
    if count < FEWEST || (centre / total).norm() > OFF_CENTRE {
        return None;
    }
    normal += Matrix4::from_diagonal(&Vector4::new(0.0, 1.0, 1.0, 1.0)) * (RIDGE * total);
    let solution = normal.cholesky()?.solve(&right);
    let row = solution.row(0);
    Some(core::array::from_fn(|joint| row[joint]))
}
