//! Cap on the speed of the tool near people.

use ahqp_core::{AugmentedState, Rows};
use nalgebra::Vector3;

use crate::approach::JointMotion;
use crate::error::{Error, check_size, check_slice};

/// Speed near people \[m/s\]: the reduced speed of ISO 10218-1.
const REDUCED: f64 = 0.25;
/// Speed at [`FAR`] \[m/s\]: a Panda's tool is no faster (Franka Emika's data sheet).
const FULL: f64 = 1.7;
/// Distance up to which the speed is [`REDUCED`] \[m\]: about the reach of a person's arm.
const NEAR: f64 = 0.6;
/// Distance from which there is no cap \[m\]: more than a person's step and reach.
const FAR: f64 = 2.0;

/// Largest speed of the tool as a function of the distance to the nearest person.
///
/// ```
/// use hrsw_safety::SpeedCap;
///
/// assert_eq!(SpeedCap::limit(0.2), 0.25);
/// assert_eq!(SpeedCap::limit(10.0), f64::INFINITY);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct SpeedCap;

/// Axes and diagonals of a cube. The polyhedron |dᵢ · v| ≤ h has no point farther from zero than h
/// / [`INNER`].
const DIRECTIONS: [[f64; 3]; 7] = {
    const D: f64 = 0.577_350_269_189_625_8;
    [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [D, D, D],
        [D, D, -D],
        [D, -D, D],
        [D, -D, -D],
    ]
};

/// 1/√(1 + (√3 − 1)²): the distance from zero to the facets of the hull of ±dᵢ.
const INNER: f64 = 0.806_898_221_355_073_5;

/// Speed that is admitted beyond what braking needs \[m/s\]. Rows that admit a single velocity hold
/// only to the accuracy of the solver.
const ROOM: f64 = 1e-6;

impl SpeedCap {
    /// Number of rows of [`rows`](Self::rows).
    pub const ROWS: usize = DIRECTIONS.len();

    /// Returns the largest speed at `distance` \[m\] from the nearest person \[m/s\]: 0.25 m/s up to
    /// 0.6 m, growing linearly to 1.7 m/s at 2 m, and infinite beyond.
    pub fn limit(distance: f64) -> f64 {
        if distance >= FAR {
            return f64::INFINITY;
        }
        let share = ((distance - NEAR) / (FAR - NEAR)).max(0.0);
        REDUCED + share * (FULL - REDUCED)
    }

    /// Returns the block of rows, which bounds nothing yet.
    pub fn rows(state: AugmentedState) -> Rows {
        let mut rows = Rows::zeros(Self::ROWS, state.len());
        rows.set_free();
        rows
    }

    /// Writes rows for ‖v − w‖ ≤ `speed`. v is the velocity of the reference point of the Jacobian
    /// and w that of the `person`.
    ///
    /// The bound holds along 7 directions, each with both signs, and is never exceeded between
    /// them. The rows are relaxed so that they admit rest, and [`JointMotion::braking`] with 1e-6
    /// m/s to spare. An infinite speed bounds nothing. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if an argument does not fit. [`Error::Value`] if the speed is negative or a
    /// number is not finite.
    pub fn write(
        motion: &JointMotion<'_>,
        person: &Vector3<f64>,
        speed: f64,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        check_size("the block of rows", rows.len(), Self::ROWS)?;
        let joints = motion.jacobian.ncols();
        check_size("the braking velocity", motion.braking.map_or(joints, <[f64]>::len), joints)?;
        check_slice("the Jacobian", motion.jacobian.as_slice())?;
        check_slice("the velocity of the person", person.as_slice())?;
        if speed.is_nan() || speed < 0.0 {
            let (name, expected) = ("the cap of the speed", "not negative");
            return Err(Error::Value { what: name, got: speed, wanted: expected });
        }
        for (index, direction) in DIRECTIONS.iter().enumerate() {
            let direction = Vector3::from(*direction);
            let row = rows.row_mut(index)?;
            row.fill(0.0);
            for (out, [linear, _]) in row.iter_mut().zip(motion.columns(joints)) {
                *out = linear.dot(&direction);
            }
            let along = |rates: &[f64]| row.iter().zip(rates).map(|(a, b)| a * b).sum::<f64>();
            let braking = motion.braking.map_or(0.0, along);
            let (bound, carried) = (INNER * speed, direction.dot(person));
            rows.upper_mut()[index] = (bound + carried).max(braking.max(0.0) + ROOM);
            rows.lower_mut()[index] = (carried - bound).min(braking.min(0.0) - ROOM);
        }
        Ok(())
    }
}
