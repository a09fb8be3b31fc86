//! Functions that are called a thousand times a second allocate nothing.

use std::hint::black_box;

use ahqp_core::AugmentedState;
use hrsw::{
    Attachment, Bounds, Capsule, Cone, FrameFollower, MovingWorkspace, OrientedBox, Polytope,
    PositionShape, SoftWorkspace, Softening, Workspace,
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3, Vector6};

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
    let mut moving = MovingWorkspace::new(workspace, FrameFollower::SPEED).unwrap();
    moving.attach(Attachment::Person(Isometry3::identity())).unwrap();
    let softening = Softening { position_rows: 12, ..Softening::default() };
    let soft = SoftWorkspace::new(state, 0.2, softening).unwrap();
    let mut level = soft.level().unwrap();
    let desired = Isometry3::translation(0.6, 0.4, 1.0);

    let tick = |tick: usize| {
        if tick.is_multiple_of(50) {
            let walked = Isometry3::translation(tick as f64 * 1e-4, 0.0, 0.0);
            moving.set_person(walked, Vector6::zeros()).unwrap();
            moving.reshape_position(&shapes[(tick / 300) % 4], 0.2).unwrap();
            moving.set_lead(Vector3::x() * 0.1).unwrap();
            let goal = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 3.0);
            moving.reorient(goal, &Vector3::z_axis()).unwrap();
            let orientation = if tick % 1000 < 500 { cone.into() } else { turn.into() };
            moving.reshape_orientation(&orientation, 0.2).unwrap();
        }
        moving.advance(1e-3).unwrap();
        soft.write_rows(moving.workspace(), &desired, level.constraints_mut()).unwrap();
        black_box(moving.workspace().violation(&desired));
    };
    assert_eq!(allocation_counter::measure(|| (0..4000).for_each(tick)).count_total, 0);
}
