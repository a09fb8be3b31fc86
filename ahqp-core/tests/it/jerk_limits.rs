//! Velocity intervals with position, velocity, acceleration and jerk limits.

use ahqp_core::{AcceleratedState, Hierarchy, JerkLimits, Limits, MotionState, Settings, Solver};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, RngSeed, TestRng};

const PERIOD: f64 = 1e-3;
/// Rounding relative to a limit.
const ROUNDING: f64 = 1e-9;

/// Uses the same cases on every run. `PROPTEST_RNG_SEED` selects others, and `AHQP_CASES`
/// multiplies their number.
fn config(cases: u32) -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    let cases = cases * number("AHQP_CASES").map_or(1, |times| u32::try_from(times).unwrap());
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        cases,
        max_global_rejects: 10 * cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Returns random numbers, the same for the same seed.
fn random(seed: u64) -> TestRng {
    TestRng::from_seed(RngAlgorithm::XorShift, &[seed.to_le_bytes(), [1; 8]].concat())
}

/// Generates numbers between two powers of ten, uniform in their exponent.
fn decades(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from..to).prop_map(|exponent: f64| 10_f64.powf(exponent))
}

/// Generates ranges from tiny to metres, and ramps from one tick to seconds.
fn limits() -> impl Strategy<Value = JerkLimits> {
    let width = prop_oneof![1 => Just(0.0), 6 => decades(-5.0, 1.0), 1 => Just(f64::INFINITY)];
    (-3.0..3.0_f64, width, decades(-1.5, 1.0), decades(-1.0, 1.5), decades(-0.5, 4.5)).prop_map(
        |(lower, width, velocity, acceleration, jerk)| {
            Limits::new(lower, lower + width, velocity, acceleration)
                .unwrap()
                .with_jerk(jerk)
                .unwrap()
        },
    )
}

/// Choice of the next velocity from the interval.
#[derive(Debug, Clone, Copy)]
enum Choice {
    Least,
    Greatest,
    /// Either end, at random.
    Ends,
    /// Any velocity, at random.
    Any,
    /// One end for some time, then the other.
    Runs,
    /// The slowest velocity.
    Rest,
}

fn choices() -> impl Strategy<Value = Choice> {
    prop_oneof![
        Just(Choice::Least),
        Just(Choice::Greatest),
        Just(Choice::Ends),
        Just(Choice::Any),
        Just(Choice::Runs),
        Just(Choice::Rest),
    ]
}

struct Walk {
    limits: JerkLimits,
    choice: Choice,
    random: TestRng,
    share: f64,
}

impl Walk {
    fn new(limits: JerkLimits, choice: Choice, seed: u64) -> Self {
        Self { limits, choice, random: random(seed), share: 0.0 }
    }

    fn step(&mut self, state: AcceleratedState, period: f64) -> AcceleratedState {
        let interval = self.limits.velocity_interval(state, period);
        assert!(interval.lower <= interval.upper, "{interval:?} from {state:?}");
        let draw = self.random.random::<f64>();
        self.share = match self.choice {
            Choice::Least => 0.0,
            Choice::Greatest => 1.0,
            Choice::Ends => (2.0 * draw).floor(),
            Choice::Any => draw,
            Choice::Runs if draw < 0.02 => (100.0 * draw).floor(),
            Choice::Runs | Choice::Rest => self.share,
        };
        let velocity = match self.choice {
            Choice::Rest => 0.0,
            _ => interval.lower + self.share * (interval.upper - interval.lower),
        };
        state.after(velocity.clamp(interval.lower, interval.upper), period)
    }
}

/// Expects that every limit holds in a step from one state to the next.
fn expect_within(
    limits: &JerkLimits,
    from: AcceleratedState,
    to: AcceleratedState,
    period: f64,
) -> Result<(), TestCaseError> {
    let plain = limits.limits();
    // A velocity of rounding size corresponds to an acceleration of that size over the period.
    let noise = 1e-14 * plain.velocity() / period;
    let change = (to.acceleration - from.acceleration).abs();
    prop_assert!(
        change <= limits.jerk() * period * (1.0 + ROUNDING) + noise,
        "jerk: {from:?} {to:?}"
    );
    prop_assert!(
        to.acceleration.abs() <= plain.acceleration() * (1.0 + ROUNDING) + noise,
        "acceleration: {to:?}"
    );
    prop_assert!(to.velocity.abs() <= plain.velocity() * (1.0 + 1e-15), "velocity: {to:?}");
    prop_assert!(to.position <= plain.upper() + 1e-12, "position: {to:?} {limits:?}");
    prop_assert!(to.position >= plain.lower() - 1e-12, "position: {to:?} {limits:?}");
    Ok(())
}

proptest! {
    #![proptest_config(config(60))]

    #[test]
    fn whatever_is_chosen_all_limits_hold_for_ever(
        limits in limits(), start in 0.0..1.0_f64, choice in choices(), seed in any::<u64>(),
        period in decades(-4.0, -1.5), jitter in prop_oneof![Just(0.0), 0.0..0.95_f64],
    ) {
        let plain = limits.limits();
        let width = (plain.upper() - plain.lower()).min(10.0);
        let mut state = AcceleratedState::at_rest(plain.lower() + start * width);
        let mut walk = Walk::new(limits, choice, seed);
        let mut periods = random(!seed);
        for _ in 0..100_000 {
            let period = period * (1.0 + jitter * (2.0 * periods.random::<f64>() - 1.0));
            let next = walk.step(state, period);
            expect_within(&limits, state, next, period)?;
            state = next;
        }
    }
}

/// Returns a state within the position, velocity and acceleration limits. `power` favours small
/// numbers, which narrow ranges need.
fn state(limits: &JerkLimits, shares: [f64; 3], power: i32) -> AcceleratedState {
    let plain = limits.limits();
    let width = (plain.upper() - plain.lower()).min(10.0);
    AcceleratedState {
        position: plain.lower() + 0.5 * (shares[0] + 1.0) * width,
        velocity: plain.velocity() * shares[1].powi(power),
        acceleration: plain.acceleration() * shares[2].powi(power),
    }
}

fn shares() -> [std::ops::Range<f64>; 3] {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0]
}

/// Returns the time from rest to rest over a distance at full jerk, acceleration and velocity
/// \[s\], and the velocity reached.
fn ideal_motion(limits: &JerkLimits, distance: f64) -> (f64, f64) {
    let (plain, j) = (limits.limits(), limits.jerk());
    let (v, a) = (plain.velocity(), plain.acceleration());
    // Time to reach a velocity, and the velocity that takes half the distance to reach.
    let rise = |v: f64| if v >= a * a / j { v / a + a / j } else { 2.0 * (v / j).sqrt() };
    let by_ramps = (0.5 * distance * j.sqrt()).powf(2.0 / 3.0);
    let by_hold = 0.5 * ((a * a / j).powi(2) + 4.0 * a * distance).sqrt() - 0.5 * a * a / j;
    let peak = v.min(if by_ramps <= a * a / j { by_ramps } else { by_hold });
    (2.0 * rise(peak) + (distance - peak * rise(peak)).max(0.0) / peak, peak)
}

/// Returns the distance of time-optimal braking in continuous time, by small steps.
fn braking_distance(limits: &JerkLimits, state: AcceleratedState) -> f64 {
    let (a, j) = (limits.limits().acceleration(), limits.jerk());
    let mut velocity = state.velocity;
    let mut acceleration = state.acceleration;
    let step = ideal_motion(limits, 10.0).0.min(limits.limits().velocity() / a + a / j) / 2e5;
    let (mut distance, mut farthest) = (0.0, 0.0_f64);
    while velocity > 0.0 || acceleration > 0.0 {
        let wanted = -(2.0 * j * velocity.max(0.0)).sqrt().min(a);
        acceleration += (wanted - acceleration).clamp(-j * step, j * step);
        let next = velocity + acceleration * step;
        distance += 0.5 * (velocity + next) * step;
        farthest = farthest.max(distance);
        if next.abs() < 1e-6 * limits.limits().velocity() && acceleration <= 0.0 {
            break;
        }
        velocity = next;
    }
    farthest
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn an_admitted_state_leads_to_admitted_ones(
        limits in limits(), shares in shares(), choice in choices(), seed in any::<u64>(),
        period in decades(-4.0, -1.0),
    ) {
        let mut state = state(&limits, shares, 9);
        prop_assume!(limits.admits(state));
        let mut walk = Walk::new(limits, choice, seed);
        for _ in 0..200 {
            let next = walk.step(state, period);
            expect_within(&limits, state, next, period)?;
            prop_assert!(limits.admits(next), "{next:?} {limits:?}");
            state = next;
        }
    }

    #[test]
    fn the_interval_ends_where_velocities_become_inadmissible(
        limits in limits(), shares in shares(), period in decades(-4.0, -1.5),
    ) {
        let plain = limits.limits();
        let state = state(&limits, shares, 1);
        prop_assume!(limits.admits(state));
        let interval = limits.velocity_interval(state, period);
        let reach = limits.jerk() * period * period;
        let within = |velocity: f64| {
            let next = state.after(velocity, period);
            limits.admits(next)
                && (next.acceleration - state.acceleration).abs() <= limits.jerk() * period
        };
        let inner = 1e-6 * (interval.upper - interval.lower);
        let middle = 0.5 * (interval.lower + interval.upper);
        prop_assert!(inner < 1e-12 || within(middle), "{interval:?}");
        if inner > 1e-12 {
            prop_assert!(within(interval.upper - inner) && within(interval.lower + inner));
        }
        let outer = 1e-6 * reach + 1e-8 * plain.velocity();
        prop_assert!(!within(interval.upper + outer), "above {interval:?}, {state:?}, {limits:?}");
        prop_assert!(!within(interval.lower - outer), "below {interval:?}, {state:?}, {limits:?}");
    }

    #[test]
    fn outside_positions_keep_acceleration_and_jerk_limits(
        limits in limits(), shares in shares(), beyond in -1.0..1.0_f64, choice in choices(),
        seed in any::<u64>(), period in decades(-4.0, -1.0), scale in 0.0..1.0_f64,
    ) {
        let inside = state(&limits, shares, 1);
        let mut state = AcceleratedState { position: inside.position + beyond, ..inside };
        let mut walk = Walk::new(limits.slowed(scale), choice, seed);
        for _ in 0..50 {
            let next = walk.step(state, period);
            prop_assert!(next.acceleration.abs() <= limits.limits().acceleration() * (1.0 + ROUNDING));
            prop_assert!((next.acceleration - state.acceleration).abs()
                <= limits.jerk() * period * (1.0 + ROUNDING) + 1e-13 / period);
            state = next;
        }
    }

    #[test]
    fn excessive_accelerations_fall_at_the_jerk_limit(
        limits in limits(), shares in shares(), factor in 1.0..3.0_f64, choice in choices(),
        period in decades(-4.0, -1.0),
    ) {
        let strongest = limits.limits().acceleration();
        let mut state = state(&limits, shares, 1);
        state.acceleration = (factor * strongest).copysign(state.acceleration);
        let mut walk = Walk::new(limits, choice, 0);
        let change = limits.jerk() * period;
        for _ in 0..50 {
            let next = walk.step(state, period);
            prop_assert!(next.acceleration.abs()
                <= strongest.max(state.acceleration.abs() - change) * (1.0 + ROUNDING));
            state = next;
        }
    }
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn slowed_limits_hold_and_zero_means_rest(
        limits in limits(), start in 0.0..1.0_f64, choice in choices(), seed in any::<u64>(),
        period in decades(-4.0, -2.0),
    ) {
        let plain = limits.limits();
        let width = (plain.upper() - plain.lower()).min(10.0);
        let mut state = AcceleratedState::at_rest(plain.lower() + start * width);
        let mut walk = Walk::new(limits, choice, seed);
        let mut scales = random(!seed);
        let mut scale = 1.0;
        for tick in 0..3000 {
            if tick % 20 == 0 {
                scale = scales.random::<f64>().powi(2);
            }
            walk.limits = limits.slowed(scale);
            let next = walk.step(state, period);
            expect_within(&limits, state, next, period)?;
            state = next;
        }
        walk.limits = limits.slowed(0.0);
        let (a, j) = (plain.acceleration(), limits.jerk());
        // Time to remove the acceleration, to come to rest, and for both ramps.
        let time = plain.velocity() / a + 3.0 * a / j + 10.0 * period;
        let mut elapsed = 0.0;
        while elapsed < time {
            state = walk.step(state, period);
            elapsed += period;
        }
        prop_assert!(state.velocity.abs() <= 1e-9 * plain.velocity(), "{state:?}");
    }

    #[test]
    fn the_far_limit_is_reached_almost_time_optimally(
        limits in limits(), up in any::<bool>(), period in decades(-4.0, -2.5),
    ) {
        let plain = limits.limits();
        let distance = plain.upper() - plain.lower();
        prop_assume!(distance > 0.0 && distance < 20.0);
        let (from, to) = if up {
            (plain.lower(), plain.upper())
        } else {
            (plain.upper(), plain.lower())
        };
        let (ideal, peak) = ideal_motion(&limits, distance);
        let mut walk = Walk::new(limits, if up { Choice::Greatest } else { Choice::Least }, 0);
        let mut state = AcceleratedState::at_rest(from);
        let (mut elapsed, mut fastest) = (0.0, 0.0_f64);
        while (state.position - to).abs() > 1e-6 * distance {
            state = walk.step(state, period);
            elapsed += period;
            fastest = fastest.max(state.velocity.abs());
            prop_assert!(elapsed <= ideal + 5.0 * period, "{elapsed} for {ideal}: {state:?}");
        }
        prop_assert!(fastest >= peak * (1.0 - 2.0 * period / ideal), "{fastest} for {peak}");
        // The coordinate stays there.
        let mut rest = 0.1 * ideal + 100.0 * period;
        while rest > 0.0 {
            state = walk.step(state, period);
            rest -= period;
            prop_assert!((state.position - to).abs() <= 1e-6 * distance);
        }
        prop_assert!(state.velocity.abs() <= 1e-9 * plain.velocity(), "{state:?}");
    }

    #[test]
    fn a_state_too_fast_to_stop_brakes_fully(
        limits in limits(), speed in 0.0..1.0_f64, push in -1.0..1.0_f64, gap in 0.0..1.0_f64,
        period in decades(-4.0, -2.0),
    ) {
        let plain = limits.limits();
        prop_assume!(plain.upper() - plain.lower() > 1e-3 && limits.jerk() < 1e4);
        let mut state = AcceleratedState {
            position: plain.upper().min(5.0),
            velocity: speed * plain.velocity(),
            acceleration: push * plain.acceleration(),
        };
        let stop = braking_distance(&limits, state);
        state.position -= gap * stop;
        let end = state.position + stop;
        let mut walk = Walk::new(limits, Choice::Greatest, 0);
        let mut farthest = state.position;
        for _ in 0..2000 {
            state = walk.step(state, period);
            farthest = farthest.max(state.position);
        }
        prop_assert!(farthest <= end.max(plain.upper()) + 1e-4 * stop + 1e-12, "{farthest} {end}");
    }

    #[test]
    fn outside_positions_return_in_time(
        limits in limits(), speed in -1.0..1.0_f64, beyond in decades(-6.0, 0.5), up in any::<bool>(),
        period in decades(-4.0, -2.5),
    ) {
        let plain = limits.limits();
        prop_assume!(plain.upper().is_finite());
        let sign = if up { 1.0 } else { -1.0 };
        let limit = if up { plain.upper() } else { plain.lower() };
        let velocity = sign * speed * plain.velocity();
        let mut state =
            AcceleratedState { position: limit + sign * beyond, velocity, acceleration: 0.0 };
        // The coordinate first comes to rest, in whichever direction it moves, and then returns.
        let (a, j) = (plain.acceleration(), limits.jerk());
        let rest = speed.abs() * plain.velocity();
        let stop = rest / a + 2.0 * a / j + 2.0 * (rest / j).sqrt();
        let time = stop + ideal_motion(&limits, beyond + rest * stop).0;
        let mut walk = Walk::new(limits, if up { Choice::Greatest } else { Choice::Least }, 0);
        let mut elapsed = 0.0;
        while sign * (state.position - limit) > 1e-9 {
            state = walk.step(state, period);
            elapsed += period;
            prop_assert!(elapsed <= 1.01 * time + 10.0 * period, "{state:?} {limits:?}");
        }
        for _ in 0..1000 {
            state = walk.step(state, period);
            prop_assert!(sign * (state.position - limit) <= 2e-9, "{state:?} {limits:?}");
        }
    }

    #[test]
    fn an_infinite_jerk_limit_changes_no_interval(
        limits in limits(), shares in shares(), beyond in -1.0..1.0_f64,
    ) {
        let limits = limits.limits().with_jerk(f64::INFINITY).unwrap();
        let inside = state(&limits, shares, 1);
        let state = AcceleratedState { position: inside.position + beyond, ..inside };
        let motion = MotionState { position: state.position, velocity: state.velocity };
        prop_assert_eq!(
            limits.velocity_interval(state, PERIOD),
            limits.limits().velocity_interval(motion, PERIOD)
        );
    }
}

#[test]
fn an_invalid_jerk_limit_is_an_error() {
    let limits = Limits::new(-1.0, 1.0, 1.0, 1.0).unwrap();
    for jerk in [0.0, -1.0, f64::NAN] {
        let error = limits.with_jerk(jerk).unwrap_err();
        assert!(error.to_string().contains("jerk limit"), "{error}");
    }
}

#[test]
fn numbers_that_are_not_finite_do_no_harm() {
    let limits = Limits::new(-1.0, 1.0, 1.0, 1.0).unwrap().with_jerk(100.0).unwrap();
    for position in [f64::INFINITY, f64::NEG_INFINITY] {
        let state = AcceleratedState { position, velocity: 0.5, acceleration: 0.0 };
        let interval = limits.velocity_interval(state, PERIOD);
        assert!(interval.lower <= interval.upper && interval.upper <= 1.0);
    }
    for number in [f64::INFINITY, f64::NEG_INFINITY] {
        // No velocity follows from it, and `solve` refuses such bounds.
        let state = AcceleratedState { position: 0.0, velocity: number, acceleration: number };
        let interval = limits.velocity_interval(state, PERIOD);
        let mut hierarchy = Hierarchy::new(1).unwrap();
        let (lower, upper) = hierarchy.bounds_mut();
        (lower[0], upper[0]) = (interval.lower, interval.upper);
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        assert!(solver.solve(&hierarchy).is_err(), "{interval:?}");
    }
    // NaN gives no interval, and no solver accepts it.
    let state = AcceleratedState { position: 0.1, velocity: 0.2, acceleration: 0.3 };
    let nan = f64::NAN;
    for (state, period) in [
        (AcceleratedState { position: nan, ..state }, PERIOD),
        (AcceleratedState { velocity: nan, ..state }, PERIOD),
        (AcceleratedState { acceleration: nan, ..state }, PERIOD),
        (state, nan),
        (state, 0.0),
    ] {
        let AcceleratedState { position, velocity, .. } = state;
        let motion = MotionState { position, velocity };
        let mut intervals = vec![limits.velocity_interval(state, period)];
        if !state.acceleration.is_nan() {
            intervals.push(limits.limits().velocity_interval(motion, period));
        }
        for interval in intervals {
            assert!(interval.lower.is_nan() && interval.upper.is_nan(), "{state:?} {period}");
        }
    }
    assert_eq!(limits.slowed(nan).limits().velocity(), 0.0);
}
