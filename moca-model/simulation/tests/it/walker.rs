//! The simulated person is reproducible, plausible, and as hard for a controller as asked.

use std::{collections::HashSet, f64::consts::TAU};

use moca_simulation::people::{CameraSettings, Error, Truth, Walker, WalkerSettings, WalkingPath};
use vision_models::{Action, BodyTracker, Percept, Tool, TrackerSettings, WalkingDirection};

use crate::support::recorded;

fn frames(settings: WalkerSettings) -> Vec<(Truth, Option<Percept>)> {
    let mut walker = Walker::new(settings).unwrap();
    std::iter::from_fn(|| walker.next_frame()).collect()
}

fn on(path: WalkingPath) -> WalkerSettings {
    WalkerSettings { path, camera: CameraSettings::PERFECT, ..WalkerSettings::default() }
}

#[test]
fn the_shipped_recording_tells_the_story() {
    assert_eq!(Walker::new(WalkerSettings::default()).unwrap().header().stature, Some(1.75));
    let percepts = recorded();
    let last = percepts.last().unwrap().time;
    assert!((40.0..=60.0).contains(&last), "{last} s");
    // Actions that are recognised with confidence, one entry for each change.
    let mut actions: Vec<Action> = percepts
        .iter()
        .filter_map(|percept| percept.action)
        .filter(|seen| seen.confidence.value() > 0.8)
        .map(|seen| seen.action)
        .collect();
    actions.dedup();
    let drill = Tool::Drill;
    let moving = |direction| Action::MoveWhileUsing(direction, drill);
    let expected = [
        Action::WalkingWithObject,
        Action::DeliverObject,
        Action::PickUp(drill),
        Action::NoCollaborative(drill),
        Action::Using(drill),
        moving(WalkingDirection::Backwards),
        Action::Using(drill),
        moving(WalkingDirection::Left),
        Action::Using(drill),
        moving(WalkingDirection::BackwardsLeft),
        Action::Using(drill),
        moving(WalkingDirection::BackwardsRight),
        Action::Using(drill),
        Action::PutDown(drill),
        Action::Walking,
    ];
    assert_eq!(actions, expected);
    // The surface is known from the delivery on.
    let seen = percepts.iter().find(|percept| percept.surface.is_some()).unwrap();
    assert!(seen.surface.unwrap().surface == drill.surface() && seen.time > 5.0);
}

#[test]
fn walk_depends_only_on_its_seed() {
    let walk = |seed| Walker::random(seed).collect::<Vec<_>>();
    assert_eq!(walk(3), walk(3));
    assert_ne!(walk(3), walk(4));
    // More noise does not change where the person walks.
    let truths =
        |settings| frames(settings).into_iter().map(|(truth, _)| truth).collect::<Vec<_>>();
    let noisy = WalkerSettings { camera: CameraSettings::default(), ..on(WalkingPath::Random) };
    assert_eq!(truths(noisy), truths(on(WalkingPath::Random)));
}

#[test]
fn people_walk_like_people_on_every_path() {
    for path in [
        WalkingPath::Stations,
        WalkingPath::Straight,
        WalkingPath::Square,
        WalkingPath::Circle,
        WalkingPath::FigureEight,
        WalkingPath::Random,
        "1.4,0 2,0.5".parse().unwrap(),
    ] {
        let frames = frames(on(path.clone()));
        let mut directions = HashSet::new();
        for pair in frames.windows(2) {
            let ((before, _), (now, percept)) = (&pair[0], &pair[1]);
            let step = now.floor - before.floor;
            assert!((step / 0.05 - now.velocity).norm() < 0.05, "{path:?}: speed is the step's");
            assert!(now.velocity.norm() < 0.81 && (now.velocity - before.velocity).norm() < 0.0401);
            assert!((now.heading - before.heading).abs() <= 1.2 * 0.05 + 1e-9);
            if now.action.is_collaborative() {
                assert!(now.velocity.norm() < 0.31, "{path:?}: the robot can follow");
                assert!(now.floor.x > 1.0, "{path:?}: not into the robot's first place");
            }
            directions.extend(now.action.walking_direction());
            // The camera without noise sees the truth.
            let hip = percept.as_ref().unwrap().body.as_ref().unwrap();
            let hip = hip.get(vision_models::Body25::MidHip).unwrap().position;
            assert!((hip.xy() - now.floor).norm() < 1e-9);
        }
        assert!(directions.len() >= 2, "{path:?}: {directions:?}");
        assert_eq!(frames.last().unwrap().0.action, Action::Walking, "{path:?}: leaves in the end");
    }
}

#[test]
fn actions_are_recognised_a_little_late() {
    let frames = frames(on(WalkingPath::Stations));
    let recognised: Vec<Action> =
        frames.iter().filter_map(|(_, percept)| Some(percept.as_ref()?.action?.action)).collect();
    let agree = |delay: usize| {
        let truths = frames.iter().map(|(truth, _)| truth.action).skip(4 - delay);
        recognised.iter().zip(truths).filter(|(seen, truth)| *seen == truth).count()
    };
    // Nothing is reported in the first four frames, so `skip(4 - delay)` delays by `delay` frames.
    let share = agree(4) as f64 / recognised.len() as f64;
    assert!((0.95..1.0).contains(&share), "right labels: {share}");
    assert!((0..4).all(|delay| agree(delay) < agree(4)), "the latency is 0.2 s");
}

#[test]
fn the_tracker_follows_the_shipped_walk() {
    let mut tracker = BodyTracker::new(TrackerSettings::default()).unwrap();
    let (mut floor_error, mut heading_error, mut count) = (0.0, 0.0, 0.0);
    let mut walker = Walker::new(WalkerSettings::default()).unwrap();
    while let Some((truth, percept)) = walker.next_frame() {
        if let Some(percept) = percept {
            tracker.update(&percept).unwrap();
        }
        let Some(pose) = tracker.predict(truth.time).filter(|_| truth.time > 1.0) else {
            continue;
        };
        assert!(pose.freshness.is_usable(), "at {} s", truth.time);
        floor_error += (pose.floor - truth.floor).norm_squared();
        // The person starts at half a turn, which may be measured with either sign.
        let turned = pose.heading - truth.heading;
        heading_error += (turned - TAU * (turned / TAU).round()).powi(2);
        count += 1.0;
    }
    let (floor_error, heading_error) =
        (f64::sqrt(floor_error / count), f64::sqrt(heading_error / count));
    // The person works up to 3.4 m from the camera, where the depth of a joint has a standard deviation of 45 mm.
    assert!(floor_error < 0.04, "position: {floor_error} m RMS");
    assert!(heading_error < 0.1, "heading: {heading_error} rad RMS");
    let stature = tracker.stature().unwrap();
    assert!((stature.stature - 1.75).abs() < 0.04, "{stature:?}");
}

#[test]
fn random_walks_vanish_and_jump() {
    for seed in 0..50 {
        let mut walker = Walker::random(seed);
        let (mut unseen, mut longest, mut jumped) = (0, 0, false);
        while let Some((truth, percept)) = walker.next_frame() {
            let body = percept.and_then(|percept| percept.body);
            let hip = body.as_ref().and_then(|body| body.get(vision_models::Body25::MidHip));
            unseen = if body.is_none() { unseen + 1 } else { 0 };
            longest = longest.max(unseen);
            jumped |= hip.is_some_and(|hip| (hip.position.xy() - truth.floor).norm() > 1.5);
        }
        assert!(longest >= 6, "seed {seed}: vanishes for 0.3 s at least, not {longest} frames");
        // A jump may be within a vanishing, where it is not seen.
        assert!(jumped || longest > 6, "seed {seed} never jumps");
    }
}

#[test]
fn wrong_settings_are_named() {
    let base = WalkerSettings::default;
    let camera = CameraSettings::default;
    for (name, settings) in [
        ("stature", WalkerSettings { stature: 0.0, ..base() }),
        ("stature", WalkerSettings { stature: f64::NAN, ..base() }),
        ("duration", WalkerSettings { duration: -1.0, ..base() }),
        ("noise", WalkerSettings { camera: CameraSettings { noise: -1.0, ..camera() }, ..base() }),
        ("sway", WalkerSettings { sway: -1.0, ..base() }),
        (
            "lasting",
            WalkerSettings { camera: CameraSettings { lasting: 1.1, ..camera() }, ..base() },
        ),
        ("drop", WalkerSettings { camera: CameraSettings { drop: 1.1, ..camera() }, ..base() }),
        ("path", on(WalkingPath::Points(vec![nalgebra::Point2::new(f64::NAN, 0.0)]))),
    ] {
        let error = Walker::new(settings).unwrap_err();
        assert!(matches!(error, Error::Value { what, .. } if what == name), "{error}");
        assert!(error.to_string().contains("give"), "{error}");
    }
}

#[test]
fn wrong_paths_are_named() {
    for text in ["", "zigzag", "1.4", "1.4,0 2.4", "1,2,3"] {
        let error = WalkingPath::from_argument(text).unwrap_err();
        assert!(
            error.to_string().starts_with(&format!("path \"{text}\": give stations")),
            "{error}"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("path.txt");
    std::fs::write(&file, "1.4,0\n\n2.0, 0.5\n").unwrap();
    let path = WalkingPath::from_argument(file.to_str().unwrap()).unwrap();
    assert_eq!(path, "1.4,0 2.0,0.5".parse().unwrap());
    std::fs::write(&file, "1.4,0\nhere\n").unwrap();
    let error = WalkingPath::from_argument(file.to_str().unwrap()).unwrap_err();
    assert!(error.to_string().contains("\"here\""), "{error}");
    std::fs::write(&file, [0xff, 0xfe]).unwrap();
    let error = WalkingPath::from_argument(file.to_str().unwrap()).unwrap_err();
    assert!(matches!(error, Error::PathFile { .. }), "{error}");
}
