//! A robot with two arms on a differential base: the right hand reaches for a point two metres away,
//! the left one keeps its pose beside it, and base, lift and arms share the work.
use nalgebra::{Isometry3, Point3};
use whole_body::{
    Base, Description, Error, Ik, LimitOverride, Model, PositionTask, PostureTask,
    RelativeFrameTask, WheelLimit,
};

fn main() -> Result<(), Error> {
    let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/urdf/two_arms.urdf");
    let base = LimitOverride { velocity: Some(1.0), acceleration: Some(1.0), ..Default::default() };
    let limits = ["base_x", "base_y", "base_yaw"].map(|joint| (joint.to_owned(), base)).to_vec();
    let description = Description { base: Base::Planar, limits, ..Description::default() };
    let model = Model::from_urdf_file(urdf, &description)?;
    let (right, left) = (model.frame_id("right_hand")?, model.frame_id("left_hand")?);
    let mut q = model.neutral();
    let mut builder = Ik::builder(&model);
    builder.limit("wheels", WheelLimit::differential(0.8, 0.5));
    let reach = builder.push("reach", PositionTask::new(right));
    let together = builder.push("together", RelativeFrameTask::new(right, left));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build()?;
    ik.task_mut(reach)?.set_target(Point3::new(2.0, 1.0, 0.9))?;
    ik.task_mut(together)?.set_target(Isometry3::translation(0.0, 0.3, 0.0))?;
    ik.task_mut(posture)?.set_target(&q)?;
    for _ in 0..8000 {
        ik.step(&q, 1e-3)?.integrate(&mut q)?;
    }
    assert!(
        (ik.pose(&q, right)?.translation.vector - nalgebra::Vector3::new(2.0, 1.0, 0.9)).norm()
            < 0.01
    );
    Ok(())
}
