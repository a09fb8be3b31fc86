//! The loop with a real robot: ticks, timeouts and ending.

use std::cell::RefCell;
use std::rc::Rc;

use allocation_counter::measure;
use proptest::prelude::*;
use whole_body::control_loop::{
    Clock, ControlLaw, ControlLoop, JointCommand, JointMeasurement, LoopEnding, LoopError,
    LoopSettings, ManualClock, MonotonicClock, Received, RobotSide, Scheduling, StopCause,
};

const PERIOD: f64 = 1e-3;

/// An event of the robot's side, in order.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    Sent { at: f64, velocity: f64 },
    Halted { at: f64 },
}

/// A robot whose calls take time and that may fall silent.
struct Robot {
    clock: ManualClock,
    /// Duration of each tick, repeated cyclically \[s\].
    takes: Vec<f64>,
    silent: Option<std::ops::Range<f64>>,
    breaks_at: f64,
    ticks: usize,
    events: Rc<RefCell<Vec<Event>>>,
}

/// A law that reduces the velocity by 0.1 m/s a tick.
struct Law {
    velocity: f64,
    stops: bool,
    never_rests: bool,
    age: Option<f64>,
    times: Vec<f64>,
}

impl Robot {
    fn new(clock: &ManualClock) -> Self {
        let events = Rc::new(RefCell::new(Vec::with_capacity(20_000)));
        let (clock, takes) = (clock.clone(), vec![0.0]);
        Self { clock, takes, silent: None, breaks_at: f64::INFINITY, ticks: 0, events }
    }

    fn sent(&self) -> Vec<(f64, f64)> {
        let sent = |event: &Event| match event {
            Event::Sent { at, velocity } => Some((*at, *velocity)),
            Event::Halted { .. } => None,
        };
        self.events.borrow().iter().filter_map(sent).collect()
    }
}

impl Law {
    fn new() -> Self {
        let times = Vec::with_capacity(20_000);
        Self { velocity: 0.5, stops: false, never_rests: false, age: None, times }
    }
}

impl RobotSide for Robot {
    type Error = &'static str;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, &'static str> {
        let now = self.clock.now();
        if self.silent.as_ref().is_some_and(|silent| silent.contains(&now)) {
            return Ok(Received::Nothing);
        }
        measured.position[0] = now;
        Ok(Received::Fresh)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), &'static str> {
        self.clock.advance(self.takes[self.ticks % self.takes.len()]);
        self.ticks += 1;
        let at = self.clock.now();
        self.events.borrow_mut().push(Event::Sent { at, velocity: command.velocity[0] });
        if at < self.breaks_at { Ok(()) } else { Err("unplugged") }
    }

    fn halt(&mut self) -> Result<(), &'static str> {
        self.events.borrow_mut().push(Event::Halted { at: self.clock.now() });
        Ok(())
    }
}

impl ControlLaw for Law {
    type Error = &'static str;

    fn step(
        &mut self,
        now: f64,
        _measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), &'static str> {
        self.times.push(now);
        if self.stops && !self.never_rests {
            self.velocity = (self.velocity - 0.1).max(0.0);
        }
        command.velocity[0] = self.velocity;
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        self.age
    }

    fn request_stop(&mut self) {
        self.stops = true;
    }

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        Some(self.velocity == 0.0)
    }
}

fn control(settings: LoopSettings) -> ControlLoop {
    let measured = JointMeasurement::resting(vec![0.0], 1);
    ControlLoop::new(settings, measured).unwrap()
}

/// Runs until the clock says so. Returns the loop, its ending, the robot and the law.
fn run(
    until: f64,
    change: impl FnOnce(&mut Robot, &mut Law),
) -> (ControlLoop, Result<LoopEnding, LoopError<&'static str, &'static str>>, Robot, Law) {
    let mut clock = ManualClock::default();
    let (mut robot, mut law) = (Robot::new(&clock), Law::new());
    change(&mut robot, &mut law);
    let mut control = control(LoopSettings::default());
    let watch = clock.clone();
    let ending = control.run(&mut robot, &mut law, &mut clock, || watch.now() > until);
    assert!(matches!(robot.events.borrow().last(), Some(Event::Halted { .. })), "always halted");
    (control, ending, robot, law)
}

#[test]
fn ticks_come_once_a_period() {
    let (control, ending, _, law) = run(1.0, |_, _| {});
    assert_eq!(ending.unwrap(), LoopEnding { cause: StopCause::Requested, at_rest: Some(true) });
    for (tick, time) in law.times.iter().enumerate() {
        assert!((time - tick as f64 * PERIOD).abs() < 1e-12, "tick {tick} at {time}");
    }
    let statistics = control.statistics();
    assert_eq!(statistics.missed, 0);
    assert_eq!(usize::try_from(statistics.ticks).unwrap(), law.times.len());
    assert_eq!(statistics.latency.longest(), 0.0);
}

proptest! {
    /// No two ticks begin in one period, however long they take. Each due time is run or missed.
    #[test]
    fn no_tick_is_caught_up(takes in prop::collection::vec(0.0..4e-3_f64, 1..20)) {
        let (control, ending, _, law) = run(0.3, |robot, _| robot.takes.clone_from(&takes));
        prop_assert!(ending.is_ok());
        let periods: Vec<_> = law.times.iter().map(|time| (time / PERIOD + 1e-6).floor()).collect();
        prop_assert!(periods.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", periods);
        prop_assert!(law.times.windows(2).all(|pair| pair[1] - pair[0] > 0.049 * PERIOD));
        let statistics = control.statistics();
        // Ticks due within a twentieth of the period after the last tick are missed.
        let last = law.times.last().copied().unwrap_or_default();
        let due = (last / PERIOD + 0.05).floor() + 1.0;
        prop_assert_eq!((statistics.ticks + statistics.missed) as f64, due);
        let longest = takes.iter().copied().fold(0.0, f64::max);
        prop_assert!(statistics.duration.longest() <= longest + 1e-12);
        let (half, all) = (statistics.duration.quantile(0.5), statistics.duration.quantile(1.0));
        prop_assert!(half <= all && (all - statistics.duration.longest()).abs() <= 1.0001e-6);
    }
}

/// Times are in tenths of the period, so that counts do not round.
#[test]
fn tick_after_a_late_one_keeps_its_time() {
    for tenths in 0..=1000_u32 {
        let (control, _, _, law) = run(0.17, |robot, _| {
            robot.takes = vec![0.0; 300];
            robot.takes[19] = PERIOD * (1.0 + 0.1 * f64::from(tenths));
        });
        let statistics = control.statistics();
        assert_eq!(statistics.missed, u64::from(tenths / 10), "{tenths}");
        assert_eq!(statistics.late, u64::from(tenths >= 10), "{tenths}");
        for (tick, time) in law.times.iter().enumerate() {
            let off = time / PERIOD - (time / PERIOD).round();
            assert!(tick == 20 || off.abs() < 1e-9, "{tenths}: tick {tick} at {time}");
        }
    }
}

#[test]
fn a_stop_is_in_order() {
    let (_, ending, robot, _) = run(0.1, |_, _| {});
    assert_eq!(ending.unwrap().at_rest, Some(true));
    let sent = robot.sent();
    // The robot runs at full speed, brakes tick by tick, is at rest at the end, and gets nothing after the halt.
    assert!(sent.iter().take(100).all(|(_, velocity)| *velocity == 0.5));
    assert!(sent.windows(2).all(|pair| (pair[0].1 - pair[1].1).abs() <= 0.1 + 1e-12));
    assert_eq!(sent.last().unwrap().1, 0.0);
}

#[test]
fn law_that_never_rests_is_halted() {
    let (_, ending, robot, _) = run(0.1, |_, law| law.never_rests = true);
    assert_eq!(ending.unwrap(), LoopEnding { cause: StopCause::Requested, at_rest: Some(false) });
    let last = robot.sent().last().unwrap().0;
    assert!((last - 3.1).abs() < 0.01, "{last}");
}

#[test]
fn only_long_silence_of_the_robot_stops() {
    let (control, ending, ..) = run(0.5, |robot, _| robot.silent = Some(0.0995..0.1155));
    assert_eq!(ending.unwrap().cause, StopCause::Requested);
    assert_eq!(control.statistics().unmeasured, 16);

    let (_, ending, robot, _) = run(0.5, |robot, _| robot.silent = Some(0.1..9.0));
    assert_eq!(ending.unwrap(), LoopEnding { cause: StopCause::RobotSilent, at_rest: Some(true) });
    let begins = robot.sent().into_iter().find(|(_, velocity)| *velocity < 0.5).unwrap().0;
    // The timeout is 20 ms after the last measurement, at 0.099 s.
    assert!((begins - 0.12).abs() < 1.5e-3, "{begins}");
}

#[test]
fn a_silent_perception_ends_the_loop() {
    // Perception that has never come is as old as the loop.
    for age in [f64::INFINITY, 31.0] {
        let (_, ending, _, law) = run(40.0, |_, law| law.age = Some(age));
        assert_eq!(ending.unwrap().cause, StopCause::PerceptionSilent);
        let end = law.times.last().unwrap();
        assert!((30.0..30.1).contains(end), "{end}");
    }
    let (_, ending, ..) = run(0.5, |_, law| law.age = Some(0.1));
    assert_eq!(ending.unwrap().cause, StopCause::Requested);
}

#[test]
fn nothing_is_sent_before_the_first_measurement() {
    let (_, ending, robot, law) = run(1.0, |robot, _| robot.silent = Some(0.0..0.3));
    assert!(ending.is_ok());
    assert!(robot.sent()[0].0 >= 0.3 - 1e-9 && law.times[0] >= 0.3 - 1e-9);
    let (_, ending, robot, _) = run(9.0, |robot, _| robot.silent = Some(0.0..99.0));
    assert!(matches!(ending, Err(LoopError::NoMeasurement { waited }) if waited > 5.0));
    assert!(robot.sent().is_empty());
    // The stop is requested while the loop waits.
    let (_, ending, robot, _) = run(1.0, |robot, _| robot.silent = Some(0.0..99.0));
    assert_eq!(ending.unwrap().cause, StopCause::Requested);
    assert!(robot.sent().is_empty());
}

#[test]
fn a_robot_that_breaks_is_halted_at_once() {
    let (_, ending, robot, _) = run(1.0, |robot, _| robot.breaks_at = 0.2);
    let error = ending.unwrap_err();
    assert_eq!(error, LoopError::Robot("unplugged"));
    assert_eq!(error.to_string(), "the robot: unplugged");
    assert!((robot.sent().last().unwrap().0 - 0.2).abs() < 2e-3);
}

#[test]
fn the_loop_allocates_nothing() {
    let mut clock = ManualClock::default();
    let (mut robot, mut law) = (Robot::new(&clock), Law::new());
    let mut control = control(LoopSettings::default());
    let watch = clock.clone();
    let allocations = measure(|| {
        control.run(&mut robot, &mut law, &mut clock, || watch.now() > 2.0).unwrap();
    });
    assert_eq!(allocations.count_total, 0);
    assert!(law.times.len() > 1900);
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = LoopSettings::default();
    for wrong in [
        LoopSettings { period: f64::NAN, ..good },
        LoopSettings { period: -1e-3, ..good },
        LoopSettings { first_measurement: 0.0, ..good },
        LoopSettings { robot_timeout: 1e-3, ..good },
        LoopSettings { perception_timeout: 0.0, ..good },
        LoopSettings { stop_within: f64::INFINITY, ..good },
    ] {
        assert!(wrong.validate().is_err(), "{wrong:?}");
    }
    assert!(LoopSettings { perception_timeout: f64::INFINITY, ..good }.validate().is_ok());
}

#[test]
fn system_clock_never_wakes_too_early() {
    for spin in [0.0, 1e-3] {
        let mut clock = MonotonicClock::new(spin);
        let until = clock.now() + 2e-3;
        clock.sleep_until(until);
        assert!(clock.now() >= until);
        // A time in the past neither waits nor panics.
        clock.sleep_until(-1.0);
        clock.sleep_until(f64::NAN);
    }
}

#[test]
fn a_priority_that_is_none_is_refused() {
    for priority in [0, 100] {
        let wanted = Scheduling { priority: Some(priority), lock_memory: false };
        assert!(wanted.apply().unwrap_err().to_string().contains("from 1 to 99"));
    }
}
