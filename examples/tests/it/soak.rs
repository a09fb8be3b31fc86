//! The closed loop under random people, workspaces and losses, for a short while.

use std::ops::ControlFlow;

use examples::soak::{Counts, Soak, Summary};

fn run(seed: u64, ticks: u64) -> Summary {
    Soak::new(seed, ticks).unwrap().run(|_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn nothing_goes_wrong() {
    let mut moving = 0;
    for seed in 0..4 {
        let summary = run(seed, 4_000);
        assert_eq!(summary.counts.wrong(), 0, "seed {seed}: {:?}", summary.counts);
        moving += summary.moving;
    }
    assert!(moving > 2_700, "the robot moves: {moving} ticks");
}

#[test]
fn a_seed_gives_the_same_ticks() {
    let counts = |seed| -> (Counts, u64) {
        let summary = run(seed, 2_000);
        (summary.counts, summary.moving)
    };
    assert_eq!(counts(5), counts(5));
    assert_ne!(counts(5), counts(6));
}

#[test]
fn the_last_line_is_one_json_object_with_the_names_of_the_book() {
    let line = serde_json::to_string(&run(2, 100)).unwrap();
    let value: serde_json::Value = serde_json::from_str(&line).unwrap();
    for key in [
        "ticks",
        "infeasible",
        "not_finite",
        "limit_violations",
        "acceleration_violations",
        "jerk_violations",
        "torque_violations",
        "separation_violations",
        "discontinuities",
        "tick_us_p50",
        "tick_us_p999",
    ] {
        assert!(value[key].is_number(), "{key} in {line}");
    }
    assert_eq!(value["ticks"], 100);
}

#[test]
fn no_ticks_are_refused() {
    let error = Soak::new(1, 0).unwrap_err();
    assert!(error.to_string().contains("at least 1"), "{error}");
}
