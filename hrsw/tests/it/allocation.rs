//! What is called a thousand times a second allocates nothing.

use std::hint::black_box;

use ahqp_core::AugmentedState;
use hrsw::{
    ApproachRows, Attachment, BodyRegion, Bounds, Capsule, ClockSettings, Cone, Contact,
    ContactLimits, Fault, JointMotion, LoopClock, MovingSettings, MovingWorkspace, Observation,
    OrientedBox, PersonBody, Polytope, PositionShape, RobotBody, SeparationSettings, SoftWorkspace,
    Softening, SpeedCap, Supervisor, SupervisorSettings, Workspace,
};
use nalgebra::{DMatrix, Isometry3, Matrix6xX, UnitQuaternion, Vector3, Vector6};

#[test]
fn a_tick_allocates_nothing() {
    let state = AugmentedState { joints: 10, task: 6, slack: 6 };
    let bounds = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.8, 0.3, 1.5)).unwrap();
    let turn = Bounds::symmetric(Vector3::repeat(0.3)).unwrap();
    let turned = OrientedBox::new(Isometry3::rotation(Vector3::z() * 0.3), bounds).unwrap();
    let corners = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
    let shapes: [PositionShape; 4] = [
        turned.into(),
        Polytope::hull(&corners).unwrap().into(),
        Capsule::sphere(Vector3::x(), 0.4).unwrap().into(),
        bounds.into(),
    ];
    let cone = Cone::new(Vector3::z(), -Vector3::x(), 0.4).unwrap();
    let workspace = Workspace::new(Isometry3::identity(), bounds, turn).unwrap();
    let mut moving = MovingWorkspace::new(workspace, MovingSettings::default()).unwrap();
    moving.attach(Attachment::Person(Isometry3::identity())).unwrap();
    let softening = Softening { position_rows: 12, ..Softening::default() };
    let soft = SoftWorkspace::with_softening(state, 0.2, softening).unwrap();
    let mut level = soft.level().unwrap();
    let capsule =
        |x: f64| Capsule::new(Vector3::new(x, 0.1, 0.0), Vector3::new(x, 0.0, 0.4), 0.1).unwrap();
    let robot: Vec<_> =
        (0..5).map(|i| RobotBody { capsule: capsule(0.2 * f64::from(i)), joints: 10 }).collect();
    let person: Vec<_> = (0..8_u8)
        .map(|i| PersonBody {
            assumed_speed: 1.6,
            capsule: capsule(1.0 + 0.2 * f64::from(i)),
            velocity: None,
            age: 0.1,
            uncertainty: 0.0,
            contact: ContactLimits::default()
                .of(BodyRegion::ALL[3 + usize::from(i)])
                .map(|limit| Contact { limit, fastest: 0.25, velocity: None }),
        })
        .collect();
    let jacobian = Matrix6xX::from_fn(10, |i, j| (i as f64 - j as f64).sin());
    let rest = [0.0; 10];
    let inverse_inertia = DMatrix::identity(10, 10);
    let motion = JointMotion {
        jacobian: &jacobian,
        origin: Vector3::zeros(),
        velocity: &rest,
        braking: Some(&rest),
        change: Some(&rest),
        inverse_inertia: Some(&inverse_inertia),
    };
    let settings = SeparationSettings::default();
    let mut separation = ApproachRows::new(state, settings, 20).unwrap();
    let mut own = ApproachRows::new(state, settings, 4).unwrap();
    let (mut separation_rows, mut own_rows) = (separation.rows(), own.rows());
    let mut cap_rows = SpeedCap::rows(state);
    let mut supervisor = Supervisor::new(SupervisorSettings::default()).unwrap();
    let mut clock = LoopClock::new(1e-3, ClockSettings::default()).unwrap();
    let desired = Isometry3::translation(0.6, 0.4, 1.0);

    let tick = |tick: usize| {
        if tick.is_multiple_of(50) {
            let walked = Isometry3::translation(tick as f64 * 1e-4, 0.0, 0.0);
            moving.observe_person(walked, Vector6::zeros(), 0.05).unwrap();
            moving.reshape_position(&shapes[(tick / 300) % 4], 0.2).unwrap();
            moving.set_lead(Vector3::x() * 0.1).unwrap();
            let goal = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 3.0);
            moving.reorient(goal, &Vector3::z_axis()).unwrap();
            let orientation = if tick % 1000 < 500 { cone.into() } else { turn.into() };
            moving.reshape_orientation(&orientation, 0.2).unwrap();
        }
        moving.advance(1e-3).unwrap();
        soft.write(moving.workspace(), &desired, &mut level).unwrap();
        black_box(moving.workspace().violation(&desired));
        let nearest = separation.write(&motion, &robot, &person, &mut separation_rows).unwrap();
        own.write_own(&motion, &robot, &[(0, 2), (0, 3), (1, 4)], &mut own_rows).unwrap();
        let distance = nearest.map_or(f64::INFINITY, |pair| pair.distance);
        let cap = SpeedCap::default().limit(distance);
        SpeedCap::write(&motion, &Vector3::zeros(), cap, &mut cap_rows).unwrap();
        black_box(clock.tick(1e-3 * tick as f64));
        black_box(clock.frame(1e-3 * tick as f64 - 0.05).is_ok());
        supervisor.report(Fault::LateTick);
        supervisor.update(&Observation { nearest, age: clock.age() }, 1e-3);
        black_box(supervisor.speed_scale());
    };
    assert_eq!(allocation_counter::measure(|| (0..4000).for_each(tick)).count_total, 0);
}
