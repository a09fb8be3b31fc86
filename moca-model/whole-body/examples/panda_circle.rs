//! Moves a Panda's tool on a circle, with position before orientation before posture.
use std::io::Write;
use whole_body::tasks::{OrientationTask, PositionTask, PostureTask};
use whole_body::{Description, Ik, Model};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::from_urdf(include_str!("urdf/panda.urdf"), &Description::default())?;
    let tool = model.frame_id("panda_hand_tcp")?;
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let mut builder = Ik::builder(&model);
    let position = builder.push("position", PositionTask::new(tool));
    builder.push("orientation", OrientationTask::new(tool));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q)?; // orientation and posture stay as they are there
    let start = ik.pose(&q, tool)?.translation.vector;
    for angle in (0..8000).map(|tick| 1.57e-3 * f64::from(tick)) {
        let shift = 0.1 * nalgebra::vector![0.0, angle.sin(), angle.cos() - 1.0];
        ik.task_mut(position)?.set_target(start + shift)?;
        ik.step(&q, 1e-3)?.integrate(&mut q)?; // send step.velocity() to a real robot as well
    }
    Ok(writeln!(std::io::stdout(), "{q:?}")?)
}
