//! Tests of the situation that a tick knows.

use hrsw_safety::nalgebra::{Isometry3, Vector3};
use moca_model::{ControllerSettings, SharedSpace, Situation};
use vision_models::{Action, Freshness, Tool};

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

/// A tool inside follows the workspace at most at its own speed. Somebody who turns at once is at the origin of the frame,
/// and the workspace in front of them.
#[test]
fn workspace_turns_no_faster_than_tool() {
    let settings = ControllerSettings::default();
    let tool = Isometry3::translation(0.9, 0.0, 1.0);
    let mut space = SharedSpace::new(&settings, &tool).unwrap();
    let mut fastest = 0.0_f64;
    for tick in 0_u32..12_000 {
        let time = f64::from(tick) * PERIOD;
        if tick.is_multiple_of(50) {
            let mut percept = doing(Action::Using(Tool::Drill), time, Some(1.7));
            let about = Isometry3::translation(1.7, 0.0, 0.0);
            let turn = Isometry3::rotation(Vector3::z() * if time > 6.0 { 0.7 } else { 0.0 });
            percept.body =
                percept.body.map(|body| body.transformed(&(about * turn * about.inverse())));
            space.observe(&percept).unwrap();
        }
        let situation = space.advance(time, PERIOD).unwrap();
        let workspace = space.workspace();
        let centre = (settings.space.min + settings.space.max) * 0.5;
        let arm = workspace.world_from_workspace().rotation * centre;
        let turning = workspace.twist().fixed_rows::<3>(3).into_owned();
        if time > 5.0 {
            fastest = fastest.max(turning.cross(&arm).norm());
            let frame = workspace.world_from_workspace() * Vector3::x();
            let off = frame.y.atan2(frame.x) - situation.frame.heading();
            assert!(
                off.sin().abs() < 1e-3,
                "the workspace turns with the frame, {off} rad at {time} s"
            );
        }
    }
    let speed = settings.desired.velocity;
    assert!((0.3 * speed..speed).contains(&fastest), "{fastest} m/s");
}
