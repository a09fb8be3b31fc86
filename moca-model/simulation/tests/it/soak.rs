//! The closed loop under random people, workspaces and losses, for a short time.

use std::ops::ControlFlow;

use hrsw_safety::SafetyState;
use moca_simulation::plant::PlantSettings;
use moca_simulation::soak::{Counts, Disturbance, Movements, Soak, StateCounts, Summary};

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

/// Each movement of a person who works with the robot. The longer form is `soak --movements 100`.
#[test]
fn people_moving_on_the_spot_are_safe() {
    let movements = Movements { seed: 1, people: 1, robot: PlantSettings::default() };
    let results = movements.run(|_| ControlFlow::Continue(())).unwrap();
    assert_eq!(results.wrong(), 0, "{:?}", results.findings);
    assert!(results.movements.iter().all(|result| result.ticks == 8_000));
    let speed = results.contact_speed.unwrap();
    assert!(speed < 0.35, "{speed} m/s within 5 cm");
}

/// One thing after the other fails: cameras, clocks, measurements; and there is a push.
#[test]
fn disturbances_end_in_the_states_of_the_book() {
    let mut ended = 0;
    for seed in 0..2 {
        let summary = run(seed, 16_000);
        assert_eq!(summary.counts.wrong(), 0, "seed {seed}: {:?}", summary.findings);
        for (_, states) in summary.ended.counts() {
            let StateCounts { normal, reduced, retreat, protective_stop } = states;
            ended += normal + reduced + retreat + protective_stop;
        }
    }
    assert!(ended > 3, "{ended}");
}

#[test]
fn longer_disturbances_need_stricter_states() {
    for disturbance in Disturbance::ALL {
        let states = (0..200_u32).map(|tick| disturbance.least_state(0.01 * f64::from(tick)));
        assert!(states.is_sorted(), "{disturbance:?}");
        assert_eq!(disturbance.least_state(0.0), SafetyState::Normal);
        // A moved camera cannot be noticed. A line that loses a third of the commands is bridged. Occasional late ticks
        // are no fault.
        let is_borne = matches!(
            disturbance,
            Disturbance::CameraMoved | Disturbance::CommandsThinned | Disturbance::TicksLate
        );
        let asked = disturbance.least_state(2.0) > SafetyState::Normal;
        assert_eq!(asked, !is_borne, "{disturbance:?}");
    }
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
fn last_line_is_json_with_documented_names() {
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
        "wrong_states",
        "standing_ticks",
        "tick_us_p50",
        "tick_us_p999",
    ] {
        assert!(value[key].is_number(), "{key} in {line}");
    }
    assert_eq!(value["ticks"], 100);
    for disturbance in Disturbance::ALL {
        let name = serde_json::to_value(disturbance).unwrap();
        assert_eq!(value["disturbances"][name.as_str().unwrap()]["protective_stop"], 0);
    }
}

#[test]
fn no_ticks_are_refused() {
    let error = Soak::new(1, 0).unwrap_err();
    assert!(error.to_string().contains("at least 1"), "{error}");
}
