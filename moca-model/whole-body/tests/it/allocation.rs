//! No function of the control path allocates after construction.

use allocation_counter::measure;
use nalgebra::{DMatrix, IsometryMatrix3, Matrix3, Matrix3xX, Matrix6xX, Point3, Vector3, Vector6};
use whole_body::limits::FrameVelocityLimit;
use whole_body::simulation::{Contact, JointDrive, RigidBodySimulation, SensorSettings, Sensors};
use whole_body::state::{ExternalWrench, Payload};
use whole_body::tasks::{
    AxisTask, CentreOfMassTask, DampingTask, FrameTask, ManipulabilityTask, PostureTask,
};
use whole_body::torque::{
    Compensation, ContactForce, JointState, MomentumObserver, ObserverSettings, TorqueControl,
    TorqueSettings,
};
use whole_body::{Axes, Base, Data, Description, Ik, Model};

use crate::support::stacks;

#[test]
fn the_counter_counts() {
    assert!(measure(|| drop(std::hint::black_box(vec![1_u8]))).count_total > 0);
}

/// The number of allocations of all functions that a loop may call.
fn allocations(urdf: &str, base: Base, frame: &str) -> u64 {
    let model = Model::from_urdf(urdf, &Description { base, ..Description::default() }).unwrap();
    let n = model.velocity_count();
    let frame = model.frame_id(frame).unwrap();
    let root = model.frames().next().unwrap().0;
    let mut data = Data::new(&model);
    let (mut q, neutral) = (model.neutral(), model.neutral());
    let refused = vec![f64::NAN; q.len()];
    let (v, mut out) = (vec![0.1; n], vec![0.0; n]);
    let mut jacobian = Matrix6xX::zeros(n);
    let mut centre = Matrix3xX::zeros(n);
    let mut mass = DMatrix::zeros(n, n);
    let mut placements = vec![IsometryMatrix3::identity(); model.frame_count()];
    let wrench = [ExternalWrench { frame, wrench: Vector6::repeat(1.0) }];
    let centre_of_payload = Point3::new(0.0, 0.0, 0.1);
    let payload =
        Payload { frame, mass: 1.0, centre: centre_of_payload, inertia: Matrix3::identity() };
    measure(|| {
        for _ in 0..3 {
            let held = data.attach(&model, &payload).unwrap();
            model.integrate(&mut q, &v).unwrap();
            assert!(model.is_configuration(&q) && !model.is_configuration(&refused));
            model.difference(&neutral, &q, &mut out).unwrap();
            let mut posed = data.pose(&model, &q).unwrap();
            posed.world_from(frame).unwrap();
            posed.placements_into(&mut placements).unwrap();
            posed.relative_pose(root, frame).unwrap();
            posed.jacobian_into(frame, Axes::Local, &mut jacobian).unwrap();
            posed.relative_jacobian_into(root, frame, &mut jacobian).unwrap();
            posed.gravity_into(&mut out).unwrap();
            posed.centre_of_mass();
            posed.centre_of_mass_jacobian_into(&mut centre).unwrap();
            posed.mass_matrix_into(&mut mass).unwrap();
            posed.effective_mass(frame, &Vector3::x_axis()).unwrap();
            let mut moving = posed.moving(&v).unwrap();
            moving.twist(frame, Axes::World).unwrap();
            moving.jacobian_rate_times_velocity(frame, Axes::Local).unwrap();
            moving.inverse_dynamics_into(&v, &wrench, &mut out).unwrap();
            moving.bias_forces_into(&mut out).unwrap();
            moving.forward_dynamics_into(&v, &wrench, &mut out).unwrap();
            moving.friction_into(&mut out).unwrap();
            std::hint::black_box((moving.kinetic_energy(), moving.momentum()));
            data.detach(&model, held).unwrap();
        }
    })
    .count_total
}

#[test]
fn kinematics_and_dynamics_allocate_nothing() {
    let humanoid = include_str!("../golden/humanoid.urdf");
    assert_eq!(allocations(humanoid, Base::Floating, "left_palm"), 0);
    // Mimic joints need the factorisation by Cholesky.
    let two_arms = include_str!("../golden/two_arms.urdf");
    assert_eq!(allocations(two_arms, Base::Planar, "left_finger2_link"), 0);
}

#[test]
fn torques_observation_and_simulation_allocate_nothing() {
    let model = crate::momentum::arm(true);
    let home = crate::momentum::HOME;
    let tool = model.frame_id("panda_tcp").unwrap();
    let mut control =
        TorqueControl::new(&model, TorqueSettings::new(Compensation::BARE), &home).unwrap();
    let mut observer = MomentumObserver::new(&model, ObserverSettings::default()).unwrap();
    let mut contact = ContactForce::new(&model, tool, &[]).unwrap();
    let drives = [JointDrive::Torque { rotor_inertia: 0.1 }; 7];
    let mut robot = RigidBodySimulation::new(&model, &drives, &home).unwrap();
    let noise = SensorSettings { delay: 2, loss: 0.1, ..SensorSettings::ideal(&model) };
    let mut sensors = Sensors::new(noise, &home).unwrap();
    let mut random = crate::simulation::Noise(stacks::Random(3));
    let wall = Contact::wall(tool, Vector3::x_axis(), 0.4);
    robot.contacts_mut().push(wall);
    let push = [ExternalWrench { frame: tool, wrench: Vector6::repeat(1.0) }];
    robot.step(&[0.0; 7], &push, 1e-3).unwrap(); // room for wrenches and contacts
    let mut data = Data::new(&model);
    let count = measure(|| {
        for tick in 0..100 {
            sensors.measure(&robot, &mut random).unwrap();
            let mut moving =
                data.pose(&model, sensors.position()).unwrap().moving(sensors.velocity()).unwrap();
            let found = observer.update(&mut moving, sensors.torque(), 1e-3).unwrap();
            contact.estimate(moving.posed(), found).unwrap();
            if tick == 50 {
                control.give_way();
            }
            let measured =
                JointState { position: sensors.position(), velocity: sensors.velocity() };
            let torque = control.step(&[0.2; 7], measured, 0.0, 1e-3).unwrap();
            robot.step(torque, &push, 1e-3).unwrap();
        }
    })
    .count_total;
    assert_eq!(count, 0);
}

/// The number of allocations of `steps` of a stack after its construction.
fn allocations_of_steps(model: &Model) -> u64 {
    let tip = model.frames().last().unwrap().0;
    let mut builder = Ik::builder(model);
    builder.limit("slow", FrameVelocityLimit::new(tip, Vector3::repeat(0.1), Vector3::repeat(0.1)));
    builder.push("above", ManipulabilityTask::new(tip, 0.1));
    let frame = builder.push("frame", FrameTask::new(tip));
    let axis = builder.push("axis", AxisTask::new(tip, Vector3::z_axis()));
    let centre = builder.push("centre", CentreOfMassTask::new(model));
    let posture = builder.push("posture", PostureTask::new());
    builder.push("rest", DampingTask::new());
    let mut ik = builder.build().unwrap();
    let mut q = model.neutral();
    ik.task_mut(posture).unwrap().set_target(&q).unwrap();
    ik.task_mut(axis).unwrap().set_target(Vector3::y_axis()).unwrap();
    ik.task_mut(centre).unwrap().set_target(Point3::new(0.1, 0.0, 0.3)).unwrap();
    let start = ik.pose(&q, tip).unwrap();
    measure(|| {
        for tick in 0..100 {
            let mut target = start;
            target.translation.vector += Vector3::new(0.0, 0.01 * f64::from(tick), 0.1);
            ik.task_mut(frame).unwrap().set_target(target).unwrap();
            let step = ik.step(&q, 1e-3).unwrap();
            step.integrate(&mut q).unwrap();
            let reports = step.levels().count() + step.active_limits().count();
            std::hint::black_box((reports, step.active_rows().count(), step.slack(frame).unwrap()));
        }
        ik.brake(1e-3).unwrap();
    })
    .count_total
}

#[test]
fn steps_allocate_nothing() {
    assert_eq!(allocations_of_steps(&stacks::panda()), 0);
    assert_eq!(allocations_of_steps(&stacks::humanoid()), 0);
}
