//! The closed loop under random people, workspaces and losses, for a short while.

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

/// Each movement of one person, who works with the robot; the longer form is `soak --movements 100`.
#[test]
fn nobody_who_moves_on_the_spot_is_approached_too_near() {
    let movements = Movements { seed: 1, people: 1, robot: PlantSettings::default() };
    let results = movements.run(|_| ControlFlow::Continue(())).unwrap();
    assert_eq!(results.wrong(), 0, "{:?}", results.findings);
    assert!(results.movements.iter().all(|result| result.ticks == 8_000));
    let speed = results.contact_speed.unwrap();
    assert!(speed < 0.35, "{speed} m/s within 5 cm");
}

/// One after the other goes wrong: cameras, clocks, measurements, a push.
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
fn a_disturbance_asks_for_more_the_longer_it_lasts() {
    for disturbance in Disturbance::ALL {
        let states = (0..200_u32).map(|tick| disturbance.least_state(0.01 * f64::from(tick)));
        assert!(states.is_sorted(), "{disturbance:?}");
        assert_eq!(disturbance.least_state(0.0), SafetyState::Normal);
        // A camera that was moved cannot be noticed; a line that loses a third of the commands is bridged; ticks that
        // are late now and then are no fault.
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
        "wrong_states",
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
