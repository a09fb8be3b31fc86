//! The problem of a mobile manipulator's controller, which follows a wandering target in a box.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, SMatrix, Translation3, UnitQuaternion, Vector3, Vector6,
};

use crate::error::Error;
use crate::kinematics::clik::{AugmentedClik, AugmentedState, PoseAxes};
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Level;
use crate::problem::rows::Rows;
use crate::testing::random::Random;

const STATE: AugmentedState = AugmentedState { joints: 10, task: 6, slack: 6 };
/// Control period \[s\].
const PERIOD: f64 = 1e-3;
/// Gain of the inverse kinematics \[1/s\].
const GAIN: f64 = 40.0;
/// Limits of base (x, y, yaw) and arm \[m/s, rad/s\].
const JOINT_SPEED: [f64; 10] = [0.25, 0.25, 0.4, 0.9, 0.9, 0.9, 0.9, 0.9, 0.9, 0.9];
/// Limits of the desired twist \[m/s, rad/s\].
const TASK_SPEED: [f64; 6] = [0.6, 0.6, 0.6, 0.8, 0.8, 0.8];
/// The box around the first pose: below and above \[m, rad\].
const BOX: [[f64; 6]; 2] =
    [[0.10, 0.14, 0.08, 0.25, 0.25, 0.25], [0.16, 0.10, 0.12, 0.25, 0.25, 0.25]];
/// Initial joint positions, base first \[m, rad\].
const START: [f64; 10] = [0.0, 0.0, 0.0, 0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.78];
/// Denavit-Hartenberg parameters by Craig's convention: a \[m\], d \[m\], α \[rad\] of each arm
/// joint.
const ARM: [[f64; 3]; 7] = [
    [0.0, 0.333, 0.0],
    [0.0, 0.0, -FRAC_PI_2],
    [0.0, 0.316, FRAC_PI_2],
    [0.0825, 0.0, FRAC_PI_2],
    [-0.0825, 0.384, -FRAC_PI_2],
    [0.0, 0.0, FRAC_PI_2],
    [0.088, 0.0, FRAC_PI_2],
];

type Jacobian = SMatrix<f64, 6, 10>;

/// Returns the stack of a mobile manipulator with an augmented state of 22 variables, one problem
/// for each millisecond.
///
/// It consists of velocity bounds and inverse kinematics, followed by the box as hard rows softened
/// by a slack. The least slack and a person-side task of three rows come last.
///
/// # Errors
/// Those of [`Hierarchy`]'s constructors, which the sizes here do not cause.
pub fn controller_sequence(seed: u64, ticks: usize) -> Result<Vec<Hierarchy>, Error> {
    let random = &mut Random::new(seed);
    let preference = preference(random);
    let clik = AugmentedClik::new(STATE, PoseAxes::ALL, Vector6::repeat(GAIN), PERIOD)?;
    let mut joints = SMatrix::<f64, 10, 1>::from(START);
    let (start, _) = kinematics(&joints);
    let mut desired = start;
    let mut problems = Vec::with_capacity(ticks);
    for tick in 0..ticks {
        let time = PERIOD * tick as f64;
        let (position, jacobian) = kinematics(&joints);
        let wave = |frequency: f64, phase: f64| (TAU * frequency * time + phase).sin();
        let target = start
            + Vector3::new(
                0.2 * wave(0.8, 0.0),
                0.2 * wave(1.1, 0.4) - 0.0779,
                0.15 * wave(1.7, 0.0),
            );
        let wish = 12.0 * (target - desired);
        let tilt =
            0.15 * Vector3::new((3.0 * time).sin(), (2.0 * time).cos() - 1.0, (4.0 * time).sin());
        // The tracking error plus small noise of the measured pose.
        let noise = [31.0, 17.0, 23.0, 5.0, 7.0, 3.0].map(|rate| 1e-4 * (rate * time).sin());
        let mut error = Vector6::from(noise);
        for i in 0..3 {
            error[i] += desired[i] - position[i];
        }
        let offset = desired - start;
        let room = |side: usize, sign: f64| -> [f64; 6] {
            std::array::from_fn(|i| {
                BOX[side][i] - sign * if i < 3 { offset[i] } else { tilt[i - 3] }
            })
        };

        let mut hierarchy = Hierarchy::new(STATE.len())?;
        let (lower, upper) = hierarchy.bounds_mut();
        for (i, speed) in JOINT_SPEED.iter().chain(&TASK_SPEED).enumerate() {
            (lower[i], upper[i]) = (-speed, *speed);
        }
        let mut tracking = clik.rows();
        clik.write(&DMatrix::from_column_slice(6, 10, jacobian.as_slice()), &error, &mut tracking)?;
        hierarchy.push(Level::least_squares(tracking))?;
        hierarchy.push(Level::constraints_only(box_rows(&room(1, 1.0), &room(0, -1.0))?))?;
        hierarchy.push(Level::least_squares(block(
            STATE.slack().start,
            &DMatrix::identity(6, 6),
            &DVector::zeros(6),
        )?))?;
        let person = DMatrix::from_column_slice(3, 3, preference.as_slice());
        let pull = DVector::from_column_slice((preference * wish).as_slice());
        hierarchy.push(Level::least_squares(block(
            STATE.desired_velocity().start,
            &person,
            &pull,
        )?))?;
        problems.push(hierarchy);

        // The robot moves on, clipped to its box.
        let mut velocity = wish;
        for i in 0..3 {
            let (below, above) = (-BOX[0][i] - offset[i], BOX[1][i] - offset[i]);
            velocity[i] = velocity[i]
                .clamp(-TASK_SPEED[i], TASK_SPEED[i])
                .clamp(below / PERIOD, above / PERIOD);
        }
        let chase = velocity + GAIN * (desired - position);
        let twist = Vector6::new(chase.x, chase.y, chase.z, 0.0, 0.0, 0.0);
        let damped = jacobian * jacobian.transpose() + SMatrix::identity() * 1e-6;
        let step = damped.cholesky().map_or(twist, |factor| factor.solve(&twist));
        let rates = jacobian.transpose() * step;
        for (i, limit) in JOINT_SPEED.iter().enumerate() {
            joints[i] += PERIOD * rates[i].clamp(-limit, *limit);
        }
        desired += PERIOD * velocity;
    }
    Ok(problems)
}

/// Returns a matrix with singular values 1.5, 1 and 0.3 between random rotations.
fn preference(random: &mut Random) -> Matrix3<f64> {
    let mut turn = || {
        let axis = Vector3::new(random.normal(), random.normal(), random.normal());
        UnitQuaternion::from_scaled_axis(axis).to_rotation_matrix().into_inner()
    };
    turn() * Matrix3::from_diagonal(&Vector3::new(1.5, 1.0, 0.3)) * turn()
}

/// Returns the rows Δt ẋ_d − s ≤ above and −Δt ẋ_d − s ≤ below.
fn box_rows(above: &[f64; 6], below: &[f64; 6]) -> Result<Rows, Error> {
    let mut rows = Rows::zeros(12, STATE.len());
    for i in 0..12 {
        let axis = i % 6;
        let row = rows.row_mut(i)?;
        row[STATE.desired_velocity().start + axis] = if i < 6 { PERIOD } else { -PERIOD };
        row[STATE.slack().start + axis] = -1.0;
        rows.lower_mut()[i] = f64::NEG_INFINITY;
        rows.upper_mut()[i] = if i < 6 { above[axis] } else { below[axis] };
    }
    Ok(rows)
}

/// Returns the equalities of `matrix` on the variables from `start` on.
fn block(start: usize, matrix: &DMatrix<f64>, target: &DVector<f64>) -> Result<Rows, Error> {
    let mut wide = DMatrix::zeros(matrix.nrows(), STATE.len());
    wide.view_mut((0, start), matrix.shape()).copy_from(matrix);
    Rows::equalities(&wide, target)
}

/// Returns the position of the tool and its Jacobian in world axes.
fn kinematics(joints: &SMatrix<f64, 10, 1>) -> (Vector3<f64>, Jacobian) {
    let mut pose =
        Isometry3::new(Vector3::new(joints[0], joints[1], 0.0), Vector3::new(0.0, 0.0, joints[2]));
    let mut axes = [(Vector3::z(), pose.translation.vector); 8];
    pose *= Translation3::new(0.2, 0.0, 0.6);
    for (i, [a, d, twist]) in ARM.into_iter().enumerate() {
        pose *= UnitQuaternion::from_axis_angle(&Vector3::x_axis(), twist);
        pose *= UnitQuaternion::from_axis_angle(&Vector3::z_axis(), joints[3 + i]);
        // Craig's frames move by a along the old x and by d along the new z.
        let shift = pose.rotation * Vector3::new(0.0, 0.0, d);
        let along = pose.rotation
            * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -joints[3 + i])
            * Vector3::new(a, 0.0, 0.0);
        pose.translation.vector += shift + along;
        axes[i + 1] = (pose.rotation * Vector3::z(), pose.translation.vector);
    }
    let tool = pose * nalgebra::Point3::new(0.0, 0.0, 0.2);
    let mut jacobian = Jacobian::zeros();
    jacobian[(0, 0)] = 1.0;
    jacobian[(1, 1)] = 1.0;
    for (i, (axis, origin)) in axes.iter().enumerate() {
        let linear = axis.cross(&(tool.coords - origin));
        jacobian.fixed_view_mut::<3, 1>(0, 2 + i).copy_from(&linear);
        jacobian.fixed_view_mut::<3, 1>(3, 2 + i).copy_from(axis);
    }
    (tool.coords, jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jacobian_is_the_derivative_of_the_position() {
        let joints = SMatrix::<f64, 10, 1>::from_fn(|i, _| START[i] + 0.3 * (i as f64).sin());
        let (_, jacobian) = kinematics(&joints);
        for j in 0..10 {
            let at = |step: f64| {
                let mut moved = joints;
                moved[j] += step;
                kinematics(&moved).0
            };
            let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((jacobian.fixed_view::<3, 1>(0, j) - difference).norm() < 1e-8);
        }
    }
}
