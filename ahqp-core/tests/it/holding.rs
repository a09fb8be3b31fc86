//! Velocity intervals if commands come late, so that a velocity lasts longer than planned.

use ahqp_core::{AcceleratedState, JerkLimits, Limits};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, RngSeed, TestRng};

/// Uses the same cases on every run. `PROPTEST_RNG_SEED` selects others.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn random(seed: u64) -> TestRng {
    TestRng::from_seed(RngAlgorithm::XorShift, &[seed.to_le_bytes(), [1; 8]].concat())
}

/// Generates numbers between two powers of ten, uniform in their exponent.
fn decades(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from..to).prop_map(|exponent: f64| 10_f64.powf(exponent))
}

/// Generates limits with and without a jerk limit.
fn limits() -> impl Strategy<Value = JerkLimits> {
    let jerk = prop_oneof![1 => Just(f64::INFINITY), 2 => decades(0.0, 4.5)];
    (-3.0..3.0_f64, decades(-3.0, 1.0), decades(-1.0, 1.0), decades(-0.5, 1.5), jerk).prop_map(
        |(lower, width, velocity, acceleration, jerk)| {
            let limits = Limits::new(lower, lower + width, velocity, acceleration).unwrap();
            limits.with_jerk(jerk).unwrap()
        },
    )
}

/// A coordinate that moves back and forth between its limits.
struct Runner {
    limits: JerkLimits,
    hold: f64,
    random: TestRng,
    /// Chosen point of the interval, from 0 to 1: often one of its ends.
    share: f64,
    position: f64,
    velocity: f64,
    acceleration: f64,
}

impl Runner {
    fn new(limits: JerkLimits, hold: f64, start: f64, seed: u64) -> Self {
        let plain = limits.limits();
        let position = plain.lower() + start * (plain.upper() - plain.lower());
        let random = random(seed);
        Self { limits, hold, random, share: 1.0, position, velocity: 0.0, acceleration: 0.0 }
    }

    fn draw(&mut self) -> f64 {
        self.random.random::<f64>()
    }

    /// Applies a command `passed` \[s\] after the last one, which lasts for `lasts` \[s\].
    fn command(&mut self, passed: f64, lasts: f64) -> Result<(), TestCaseError> {
        let Self { position, velocity, acceleration, .. } = *self;
        let state = AcceleratedState { position, velocity, acceleration };
        let interval = self.limits.holding(self.hold).velocity_interval(state, passed);
        prop_assert!(interval.lower <= interval.upper, "{interval:?} from {state:?}");
        match self.draw() {
            draw if draw < 0.01 => self.share = (200.0 * draw).floor(),
            draw if draw < 0.02 => self.share = self.draw(),
            _ => {}
        }
        let wanted = interval.lower + self.share * (interval.upper - interval.lower);
        self.velocity = wanted.clamp(interval.lower, interval.upper);
        self.acceleration = (self.velocity - velocity) / passed;
        self.position += self.velocity * lasts;
        let (plain, noise) = (self.limits.limits(), 1e-14 * self.velocity.abs() / passed);
        let most = plain.acceleration() * (1.0 + 1e-9) + noise;
        prop_assert!(self.acceleration.abs() <= most, "{}", self.acceleration);
        prop_assert!(self.velocity.abs() <= plain.velocity() * (1.0 + 1e-9));
        let jerk = (self.acceleration - acceleration).abs() / passed;
        prop_assert!(jerk <= self.limits.jerk() * (1.0 + 1e-9) + 2.0 * noise / passed, "{jerk}");
        let beyond = (self.position - plain.upper()).max(plain.lower() - self.position);
        prop_assert!(beyond <= 1e-12, "{beyond} outside after {lasts} s, {state:?}");
        Ok(())
    }

    /// Applies regular commands for `time` \[s\].
    fn last_for(&mut self, time: f64, period: f64) -> Result<(), TestCaseError> {
        let mut elapsed = 0.0;
        while elapsed < time {
            self.command(period, period)?;
            elapsed += period;
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(config(150))]

    /// Each command is planned with the time since the last one.
    #[test]
    fn commands_at_arbitrary_times_keep_all_limits(
        limits in limits(), start in 0.0..1.0_f64, hold in decades(-3.0, -1.0), seed in any::<u64>(),
    ) {
        let mut runner = Runner::new(limits, hold, start, seed);
        let mut passed = hold;
        for _ in 0..20_000 {
            // The duration is at least a thousandth of the longest one, and often the longest.
            let lasts = hold * 10_f64.powf((-3.5 * runner.draw()).min(0.0) + 0.5).min(1.0);
            runner.command(passed, lasts)?;
            passed = lasts;
        }
    }

    /// Commands are planned with the period, except the one after a change of the period.
    #[test]
    fn one_command_that_lasts_longer_keeps_all_limits(
        limits in limits(), start in 0.0..1.0_f64, period in decades(-4.0, -2.0), seed in any::<u64>(),
        longer in 1.0..60.0_f64,
    ) {
        let hold = longer * period;
        let mut runner = Runner::new(limits, hold, start, seed);
        for round in 0..20_u32 {
            // The run is long enough to reach a high speed or a limit.
            let calm = (400.0 + 400.0 * runner.draw()) * period;
            let plain = limits.limits();
            let brakes = plain.velocity() / plain.acceleration()
                + 3.0 * plain.acceleration() / limits.jerk();
            runner.share = f64::from(round % 2);
            runner.last_for(calm, period)?;
            let lasts = hold * runner.draw().max(0.9);
            runner.command(period, lasts)?;
            // Braking compensates the room that the long command has used.
            runner.share = 0.5;
            runner.last_for(brakes.min(20_000.0 * period), period)?;
        }
    }
}

/// A motion towards a limit violates it by braking one long period too late, for the limits of a
/// Panda's second joint.
#[test]
fn a_fast_joint_respects_its_limit_after_stalls() {
    for (hold, stays) in [(0.06, true), (0.0, false)] {
        let limits = Limits::new(-1.7628, 1.7628, 2.175, 7.5).unwrap().with_jerk(3750.0).unwrap();
        let limits = limits.holding(hold);
        let mut farthest = f64::NEG_INFINITY;
        for stall in 0..1500 {
            let mut state = AcceleratedState::at_rest(0.0);
            for tick in 0..1600 {
                let velocity = limits.velocity_interval(state, 1e-3).upper;
                state = state.after(velocity, 1e-3);
                if tick == stall {
                    state.position += 0.059 * velocity;
                }
                farthest = farthest.max(state.position);
            }
        }
        assert_eq!(farthest <= 1.7628 + 1e-12, stays, "{farthest}");
    }
}
