//! Tests of the situation that a tick knows.

use hrsw::HeldFrame;
use hrsw_safety::nalgebra::{Isometry3, Vector3};
use moca_model::{ControllerSettings, SharedSpace, Situation};
use vision_models::{Action, Freshness, People, PeopleSettings, Percept, Tool, TrackerSettings};

use crate::drive::doing;

const PERIOD: f64 = 1e-3;
/// Time of the last frame that shows the person \[s\].
const LAST: f64 = 1.95;

/// The situation this long after a person who drills was seen for the last time.
fn unseen_for(age: f64) -> Situation {
    let tool = Isometry3::translation(0.9, 0.0, 1.0);
    let mut space = SharedSpace::new(&ControllerSettings::default(), &tool).unwrap();
    let mut situation = space.advance(0.0, PERIOD).unwrap();
    assert_eq!((situation.freshness(), situation.is_shared), (Freshness::Lost, false));
    for tick in 1_u32.. {
        let time = f64::from(tick) * PERIOD;
        if time > LAST + age {
            break;
        }
        if tick.is_multiple_of(50) {
            let person = (time < LAST + 0.5 * PERIOD).then_some(1.7);
            space.observe(&doing(Action::Using(Tool::Drill), time, person)).unwrap();
        }
        situation = space.advance(time, PERIOD).unwrap();
    }
    situation
}

#[test]
fn vanished_person_goes_down_the_ladder() {
    for (age, freshness) in [
        (0.1, Freshness::Tracked),
        (0.4, Freshness::Coasting),
        (1.4, Freshness::Uncertain),
        (1.6, Freshness::Lost),
    ] {
        let situation = unseen_for(age);
        assert_eq!(situation.freshness(), freshness, "after {age} s");
        // A person who is not seen still works with the robot, but nothing follows them.
        assert!(situation.is_shared, "after {age} s");
        let place = situation.frame.position() - Vector3::new(1.7, 0.0, 0.0);
        assert!(place.norm() < 0.1, "{place}");
        let follows = freshness.is_usable();
        assert!(follows || (situation.velocity == Vector3::zeros() && situation.is_at_rest));
    }
}

/// The percept of somebody who drills at this place, turned by so many radians.
fn turned(time: f64, place: Vector3<f64>, turn: f64) -> Percept {
    let mut percept = doing(Action::Using(Tool::Drill), time, Some(0.0));
    let motion = Isometry3::new(place, Vector3::z() * turn);
    percept.body = percept.body.map(|body| body.transformed(&motion));
    percept
}

/// The largest speed of a corner of the workspace, over the floor \[m/s\].
fn corner_speed(space: &SharedSpace, settings: &ControllerSettings) -> f64 {
    let workspace = space.workspace();
    let twist = workspace.twist();
    let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
    let (min, max) = (settings.space.min, settings.space.max);
    let corners = [min.x, max.x].map(|x| [min.y, max.y].map(|y| Vector3::new(x, y, 0.0)));
    let arms = corners.as_flattened().iter();
    let rotation = workspace.world_from_workspace().rotation;
    arms.map(|arm| (linear + angular.cross(&(rotation * arm))).norm()).fold(0.0, f64::max)
}

/// A tool in any corner of the workspace is fast enough to stay in it while a person turns on the spot.
#[test]
fn workspace_turns_no_faster_than_tool() {
    for speed in [0.2, 0.5] {
        let mut settings = ControllerSettings::default();
        settings.desired.velocity = speed;
        let tool = Isometry3::translation(0.9, 0.0, 1.0);
        let mut space = SharedSpace::new(&settings, &tool).unwrap();
        let place = Vector3::new(1.7, 0.0, 0.0);
        let mut fastest = 0.0_f64;
        for tick in 0_u32..20_000 {
            let time = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(50) {
                let turn = if time > 6.0 { 0.7 } else { 0.0 };
                space.observe(&turned(time, place, turn)).unwrap();
            }
            space.advance(time, PERIOD).unwrap();
            if time > 6.0 {
                fastest = fastest.max(corner_speed(&space, &settings));
            }
        }
        assert!((0.5 * speed..=speed).contains(&fastest), "{fastest} m/s");
        let forward = space.workspace().world_from_workspace() * Vector3::x();
        // They faced the robot.
        let off = (forward.y.atan2(forward.x) - (std::f64::consts::PI + 0.7)).sin().abs();
        assert!(off < HeldFrame::HEADING, "the workspace is {off} rad off the person");
    }
}

/// The frame of somebody who was lost closes in on them as slowly as the workspace on a new carrier.
#[test]
fn workspace_approaches_who_is_found_again_slowly() {
    let settings = ControllerSettings::default();
    let tool = Isometry3::translation(0.9, 0.0, 1.0);
    let mut space = SharedSpace::new(&settings, &tool).unwrap();
    let mut fastest = 0.0_f64;
    let before = |time: f64| time < 5.0;
    for tick in 0_u32..14_000 {
        let time = f64::from(tick) * PERIOD;
        let place = Vector3::new(1.7, if before(time) { 0.0 } else { 0.8 }, 0.0);
        if tick.is_multiple_of(50) && (before(time) || time > 6.2) {
            space.observe(&turned(time, place, 0.0)).unwrap();
        }
        let situation = space.advance(time, PERIOD).unwrap();
        if time > 6.3 {
            let speed = space.workspace().twist().fixed_rows::<3>(0).norm();
            fastest = fastest.max(speed);
            let far = (space.workspace().world_from_workspace().translation.vector - place).norm();
            let seen = situation.freshness() == Freshness::Tracked;
            assert!(!seen || !situation.is_in_place || far < 0.4, "in place at {far} m");
        }
        if tick == 13_999 {
            assert!(situation.is_in_place, "they stand where they are");
        }
    }
    assert!((0.3..0.5).contains(&fastest), "{fastest} m/s");
}

/// Perception and the controller predict a person from the same measured joints, each for itself.
#[test]
fn controller_and_perception_agree_on_the_person() {
    let settings = ControllerSettings::default();
    let mut space = SharedSpace::new(&settings, &Isometry3::translation(0.9, 0.0, 1.0)).unwrap();
    let position_sigma = settings.safety.position_sigma;
    let tracker = TrackerSettings { position_sigma, ..TrackerSettings::default() };
    let mut people = People::new(PeopleSettings::default(), tracker).unwrap();
    let mut compared = 0;
    for tick in 0_u32..6_000 {
        let time = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(50) {
            let place = Vector3::new(1.7 + 0.3 * (0.8 * time).sin(), 0.4 * time, 0.0);
            let seen = turned(time, place, 0.2 * time);
            // They are hidden for a while.
            let body = seen.body.filter(|_| !(3.0..3.4).contains(&time));
            people.update(time, &body).unwrap();
            let body = people.tracks().first().filter(|track| track.is_in_frame());
            let body = body.map(|track| track.measured().clone());
            space.observe(&Percept { body, ..seen }).unwrap();
        }
        let situation = space.advance(time, PERIOD).unwrap();
        let tracked = people.tracks().first().and_then(|track| track.predict(time));
        assert_eq!(situation.worker, tracked, "{time} s");
        compared += u32::from(tracked.is_some());
    }
    assert!(compared > 5_500, "{compared} ticks");
}
