//! People besides the person who works with the robot.

use hrsw_safety::{PersonBody, SafetyState};
use moca_model::{Error, Scene};
use vision_models::{Action, Body, Percept, PersonId, Tool};

use crate::drive::{Drive, FRAME, body, doing, others, percept};

#[test]
fn others_in_the_way_are_not_touched() {
    let mut drive = Drive::fast();
    drive.others = vec![drive.controller.actual().translation.x + 1.8];
    drive.run(5.0); // every tick finds the robot away from them
    drive.assert_near_but_not_too_near();
    // They leave and are out of sight, and the robot goes on when they are forgotten.
    drive.others.clear();
    drive.run(5.0);
    assert_ne!(drive.state(), SafetyState::Normal, "they may be anywhere");
    drive.run(8.0);
    assert_eq!(drive.state(), SafetyState::Normal);
}

/// One frame in five shows them.
#[test]
fn rarely_seen_person_is_not_touched() {
    let mut drive = Drive::fast();
    let at = drive.controller.actual().translation.x + 1.8;
    for tick in 0..5000_u32 {
        drive.others = if tick % (5 * FRAME) < FRAME { vec![at] } else { Vec::new() };
        drive.step();
        let others = std::mem::replace(&mut drive.others, vec![at]);
        assert!(drive.distance() > 0.0, "tick {tick}");
        drive.others = others;
    }
}

/// Contact is only permitted for the person who works with the robot. The speed of others is measured by their own
/// joints.
#[test]
fn nobody_else_is_worked_with() {
    let mut drive = Drive::new();
    (drive.person, drive.camera) = (Some(3.0), false);
    for tick in 0..1500_u32 {
        if tick.is_multiple_of(FRAME) {
            let work = doing(Action::Using(Tool::Drill), drive.time(), drive.person);
            drive.controller.observe(Scene::from(work).with_others(&others(&[4.0]))).unwrap();
        }
        drive.controller.set_external_force(0.0);
        drive.step();
    }
    assert!(drive.controller.safety().contact_speed() > 0.0);
    let of_person = drive.controller.safety().person_bodies().len();
    let (person, others) = drive.controller.safety().all_bodies().split_at(of_person);
    assert!(person.iter().any(|body| body.contact.is_some()));
    assert!(!others.is_empty());
    assert!(others.iter().all(|body| body.contact.is_none()));
    let stands =
        |body: &PersonBody| body.velocity.is_some_and(|velocity| velocity.mean.norm() < 0.05);
    assert!(others.iter().all(stands));
}

/// Each body of a frame is that of the person with its id, in any order and at any place that they can have reached.
#[test]
fn people_are_told_apart_by_their_ids() {
    let mut drive = Drive::new();
    drive.camera = false;
    let mut look = |bodies: &[Body]| {
        let seen =
            drive.controller.observe(Scene::from(percept(drive.time(), None)).with_others(bodies));
        (0..FRAME).for_each(|_| drive.step());
        seen
    };
    let mut people = others(&[10.0, 12.0, 14.0, 16.0]);
    for frame in 0..40 {
        people.rotate_left(frame % 3);
        look(&people[..=frame % 4]).unwrap();
    }
    let is_too_many = |error: &Error| {
        use hrsw_safety::Error::TooManyPeople;
        matches!(error, Error::Safety(TooManyPeople { got: 1, left_out: 1, most: 4 }))
    };
    // Another id is another person, also where somebody is.
    let error = look(&[body(10.0).with_id(PersonId::new(9))]).unwrap_err();
    assert!(is_too_many(&error), "{error}");
    // Nobody can be at the other end of the room in the next frame.
    let jumped = body(20.0).with_id(people[0].id());
    let error = look(&[jumped]).unwrap_err();
    let too_fast =
        matches!(error, Error::Safety(hrsw_safety::Error::BodySpeed { speed }) if speed > 12.5);
    assert!(too_fast, "{error}");
}

/// Those who move on are the same people, at their measured speeds. Those who appear elsewhere are new, until there are
/// too many.
#[test]
fn people_without_ids_are_told_apart() {
    let mut drive = Drive::new();
    drive.camera = false;
    let mut look = |places: &[f64]| {
        let people: Vec<_> = places.iter().map(|&place| body(place)).collect();
        let scene = Scene::from(percept(drive.time(), None)).with_others(&people);
        let seen = drive.controller.observe(scene);
        drive.run(0.05);
        (seen, drive.controller.safety().all_bodies().to_vec())
    };
    let (_, of_two) = look(&[5.0, 8.0]);
    for frame in 1..20 {
        let walked = 0.05 * f64::from(frame);
        let (seen, bodies) = look(&[5.0 + walked, 8.0]);
        seen.unwrap();
        assert_eq!(bodies.len(), of_two.len(), "frame {frame}");
        for body in bodies.iter().filter(|_| frame > 12) {
            let speed = if body.capsule.start().x < 7.0 { 1.0 } else { 0.0 };
            let velocity = body.velocity.unwrap();
            let error = (velocity.mean.x - speed).abs();
            assert!(error <= velocity.uncertainty, "frame {frame}: {error} m/s off");
            assert!(velocity.uncertainty < 0.8, "frame {frame}: {} m/s", velocity.uncertainty);
        }
    }
    look(&[11.0]).0.unwrap();
    look(&[14.0]).0.unwrap();
    let error = look(&[17.0]).0.unwrap_err();
    assert!(matches!(error, Error::Safety(hrsw_safety::Error::TooManyPeople { .. })), "{error}");
    assert_eq!(drive.state(), SafetyState::ProtectiveStop);
}

/// Somebody passes by. The worker stays who they are, if there are no ids, or some are missing in between.
#[test]
fn worker_stays_the_same_beside_a_bystander() {
    for has_ids in [false, true] {
        let mut drive = Drive::new();
        drive.camera = false;
        for frame in 0..80_u32 {
            let passes = (30..60).contains(&frame).then_some(4.5 + 0.05 * f64::from(frame));
            let id = |number| (has_ids && frame % 20 != 13).then(|| PersonId::new(number));
            let percept = doing(Action::Using(Tool::Drill), drive.time(), None);
            let percept = Percept { body: Some(body(3.0).with_id(id(5))), ..percept };
            let others: Vec<_> = passes.iter().map(|&x| body(x).with_id(id(0))).collect();
            drive.controller.observe(Scene::from(percept).with_others(&others)).unwrap();
            (0..FRAME).for_each(|_| {
                drive.controller.set_external_force(0.0);
                drive.step();
            });
            let situation = drive.controller.situation();
            assert!(frame < 20 || situation.is_shared, "frame {frame}, ids {has_ids}");
        }
    }
}

/// After a frame of the future a clock was wrong. People are then told apart anew.
#[test]
fn people_are_told_apart_after_wrong_clock() {
    let mut drive = Drive::new();
    drive.camera = false;
    let people = [body(5.0), body(8.0)];
    let scene = |time| Scene::from(percept(time, None)).with_others(&people);
    drive.controller.observe(scene(3600.0)).unwrap();
    drive.run(0.1);
    for _frame in 0..20 {
        drive.controller.observe(scene(drive.time())).unwrap();
        drive.run(0.05);
    }
    assert!(drive.controller.safety().all_bodies().iter().all(|body| body.velocity.is_some()));
}

/// A person who first stands among the others and then works with the robot no longer counts as one of them.
#[test]
fn working_person_stops_counting_as_another() {
    let mut drive = Drive::new();
    drive.camera = false;
    let at_work = |time| {
        let percept = doing(Action::Using(Tool::Drill), time, None);
        Percept { body: others(&[5.0, 3.0]).pop(), ..percept }
    };
    let mut look = |work: bool| {
        let time = drive.time();
        let (percept, others) = if work {
            (at_work(time), others(&[5.0]))
        } else {
            (percept(time, None), others(&[5.0, 3.0]))
        };
        drive.controller.observe(Scene::from(percept).with_others(&others)).unwrap();
        drive.controller.set_external_force(0.0);
        drive.step();
        let safety = drive.controller.safety();
        let of_person = safety.person_bodies().len();
        safety.all_bodies().len() - of_person
    };
    let of_two = look(false);
    assert_eq!(look(true) * 2, of_two, "one of them is left");
    // A person who stops working is one of the others again.
    assert_eq!(look(false), of_two);
}

/// Somebody else steps to the tool while the robot works with a person. What the first one wanted does not count for
/// the second.
#[test]
fn somebody_else_is_not_taken_for_the_worker() {
    let mut drive = Drive::new();
    drive.camera = false;
    let mut work = |id: u64, action: Option<Action>, frames: u32| {
        for _frame in 0..frames {
            let percept = match action {
                Some(action) => doing(action, drive.time(), None),
                None => percept(drive.time(), None),
            };
            let body = body(3.0).with_id(PersonId::new(id));
            drive.controller.observe(&Percept { body: Some(body), ..percept }).unwrap();
            (0..FRAME).for_each(|_| {
                drive.controller.set_external_force(0.0);
                drive.step();
            });
        }
        let situation = drive.controller.situation();
        (situation.intention.is_together(), situation.worker.is_some())
    };
    assert_eq!(work(1, Some(Action::Using(Tool::Drill)), 20), (true, true));
    assert_eq!(work(2, None, 1), (false, false), "nothing is known of the second");
    assert_eq!(work(2, None, 10), (false, true), "who only stands there");
    assert_eq!(work(2, Some(Action::Using(Tool::Drill)), 20), (true, true));
}

/// Frames come from another thread.
mod from_another_thread {
    use hrsw_safety::SafetyState;
    use moca_model::Scene;
    use moca_model::whole_body::control_loop::{ControlLaw, JointCommand};

    use super::{Drive, percept};
    use crate::drive::loop_controller;

    fn state_with(others: &[f64]) -> SafetyState {
        let (mut law, frames, measured) = loop_controller();
        let mut command = JointCommand::at_rest(&measured);
        for tick in 0..150_u32 {
            let now = f64::from(tick) * 1e-3;
            let bodies = crate::drive::others(others);
            let frame = Scene::from(percept(now, None)).with_others(&bodies);
            assert_eq!(frame.others(), &bodies[..bodies.len().min(5)]);
            frames.send(frame).unwrap();
            law.step(now, &measured, &mut command).unwrap();
        }
        law.controller().controller().command().safety
    }

    #[test]
    fn others_are_kept_away_from() {
        assert_eq!(state_with(&[9.0]), SafetyState::Normal);
        let tool = Drive::new().controller.actual().translation.x;
        assert_eq!(state_with(&[tool + 0.2]), SafetyState::Retreat);
    }

    #[test]
    fn too_many_stop_the_robot() {
        let many = [9.0, 11.0, 13.0, 15.0, 17.0, 19.0];
        assert_eq!(state_with(&many[..4]), SafetyState::Normal);
        assert_eq!(state_with(&many[..5]), SafetyState::ProtectiveStop);
        assert_eq!(state_with(&many), SafetyState::ProtectiveStop);
    }
}
