//! Time of one velocity interval: `cargo bench -p ahqp-core --bench limits`.
//!
//! One set of states is that of a joint of the Panda at 1 kHz, driven from limit to limit. The
//! other set stays well inside the limits.
#![allow(clippy::unwrap_used, missing_docs)]

use ahqp_core::{AcceleratedState, JerkLimits, Limits, MotionState};
use divan::{Bencher, black_box};

const PERIOD: f64 = 1e-3;

fn main() {
    divan::main();
}

fn limits() -> JerkLimits {
    Limits::new(-2.8973, 2.8973, 2.175, 15.0).unwrap().with_jerk(7500.0).unwrap()
}

/// Returns states of a back-and-forth motion: `switch` ticks towards one limit, then as many
/// towards the other.
fn states(switch: usize) -> Vec<AcceleratedState> {
    let mut state = AcceleratedState::at_rest(0.0);
    let mut all = Vec::new();
    for tick in 0..20_000 {
        let interval = limits().velocity_interval(state, PERIOD);
        let up = (tick / switch).is_multiple_of(2);
        state = state.after(if up { interval.upper } else { interval.lower }, PERIOD);
        all.push(state);
    }
    all
}

#[divan::bench(args = [150, 3000])]
fn with_jerk(bencher: Bencher, switch: usize) {
    let (states, limits) = (states(switch), limits());
    bencher.counter(states.len()).bench_local(|| {
        for state in &states {
            black_box(black_box(limits).velocity_interval(*state, PERIOD));
        }
    });
}

#[divan::bench(args = [150, 3000])]
fn without_jerk(bencher: Bencher, switch: usize) {
    let (states, limits) = (states(switch), limits().limits());
    bencher.counter(states.len()).bench_local(|| {
        for AcceleratedState { position, velocity, .. } in &states {
            let state = MotionState { position: *position, velocity: *velocity };
            black_box(black_box(limits).velocity_interval(state, PERIOD));
        }
    });
}

/// Measures right before the limit, where the search for the end of the interval is longest.
#[divan::bench]
fn while_braking(bencher: Bencher) {
    let limits = limits();
    let plain = limits.limits();
    let brakes = |state: &&AcceleratedState| {
        let interval = limits.velocity_interval(**state, PERIOD);
        let free =
            state.velocity + (state.acceleration + limits.jerk() * PERIOD).min(15.0) * PERIOD;
        interval.upper < free.min(plain.velocity()) - 1e-9
    };
    let states: Vec<_> = states(3000).iter().filter(brakes).copied().collect();
    bencher.counter(states.len()).bench_local(|| {
        for state in &states {
            black_box(black_box(limits).velocity_interval(*state, PERIOD));
        }
    });
}
