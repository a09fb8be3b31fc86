//! A Panda whose hand follows a circle: position before orientation before posture.
use nalgebra::{Point3, Vector3};
use whole_body::{Description, Error, Ik, Model, OrientationTask, PositionTask, PostureTask};

fn main() -> Result<(), Error> {
    let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/urdf/panda.urdf");
    let model = Model::from_urdf_file(urdf, &Description::default())?;
    let hand = model.frame_id("panda_hand_tcp")?;
    let mut q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let mut builder = Ik::builder(&model);
    let position = builder.push("position", PositionTask::new(hand));
    let orientation = builder.push("orientation", OrientationTask::new(hand));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build()?;
    let start = ik.pose(&q, hand)?;
    ik.task_mut(orientation)?.set_target(start.rotation)?;
    ik.task_mut(posture)?.set_target(&q)?;
    for tick in 0..8000 {
        let (sine, cosine) = (f64::from(tick) * 1e-3 * 1.57).sin_cos();
        let target = start.translation.vector + 0.1 * Vector3::new(0.0, sine, cosine - 1.0);
        ik.task_mut(position)?.set_target(Point3::from(target))?;
        ik.step(&q, 1e-3)?.integrate(&mut q)?; // or send step.velocity() to the robot
    }
    Ok(())
}
