//! The supervisor enters stricter states at once, recovers by one state at a time, and always has a
//! cause.

use hrsw_safety::{
    Age, Cause, Fault, FrameFault, Nearest, Observation, SafetyState, Supervisor,
    SupervisorSettings,
};
use proptest::prelude::*;

const NOBODY: Option<Nearest> = None;

fn seen(nearest: Option<Nearest>, age: f64) -> Observation {
    Observation { nearest, age: Age::new(age).unwrap() }
}

fn pair(room: f64) -> Nearest {
    Nearest { robot: 0, other: 1, distance: 1.0 + room, required: 1.0, approach: 0.0 }
}

fn supervisor() -> Supervisor {
    Supervisor::new(SupervisorSettings::default()).unwrap()
}

proptest! {
    #[test]
    fn the_supervisor_stops_at_once_and_recovers_stepwise(
        steps in prop::collection::vec(
            (prop::option::of(-0.5..2.0_f64), 0.0..1.2_f64,
             prop::option::weighted(0.1, prop::sample::select(&Fault::ALL[..])), 1..900_usize),
            1..12),
        acknowledge in any::<bool>(),
    ) {
        let settings = SupervisorSettings { acknowledge, ..SupervisorSettings::default() };
        let mut supervisor = Supervisor::new(settings).unwrap();
        let (mut clear, mut violated) = (0.0, 0.0);
        for (room, age, fault, ticks) in steps {
            let observation = seen(room.map(pair), age);
            let room = room.unwrap_or(f64::INFINITY);
            let asked = fault.map_or(SafetyState::Normal, Fault::state);
            let stop = asked == SafetyState::ProtectiveStop || age > settings.stop_age;
            let close = room < 0.0;
            let slow = asked == SafetyState::Reduced || age > settings.reduced_age;
            for _ in 0..ticks {
                let before = supervisor;
                violated = if close { violated + 1e-3 } else { 0.0 };
                if let Some(fault) = fault {
                    supervisor.report(fault);
                    prop_assert!(supervisor.state() >= fault.state(), "at once");
                }
                supervisor.update(&observation, 1e-3);
                if stop {
                    prop_assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
                } else if violated >= 0.12 + 1e-3 {
                    prop_assert!(supervisor.state() >= SafetyState::Retreat);
                } else if slow {
                    prop_assert!(supervisor.state() >= SafetyState::Reduced);
                }
                // Outside retreat, a person who is too close for a moment is no cause.
                let retreats = close && before.state().max(supervisor.state()) >= SafetyState::Retreat;
                clear = if stop || retreats || slow { 0.0 } else { clear + 1e-3 };
                if supervisor.state() < before.state() {
                    prop_assert!(!supervisor.waits_for_acknowledgement());
                    prop_assert!(!supervisor.stops_at_once());
                    // Recovery is one state at a time.
                    prop_assert_eq!(supervisor.state() as u8 + 1, before.state() as u8);
                    if supervisor.state() == SafetyState::Normal {
                        prop_assert!(clear >= 0.2 - 1e-9);
                    }
                }
                let change = (supervisor.speed_scale() - before.speed_scale()).abs();
                prop_assert!(change <= 1e-3 / 0.25 + 1e-12);
                prop_assert!((0.0..=1.0).contains(&supervisor.speed_scale()));
                prop_assert_eq!(supervisor.cause().is_none(), supervisor.state() == SafetyState::Normal);
                prop_assert!(supervisor.unacknowledged().is_none_or(Fault::waits));
            }
        }
        supervisor.acknowledge();
        for _ in 0..3000 { supervisor.update(&seen(NOBODY, 0.0), 1e-3); }
        prop_assert_eq!(supervisor.state(), SafetyState::Normal);
        prop_assert_eq!(supervisor.speed_scale(), 1.0);
    }

    /// A fault that waits is neither forgotten nor recovered from, whatever is seen meanwhile.
    #[test]
    fn a_waiting_fault_is_kept_until_acknowledgement(
        fault in prop::sample::select(&Fault::ALL[..]).prop_filter("waits", |fault| fault.waits()),
        seen_later in prop::collection::vec(
            (prop::option::of(-0.5..2.0_f64), 0.0..1.2_f64), 1..3000),
    ) {
        let mut supervisor = supervisor();
        supervisor.report(fault);
        for (room, age) in seen_later {
            supervisor.update(&seen(room.map(pair), age), 1e-3);
            prop_assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
            prop_assert_eq!(supervisor.cause(), Some(&Cause::Fault(fault)));
            prop_assert_eq!(supervisor.unacknowledged(), Some(fault));
            prop_assert!(supervisor.stops_at_once());
        }
    }
}

#[test]
fn the_supervisor_says_why() {
    let mut supervisor = supervisor();
    supervisor.update(&seen(NOBODY, 0.5), 1e-3);
    assert_eq!(supervisor.state(), SafetyState::Reduced);
    assert_eq!(supervisor.cause(), Some(&Cause::Stale { age: Age::new(0.5).unwrap() }));
    supervisor.update(&seen(NOBODY, 0.9), 1e-3);
    assert!(!supervisor.stops_at_once(), "for want of frames it stops along its ramp");
    let close = pair(-0.2);
    supervisor.update(&seen(Some(close), 0.9), 1e-3);
    assert_eq!(supervisor.state(), SafetyState::ProtectiveStop, "nobody knows who is where now");
    supervisor.update(&seen(Some(Nearest { distance: f64::NAN, ..close }), 0.0), 1e-3);
    assert_eq!(supervisor.cause(), Some(&Cause::Fault(Fault::BadData)));
    assert_eq!(supervisor.unacknowledged(), Some(Fault::BadData));
}

/// The robot stops as fast as it can if it approaches a person who is too close. It may leave them.
#[test]
fn the_robot_retreats_from_a_close_person() {
    let mut supervisor = supervisor();
    let coming = Nearest { approach: 0.3, ..pair(-0.2) };
    for _ in 0..100 {
        supervisor.update(&seen(Some(coming), 0.0), 1e-3);
        assert_eq!(supervisor.state(), SafetyState::Normal, "it may be one frame alone");
        assert!(supervisor.stops_at_once());
    }
    supervisor.update(&seen(None, 0.0), 1e-3);
    assert!(!supervisor.stops_at_once());
    for _ in 0..121 {
        supervisor.update(&seen(Some(coming), 0.0), 1e-3);
    }
    assert_eq!(supervisor.state(), SafetyState::Retreat);
    assert_eq!(supervisor.cause(), Some(&Cause::TooClose(coming)));
    assert!(supervisor.stops_at_once());
    for _ in 0..2000 {
        supervisor.update(&seen(Some(Nearest { approach: -0.1, ..coming }), 0.0), 1e-3);
        assert!(!supervisor.stops_at_once());
    }
    assert!((supervisor.speed_scale() - 0.15).abs() < 1e-12);
    assert_eq!(supervisor.state(), SafetyState::Retreat);
}

/// Something that was never seen is older than everything.
#[test]
fn before_the_first_frame_the_robot_stands() {
    let mut supervisor = supervisor();
    supervisor.update(&Observation { nearest: None, age: Age::NEVER }, 1e-3);
    assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
    assert_eq!(supervisor.cause(), Some(&Cause::Stale { age: Age::NEVER }));
}

#[test]
fn an_age_is_not_negative_and_not_nan() {
    for wrong in [-1e9, -1e-300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = Age::new(wrong).unwrap_err();
        assert!(error.to_string().contains("age"), "{error}");
    }
}

/// A fault that returns within the dwell time counts as lasting.
#[test]
fn a_fault_returning_within_the_dwell_time_lasts() {
    for fault in Fault::ALL {
        let mut supervisor = supervisor();
        for tick in 0..5000 {
            if tick % 150 == 0 {
                supervisor.report(fault);
            }
            supervisor.update(&seen(NOBODY, 0.0), 1e-3);
            assert_eq!(supervisor.state(), fault.state(), "{fault} at {tick}");
        }
    }
}

/// A fault holds for the tick in which it was reported, even if that lasts for the dwell time.
#[test]
fn a_fault_outlives_its_tick() {
    let mut supervisor = supervisor();
    supervisor.report(FrameFault::Future.into());
    supervisor.update(&seen(NOBODY, 0.0), 0.25);
    assert_eq!(supervisor.state(), SafetyState::ProtectiveStop);
    supervisor.update(&seen(NOBODY, 0.0), 0.25);
    assert_eq!(supervisor.state(), SafetyState::Retreat);
}

#[test]
fn the_first_waiting_fault_is_reported() {
    let mut supervisor = supervisor();
    supervisor.report(Fault::LateTick);
    supervisor.report(Fault::FollowingError);
    supervisor.report(Fault::BadMeasurement);
    assert_eq!(supervisor.unacknowledged(), Some(Fault::FollowingError));
    supervisor.acknowledge();
    assert_eq!(supervisor.unacknowledged(), None);
}
