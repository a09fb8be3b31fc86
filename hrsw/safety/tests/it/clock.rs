//! The clock of ticks and frames.

use hrsw_safety::{Age, ClockFault, Error, Fault, FrameFault, LoopClock};
use proptest::prelude::*;

const PERIOD: f64 = 1e-3;

fn clock() -> LoopClock {
    LoopClock::new(PERIOD).unwrap()
}

/// Generates times of clocks that are right, set, stopped or not finite.
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
    /// Holds for arbitrary times of ticks and frames.
    #[test]
    fn accepted_frames_are_newer_and_not_future(
        events in prop::collection::vec((any::<bool>(), time()), 1..60),
    ) {
        let mut clock = clock();
        for (is_tick, time) in events {
            let before = clock;
            if is_tick {
                let tick = clock.tick(time);
                prop_assert!(tick.elapsed > 0.0 && tick.elapsed <= clock.longest_gap() + 1.001 * PERIOD);
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
                prop_assert!(newest - now <= LoopClock::AHEAD + 1.5 * PERIOD * (1.0 + 1e-9));
            }
            let age = clock.age();
            prop_assert!(age.seconds() >= 0.0);
            prop_assert_eq!(age == Age::NEVER, clock.now().is_none() || clock.newest().is_none());
        }
    }

    /// Holds for any origin up to seconds since 1970.
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
        // A single late tick is no fault.
        (1.6e-3, None),
        (0.09, None),
        (0.101, None),
        (0.1011, Some(ClockFault::SetAhead.into())),
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

proptest! {
    /// Each tick comes at its own time on the grid, however late the others are.
    #[test]
    fn ticks_on_the_grid_are_never_early(
        origin in prop_oneof![Just(0.0), -1e6..1e6_f64, Just(1.76e9)],
        // A gap of 100 periods counts from the tick before, which may have been a little early.
        late in prop::collection::vec(prop_oneof![4 => 0.0..0.1_f64, 1 => 0.0..99.9_f64], 1..300),
    ) {
        let mut clock = clock();
        // The grid begins with the first tick.
        let _ = clock.tick(origin);
        let mut due = 1.0;
        for late in late {
            // In units of the period.
            let now = due + late;
            let fault = clock.tick(origin + now * PERIOD).fault;
            prop_assert!(matches!(fault, None | Some(Fault::LateTick)), "{fault:?}");
            due = (now + 0.051).floor().max(due) + 1.0;
        }
    }

    /// A clock that is too fast is noticed, even with late ticks in between.
    #[test]
    fn ticks_that_come_too_often_are_early(
        share in 0.05..0.45_f64, late in prop::collection::vec(0.0..5.0_f64, 20),
    ) {
        let mut clock = clock();
        let mut now = 0.0;
        let mut early = 0;
        for late in late {
            now += (1.0 + late) * PERIOD;
            let _ = clock.tick(now);
            for _ in 0..20 {
                now += share * PERIOD;
                early += u32::from(clock.tick(now).fault == Some(Fault::EarlyTick));
            }
        }
        // A late tick is made up for by at most two early ones in a row.
        prop_assert!(early >= 20 * 18, "{early}");
    }
}

/// The loop is slower than its period.
#[test]
fn mostly_late_ticks_are_a_fault() {
    for (takes, of, is_late) in [(2, 1, true), (20, 1, true), (5, 3, false), (5, 10, false)] {
        let mut clock = clock();
        let (mut now, mut late) = (0.0, 0);
        for tick in 0..300 {
            let fault = clock.tick(now).fault;
            assert!(matches!(fault, None | Some(Fault::LateTick)), "{fault:?}");
            late += u32::from(fault.is_some());
            now += if tick % of == 0 { f64::from(takes) } else { 1.0 } * PERIOD;
        }
        // The fault appears after about eighteen ticks, and lasts as long as the ticks are late.
        assert_eq!(late, if is_late { 282 } else { 0 }, "{takes} periods, one in {of}");
        // The fault ends soon.
        let over =
            (0..20).filter(|tick| clock.tick(now + f64::from(*tick) * PERIOD).fault.is_some());
        assert!(over.count() <= 15);
    }
}

/// Frames that arrive while a loop stands still are from the past. Frames from the future are still
/// refused.
#[test]
fn frames_are_judged_by_the_present_time() {
    let mut clock = clock();
    clock.tick(100.0);
    assert_eq!(clock.frame(100.04), Err(FrameFault::Future));
    clock.set_present(100.06);
    clock.frame(100.04).unwrap();
    assert_eq!(clock.frame(100.07), Err(FrameFault::Future));
    let tick = clock.tick(100.06);
    assert_eq!((tick.fault, tick.forgets), (None, false));
    assert!((clock.age().seconds() - 0.02).abs() < 1e-9);
    // The present is kept until the tick. NaN clears it.
    clock.set_present(f64::NAN);
    assert_eq!(clock.frame(100.08), Err(FrameFault::Future));
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
    // The frame is valid until the next tick.
    clock.frame(100.001).unwrap();
}

/// A frame that a later tick shows to be from the future does not block the frames after it.
#[test]
fn a_clock_set_back_forgets_future_frames() {
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
fn a_bad_period_is_named() {
    for period in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let error = LoopClock::new(period).unwrap_err();
        assert!(matches!(error, Error::Value { .. }));
        assert!(error.to_string().contains("the control period"), "{error}");
    }
}
