//! A control loop: an arm on a slide brings its tool to a target, and then itself to its middle,
//! within its limits.
#![allow(clippy::print_stdout)]

use ahqp_core::nalgebra::{self, dmatrix};
use ahqp_core::{Hierarchy, Level, Limits, MotionState, Rows, Settings, Solver};

fn main() -> Result<(), ahqp_core::Error> {
    const PERIOD: f64 = 1e-3; // s
    let limits = [Limits::new(-0.5, 0.5, 0.2, 1.0)?, Limits::new(-0.3, 0.3, 1.0, 5.0)?];
    let mut joints = [MotionState { position: 0.0, velocity: 0.0 }; 2]; // slide, arm

    // The variables are the velocities of slide and arm. The first level is the tool's, the second
    // the arm's.
    let mut hierarchy = Hierarchy::new(2)?;
    let tool = Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &[0.0])?);
    let tool = hierarchy.push(tool.named("tool"))?;
    let middle = Level::least_squares(Rows::equalities(&dmatrix![0.0, 1.0], &[0.0])?);
    let middle = hierarchy.push(middle.named("arm in the middle"))?;
    let mut solver = Solver::new(&hierarchy, Settings::default())?;

    for _tick in 0..8000 {
        let (lower, upper) = hierarchy.bounds_mut();
        for (i, (limits, joint)) in limits.iter().zip(joints).enumerate() {
            let interval = limits.velocity_interval(joint, PERIOD);
            (lower[i], upper[i]) = (interval.lower, interval.upper);
        }
        let position = joints[0].position + joints[1].position;
        hierarchy.rows_mut(tool)?.set_targets(&[2.0 * (0.4 - position)])?;
        hierarchy.rows_mut(middle)?.set_targets(&[-2.0 * joints[1].position])?;
        let velocities = solver.solve(&hierarchy)?.optimum()?;
        for (joint, &velocity) in joints.iter_mut().zip(velocities) {
            *joint = MotionState { position: joint.position + PERIOD * velocity, velocity };
        }
    }
    println!("slide {:.4} m, arm {:.4} m", joints[0].position, joints[1].position);
    Ok(())
}
