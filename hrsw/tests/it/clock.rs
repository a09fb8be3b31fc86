//! The clock of ticks and frames.

use hrsw::{Age, ClockFault, ClockSettings, Error, Fault, FrameFault, LoopClock};
use proptest::prelude::*;

const PERIOD: f64 = 1e-3;

fn clock() -> LoopClock {
    LoopClock::new(PERIOD, ClockSettings::default()).unwrap()
}

/// Times as they come from clocks that are right, set, stopped or no clocks.
fn time() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.0..10.0_f64,
        (0..10_000_u32).prop_map(|tick| f64::from(tick) * PERIOD),
        -1e10..1e10_f64,
        any::<f64>(),
        Just(f64::NAN),
        Just(5.0),
    ]
}

proptest! {
    /// Whatever ticks and frames say.
    #[test]
    fn what_is_taken_is_new_and_of_the_present(
        events in prop::collection::vec((any::<bool>(), time()), 1..60),
    ) {
        let settings = ClockSettings::default();
        let mut clock = clock();
        for (is_tick, time) in events {
            let before = clock;
            if is_tick {
                let tick = clock.tick(time);
                prop_assert!(tick.elapsed > 0.0 && tick.elapsed <= settings.gap);
                prop_assert_eq!(tick.forgets, before.newest().is_some() && clock.newest().is_none());
                prop_assert!(!tick.forgets || tick.fault.is_some());
                prop_assert!(time.is_finite() || clock == before);
            } else if clock.frame(time).is_ok() {
                prop_assert!(before.newest().is_none_or(|newest| time > newest));
                prop_assert_eq!(clock.newest(), Some(time));
            } else {
                prop_assert_eq!(clock, before, "a refused frame leaves no trace");
            }
            if let (Some(now), Some(newest), true) = (clock.now(), clock.newest(), is_tick) {
                prop_assert!(newest - now <= settings.ahead + 1.5 * PERIOD * (1.0 + 1e-9));
            }
            let age = clock.age();
            prop_assert!(age.seconds() >= 0.0);
            prop_assert_eq!(age == Age::NEVER, clock.now().is_none() || clock.newest().is_none());
        }
    }

    /// Ticks in time are no fault, from any origin up to seconds since 1970.
    #[test]
    fn ticks_within_the_tolerance_are_in_time(
        origin in prop_oneof![Just(0.0), -1e6..1e6_f64, Just(1.76e9)],
        shares in prop::collection::vec(0.51..1.49_f64, 1..200),
    ) {
        let mut clock = clock();
        let mut now = origin;
        for share in shares {
            let tick = clock.tick(now);
            prop_assert_eq!(tick.fault, None);
            now += share * PERIOD;
        }
    }
}

#[test]
fn each_wrong_tick_has_its_name() {
    for (after, fault) in [
        (0.0, Some(ClockFault::StandsStill.into())),
        (1e-7, Some(ClockFault::StandsStill.into())),
        (-1e-9, Some(ClockFault::SetBack.into())),
        (-3600.0, Some(ClockFault::SetBack.into())),
        (1e-5, Some(Fault::EarlyTick)),
        (0.4e-3, Some(Fault::EarlyTick)),
        (0.6e-3, None),
        (1e-3, None),
        (1.4e-3, None),
        (1.6e-3, Some(Fault::LateTick)),
        (0.09, Some(Fault::LateTick)),
        (0.11, Some(ClockFault::SetAhead.into())),
        (3600.0, Some(ClockFault::SetAhead.into())),
        (f64::NAN, Some(ClockFault::NotFinite.into())),
        (f64::INFINITY, Some(ClockFault::NotFinite.into())),
    ] {
        let mut clock = clock();
        assert_eq!(clock.tick(1.0).fault, None);
        assert_eq!(clock.tick(1.0 + after).fault, fault, "{after} s after");
    }
}

#[test]
fn each_wrong_frame_has_its_name() {
    let mut clock = clock();
    clock.tick(100.0);
    clock.frame(99.9).unwrap();
    for (stamp, fault) in [
        (f64::NAN, FrameFault::NotFinite),
        (100.01, FrameFault::Future),
        (120.0, FrameFault::Future),
        (3700.0, FrameFault::Future),
        (1.76e9, FrameFault::ForeignEpoch),
        (-1.76e9, FrameFault::ForeignEpoch),
        (99.9, FrameFault::Repeated),
        (99.85, FrameFault::OutOfOrder),
    ] {
        assert_eq!(clock.frame(stamp), Err(fault), "{stamp}");
    }
    // Until the next tick.
    clock.frame(100.001).unwrap();
}

/// A frame that a later tick shows to be of the future does not stand against those after it.
#[test]
fn a_clock_that_is_set_back_forgets_what_it_had() {
    let mut clock = clock();
    clock.tick(100.0);
    clock.frame(99.9).unwrap();
    let tick = clock.tick(20.0);
    assert_eq!((tick.fault, tick.forgets), (Some(ClockFault::SetBack.into()), true));
    assert_eq!(clock.age(), Age::NEVER);
    clock.frame(19.9).unwrap();
    assert!((clock.age().seconds() - 0.1).abs() < 1e-9);
}

#[test]
fn bad_settings_are_named() {
    let standard = ClockSettings::default();
    for (settings, name) in [
        (ClockSettings { tolerance: 0.0, ..standard }, "clock.tolerance"),
        (ClockSettings { tolerance: f64::NAN, ..standard }, "clock.tolerance"),
        (ClockSettings { gap: 1e-3, ..standard }, "clock.gap"),
        (ClockSettings { ahead: f64::INFINITY, ..standard }, "clock.ahead"),
        (ClockSettings { epoch: 0.0, ..standard }, "clock.epoch"),
    ] {
        let error = LoopClock::new(PERIOD, settings).unwrap_err();
        assert!(matches!(error, Error::Parameter { .. }));
        assert!(error.to_string().contains(name), "{error}");
    }
    assert!(LoopClock::new(0.0, standard).is_err());
}
