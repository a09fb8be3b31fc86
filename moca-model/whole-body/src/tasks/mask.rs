//! The coordinates of a vector that a task controls, and their weights.

use nalgebra::Vector3;

use crate::error::Error;

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    Z,
}

/// The coordinates of a vector that a task controls, with their weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VectorMask {
    pub(crate) chosen: [bool; 3],
    pub(crate) weights: Vector3<f64>,
}

impl Default for VectorMask {
    fn default() -> Self {
        Self { chosen: [true; 3], weights: Vector3::repeat(1.0) }
    }
}

impl VectorMask {
    pub(crate) fn choose(&mut self, axes: &[Axis]) {
        self.chosen = [Axis::X, Axis::Y, Axis::Z].map(|axis| axes.contains(&axis));
    }

    pub(crate) fn len(&self) -> usize {
        self.iter().count()
    }

    /// The chosen coordinates, counted from 0.
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> + use<> {
        self.chosen.into_iter().enumerate().filter(|(_, chosen)| *chosen).map(|(axis, _)| axis)
    }

    /// The vector without the coordinates that are not chosen.
    pub(crate) fn apply(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| if self.chosen[axis] { vector[axis] } else { 0.0 })
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        check_weights(self.weights.as_slice())
    }
}

/// Returns an error unless all weights are zero or positive numbers of sensible size.
pub(crate) fn check_weights(weights: &[f64]) -> Result<(), Error> {
    let fits = |weight: &&f64| **weight == 0.0 || (1e-100..=1e100).contains(*weight);
    match weights.iter().find(|weight| !fits(weight)) {
        None => Ok(()),
        Some(&value) => {
            let expected = "from 1e-100 to 1e100, or zero to leave a row out";
            Err(Error::value("a weight", value, expected))
        }
    }
}
