//! Limits of joints.

use ahqp_core::{AcceleratedState, JerkLimits};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Vector, to_vector, vector, vector_of};
use crate::failure::{Failure, Result};

/// Lower and upper ends.
type Interval<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Position, velocity, acceleration and jerk limits of n joints, as one interval of velocities. The interval is never
/// empty, and any velocity in it allows the limits to hold for ever.
///
/// `Limits(lower, upper, velocity, acceleration, jerk=None)`: arrays of shape (n,) in rad or m and their
/// rates; without `jerk` it is not limited.
///
/// >>> from ahqp import Limits
/// >>> limits = Limits([-1.0], [1.0], [2.0], [10.0])
/// >>> limits.velocity_interval([0.0], [0.0], 1e-3)[1].tolist()
/// [0.01]
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Limits(Vec<JerkLimits>);

#[pymethods]
impl Limits {
    #[new]
    #[pyo3(signature = (lower, upper, velocity, acceleration, jerk=None))]
    fn new(
        lower: &Bound<'_, PyAny>,
        upper: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        acceleration: &Bound<'_, PyAny>,
        jerk: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self> {
        let lower = vector("lower", lower)?;
        let n = lower.len();
        let upper = vector_of("upper", upper, n)?;
        let velocity = vector_of("velocity", velocity, n)?;
        let acceleration = vector_of("acceleration", acceleration, n)?;
        let jerk = jerk.map(|jerk| vector_of("jerk", jerk, n)).transpose()?;
        let joints = (0..n).map(|joint| {
            let jerk = jerk.as_ref().map_or(f64::INFINITY, |jerk| jerk.as_array()[joint]);
            let [lower, upper, velocity, acceleration] =
                [&lower, &upper, &velocity, &acceleration].map(|limit| limit.as_array()[joint]);
            let limits = ahqp_core::Limits::new(lower, upper, velocity, acceleration);
            limits.and_then(|limits| limits.with_jerk(jerk)).map_err(|error| {
                crate::failure::Error::new_err(format!("joint {joint}: {error}")).into()
            })
        });
        joints.collect::<Result<_>>().map(Self)
    }

    /// The velocities for the next `period` seconds.
    ///
    /// Parameters
    /// ----------
    /// position : array_like, shape (n,)
    /// velocity : array_like, shape (n,)
    ///     The last commanded velocity.
    /// period : float
    ///     [s]
    /// acceleration : array_like, shape (n,), optional
    ///     The change of `velocity` over the last period, divided by the period; zero if not given.
    ///     It counts where the jerk is limited.
    ///
    /// Returns
    /// -------
    /// lower, upper : ndarray, shape (n,)
    #[pyo3(signature = (position, velocity, period, acceleration=None))]
    fn velocity_interval<'py>(
        &self,
        py: Python<'py>,
        position: &Bound<'py, PyAny>,
        velocity: &Bound<'py, PyAny>,
        period: f64,
        acceleration: Option<&Bound<'py, PyAny>>,
    ) -> Result<Interval<'py>> {
        if !(period > 0.0 && period.is_finite()) {
            let text = format!("period is {period} s; it must be positive and finite");
            return Err(Failure::value(text));
        }
        let states = self.states(position, velocity, acceleration)?;
        let intervals: Vec<_> = self
            .0
            .iter()
            .zip(states)
            .map(|(limits, state)| limits.velocity_interval(state, period))
            .collect();
        let ends = |end: fn(&ahqp_core::VelocityInterval) -> f64| -> Vec<f64> {
            intervals.iter().map(end).collect()
        };
        let (lower, upper) = (ends(|interval| interval.lower), ends(|interval| interval.upper));
        Ok((to_vector(py, &lower), to_vector(py, &upper)))
    }

    /// True if a state obeys the limits, up to rounding, and can go on obeying them; one value for each joint.
    #[pyo3(signature = (position, velocity, acceleration=None))]
    fn admits(
        &self,
        position: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        acceleration: Option<&Bound<'_, PyAny>>,
    ) -> Result<Vec<bool>> {
        let states = self.states(position, velocity, acceleration)?;
        Ok(self.0.iter().zip(states).map(|(limits, state)| limits.admits(state)).collect())
    }

    /// The number of joints.
    fn __len__(&self) -> usize {
        self.0.len()
    }
}

impl Limits {
    fn states(
        &self,
        position: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        acceleration: Option<&Bound<'_, PyAny>>,
    ) -> Result<Vec<AcceleratedState>> {
        let n = self.0.len();
        let position = finite("position", vector_of("position", position, n)?)?;
        let velocity = finite("velocity", vector_of("velocity", velocity, n)?)?;
        let acceleration = match acceleration {
            Some(acceleration) => {
                finite("acceleration", vector_of("acceleration", acceleration, n)?)?
            }
            None => vec![0.0; n],
        };
        let entries = position.into_iter().zip(velocity).zip(acceleration);
        Ok(entries
            .map(|((position, velocity), acceleration)| AcceleratedState {
                position,
                velocity,
                acceleration,
            })
            .collect())
    }
}

fn finite(name: &str, vector: Vector<'_>) -> Result<Vec<f64>> {
    let numbers = vector.as_array().to_vec();
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(entry) => {
            let value = numbers[entry];
            let text = format!("entry {entry} of {name} is {value}; it must be finite");
            Err(Failure::value(text))
        }
    }
}
