//! Limits on velocities in front of a bound, for accelerations that cannot end at once.

use ahqp_core::Rows;

use super::joint_intervals::JointIntervals;
use crate::vector::dot_of_sizes;

/// Share of a limit by which a row may change while the robot comes to rest. The remainder is for accelerations that
/// change at once, and for rows that change faster on the way.
const KEPT: f64 = 0.5;

/// Narrows the rows of limits so that under jerk limits their values come to rest at the limit and not beyond it.
///
/// A value s = Σ cᵢ q̇ᵢ grows by Σ cᵢ q̈ᵢ²/(2jᵢ) while the joints that drive it towards its limit bring their
/// accelerations to zero. The jerk j of s is the one for which that is S²/(2j), S = Σ cᵢ q̈ᵢ. The next acceleration α
/// is then that of a single joint in front of its velocity limit: α Δt + α²/(2j) = limit − s. Rows of joints without
/// jerk limits are left as they are.
#[derive(Debug, Clone)]
pub(crate) struct Anticipation {
    /// Half the time in which the acceleration of each entry of q̇ ends \[s\].
    ends: Vec<f64>,
    /// True if each row anticipates by itself.
    done: Vec<bool>,
    /// Largest growth of each entry of q̇ until then \[rad/s or m/s\].
    growth: Vec<f64>,
    /// Coefficients of the rows in the last period, row by row; empty before the first.
    past: Vec<f64>,
    /// The longest time of an even stop \[s\].
    stop_time: f64,
}

impl Anticipation {
    /// Creates the anticipation for rows, some of which anticipate by themselves (`done`).
    pub(crate) fn new(velocities: usize, done: Vec<bool>) -> Self {
        let past = Vec::with_capacity(done.len() * velocities);
        let (ends, growth) = (vec![0.0; velocities], vec![0.0; velocities]);
        Self { ends, growth, done, past, stop_time: f64::INFINITY }
    }

    /// The longest time in which the velocities may shrink evenly to zero while the rows hold \[s\]. It is computed
    /// from the last period, and infinite without rows of speeds.
    pub(crate) fn stop_time(&self) -> f64 {
        self.stop_time
    }

    /// Computes the stop time from the change of the rows since the last period.
    ///
    /// At constant velocities the value s of a row changes at the rate b = J̇q̇. While velocities shrink evenly to zero
    /// in a time T, s shrinks at s/T and grows at most at b. If |b| T is below the limit, s stays within it.
    fn observe_turning(&mut self, rows: &Rows, velocity: &[f64], period: f64) {
        let columns = velocity.len();
        self.stop_time = f64::INFINITY;
        let past = self.past.chunks_exact(columns.max(1));
        // Rows of distances have one side. Rows that hold a value at zero leave no room, and the robot could only
        // stand.
        let of_speeds = |range: &(&[f64], f64, f64)| range.2 > 0.0 && range.1 == -range.2;
        for ((row, _, upper), past) in rows.iter().zip(past).filter(|(row, _)| of_speeds(row)) {
            let turned = row.iter().zip(past).zip(velocity);
            let change: f64 = turned.map(|((now, past), velocity)| (now - past) * velocity).sum();
            let limit = KEPT * upper;
            if change.abs() * self.stop_time > limit * period {
                self.stop_time = limit * period / change.abs();
            }
        }
        self.past.clear();
        self.past.extend(rows.iter().flat_map(|(row, ..)| row.iter().take(columns)));
    }

    /// Returns true if some rows do not anticipate by themselves.
    pub(crate) fn is_needed(&self) -> bool {
        self.done.iter().any(|done| !done)
    }

    /// Narrows the rows for the last commanded velocities and accelerations. `values` is scratch memory of one number a
    /// row.
    pub(crate) fn narrow(
        &mut self,
        rows: &mut Rows,
        velocity: &[f64],
        acceleration: &[f64],
        joints: &JointIntervals,
        period: f64,
        values: &mut [f64],
    ) {
        if self.is_needed() {
            self.observe_turning(rows, velocity, period);
        }
        let entries = self.ends.iter_mut().zip(&mut self.growth).zip(acceleration);
        for (entry, ((end, growth), acceleration)) in entries.enumerate() {
            let jerk = joints.jerk(entry);
            if jerk.is_finite() {
                *end = 0.5 * acceleration.abs() / jerk;
                let next = acceleration.abs() + jerk * period;
                *growth = next * period + 0.5 * next * next / jerk;
            }
        }
        if self.growth.iter().all(|growth| *growth == 0.0) || self.done.iter().all(|done| *done) {
            return;
        }
        if rows.multiply_into(0, velocity, values).is_err() {
            return;
        }
        for (index, (&value, done)) in values.iter().zip(&self.done).enumerate() {
            if *done {
                continue;
            }
            let row = rows.row(index).unwrap_or_default();
            let (lower, upper) = (rows.lower()[index], rows.upper()[index]);
            let growth = dot_of_sizes(row, &self.growth);
            if value - lower >= growth && upper - value >= growth {
                continue;
            }
            let row = Row { coefficients: row, value, acceleration, ends: &self.ends, period };
            let narrowed = [
                if value - lower < growth { row.narrowed(lower, -1.0) } else { lower },
                if upper - value < growth { row.narrowed(upper, 1.0) } else { upper },
            ];
            (rows.lower_mut()[index], rows.upper_mut()[index]) =
                (narrowed[0], narrowed[1].max(narrowed[0]));
        }
    }
}

struct Row<'a> {
    coefficients: &'a [f64],
    value: f64,
    acceleration: &'a [f64],
    ends: &'a [f64],
    period: f64,
}

impl Row<'_> {
    /// The bound for the next period, for an upper limit (`sign` 1) or a lower one (−1).
    fn narrowed(&self, limit: f64, sign: f64) -> f64 {
        let (mut driving, mut overrun) = (0.0, 0.0);
        let entries = self.coefficients.iter().zip(self.acceleration).zip(self.ends);
        for ((c, a), end) in entries {
            let part = (sign * c * a).max(0.0);
            driving += part;
            overrun += part * end;
        }
        let excess = sign * (limit - self.value);
        if overrun <= 0.0 || excess <= 0.0 {
            return limit;
        }
        let jerk = 0.5 * driving * driving / overrun;
        let root = (self.period * self.period + 2.0 * excess / jerk).sqrt();
        let next = self.value + sign * (2.0 * excess / (self.period + root)) * self.period;
        if sign > 0.0 { limit.min(next) } else { limit.max(next) }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use nalgebra::dmatrix;

    use super::*;

    /// The stop time after a row has changed from x to y while the second joint moves.
    fn stop_time(lower: f64, upper: f64) -> f64 {
        let mut anticipation = Anticipation::new(2, vec![false]);
        for row in [dmatrix![1.0, 0.0], dmatrix![1.0, 0.01]] {
            let rows = Rows::ranges(&row, &[lower], &[upper]).unwrap();
            anticipation.observe_turning(&rows, &[0.0, 2.0], 1e-3);
        }
        anticipation.stop_time()
    }

    #[test]
    fn only_rows_of_speeds_shorten_the_stop() {
        // The row changes at 20 m/s² beside a limit of 4 m/s, of which half counts.
        assert!((stop_time(-4.0, 4.0) - 0.1).abs() < 1e-12);
        for (lower, upper) in [(0.0, 0.0), (f64::NEG_INFINITY, 0.0), (-1.0, f64::INFINITY)] {
            assert_eq!(stop_time(lower, upper), f64::INFINITY);
        }
    }
}
