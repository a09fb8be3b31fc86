//! A desired pose stays in a box that moves with a person. Below that it moves as little as
//! possible.
#![allow(clippy::print_stdout)]

use ahqp_core::{AugmentedState, Hierarchy, Level, Rows, Settings, Solver, integrate_pose};
use hrsw::nalgebra::{DMatrix, DVector, Isometry3, Vector3, Vector6};
use hrsw::{Bounds, FrameFollower, SoftWorkspace, Softening, Workspace};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const PERIOD: f64 = 1e-3; // s
    let mut person = FrameFollower::new(Isometry3::identity())?;
    let mut workspace = Workspace::new(
        *person.pose(),
        Bounds::new(Vector3::new(0.25, -0.4, 0.7), Vector3::new(0.75, 0.3, 1.5))?,
        Bounds::symmetric(Vector3::repeat(0.3))?,
    )?;

    // χ = [ẋ_d; s]: the twist of the desired pose and the slack. The joints of a robot would come
    // first.
    let state = AugmentedState { joints: 0, task: 6, slack: 6 };
    let soft = SoftWorkspace::new(state, 0.2, Softening::default())?;
    let mut hierarchy = Hierarchy::new(state.len())?;
    let inside = hierarchy.push(soft.level()?)?;
    let still = Rows::equalities(&DMatrix::identity(6, 12), &DVector::zeros(6))?;
    hierarchy.push(Level::least_squares(still))?;
    let mut solver = Solver::new(&hierarchy, Settings::default())?;

    // The person steps back by half a metre, and the tool follows into the box.
    let mut desired = Isometry3::translation(0.5, 0.0, 1.0);
    person.retarget(Isometry3::translation(-0.5, 0.0, 0.0), Vector6::zeros())?;
    for _tick in 0..4000 {
        person.advance(PERIOD);
        workspace.place(*person.pose(), person.twist())?;
        soft.write_rows(&workspace, &desired, hierarchy.constraints_mut(inside)?)?;
        let x = solver.solve(&hierarchy)?.optimum()?;
        let twist = Vector6::from_column_slice(&x[state.desired_velocity()]);
        desired = integrate_pose(&desired, &twist, PERIOD);
    }
    println!("the tool at x = {:.3} m", desired.translation.x);
    Ok(())
}
