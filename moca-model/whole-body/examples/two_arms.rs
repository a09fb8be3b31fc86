//! A robot with two arms on a differential base. The right tool reaches for a point two metres away, and the left one
//! keeps its pose beside it. Base, lift and arms share the work.
use nalgebra::{Isometry3, vector};
use whole_body::limits::WheelLimit;
use whole_body::robot::LimitOverride;
use whole_body::tasks::{PositionTask, PostureTask, RelativeFrameTask};
use whole_body::{Description, Error, Ik, Model};

fn main() -> Result<(), Error> {
    let slow = LimitOverride::of_speed(1.0, 1.0);
    let description = Description::on_planar_base(slow, slow);
    let model = Model::from_urdf(include_str!("urdf/two_arms.urdf"), &description)?;
    let (right, left) = (model.frame_id("right_hand")?, model.frame_id("left_hand")?);
    let mut q = model.neutral();
    let mut builder = Ik::builder(&model);
    builder.limit("wheels", WheelLimit::differential(0.8, 0.5));
    let reach = builder.push("reach", PositionTask::new(right));
    let together = builder.push("together", RelativeFrameTask::new(right, left));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q)?;
    let goal = vector![2.0, 1.0, 0.9];
    ik.task_mut(reach)?.set_target(goal)?;
    ik.task_mut(together)?.set_target(Isometry3::translation(0.0, 0.3, 0.0))?;
    for _ in 0..8000 {
        ik.step(&q, 1e-3)?.integrate(&mut q)?;
    }
    assert!((ik.pose(&q, right)?.translation.vector - goal).norm() < 0.01);
    Ok(())
}
