//! A humanoid reaches down with one hand. Its feet stay in place and its centre of mass above them.
use nalgebra::Vector3;
use whole_body::stack::TaskLevel;
use whole_body::tasks::{Axis, CentreOfMassTask, FrameTask, PositionTask, PostureTask};
use whole_body::{Base, Data, Description, Error, Ik, Model};

fn main() -> Result<(), Error> {
    let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/urdf/humanoid.urdf");
    let description = Description { base: Base::Floating, ..Description::default() };
    let model = Model::from_urdf_file(urdf, &description)?;
    let feet = [model.frame_id("left_foot")?, model.frame_id("right_foot")?];
    let hand = model.frame_id("right_hand")?;
    let mut q = model.neutral();
    for (joint, angle) in
        [("hip_pitch", -0.4), ("knee", 0.8), ("ankle_pitch", -0.4), ("elbow", -1.0)]
    {
        for side in ["left", "right"] {
            let id = model.joint_id(&format!("{side}_{joint}"))?;
            q[model.joint(id)?.position_index] = angle;
        }
    }
    let mut stand = TaskLevel::new("stand");
    stand.push("left", FrameTask::new(feet[0]));
    stand.push("right", FrameTask::new(feet[1]));
    let mut builder = Ik::builder(&model);
    builder.push_level(stand);
    let axes = [Axis::X, Axis::Y];
    let balance = builder.push("balance", CentreOfMassTask::new(&model).with_axes(&axes));
    let reach = builder.push("reach", PositionTask::new(hand));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&q)?; // the feet, and the posture, stay as they are there
    let middle = nalgebra::center(
        &ik.pose(&q, feet[0])?.translation.vector.into(),
        &ik.pose(&q, feet[1])?.translation.vector.into(),
    );
    ik.task_mut(balance)?.set_target(middle)?;
    let goal = ik.pose(&q, hand)?.translation.vector + Vector3::new(0.25, 0.1, -0.4);
    ik.task_mut(reach)?.set_target(goal)?;
    let start = ik.pose(&q, feet[0])?;
    for _ in 0..6000 {
        ik.step(&q, 1e-3)?.integrate(&mut q)?;
    }
    assert!((ik.pose(&q, hand)?.translation.vector - goal).norm() < 1e-3);
    assert!((ik.pose(&q, feet[0])?.translation.vector - start.translation.vector).norm() < 1e-4);
    let centre = Data::new(&model).pose(&model, &q)?.centre_of_mass();
    assert!((centre - middle).xy().norm() < 1e-3);
    Ok(())
}
