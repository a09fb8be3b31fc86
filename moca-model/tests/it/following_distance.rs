//! The workspace falls behind a person who walks away, by the distance that separation needs.

use moca_model::{ControllerSettings, SharedSpace, moca_safety};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use vision_models::{Action, Body25, Confidence, Keypoint, Tool};

use crate::drive::{FRAME, PERIOD, doing};

/// Times for which they stand, walk, and stand again \[s\].
const STAND: f64 = 5.0;
const WALK: f64 = 12.0;

/// Acceleration of a person who begins to walk, or stops \[m/s²\].
const ACCELERATION: f64 = 1.5;

/// The distance that a person has walked this long after the start \[m\].
fn walked(speed: f64, since: f64) -> f64 {
    let rise = speed / ACCELERATION;
    let (begins, walks, stops) = (
        since.clamp(0.0, rise),
        (since - rise).clamp(0.0, WALK),
        (since - rise - WALK).clamp(0.0, rise),
    );
    speed * (walks + stops) + 0.5 * ACCELERATION * (begins * begins - stops * stops)
}

/// The place of the workspace in the frame of a person who walks evenly, and after they stop, in their axes \[m\]. They
/// walk at `velocity`, forwards and to the left \[m/s\].
fn places(settings: &ControllerSettings, velocity: [f64; 2]) -> [Vector3<f64>; 2] {
    let tool = Isometry3::translation(3.0, 0.0, 1.0);
    let mut space = SharedSpace::new(settings, &tool).unwrap();
    let velocity = Vector2::from(velocity);
    let mut places = [Vector3::zeros(); 2];
    for (tick, time) in (0_u32..25_000).map(|tick| (tick, f64::from(tick) * PERIOD)) {
        // The person faces the robot, against x.
        let way = -velocity.normalize() * walked(velocity.norm(), time - STAND);
        if tick.is_multiple_of(FRAME) {
            let mut percept = doing(Action::Using(Tool::Drill), time, Some(4.0));
            let body = percept.body.as_mut().unwrap();
            for joint in Body25::ALL {
                let Some(seen) = body.get(joint) else { continue };
                let position = seen.position + way.push(0.0);
                body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
            }
            space.observe(&percept).unwrap();
        }
        let situation = space.advance(time, PERIOD).unwrap();
        let floor = Point3::new(4.0 + way.x, way.y, 0.0);
        let off = space.workspace().world_from_workspace().translation.vector - floor.coords;
        let place = Vector3::new(-off.x, -off.y, off.z);
        if time < STAND + WALK {
            places[0] = place;
            if time > 4.0 {
                assert!(situation.is_in_place, "{time} s: {off:?}");
            }
        }
        places[1] = place;
    }
    places
}

#[test]
fn workspace_falls_behind_a_departing_person() {
    let settings = ControllerSettings::default();
    let space = &settings.space;
    let outward = (space.min + space.max).xy().normalize();
    for speed in [0.2, 0.4, 0.6, 0.8] {
        // The person is seen T_r late. S_p is that for T_r = 0.15 s, a = 0.5 m/s² and C + Z_d + Z_r = 0.11 m.
        let away = speed * outward.x;
        let needed = 2.0 * 0.15 * away + away * away + 0.11 - 0.4;
        let expected = (outward * needed.max(0.0)).push(0.0);
        let [walking, standing] = places(&settings, [-speed, 0.0]);
        assert!((walking - expected).norm() < 0.02, "{speed} m/s: {walking:?}, not {expected:?}");
        // The frame is held where it came to rest.
        assert!(standing.norm() < 0.04, "{standing:?}");
    }
}

#[test]
fn workspace_stays_with_approaching_or_passing_person() {
    let settings = ControllerSettings::default();
    for velocity in [[0.8, 0.0], [0.0, 0.6], [0.5, 0.5]] {
        let [walking, _] = places(&settings, velocity);
        assert!(walking.norm() < 0.02, "{velocity:?}: {walking:?}");
    }
}

/// No distance is kept, so that there is no need to fall behind.
#[test]
fn without_separation_the_workspace_stays_with_them() {
    let settings =
        ControllerSettings { safety: moca_safety().off(), ..ControllerSettings::default() };
    let [walking, _] = places(&settings, [-0.8, 0.0]);
    assert!(walking.norm() < 0.02, "{walking:?}");
}
