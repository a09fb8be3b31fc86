//! Stacks of three moving robots, for benchmarks of `Ik::step`.

use nalgebra::{Isometry3, Point3, Vector3};
use whole_body::limits::{FrameVelocityLimit, WheelLimit};
use whole_body::robot::LimitOverride;
use whole_body::stack::{TaskId, TaskLevel};
use whole_body::tasks::{
    Axis, CentreOfMassTask, FrameTask, OrientationTask, PositionTask, PostureTask, VelocityTask,
};
use whole_body::{Base, Description, Ik, Model};

/// A stack whose tools move on circles of 5 cm.
pub(crate) struct Loop {
    pub(crate) ik: Ik,
    q: Vec<f64>,
    tools: Vec<(Tool, Vector3<f64>)>,
    tick: u32,
}

enum Tool {
    Position(TaskId<PositionTask>),
    Pose(TaskId<FrameTask>, Isometry3<f64>),
}

impl Loop {
    /// Moves the targets, steps and integrates.
    pub(crate) fn step(&mut self) {
        let angle = 1.5e-3 * f64::from(self.tick);
        self.tick += 1;
        let shift = Vector3::new(0.0, 0.05 * angle.sin(), 0.05 * angle.cos() - 0.05);
        for (tool, start) in &self.tools {
            match tool {
                Tool::Position(id) => {
                    let target = Point3::from(start + shift);
                    self.ik.task_mut(*id).unwrap().set_target(target).unwrap();
                }
                Tool::Pose(id, pose) => {
                    let mut target = *pose;
                    target.translation.vector = start + shift;
                    self.ik.task_mut(*id).unwrap().set_target(target).unwrap();
                }
            }
        }
        let step = self.ik.step(std::hint::black_box(&self.q), 1e-3).unwrap();
        step.integrate(&mut self.q).unwrap();
    }
}

/// A Panda: position before orientation before posture.
pub(crate) fn panda() -> Loop {
    let urdf = include_str!("../../examples/urdf/panda.urdf");
    let model = Model::from_urdf(urdf, &Description::default()).unwrap();
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let q = vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let mut builder = Ik::builder(&model);
    let position = builder.push("position", PositionTask::new(tool));
    let orientation = builder.push("orientation", OrientationTask::new(tool));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    let start = ik.pose(&q, tool).unwrap();
    ik.task_mut(orientation).unwrap().set_target(start.rotation).unwrap();
    ik.task_mut(posture).unwrap().set_target(&q).unwrap();
    Loop { ik, q, tools: vec![(Tool::Position(position), start.translation.vector)], tick: 0 }
}

/// Two arms on a base: wheels, positions of both tools, their orientations, the head, the base's place, posture.
pub(crate) fn two_arms() -> Loop {
    let urdf = include_str!("../../examples/urdf/two_arms.urdf");
    let [linear, angular] = [(1.0, 1.0), (2.0, 3.0)].map(|(v, a)| LimitOverride::of_speed(v, a));
    let description = Description::on_planar_base(linear, angular);
    let model = Model::from_urdf(urdf, &description).unwrap();
    let mut q = model.neutral();
    for side in ["left", "right"] {
        for (joint, angle) in [("elbow", -1.5), ("shoulder_pitch", 0.5)] {
            let id = model.joint_id(&format!("{side}_{joint}")).unwrap();
            q[model.joint(id).unwrap().position_index] = angle;
        }
    }
    let frames =
        ["left_hand", "right_hand", "head", "base"].map(|name| model.frame_id(name).unwrap());
    let [left, right, head, base] = frames;
    let mut builder = Ik::builder(&model);
    builder.limit("wheels", WheelLimit::mecanum(1.0, 0.4));
    let mut positions = TaskLevel::new("positions");
    let tools = [
        positions.push("left", PositionTask::new(left)),
        positions.push("right", PositionTask::new(right)),
    ];
    builder.push_level(positions);
    let mut orientations = TaskLevel::new("orientations");
    let turns = [
        (orientations.push("left", OrientationTask::new(left)), left),
        (orientations.push("right", OrientationTask::new(right)), right),
    ];
    builder.push_level(orientations);
    let centre = builder.push("centre", CentreOfMassTask::new(&model).with_axes(&[Axis::Y]));
    let gaze = builder.push("gaze", OrientationTask::new(head).with_axes(&[Axis::Y, Axis::Z]));
    let place = builder.push("place", PositionTask::new(base).with_axes(&[Axis::X, Axis::Y]));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    for (task, frame) in turns.into_iter().chain([(gaze, head)]) {
        let start = ik.pose(&q, frame).unwrap().rotation;
        ik.task_mut(task).unwrap().set_target(start).unwrap();
    }
    ik.task_mut(centre).unwrap().set_target(Point3::origin()).unwrap();
    ik.task_mut(place).unwrap().set_target(Point3::origin()).unwrap();
    ik.task_mut(posture).unwrap().set_target(&q).unwrap();
    let tools = tools.into_iter().zip([left, right]);
    let tools = tools
        .map(|(id, frame)| (Tool::Position(id), ik.pose(&q, frame).unwrap().translation.vector))
        .collect();
    Loop { ik, q, tools, tick: 0 }
}

/// A humanoid: feet, centre of mass, both tools, head, posture. The speed of the tools is limited (12 rows), and 48
/// rows stand for distances to obstacles.
pub(crate) fn humanoid() -> Loop {
    let urdf = include_str!("../../examples/urdf/humanoid.urdf");
    let description = Description { base: Base::Floating, ..Description::default() };
    let model = Model::from_urdf(urdf, &description).unwrap();
    let mut q = model.neutral();
    for side in ["left", "right"] {
        for (joint, angle) in
            [("elbow", -1.5), ("hip_pitch", -0.4), ("knee", 0.8), ("ankle_pitch", -0.4)]
        {
            let id = model.joint_id(&format!("{side}_{joint}")).unwrap();
            q[model.joint(id).unwrap().position_index] = angle;
        }
    }
    let names = ["left_foot", "right_foot", "left_hand", "right_hand", "head"];
    let frames = names.map(|name| model.frame_id(name).unwrap());
    let [left_foot, right_foot, left, right, head] = frames;
    let mut builder = Ik::builder(&model);
    for (name, tool) in [("slow left", left), ("slow right", right)] {
        let limit = FrameVelocityLimit::new(tool, Vector3::repeat(1.0), Vector3::repeat(2.0));
        builder.limit(name, limit);
    }
    let mut obstacles = VelocityTask::new(48);
    for row in 0..48_u32 {
        let coefficients: Vec<f64> = (0_u32..)
            .take(model.velocity_count())
            .map(|entry| (f64::from(row * 37 + entry * 11)).sin())
            .collect();
        obstacles.set_row(row as usize, &coefficients, f64::NEG_INFINITY, 3.0).unwrap();
    }
    builder.limit("obstacles", obstacles);
    let mut feet = TaskLevel::new("feet");
    let mut poses = vec![
        (feet.push("left", FrameTask::new(left_foot)), left_foot),
        (feet.push("right", FrameTask::new(right_foot)), right_foot),
    ];
    builder.push_level(feet);
    let centre =
        builder.push("centre", CentreOfMassTask::new(&model).with_axes(&[Axis::X, Axis::Y]));
    let mut tools = TaskLevel::new("tools");
    let moving = [
        (tools.push("left", FrameTask::new(left)), left),
        (tools.push("right", FrameTask::new(right)), right),
    ];
    builder.push_level(tools);
    poses.push((builder.push("head", FrameTask::new(head)), head));
    let posture = builder.push("posture", PostureTask::new());
    let mut ik = builder.build().unwrap();
    for (task, frame) in poses {
        let start = ik.pose(&q, frame).unwrap();
        ik.task_mut(task).unwrap().set_target(start).unwrap();
    }
    let mut data = whole_body::Data::new(&model);
    let start = data.pose(&model, &q).unwrap().centre_of_mass();
    ik.task_mut(centre).unwrap().set_target(start).unwrap();
    ik.task_mut(posture).unwrap().set_target(&q).unwrap();
    let tools = moving
        .into_iter()
        .map(|(id, frame)| {
            let pose = ik.pose(&q, frame).unwrap();
            (Tool::Pose(id, pose), pose.translation.vector)
        })
        .collect();
    Loop { ik, q, tools, tick: 0 }
}
