//! The book's table of faults. Each fault is caused, and the robot does what the table says, also with a person in the
//! way.

use std::collections::BTreeMap;

use hrsw_safety::{ClockFault, Fault, FrameFault, SafetyState};
use moca_model::{Error, Scene};
use vision_models::Percept;

use crate::drive::{Drive, PERIOD, others, percept};
use crate::faults::{towards_work, unusable, usable};
use crate::units::standing;

type Scenario = fn(&mut Drive);

/// The scenario of each fault of the book's table.
fn scenarios() -> BTreeMap<String, Scenario> {
    fn frame(drive: &mut Drive, stamp: f64) {
        assert!(drive.controller.observe(percept(stamp, None)).is_err());
        drive.step();
    }
    fn shown(drive: &mut Drive, scale: f64) {
        let frame = Percept { body: Some(standing(2.5, scale)), ..percept(drive.time(), None) };
        assert!(drive.controller.observe(&frame).is_err());
        drive.step();
    }
    fn clock(drive: &mut Drive, now: f64) {
        let measured = drive.robot.position().to_vec();
        drive.controller.step(now, &measured).unwrap();
        drive.obey(PERIOD);
    }
    let scenarios: [(Fault, Scenario); 21] = [
        (ClockFault::NotFinite.into(), |drive| clock(drive, f64::NAN)),
        (ClockFault::StandsStill.into(), |drive| clock(drive, drive.time() - PERIOD)),
        (ClockFault::SetBack.into(), |drive| clock(drive, drive.time() - 5.0)),
        (ClockFault::SetAhead.into(), |drive| clock(drive, drive.time() + 5.0)),
        (Fault::EarlyTick, |drive| clock(drive, drive.time() - 0.8 * PERIOD)),
        (Fault::LateTick, |drive| {
            // Every tick comes two periods after the last one.
            for _ in 0..30 {
                let measured = drive.robot.position().to_vec();
                drive.controller.step(drive.time(), &measured).unwrap();
                drive.obey(2.0 * PERIOD);
                drive.tick += 2;
            }
        }),
        (FrameFault::NotFinite.into(), |drive| frame(drive, f64::NAN)),
        (FrameFault::Future.into(), |drive| frame(drive, drive.time() + 0.1)),
        (FrameFault::ForeignEpoch.into(), |drive| frame(drive, 1.7e9)),
        (FrameFault::Repeated.into(), |drive| {
            frame(drive, drive.controller.clock().newest().unwrap());
        }),
        (FrameFault::OutOfOrder.into(), |drive| frame(drive, drive.time() - 0.2)),
        (FrameFault::Units.into(), |drive| shown(drive, 1e3)),
        (FrameFault::ImpossibleBody.into(), |drive| shown(drive, 1.0 / 0.3048)),
        (FrameFault::ImpossibleSpeed.into(), |drive| {
            drive.person = Some(20.0);
            drive.run(0.2);
            drive.camera = false;
            let jumped = percept(drive.time(), Some(22.0));
            let error = drive.controller.observe(&jumped).unwrap_err();
            assert!(
                matches!(error, Error::Safety(hrsw_safety::Error::BodySpeed { speed }) if speed > 20.0),
                "{error}"
            );
            drive.step();
            drive.camera = true;
        }),
        (Fault::TooManyPeople, |drive| {
            // The people are far away and apart from each other.
            let people = others(&[50.0, 60.0, 70.0, 80.0, 90.0]);
            drive.camera = false;
            let frame = percept(drive.time(), drive.person);
            let error =
                drive.controller.observe(Scene::from(frame).with_others(&people)).unwrap_err();
            assert!(matches!(
                error,
                Error::Safety(hrsw_safety::Error::TooManyPeople { got: 5, left_out: 1, most: 4 })
            ));
            drive.step();
            drive.camera = true;
        }),
        (Fault::BadMeasurement, |drive| drive.step_with(&[f64::INFINITY; 10])),
        (Fault::FollowingError, |drive| {
            let mut pushed = drive.robot.position().to_vec();
            pushed[4] += 0.2;
            drive.step_with(&pushed);
        }),
        (Fault::RobotStopped, |drive| {
            drive.controller.robot_stopped();
            drive.step();
        }),
        (Fault::ContactForce, |drive| {
            // A torque controller reports the observed force to the supervisor.
            let supervisor = drive.controller.safety_mut().supervisor_mut();
            assert_eq!(supervisor.set_external_force(59.0), None);
            assert_eq!(supervisor.set_external_force(61.0), Some(Fault::ContactForce));
            drive.step();
        }),
        (Fault::NoSolution, |drive| {
            towards_work(drive);
            drive.controller.set_ergonomics(unusable());
            drive.step();
            drive.controller.set_ergonomics(usable());
        }),
        (Fault::StopRequested, |drive| {
            drive.controller.request_stop();
            drive.step();
        }),
    ];
    scenarios.into_iter().map(|(fault, make)| (fault.to_string(), make)).collect()
}

/// The rows of the book's table: fault, state, how it ends.
fn table() -> Vec<[String; 3]> {
    let book = include_str!("../faults.md");
    let (_, table) = book.split_once("| fault | when | state | how it ends |").unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|line| {
        let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
        [cells[0].to_owned(), cells[2].to_owned(), cells[3].to_owned()]
    })
    .collect()
}

#[test]
fn every_fault_acts_as_in_the_book() {
    let scenarios = scenarios();
    let table = table();
    let mut named: Vec<_> = table.iter().map(|[fault, ..]| fault.clone()).collect();
    let mut all: Vec<_> = Fault::ALL.iter().map(ToString::to_string).collect();
    named.sort();
    all.sort();
    assert_eq!(named, all, "each fault has one row");
    for [name, state, end] in table {
        let fault = *Fault::ALL.iter().find(|fault| fault.to_string() == name).unwrap();
        let expected = match state.as_str() {
            "protective stop" => SafetyState::ProtectiveStop,
            "reduced" => SafetyState::Reduced,
            other => panic!("{other} is no state"),
        };
        assert_eq!(fault.state(), expected, "{name}");
        let waits = match end.as_str() {
            "acknowledgement" => true,
            "by itself" => false,
            other => panic!("{other} is no end"),
        };
        assert_eq!(fault.waits(), waits, "{name}");
        // This test cannot cause the other faults.
        let Some(make) = scenarios.get(&name) else {
            let others = [Fault::IterationLimit, Fault::BadData, Fault::LimitViolated];
            // Robots under torques have these faults; `silence`, `torque` and `lost_commands` cause them.
            let of_torques = [
                Fault::MissingMeasurement,
                Fault::FrozenMeasurement,
                Fault::UnknownPayload,
                Fault::LostCommand,
            ];
            assert!(others.contains(&fault) || of_torques.contains(&fault), "{name}");
            continue;
        };
        let mut drive = Drive::fast();
        make(&mut drive);
        assert_eq!(drive.state(), expected, "{name}");
        assert_eq!(drive.cause(), Some(fault), "{name}");
        // The clock continues from its present time.
        let offset = drive.controller.clock().now().unwrap() + PERIOD - drive.time();
        drive.go_on(offset, 2.0);
        if waits {
            drive.assert_waits(fault);
            drive.acknowledge();
            drive.go_on(offset, 2.0);
        }
        assert_eq!(drive.state(), SafetyState::Normal, "{name}");
        assert!(drive.fastest() > 0.1, "{name}: it goes on");
    }
}

/// Each fault of the table occurs while the robot drives towards a person, with and without later frames. The state is
/// reached within 0.2 s, and the robot stays away from the person in every tick.
#[test]
fn no_fault_drives_robot_into_a_person() {
    for (name, make) in scenarios() {
        let fault = *Fault::ALL.iter().find(|fault| fault.to_string() == name).unwrap();
        for sees in [true, false] {
            // This fault has a person of its own.
            let mut drive = match fault {
                Fault::NoSolution => Drive::fast(),
                _ => Drive::towards_a_person(),
            };
            drive.run(0.2);
            make(&mut drive);
            assert!(drive.person.is_some(), "{name}");
            let offset = drive.controller.clock().now().unwrap() + PERIOD - drive.time();
            let (begin, mut state) = (drive.time(), drive.state());
            while drive.time() < begin + if sees { 0.7 } else { 2.2 } {
                if drive.time() < begin + 0.2 {
                    state = state.max(drive.state());
                }
                if sees {
                    drive.go_on(offset, PERIOD);
                } else {
                    let measured = drive.robot.position().to_vec();
                    drive.controller.step(drive.time() + offset, &measured).unwrap();
                    drive.obey(PERIOD); // away from the person
                    drive.tick += 1;
                }
            }
            assert!(state >= fault.state(), "{name}: {state:?}");
            assert!(sees || drive.fastest() == 0.0, "{name}: without frames it stands");
        }
    }
}
