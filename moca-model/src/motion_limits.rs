//! What the joints and the desired pose may do in the next tick.

use ahqp_core::{AugmentedState, Limits, MotionState, Rows, VelocityInterval};
use whole_body::Model;

use crate::error::Error;
use crate::robot::moca::{MOCA_AXIS_SPEED, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED};

/// A mecanum base whose wheels limit |v_x| + |v_y| + lever |ω| in its own frame, and whose
/// controller limits |v_x| and |v_y|.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MecanumBase {
    /// Largest sum \[m/s\].
    pub speed: f64,
    /// The lever of the yaw rate \[m\].
    pub lever: f64,
    /// Largest speed along each of its own axes \[m/s\].
    pub axis_speed: f64,
}

impl Default for MecanumBase {
    /// The SUMMIT-XL STEEL's.
    fn default() -> Self {
        Self { speed: MOCA_WHEEL_SPEED, lever: MOCA_WHEEL_LEVER, axis_speed: MOCA_AXIS_SPEED }
    }
}

/// Signs of v_x, v_y and ω in the eight rows of the wheel limit.
const WHEEL_SIGNS: [[f64; 3]; 8] = [
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, 1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [-1.0, -1.0, -1.0],
];

/// Signs of v_x and v_y in the four rows of the axes' limit.
const AXIS_SIGNS: [[f64; 3]; 4] =
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];

impl MecanumBase {
    /// Rows for [`write`](Self::write).
    pub fn rows(&self, state: AugmentedState) -> Rows {
        Rows::zeros(WHEEL_SIGNS.len() + AXIS_SIGNS.len(), state.len())
    }

    /// Writes ±v_x ± v_y ± lever ω ≤ speed and ±v_x, ±v_y ≤ axis speed for base velocities in world axes (the first three
    /// joints) at the given yaw \[rad\].
    ///
    /// The velocity nearest to rest that the `intervals` of the three joints allow is always
    /// admitted, so that turning while driving at the limit cannot make the problem infeasible.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] for rows that [`rows`](Self::rows) has not made.
    pub fn write(
        &self,
        yaw: f64,
        intervals: &[VelocityInterval],
        rows: &mut Rows,
    ) -> Result<(), Error> {
        let (sine, cosine) = yaw.sin_cos();
        let wheels = WHEEL_SIGNS.into_iter().map(|signs| (signs, self.speed));
        let axes = AXIS_SIGNS.into_iter().map(|signs| (signs, self.axis_speed));
        for (index, ([x, y, turn], limit)) in wheels.chain(axes).enumerate() {
            // v_body = R(yaw)ᵀ v_world.
            let coefficients = [x * cosine - y * sine, x * sine + y * cosine, turn * self.lever];
            let braked: f64 = coefficients
                .iter()
                .zip(intervals)
                .map(|(coefficient, interval)| coefficient * nearest_to_rest(interval))
                .sum();
            for (entry, coefficient) in rows.row_mut(index)?.iter_mut().zip(coefficients) {
                *entry = coefficient;
            }
            rows.lower_mut()[index] = f64::NEG_INFINITY;
            rows.upper_mut()[index] = limit.max(braked);
        }
        Ok(())
    }
}

/// The velocity of the interval with the least magnitude.
pub(crate) fn nearest_to_rest(interval: &VelocityInterval) -> f64 {
    0.0_f64.max(interval.lower).min(interval.upper)
}

/// The limits of all joints as [`Limits`].
///
/// # Errors
/// [`Error::Hierarchy`] for limits that are not positive or empty.
pub(crate) fn joint_limits(model: &Model) -> Result<Vec<Limits>, Error> {
    model
        .limits()
        .iter()
        .map(|l| Ok(Limits::new(l.lower, l.upper, l.velocity, l.acceleration)?))
        .collect()
}

/// Lets joints outside their position limits wait: the interval of each that the limits force
/// back is widened to admit braking, and what they force goes to `returns`, which bounds nothing
/// for the others.
pub(crate) fn admit_braking(
    limits: &[Limits],
    position: &[f64],
    velocity: &[f64],
    period: f64,
    intervals: &mut [VelocityInterval],
    returns: &mut [VelocityInterval],
) {
    let joints = limits.iter().zip(position).zip(velocity);
    for ((interval, forced), ((limits, &position), &velocity)) in
        intervals.iter_mut().zip(returns).zip(joints)
    {
        *forced = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        if position < limits.lower() || position > limits.upper() {
            let change = limits.acceleration() * period;
            let braked = velocity - velocity.clamp(-change, change);
            *forced = *interval;
            interval.lower = interval.lower.min(braked);
            interval.upper = interval.upper.max(braked);
        }
    }
}

/// The velocities that each coordinate may take for the next `period`, if only `elapsed` has passed
/// since it took the last.
pub(crate) fn write_intervals(
    limits: &[Limits],
    position: &[f64],
    velocity: &[f64],
    scale: f64,
    [period, elapsed]: [f64; 2],
    intervals: &mut [VelocityInterval],
) {
    for (((interval, limits), &position), &velocity) in
        intervals.iter_mut().zip(limits).zip(position).zip(velocity)
    {
        let state = MotionState { position, velocity };
        *interval = limits.slowed(scale).velocity_interval(state, period);
        if elapsed < period {
            let change = limits.acceleration() * elapsed;
            let reachable = |end: f64| end.clamp(velocity - change, velocity + change);
            interval.lower = reachable(interval.lower);
            interval.upper = reachable(interval.upper);
        }
    }
}

/// Lets each coordinate brake for `elapsed` seconds.
pub(crate) fn brake(limits: &[Limits], elapsed: f64, velocity: &mut [f64]) {
    for (velocity, limits) in velocity.iter_mut().zip(limits) {
        let change = limits.acceleration() * elapsed;
        *velocity -= velocity.clamp(-change, change);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_rows_are_the_wheel_limit_in_the_base_frame(
            yaw in -4.0..4.0_f64, v in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let state = AugmentedState { joints: 10, task: 6, slack: 6 };
            let base = MecanumBase::default();
            let mut rows = base.rows(state);
            let rest = [VelocityInterval { lower: -1.0, upper: 1.0 }; 3];
            base.write(yaw, &rest, &mut rows).unwrap();
            let values: Vec<f64> = rows
                .iter()
                .map(|(row, _, _)| row.iter().zip(v).map(|(a, b)| a * b).sum())
                .collect();
            let largest = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
            let (sine, cosine) = yaw.sin_cos();
            let (x, y) = (cosine * v[0] + sine * v[1], cosine * v[1] - sine * v[0]);
            let wheels = x.abs() + y.abs() + base.lever * v[2].abs();
            prop_assert!((largest(&values[..8]) - wheels).abs() < 1e-12);
            prop_assert!((largest(&values[8..]) - x.abs().max(y.abs())).abs() < 1e-12);
            prop_assert!(rows.upper()[..8].iter().all(|&upper| upper == base.speed));
            prop_assert!(rows.upper()[8..].iter().all(|&upper| upper == base.axis_speed));
        }

        #[test]
        fn the_braking_velocity_is_always_admitted(
            yaw in -4.0..4.0_f64,
            ends in prop::array::uniform3((-9.0..9.0_f64, 0.0..0.1_f64)),
        ) {
            let state = AugmentedState { joints: 10, task: 6, slack: 6 };
            let intervals =
                ends.map(|(lower, width)| VelocityInterval { lower, upper: lower + width });
            let mut rows = MecanumBase::default().rows(state);
            MecanumBase::default().write(yaw, &intervals, &mut rows).unwrap();
            let braked = intervals.map(|interval| nearest_to_rest(&interval));
            for (row, _, upper) in rows.iter() {
                let value: f64 = row.iter().zip(braked).map(|(a, b)| a * b).sum();
                prop_assert!(value <= upper + 1e-12);
            }
        }
    }
}
