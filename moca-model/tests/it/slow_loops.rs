//! Loops that are slower than their period, and loops that stall. The robot continues at its last velocity until the
//! next command, and stays within its limits.

use ergo_map::ErgonomicsQuadratic;
use hrsw::Attachment;
use hrsw_safety::SafetySettings;
use moca_model::whole_body::robot::JointLimits;
use moca_model::{Controller, ControllerSettings, DesiredMotion, MOCA_HOME, moca_safety};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

use crate::drive::{PERIOD, percept};
use crate::shared::MOCA;

/// Tolerance of position limits \[rad\].
const ROUNDING: f64 = 1e-9;
/// Time between two camera frames \[s\].
const FRAME: f64 = 0.05;
/// Time between two workspaces \[s\].
const CHANGE: f64 = 0.7;

/// Random numbers from 0 to 1, reproducible by the seed.
#[derive(Clone)]
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn around(&mut self, size: f64) -> f64 {
        size * (2.0 * self.next() - 1.0)
    }
}

/// A robot that holds its last velocity, and the true time.
#[derive(Clone)]
struct Held {
    controller: Controller,
    draw: Draw,
    position: Vec<f64>,
    velocity: Vec<f64>,
    now: f64,
    /// Time for which the velocity was held.
    lasts: f64,
    seen: f64,
    changed: f64,
    /// Smallest distance of a joint to a position limit, over its range.
    nearest: f64,
    fastest: f64,
    measures: bool,
}

impl Held {
    fn new(safety: SafetySettings, seed: u64) -> Self {
        let desired = DesiredMotion {
            velocity: 2.0,
            acceleration: 10.0,
            angular_velocity: 4.0,
            angular_acceleration: 20.0,
        };
        let defaults = ControllerSettings::default();
        let settings = ControllerSettings { safety, desired, ..defaults };
        let ergonomics =
            ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
        let controller = Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap();
        Self {
            controller,
            draw: Draw(seed),
            position: MOCA_HOME.to_vec(),
            velocity: vec![0.0; 10],
            now: 0.0,
            lasts: PERIOD,
            seen: f64::NEG_INFINITY,
            changed: f64::NEG_INFINITY,
            nearest: f64::INFINITY,
            fastest: 0.0,
            measures: true,
        }
    }

    /// Sets a workspace that is far away, with a random orientation.
    fn change(&mut self) {
        let draw = &mut self.draw;
        let place = Vector3::new(draw.around(8.0), draw.around(8.0), draw.around(3.0));
        let turn = Vector3::new(draw.around(3.0), draw.around(3.0), draw.around(3.0));
        let place = Isometry3::from_parts(Translation3::from(place), UnitQuaternion::new(turn));
        self.controller.space_mut().assign(Some(Attachment::World(place))).unwrap();
        self.changed = self.now;
    }

    /// Makes a tick whose command is held for `time`.
    fn tick(&mut self, time: f64) {
        if self.now - self.changed >= CHANGE {
            self.change();
        }
        if self.now - self.seen >= FRAME {
            self.controller.set_present(self.now);
            self.controller.observe(percept(self.now, None)).unwrap();
            self.seen = self.now;
        }
        let mut measured = self.position.clone();
        if !self.measures {
            measured[4] = f64::NAN;
        }
        let command = self.controller.step(self.now, &measured).unwrap();
        self.now += time;
        for (joint, limits) in MOCA.limits().iter().enumerate() {
            let (v, before) = (command.joint_velocity[joint], self.velocity[joint]);
            assert!(
                v.abs() <= limits.velocity * (1.0 + 1e-9),
                "{v} of joint {joint} at {}",
                self.now
            );
            // The clock counts a difference of a thousandth of the period as rounding.
            let change = limits.acceleration * (self.lasts + 1e-3 * PERIOD) * (1.0 + 1e-9);
            assert!(
                (v - before).abs() <= change,
                "{before} to {v} after {} s, joint {joint}",
                self.lasts
            );
            let q = self.position[joint] + v * time;
            for q in [q, command.joint_position[joint]] {
                let beyond = outside(q, limits);
                assert!(beyond <= ROUNDING, "joint {joint}, {beyond} outside at {} s", self.now);
            }
            let range = limits.upper - limits.lower;
            if range.is_finite() {
                self.nearest = self.nearest.min(-outside(q, limits) / range);
                self.fastest = self.fastest.max(v.abs() / limits.velocity);
            }
            self.position[joint] = q;
            self.velocity[joint] = v;
        }
        self.lasts = time;
    }

    /// Asserts that the robot moved fast and reached its limits.
    fn assert_hard(&self) {
        assert!(self.nearest < 1e-3, "no joint came to a limit: {}", self.nearest);
        assert!(self.fastest > 0.4, "no joint was fast: {}", self.fastest);
    }
}

/// The distance of a joint beyond its position limits.
fn outside(q: f64, limits: &JointLimits) -> f64 {
    (q - limits.upper).max(limits.lower - q)
}

fn both() -> [SafetySettings; 2] {
    [moca_safety().off(), moca_safety()]
}

/// Runs with commands that last for the times that `time` returns. Limits are checked after each.
fn run(seconds: f64, seed: u64, mut time: impl FnMut(&mut Draw) -> f64) {
    for safety in both() {
        let mut held = Held::new(safety, seed);
        let mut draw = Draw(!seed);
        while held.now < seconds {
            held.tick(time(&mut draw));
        }
        held.assert_hard();
    }
}

#[test]
fn steadily_slow_ticks_keep_the_limits() {
    for periods in 1..=20_u32 {
        run(8.0, 7 + u64::from(periods), |_| f64::from(periods) * PERIOD);
    }
}

#[test]
fn stalls_of_sixty_periods_keep_limits() {
    for (seed, usual) in [(1, 1.0), (2, 1.0), (3, 1.0), (4, 3.0), (5, 20.0)] {
        let mut since = 0.0;
        run(20.0, seed, |draw| {
            // A robot at its limits can come to rest between two stalls.
            let time =
                if since > 0.3 + 0.5 * draw.next() { 5.0 + 55.0 * draw.next() } else { usual };
            since = if time > usual { 0.0 } else { since + time * PERIOD };
            time * PERIOD
        });
    }
}

#[test]
fn irregularly_slow_ticks_keep_the_limits() {
    for seed in 1..6 {
        let mut slow = false;
        run(8.0, seed, |draw| {
            slow = draw.next() < if slow { 0.4 } else { 0.2 };
            // Times are multiples of the period, as the loop leaves out missed ticks, or arbitrary.
            let time = if slow { 1.0 + 19.0 * draw.next() } else { 1.0 };
            if seed % 2 == 0 { time.round() * PERIOD } else { time * PERIOD }
        });
    }
    // The shorter of two times says little about the mean.
    let mut tick = 0_u32;
    run(8.0, 9, |_| {
        tick += 1;
        if tick.is_multiple_of(2) { 20.0 * PERIOD } else { PERIOD }
    });
}

/// A bad measurement asks for a stop at a random moment.
#[test]
fn slow_loop_brakes_within_its_limits() {
    for periods in [1, 2, 5, 20_u32] {
        let mut held = Held::new(moca_safety().off(), 3);
        for _ in 0..40 {
            let begin = held.now;
            while held.now - begin < 0.3 {
                held.tick(f64::from(periods) * PERIOD);
            }
            let mut stops = Held { measures: false, ..held.clone() };
            let begin = stops.now;
            while stops.now - begin < 1.0 {
                stops.tick(f64::from(periods) * PERIOD);
            }
            let arm = &stops.velocity[3..];
            assert!(arm.iter().all(|v| *v == 0.0), "{arm:?}");
        }
    }
}
