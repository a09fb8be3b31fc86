//! The gripper of a loop, and the acknowledgement of its stops.

use hrsw_safety::SafetyState;
use moca_model::whole_body::control_loop::{
    ControlLaw, Grip, JointCommand, JointMeasurement, RobotMode,
};
use moca_model::{BoxSide, GraspedObject, GripTime, LoopController, WorkFace};
use vision_models::Surface;

use crate::drive::{FRAME, PERIOD, loop_controller, percept};

/// A law, its last command, and a measurement that the test changes.
struct Looped {
    law: LoopController,
    frames: std::sync::mpsc::SyncSender<moca_model::Scene>,
    measured: JointMeasurement,
    command: JointCommand,
    tick: u32,
}

impl Looped {
    fn new(time: Option<GripTime>) -> Self {
        let (law, frames, measured) = loop_controller();
        let law = match time {
            Some(time) => law.taking(GraspedObject::default(), time).unwrap(),
            None => law,
        };
        let command = JointCommand::at_rest(&measured);
        Self { law, frames, measured, command, tick: 0 }
    }

    fn step(&mut self) {
        let now = f64::from(self.tick) * PERIOD;
        if self.tick.is_multiple_of(FRAME) {
            self.frames.try_send(percept(now, None).into()).unwrap();
        }
        self.law.step(now, &self.measured, &mut self.command).unwrap();
        // The robot follows exactly, but for the noise without which a measurement counts as frozen.
        self.measured.position.copy_from_slice(&self.command.position);
        self.measured.position[9] += 1e-9 * f64::from(self.tick % 7);
        self.measured.velocity.copy_from_slice(&self.command.velocity);
        for (measured, command) in self.measured.torque.iter_mut().zip(&self.command.torque) {
            *measured = Some(*command);
        }
        self.tick += 1;
    }

    fn holds(&mut self, holds: Option<bool>) {
        self.measured.robot.holds = holds;
        self.step();
    }

    fn knows_of_object(&self) -> bool {
        self.law.controller().controller().object().is_some()
    }

    fn state(&self) -> SafetyState {
        self.law.controller().controller().command().safety
    }
}

#[test]
fn controller_holds_what_the_robot_holds() {
    let mut looped = Looped::new(Some(GripTime::AtOnce));
    for holds in [None, Some(false)] {
        looped.holds(holds);
        assert_eq!(looped.command.grip, Some(Grip::Close));
        assert!(!looped.knows_of_object(), "{holds:?}");
    }
    let empty = looped.command.torque[6];
    (0..50).for_each(|_| looped.holds(Some(true)));
    assert!(looped.knows_of_object());
    // A kilogram at half a metre from the elbow, at least.
    assert!((looped.command.torque[6] - empty).abs() > 2.0, "the arm carries it");
    looped.holds(None);
    assert!(looped.knows_of_object(), "a robot that says nothing has not lost it");
    looped.holds(Some(false));
    assert!(!looped.knows_of_object(), "it was taken away");
    looped.holds(Some(true));
    assert!(looped.knows_of_object(), "and given back");
}

#[test]
fn gripper_stays_open_until_something_is_offered() {
    let mut looped = Looped::new(Some(GripTime::WhenOffered));
    for holds in [None, Some(false), Some(true)] {
        looped.holds(holds);
        assert_eq!(looped.command.grip, Some(Grip::Open));
        assert!(!looped.knows_of_object(), "nobody has offered it");
    }
    let mut without = Looped::new(None);
    without.holds(Some(true));
    assert_eq!(without.command.grip, None);
    let none = GraspedObject { faces: Vec::new(), ..GraspedObject::default() };
    let twice = vec![WorkFace { side: BoxSide::Front, surface: Surface::Smooth }; 2];
    let twice = GraspedObject { faces: twice, ..GraspedObject::default() };
    for unfit in [none, twice] {
        assert!(loop_controller().0.taking(unfit, GripTime::AtOnce).is_err());
    }
}

#[test]
fn gripping_and_acknowledging_allocate_nothing() {
    let mut looped = Looped::new(Some(GripTime::AtOnce));
    let acknowledgement = looped.law.acknowledgement();
    let counted = allocation_counter::measure(|| {
        for holds in [false, true, true, false, true] {
            looped.holds(Some(holds));
            acknowledgement.give();
        }
    });
    assert_eq!((counted.count_total, counted.count_current), (0, 0));
    assert!(looped.knows_of_object());
}

#[test]
fn acknowledgement_from_another_thread_ends_the_stop() {
    let mut looped = Looped::new(None);
    (0..100).for_each(|_| looped.step());
    assert_eq!(looped.state(), SafetyState::Normal);
    looped.measured.robot.mode = Some(RobotMode::UserStop);
    looped.step();
    looped.measured.robot.mode = Some(RobotMode::Running);
    (0..3000).for_each(|_| looped.step());
    assert_eq!(looped.state(), SafetyState::ProtectiveStop, "it waits for somebody");
    let acknowledgement = looped.law.acknowledgement();
    std::thread::spawn(move || acknowledgement.give()).join().unwrap();
    (0..3000).for_each(|_| looped.step());
    assert_eq!(looped.state(), SafetyState::Normal);
    // It does not count for a later stop.
    looped.measured.robot.mode = Some(RobotMode::UserStop);
    looped.step();
    looped.measured.robot.mode = Some(RobotMode::Running);
    (0..3000).for_each(|_| looped.step());
    assert_eq!(looped.state(), SafetyState::ProtectiveStop);
}
