//! Functions that are called a thousand times a second allocate nothing.

use std::hint::black_box;

use ahqp_core::AugmentedState;
use hrsw_safety::{
    ApproachRows, BodyRegion, Capsule, Contact, ContactLimits, Fault, JointMotion, LoopClock,
    Observation, PersonBody, RobotBody, SeparationSettings, SpeedCap, Supervisor,
    SupervisorSettings,
};
use nalgebra::{DMatrix, Matrix6xX, Vector3};

#[test]
fn a_tick_allocates_nothing() {
    let state = AugmentedState { joints: 10, task: 6, slack: 6 };
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
    let mut clock = LoopClock::new(1e-3).unwrap();

    let tick = |tick: usize| {
        let nearest = separation.write(&motion, &robot, &person, &mut separation_rows).unwrap();
        own.measure_own(&motion, &robot, &[(0, 2), (0, 3), (1, 4)]).unwrap();
        own.write_rows(&motion, &mut own_rows).unwrap();
        let distance = nearest.map_or(f64::INFINITY, |pair| pair.distance);
        let cap = SpeedCap::limit(distance);
        SpeedCap::write(&motion, &Vector3::zeros(), cap, &mut cap_rows).unwrap();
        black_box(clock.tick(1e-3 * tick as f64));
        black_box(clock.frame(1e-3 * tick as f64 - 0.05).is_ok());
        supervisor.report(Fault::LateTick);
        supervisor.update(&Observation { nearest, age: clock.age() }, 1e-3);
        black_box(supervisor.speed_scale());
    };
    assert_eq!(allocation_counter::measure(|| (0..4000).for_each(tick)).count_total, 0);
}
