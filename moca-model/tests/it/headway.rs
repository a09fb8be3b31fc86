//! The workspace of who walks away from the robot falls behind by what the separation asks for.

use moca_model::{ControllerSettings, SharedSpace, moca_safety};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use vision_models::{Action, Body25, Confidence, Keypoint, Tool};

use crate::drive::{FRAME, PERIOD, doing};

/// How long they stand, walk, and stand again \[s\].
const STAND: f64 = 5.0;
const WALK: f64 = 12.0;

/// Who begins to walk, or stops, does so with this \[m/s²\].
const ACCELERATION: f64 = 1.5;

/// How far somebody has walked who began so long ago \[m\].
fn walked(speed: f64, since: f64) -> f64 {
    let rise = speed / ACCELERATION;
    let (begins, walks, stops) = (
        since.clamp(0.0, rise),
        (since - rise).clamp(0.0, WALK),
        (since - rise - WALK).clamp(0.0, rise),
    );
    speed * (walks + stops) + 0.5 * ACCELERATION * (begins * begins - stops * stops)
}

/// Where the workspace is in the frame of who walks evenly, in their axes, and where when they stand again \[m\].
/// They walk at `velocity`, forwards and to the left \[m/s\].
fn places(settings: &ControllerSettings, velocity: [f64; 2]) -> [Vector3<f64>; 2] {
    let tool = Isometry3::translation(3.0, 0.0, 1.0);
    let mut space = SharedSpace::new(settings, &tool).unwrap();
    let velocity = Vector2::from(velocity);
    let mut places = [Vector3::zeros(); 2];
    for (tick, time) in (0_u32..25_000).map(|tick| (tick, f64::from(tick) * PERIOD)) {
        // They face the robot, against x.
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
        space.advance(time, PERIOD).unwrap();
        let floor = Point3::new(4.0 + way.x, way.y, 0.0);
        let off = space.workspace().world_from_workspace().translation.vector - floor.coords;
        let place = Vector3::new(-off.x, -off.y, off.z);
        if time < STAND + WALK {
            places[0] = place;
            if time > 4.0 {
                assert!(space.is_in_place(), "{time} s: {off:?}");
            }
        }
        places[1] = place;
    }
    places
}

#[test]
fn the_workspace_falls_behind_who_walks_away() {
    let settings = ControllerSettings::default();
    let space = &settings.space;
    let outward = (space.min + space.max).xy().normalize();
    for speed in [0.2, 0.4, 0.6, 0.8] {
        // S_p with T_r = 0.15 s, a = 0.5 m/s² and C + Z_d + Z_r = 0.11 m, of who is seen T_r late.
        let away = speed * outward.x;
        let needed = 2.0 * 0.15 * away + away * away + 0.11 - space.clearance;
        let expected = (outward * needed.max(0.0)).push(0.0);
        let [walking, standing] = places(&settings, [-speed, 0.0]);
        assert!((walking - expected).norm() < 0.02, "{speed} m/s: {walking:?}, not {expected:?}");
        // The frame is held where it came to rest.
        assert!(standing.norm() < 0.04, "{standing:?}");
    }
}

#[test]
fn the_workspace_stays_with_who_comes_nearer_or_passes() {
    let settings = ControllerSettings::default();
    for velocity in [[0.8, 0.0], [0.0, 0.6], [0.5, 0.5]] {
        let [walking, _] = places(&settings, velocity);
        assert!(walking.norm() < 0.02, "{velocity:?}: {walking:?}");
    }
}

/// Where nobody is kept at a distance there is nothing to fall behind for.
#[test]
fn without_separation_the_workspace_stays_with_them() {
    let settings =
        ControllerSettings { safety: moca_safety().off(), ..ControllerSettings::default() };
    let [walking, _] = places(&settings, [-0.8, 0.0]);
    assert!(walking.norm() < 0.02, "{walking:?}");
}
