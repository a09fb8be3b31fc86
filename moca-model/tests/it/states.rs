//! The states of the supervisor, row by row of the book's table.

use hrsw::{Cause, SafetyState};
use moca_model::SafetySettings;

use crate::drive::Drive;

/// State, when it is left.
fn table() -> Vec<[String; 2]> {
    let book = include_str!("../book.md");
    let header = "| state | cause | entered when | what the robot does | left when |";
    let (_, table) = book.split_once(header).unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|line| {
        let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
        [cells[0].to_owned(), cells[4].to_owned()]
    })
    .collect()
}

/// The share of its greatest speed that a joint uses at most.
fn share(drive: &Drive) -> f64 {
    let limits = drive.controller.robot().model().limits();
    let shares = drive.velocity.iter().zip(limits).map(|(v, limits)| v.abs() / limits.velocity);
    shares.fold(0.0, f64::max)
}

#[test]
fn every_state_is_what_the_table_of_the_book_says() {
    let states: Vec<_> = table().into_iter().map(|[state, _]| state).collect();
    assert_eq!(states, ["normal", "reduced", "retreat", "protective stop"]);
    let settings = SafetySettings::default().supervisor;
    for [state, left] in table() {
        let mut drive = Drive::fast();
        match state.as_str() {
            "normal" => {
                drive.run(0.1);
                assert_eq!(drive.state(), SafetyState::Normal);
                assert!(left.is_empty());
            }
            "reduced" | "protective stop" => {
                let (after, expected) = match state.as_str() {
                    "reduced" => (settings.reduced_age, SafetyState::Reduced),
                    _ => (settings.stop_age, SafetyState::ProtectiveStop),
                };
                drive.camera = false;
                while drive.state() < expected {
                    drive.step();
                }
                let cause = drive.controller.safety().supervisor().cause();
                let Some(Cause::Stale { age }) = cause else { panic!("{cause:?}") };
                assert!((age.seconds() - after).abs() < 0.002 + 0.05, "{age:?}");
                if expected == SafetyState::ProtectiveStop {
                    drive.run(2.0);
                    assert!(drive.fastest() < 1e-9);
                } else {
                    drive.run(0.4);
                    assert!(share(&drive) <= settings.reduced_scale + 1e-9);
                }
                drive.camera = true;
                drive.run(2.0);
                assert_eq!(drive.state(), SafetyState::Normal, "{left}");
            }
            "retreat" => {
                // Somebody stands before the robot at once.
                drive.person = Some(drive.controller.actual().translation.x + 0.75);
                while drive.state() < SafetyState::Retreat {
                    drive.step();
                }
                let cause = drive.controller.safety().supervisor().cause();
                assert!(matches!(cause, Some(Cause::TooClose(_))), "{cause:?}");
                assert_eq!(drive.state(), SafetyState::Retreat);
                // The ramp, and what the joints need to slow down.
                drive.run(1.5);
                let (mut last, mut nearest) = (drive.distance(), 0.0_f64);
                while drive.state() == SafetyState::Retreat {
                    drive.step();
                    assert!(share(&drive) <= settings.retreat_scale + 1e-9, "{:?}", drive.velocity);
                    nearest = nearest.min(drive.distance() - last);
                    last = drive.distance();
                    if drive.time() > 20.0 {
                        break;
                    }
                }
                assert!(nearest > -1e-5, "it comes no nearer: {nearest} m in a tick");
                drive.person = Some(drive.controller.actual().translation.x + 5.0);
                drive.run(1.5);
                assert_eq!(drive.state(), SafetyState::Normal, "{left}");
            }
            other => panic!("{other} is no state"),
        }
    }
}
