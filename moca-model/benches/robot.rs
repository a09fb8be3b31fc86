//! Time of single calls for MOCA, n = 10, from q on.
//!
//! Run `cargo bench -p moca-model`.
#![allow(clippy::unwrap_used, missing_docs)]

use divan::{Bencher, black_box};
use moca_model::whole_body::{Axes, Data, FrameId, Model};
use moca_model::{Kinematics, MOCA_HOME, MOCA_TOOL, moca, moca_safety};
use nalgebra::Matrix6xX;

fn main() {
    divan::main();
}

/// The robot, a configuration and memory for results.
struct Bench {
    model: Model,
    data: Data,
    tool: FrameId,
    q: [f64; 10],
    jacobian: Matrix6xX<f64>,
    gravity: [f64; 10],
}

fn bench(bencher: Bencher, mut call: impl FnMut(&mut Bench)) {
    let model = moca().unwrap();
    let mut bench = Bench {
        data: Data::new(&model),
        tool: model.frame_id(MOCA_TOOL).unwrap(),
        q: MOCA_HOME.map(|position| position + 0.1),
        jacobian: Matrix6xX::zeros(10),
        gravity: [0.0; 10],
        model,
    };
    bencher.bench_local(move || call(black_box(&mut bench)));
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, .. }| {
        black_box(data.pose(model, q).unwrap().world_from(*tool).unwrap());
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_jacobian(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, jacobian, .. }| {
        let posed = data.pose(model, q).unwrap();
        black_box(posed.world_from(*tool).unwrap());
        posed.jacobian_into(*tool, Axes::World, jacobian).unwrap();
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_gravity(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, gravity, .. }| {
        let mut posed = data.pose(model, q).unwrap();
        black_box(posed.world_from(*tool).unwrap());
        posed.gravity_into(gravity).unwrap();
    });
}

#[divan::bench(sample_count = 500, sample_size = 100)]
fn fk_jacobian_gravity(bencher: Bencher) {
    bench(bencher, |Bench { model, data, tool, q, jacobian, gravity }| {
        let mut posed = data.pose(model, q).unwrap();
        black_box(posed.world_from(*tool).unwrap());
        posed.jacobian_into(*tool, Axes::World, jacobian).unwrap();
        posed.gravity_into(gravity).unwrap();
    });
}

/// The kinematics of a tick of the controller: tool, Jacobian and places of the bodies.
#[divan::bench(sample_count = 500, sample_size = 100)]
fn kinematics_of_a_tick(bencher: Bencher) {
    let bodies = moca_safety().bodies;
    let mut robot = Kinematics::new(moca().unwrap(), MOCA_TOOL, &bodies, &MOCA_HOME).unwrap();
    let q = MOCA_HOME.map(|position| position + 0.1);
    bencher.bench_local(move || robot.update(black_box(&q)).unwrap());
}

/// Ticks of the controller with a person who works with the moving robot, by velocities and down to torque.
mod tick {
    use std::cell::RefCell;

    use divan::{Bencher, black_box};
    use ergo_map::ErgonomicsQuadratic;
    use moca_model::whole_body::simulation::RandomSource;
    use moca_model::whole_body::torque::Compensation;
    use moca_model::{
        Controller, ControllerSettings, DynamicRobot, DynamicRobotSettings, MOCA_HOME, Measured,
        SimulatedRobot, TorqueController, TorqueLoopSettings, moca,
    };
    use nalgebra::{Matrix3, Point3, Vector3};
    use vision_models::{Action, Body, Body25, Confidence, Keypoint, Percept, RecognisedAction};

    const PERIOD: f64 = 1e-3;
    /// Number of ticks between two camera frames.
    const FRAME: u32 = 50;

    /// Random numbers of a sensor without noise.
    struct Exact;

    impl RandomSource for Exact {
        fn normal(&mut self) -> f64 {
            0.0
        }

        fn uniform(&mut self) -> f64 {
            1.0
        }
    }

    fn controller() -> Controller {
        let hessian = Matrix3::identity() * 8.0;
        let best = Vector3::new(0.35, -0.1, 1.1);
        let ergonomics = ErgonomicsQuadratic::new(hessian, -(hessian * best), 1.0).unwrap();
        Controller::new(moca().unwrap(), ergonomics, ControllerSettings::default(), &MOCA_HOME)
            .unwrap()
    }

    fn percept(time: f64) -> Percept {
        let mut body = Body::default();
        for (joint, y, z) in [
            (Body25::RightShoulder, 0.2, 1.43),
            (Body25::LeftShoulder, -0.2, 1.43),
            (Body25::RightHip, 0.12, 0.93),
            (Body25::LeftHip, -0.12, 0.93),
            (Body25::MidHip, 0.0, 0.93),
        ] {
            let position = Point3::new(1.6 + 0.2 * (0.5 * time).sin(), y, z);
            body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
        }
        let action = Action::DeliverObject;
        let action = Some(RecognisedAction { action, confidence: Confidence::ONE });
        Percept { time, body: Some(body), action, surface: None }
    }

    #[divan::bench(sample_count = 10000, sample_size = 1)]
    fn by_velocities(bencher: Bencher) {
        let robot = SimulatedRobot::new(&moca().unwrap(), &MOCA_HOME).unwrap();
        let state = RefCell::new((controller(), robot, 0_u32));
        let next = || {
            let (controller, robot, tick) = &mut *state.borrow_mut();
            robot.step(&controller.command().joint_velocity, PERIOD).unwrap();
            let now = f64::from(*tick) * PERIOD;
            if tick.is_multiple_of(FRAME) {
                controller.observe(&percept(now)).unwrap();
            }
            *tick += 1;
            now
        };
        bencher.with_inputs(next).bench_local_values(|now| {
            let (controller, robot, _) = &mut *state.borrow_mut();
            black_box(controller.step(now, robot.position()).unwrap());
        });
    }

    #[divan::bench(sample_count = 10000, sample_size = 1)]
    fn by_torques(bencher: Bencher) {
        let settings = DynamicRobotSettings::ideal();
        let robot = DynamicRobot::new(&moca().unwrap(), &settings, &MOCA_HOME).unwrap();
        let controller =
            TorqueController::new(controller(), TorqueLoopSettings::new(Compensation::BARE))
                .unwrap();
        let state = RefCell::new((controller, robot, 0_u32));
        let next = || {
            let (controller, robot, tick) = &mut *state.borrow_mut();
            let (command, torque) = (controller.controller().command(), controller.torque());
            robot.step(command, torque, &[], PERIOD, &mut Exact).unwrap();
            robot.measure(&mut Exact).unwrap();
            let now = f64::from(*tick) * PERIOD;
            if tick.is_multiple_of(FRAME) {
                controller.observe(&percept(now)).unwrap();
            }
            *tick += 1;
            now
        };
        bencher.with_inputs(next).bench_local_values(|now| {
            let (controller, robot, _) = &mut *state.borrow_mut();
            let measured: Measured<'_> = robot.measured();
            black_box(controller.step(now, &measured).unwrap());
        });
    }
}
