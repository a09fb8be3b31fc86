//! Projected Levenberg–Marquardt inside an augmented Lagrangian.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};

use super::active_joints;
use super::effort::{Effort, GUARD_STIFFNESS};
use super::normal::Normal;
use crate::joints::DOF;
use crate::kinematics::Pose;
use crate::skeleton::hand_axes;

/// Penalties on the hand's squared error (statures and radians) of the first passes. The last one
/// is kept while the multipliers converge.
///
/// The first penalty is so weak that the body comes close to rest from every start. The following
/// ones pull the hand to its goal with increasing strength.
const PENALTIES: [f64; 5] = [1.0, 1e1, 1e2, 1e3, 1e4];
/// Largest number of multiplier updates.
const OUTER: usize = 12;
/// Largest number of steps of each pass.
const INNER: usize = 40;
/// Largest joint motion at which a pass ends \[rad\]: early passes, last passes.
const STEP: [f64; 2] = [1e-2, 1e-7];
/// Force on the hand (penalty × error) at which the target is given up. To hold the hand there, the
/// effort would have to grow by this much per stature. This loses the outermost half per cent of
/// reach.
const OUT_OF_REACH: f64 = 400.0;
/// Error at which the hand has arrived, in statures and radians.
const ARRIVED: f64 = 1e-7;

/// Goal of the hand, in statures, right-handed.
#[derive(Debug, Clone)]
pub(super) struct Goal {
    pub(super) position: Vector3<f64>,
    pub(super) orientation: Option<Rotation3<f64>>,
}

impl Goal {
    pub(super) fn new(position: Vector3<f64>, orientation: Option<Rotation3<f64>>) -> Self {
        Self { position, orientation }
    }
}

/// Result of the search.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    pub(super) q: [f64; DOF],
    pub(super) effort: f64,
    /// Hand error in statures.
    pub(super) distance: f64,
    /// Orientation error in radians, 0 if orientation does not matter.
    pub(super) angle: f64,
}

/// The error of the hand: position and, if it matters, orientation.
type HandError = (Vector3<f64>, Vector3<f64>);

pub(super) struct Solver<'a> {
    effort: &'a Effort,
    goal: &'a Goal,
    active: usize,
    /// Penalties of the passes. The last one is kept.
    penalties: &'static [f64],
    penalty: f64,
    /// Multipliers divided by the penalty, which shift the target.
    shift: HandError,
}

impl<'a> Solver<'a> {
    pub(super) fn new(effort: &'a Effort, goal: &'a Goal) -> Self {
        let zero = Vector3::zeros();
        let active = active_joints(goal.orientation.is_some());
        Self { effort, goal, active, penalties: &PENALTIES, penalty: 0.0, shift: (zero, zero) }
    }

    /// Minimises effort(q) + multipliers · error(q) + ½ penalty ‖error(q)‖² over q in its limits.
    /// The multipliers are updated until the error vanishes.
    pub(super) fn run(mut self, start: [f64; DOF]) -> Outcome {
        // Joints that take no part are at rest.
        let neutral = self.effort.neutral();
        let start = core::array::from_fn(|i| if i < self.active { start[i] } else { neutral[i] });
        let mut q = self.projected(&start);
        let mut passes = OUTER;
        for penalty in self.penalties {
            self.penalty = *penalty;
            let pose = self.minimise(&mut q, STEP[0]);
            if penalty * self.error(&pose).0.norm() > OUT_OF_REACH {
                passes = 0;
                break;
            }
        }
        let mut last = f64::INFINITY;
        for _ in 0..passes {
            let pose = self.minimise(&mut q, STEP[1]);
            let (position, angle) = self.error(&pose);
            let norm = position.norm().max(angle.norm());
            if norm < ARRIVED || norm > 0.5 * last {
                break;
            }
            last = norm;
            self.shift.0 += position;
            self.shift.1 += angle;
        }
        let pose = Pose::new(self.effort.body(), &q);
        let (position, angle) = self.error(&pose);
        let effort = self.effort.cost(&q, &pose, &self.goal.position, GUARD_STIFFNESS);
        Outcome { q, effort, distance: position.norm(), angle: angle.norm() }
    }

    /// Runs one pass of projected Levenberg–Marquardt.
    fn minimise(&self, q: &mut [f64; DOF], tolerance: f64) -> Pose {
        let mut damping = 1e-3;
        let mut pose = Pose::new(self.effort.body(), q);
        let mut normal = self.linearise(q, &pose);
        for _ in 0..INNER {
            let Some(step) = self.step(q, &normal, damping) else {
                damping *= 10.0;
                continue;
            };
            let mut trial = *q;
            for i in 0..DOF {
                trial[i] += step[i];
            }
            let trial = self.projected(&trial);
            let moved = trial.iter().zip(q.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let trial_pose = Pose::new(self.effort.body(), &trial);
            if self.cost(&trial, &trial_pose) <= normal.cost {
                *q = trial;
                pose = trial_pose;
                if moved < tolerance {
                    break;
                }
                normal = self.linearise(q, &pose);
                damping = (damping * 0.1).max(1e-9);
            } else {
                damping *= 10.0;
                if moved < STEP[1] || damping > 1e9 {
                    break;
                }
            }
        }
        pose
    }

    /// Returns the damped Newton step of the joints that are free to move.
    fn step(&self, q: &[f64; DOF], normal: &Normal, damping: f64) -> Option<SVector<f64, DOF>> {
        let (min, max) = self.effort.limits();
        let mut matrix: SMatrix<f64, DOF, DOF> = normal.matrix + normal.curvature;
        let mut gradient = normal.gradient;
        for i in 0..DOF {
            let held = i >= self.active
                || (q[i] <= min[i] && gradient[i] > 0.0)
                || (q[i] >= max[i] && gradient[i] < 0.0);
            if held {
                matrix.row_mut(i).fill(0.0);
                matrix.column_mut(i).fill(0.0);
                matrix[(i, i)] = 1.0;
                gradient[i] = 0.0;
            } else {
                matrix[(i, i)] += damping * normal.matrix[(i, i)];
            }
        }
        Some(-matrix.cholesky()?.solve(&gradient))
    }

    /// Returns the stiffness of the balance guard, which grows with the penalty. If it were large
    /// at once, an unbalanced start would fold the body into a corner of its ranges of motion.
    fn guard(&self) -> f64 {
        (1e-4 * self.penalty * self.penalty).min(GUARD_STIFFNESS)
    }

    fn projected(&self, q: &[f64; DOF]) -> [f64; DOF] {
        let (min, max) = self.effort.limits();
        core::array::from_fn(|i| q[i].clamp(min[i], max[i]))
    }

    /// Returns the hand error: position (statures), and the negative rotation vector from hand to
    /// goal. The sign makes it grow with the joints like the position's error.
    fn error(&self, pose: &Pose) -> HandError {
        let angle = self.goal.orientation.map_or_else(Vector3::zeros, |goal| {
            let hand = Rotation3::from_matrix_unchecked(hand_axes(&pose.palm));
            -(goal * hand.inverse()).scaled_axis()
        });
        (pose.hand - self.goal.position, angle)
    }

    fn cost(&self, q: &[f64; DOF], pose: &Pose) -> f64 {
        let (position, angle) = self.error(pose);
        let squares =
            (position + self.shift.0).norm_squared() + (angle + self.shift.1).norm_squared();
        self.effort.cost(q, pose, &self.goal.position, self.guard()) + 0.5 * self.penalty * squares
    }

    fn linearise(&self, q: &[f64; DOF], pose: &Pose) -> Normal {
        let mut normal = self.effort.linearise(q, pose, &self.goal.position, self.guard());
        let (position, angle) = self.error(pose);
        let moves_hand = |i: usize| !(6..8).contains(&i);
        let scale = self.penalty.sqrt();
        let columns = core::array::from_fn(|i| {
            if moves_hand(i) {
                pose.axis[i].cross(&(pose.hand - pose.origin[i]))
            } else {
                Vector3::zeros()
            }
        });
        normal.add_axes(&[0, 1, 2], &(position + self.shift.0), &columns, scale);
        // A joint turns the velocities of all joints beyond it.
        let pull = (position + self.shift.0) * self.penalty;
        for i in (0..self.active).filter(|&i| moves_hand(i)) {
            let turned = pull.cross(&pose.axis[i]);
            for j in (i..self.active).filter(|&j| moves_hand(j)) {
                normal.curvature[(j, i)] = turned.dot(&columns[j]);
            }
        }
        if self.goal.orientation.is_some() {
            let jacobian = inverse_right_jacobian(&-angle);
            let columns = core::array::from_fn(|i| {
                if moves_hand(i) { jacobian * pose.axis[i] } else { Vector3::zeros() }
            });
            normal.add_axes(&[0, 1, 2], &(angle + self.shift.1), &columns, scale);
        }
        normal
    }
}

/// Returns the inverse right Jacobian of SO(3) at a rotation vector: log(exp(φ) exp(δ)) ≈ φ + J⁻¹
/// δ.
fn inverse_right_jacobian(phi: &Vector3<f64>) -> Matrix3<f64> {
    let angle = phi.norm();
    let skew = phi.cross_matrix();
    let factor = if angle < 1e-4 {
        1.0 / 12.0
    } else {
        1.0 / (angle * angle) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin())
    };
    Matrix3::identity() + skew * 0.5 + skew * skew * factor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::person::Person;
    use crate::predict::EffortWeights;
    use proptest::prelude::*;

    #[test]
    fn no_other_way_of_reaching_takes_less_effort() {
        // A strong force from the start sometimes leads to other postures. None of them may be
        // better.
        let effort = Effort::new(&Person::average(), &EffortWeights::default());
        let (min, max) = effort.limits();
        let (mut better, mut arrived, mut state) = (0, 0, 1_u64);
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..50 {
            let place = Vector3::new(random(), random(), random());
            let position = Vector3::new(0.12, -0.28, 0.42)
                + place.component_mul(&Vector3::new(0.3, 0.39, 0.5));
            let goal = Goal::new(position, None);
            let chosen = Solver::new(&effort, &goal).run([0.0; DOF]);
            assert!(chosen.distance < crate::predict::REACHED);
            for _ in 0..10 {
                let start = core::array::from_fn(|i| min[i] + random() * (max[i] - min[i]));
                let mut solver = Solver::new(&effort, &goal);
                solver.penalties = &PENALTIES[2..];
                let other = solver.run(start);
                if other.distance < crate::predict::REACHED {
                    arrived += 1;
                    better += usize::from(other.effort < chosen.effort - 1e-6);
                }
            }
        }
        println!("{arrived} of 500 hard-pulled searches arrived, {better} with less effort");
        assert!(arrived > 250);
        assert!(better * 100 <= arrived, "{better} of {arrived}");
    }

    proptest! {
        #[test]
        fn the_gradient_is_the_derivative_of_the_cost(
            t in proptest::array::uniform15(0.05..0.95_f64),
            position in proptest::array::uniform3(-0.5..0.5_f64),
            turn in proptest::array::uniform3(-1.0..1.0_f64),
            shift in proptest::array::uniform3(-0.1..0.1_f64),
            oriented: bool,
        ) {
            let weights = EffortWeights { load: 5.0, ..EffortWeights::default() };
            let effort = Effort::new(&Person::average(), &weights);
            let orientation = oriented.then(|| Rotation3::new(Vector3::from(turn)));
            let position = Vector3::from(position) + Vector3::new(0.3, -0.1, 0.6);
            let goal = Goal::new(position, orientation);
            let mut solver = Solver::new(&effort, &goal);
            solver.penalty = 30.0;
            let turned = if oriented { Vector3::from(shift) } else { Vector3::zeros() };
            solver.shift = (Vector3::from(shift), turned);
            let (min, max) = effort.limits();
            let q: [f64; DOF] = core::array::from_fn(|i| min[i] + t[i] * (max[i] - min[i]));
            let at = |q: &[f64; DOF]| Pose::new(effort.body(), q);
            // The logarithm jumps at half a turn.
            prop_assume!(solver.error(&at(&q)).1.norm() < 3.0);
            let normal = solver.linearise(&q, &at(&q));
            prop_assert!((normal.cost - solver.cost(&q, &at(&q))).abs() < 1e-9 * normal.cost);
            let step = 1e-6;
            for i in 0..DOF {
                let (mut low, mut high) = (q, q);
                low[i] -= step;
                high[i] += step;
                let slope = (solver.cost(&high, &at(&high)) - solver.cost(&low, &at(&low)))
                    / (2.0 * step);
                let error = (slope - normal.gradient[i]).abs();
                prop_assert!(error < 1e-5 * (1.0 + normal.cost), "{i}: {slope} {error}");
            }
        }
    }
}
