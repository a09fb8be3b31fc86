//! Late ticks are counted, the next one comes when it is due, and the robot goes on working.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use hrsw_safety::{Fault, LoopClock, SafetyState};
use moca_model::whole_body::control_loop::{
    Clock, ControlLaw, ControlLoop, DeadlineStatistics, JointCommand, JointMeasurement,
    LoopSettings, MonotonicClock, Received, RobotSide,
};

use crate::drive::{Drive, PERIOD, percept};
use crate::shared::MOCA;

/// A clock that wakes up late. `late` gives the delay for a wake-up time, counted from the origin.
#[derive(Clone)]
struct Sleeper {
    now: Rc<Cell<f64>>,
    origin: f64,
    late: Rc<RefCell<dyn FnMut(f64) -> f64>>,
}

impl Sleeper {
    fn new(origin: f64, late: impl FnMut(f64) -> f64 + 'static) -> Self {
        Self { now: Rc::new(Cell::new(origin)), origin, late: Rc::new(RefCell::new(late)) }
    }
}

impl Clock for Sleeper {
    fn now(&self) -> f64 {
        self.now.get()
    }

    fn sleep_until(&mut self, time: f64) {
        let late = (self.late.borrow_mut())(time - self.origin);
        self.now.set(self.now.get().max(time + late));
    }
}

/// A robot that is always there.
struct Anything;

impl RobotSide for Anything {
    type Error = std::convert::Infallible;

    fn receive(&mut self, _measured: &mut JointMeasurement) -> Result<Received, Self::Error> {
        Ok(Received::Fresh)
    }

    fn send(&mut self, _command: &JointCommand) -> Result<(), Self::Error> {
        Ok(())
    }

    fn halt(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// A law that only reads the clock.
struct Watch {
    clock: LoopClock,
    times: Vec<f64>,
    faults: Vec<Fault>,
    /// Duration of each tick, which may be long \[s\].
    stalls: fn(usize) -> f64,
}

impl Watch {
    fn new() -> Self {
        let clock = LoopClock::new(PERIOD).unwrap();
        Self { clock, times: Vec::new(), faults: Vec::new(), stalls: |_| 0.0 }
    }
}

impl ControlLaw for Watch {
    type Error = std::convert::Infallible;

    fn step(
        &mut self,
        now: f64,
        _measured: &JointMeasurement,
        _command: &mut JointCommand,
    ) -> Result<(), Self::Error> {
        self.faults.extend(self.clock.tick(now).fault);
        let stall = (self.stalls)(self.times.len());
        self.times.push(now);
        std::thread::sleep(std::time::Duration::from_secs_f64(stall));
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        None
    }

    fn request_stop(&mut self) {}

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        Some(true)
    }
}

/// Runs for `seconds`. Returns what the law saw and the loop's counts.
fn watch(
    mut clock: impl Clock + Clone,
    seconds: f64,
    mut law: Watch,
) -> (Watch, DeadlineStatistics) {
    let mut control =
        ControlLoop::new(LoopSettings::default(), JointMeasurement::resting(vec![0.0], 1)).unwrap();
    let (shown, begun) = (clock.clone(), clock.now());
    control.run(&mut Anything, &mut law, &mut clock, || shown.now() - begun > seconds).unwrap();
    (law, control.statistics().clone())
}

/// Times are in tenths of the period, so that the expected values do not round. Origins are those of a process, of a
/// machine and of 1970.
#[test]
fn late_tick_is_counted_and_grid_is_kept() {
    for origin in [0.0, 0.123_456_789, 86_399.7, 1.764e9, -3.5] {
        for tenths in 0..=1000_u32 {
            let by = f64::from(tenths) * 1e-4;
            let mut waits = 0;
            let clock = Sleeper::new(origin, move |_| {
                waits += 1;
                if waits == 20 { by } else { 0.0 }
            });
            let (law, statistics) = watch(clock, 0.17, Watch::new());
            let what = format!("{by} s late from {origin}");
            assert_eq!(law.faults, [], "{what}");
            assert_eq!(statistics.missed, u64::from(tenths / 10), "{what}");
            assert_eq!(statistics.late, u64::from(tenths >= 10), "{what}");
            // Seconds since 1970 have steps of 2.4e-7 s.
            let on_grid = |time: f64| ((time - origin) / PERIOD).round() * PERIOD;
            for (tick, time) in law.times.iter().enumerate() {
                // The first tick does not wait.
                let is_late = tick == 20;
                let off = time - origin - on_grid(*time);
                assert!(is_late || off.abs() < 5e-7, "{what}: tick {tick} at {time}");
            }
            for pair in law.times.windows(2) {
                assert!(pair[1] - pair[0] > 0.05 * PERIOD, "{what}: {pair:?}");
            }
        }
    }
}

/// The loop depends on the machine, but no stall of up to 0.1 s causes a fault in the next tick.
#[test]
fn system_clock_never_causes_early_ticks() {
    let law = Watch {
        stalls: |tick| if tick % 7 == 6 { 1e-3 * ((tick * 37) % 90) as f64 } else { 0.0 },
        ..Watch::new()
    };
    let (law, statistics) = watch(MonotonicClock::new(0.0), 1.5, law);
    // A busy machine may be late in most ticks, and stall for longer.
    let known = [Fault::LateTick, hrsw_safety::ClockFault::SetAhead.into()];
    assert!(law.faults.iter().all(|fault| known.contains(fault)), "{:?}", law.faults);
    let (first, last) = (law.times[0], law.times[law.times.len() - 1]);
    let due = (statistics.ticks + statistics.missed) as f64;
    assert!(
        ((last - first) / PERIOD + 1.0 - due).abs() < 1.0 + statistics.latency.longest() / PERIOD
    );
    assert!(statistics.missed > 200, "{}", statistics.missed);
}

#[test]
fn only_mostly_late_ticks_are_a_fault() {
    for (every, late) in [(1, true), (2, false), (3, false), (10, false)] {
        let mut waits = 0_u32;
        let clock = Sleeper::new(0.0, move |_| {
            waits += 1;
            if waits.is_multiple_of(every) { 1.6e-3 } else { 0.0 }
        });
        let (law, _) = watch(clock, 1.0, Watch::new());
        assert_eq!(law.faults.contains(&Fault::LateTick), late, "every {every}: {:?}", law.faults);
        assert!(law.faults.iter().all(|fault| *fault == Fault::LateTick), "{:?}", law.faults);
    }
}

/// The robot, its controller and a camera without people.
struct Law {
    drive: Drive,
    seen: f64,
    last: Option<f64>,
    /// Time in the normal state, and total time \[s\].
    normal: f64,
    all: f64,
    fastest: f64,
    states: Vec<(f64, SafetyState, Option<Fault>)>,
}

impl ControlLaw for Law {
    type Error = moca_model::Error;

    fn step(
        &mut self,
        now: f64,
        _measured: &JointMeasurement,
        _command: &mut JointCommand,
    ) -> Result<(), Self::Error> {
        if let Some(last) = self.last.replace(now) {
            // The last velocities were held for the true time.
            let velocity = self.drive.controller.command().joint_velocity.clone();
            self.drive.robot.step(&velocity, now - last).unwrap();
            self.all += now - last;
            if self.drive.state() == SafetyState::Normal {
                self.normal += now - last;
            }
        }
        if now - self.seen >= 0.05 {
            self.drive.controller.set_present(now);
            self.drive.controller.observe(percept(now, None))?;
            self.seen = now;
        }
        let measured = self.drive.robot.position().to_vec();
        let fault = self.drive.controller.step(now, &measured)?.fault;
        self.fastest = self.fastest.max(self.drive.fastest());
        let state = self.drive.state();
        if self.states.last().is_none_or(|last| last.1 != state) || fault.is_some() {
            self.states.push((now, state, fault));
        }
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        None
    }

    fn request_stop(&mut self) {}

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        Some(true)
    }
}

#[test]
fn robot_works_on_with_occasional_late_ticks() {
    let mut state = 1_u64;
    let mut draw = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut clock =
        Sleeper::new(100.0, move |_| if draw() < 0.01 { 5e-3 * draw() } else { 2e-5 * draw() });
    let seen = f64::NEG_INFINITY;
    let mut law = Law {
        drive: Drive::new(),
        seen,
        last: None,
        normal: 0.0,
        all: 0.0,
        fastest: 0.0,
        states: Vec::new(),
    };
    let measured = JointMeasurement::at_rest(&MOCA);
    let mut control = ControlLoop::new(LoopSettings::default(), measured).unwrap();
    let shown = clock.clone();
    control.run(&mut Anything, &mut law, &mut clock, || shown.now() > 120.0).unwrap();
    let share = law.normal / law.all;
    assert!(share >= 0.99, "{share} of the time normal, {:?}", law.states);
    assert!(law.fastest > 0.2, "it drives: {}", law.fastest);
    let statistics = control.statistics();
    assert!(statistics.late > 100 && statistics.missed > 300, "{}", statistics.missed);
}
