//! Assumed speed of a person whom the camera misses, and the effect of noise in the joints.

use hrsw_safety::{
    Age, Capsule, FrameFault, MeasuredVelocity, Safety, SafetyInput, SafetySettings, SafetyState,
    proximity,
};
use moca_model::{
    CollaborationStack, Kinematics, MOCA_AXIS_SPEED, MOCA_HOME, MOCA_TOOL, moca_safety,
};
use nalgebra::{Matrix3, Point3, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use vision_models::{Body, Body25, BodyTracker, Confidence, Keypoint, Percept, TrackerSettings};

use crate::drive::{Drive, FRAME, PERIOD, body, percept};
use crate::shared::MOCA;

/// Place of a person, about five metres in front of the robot \[m\].
const AHEAD: f64 = 5.5;

/// The measured velocity of the trunk.
fn speed(drive: &Drive) -> Option<MeasuredVelocity> {
    drive.controller.safety().person_bodies().first().and_then(|body| body.velocity)
}

fn seen() -> Drive {
    let mut drive = Drive::fast();
    drive.person = Some(AHEAD);
    drive.run(1.0);
    assert!(speed(&drive).is_some());
    drive
}

/// A person who is missed may have begun to walk, but is not assumed to be faster at once.
#[test]
fn missed_person_keeps_speed_with_growing_uncertainty() {
    let mut drive = seen();
    drive.person = None;
    let last = drive.time().mul_add(20.0, -1e-9).floor() / 20.0;
    let mut before = speed(&drive).unwrap();
    while drive.time() - last < 0.48 {
        drive.step();
        let now = speed(&drive).unwrap();
        assert_eq!(now.mean, before.mean);
        let growth = now.uncertainty - before.uncertainty;
        assert!((-1e-12..0.01).contains(&growth), "{growth} m/s in a tick");
        // A person who begins to walk accelerates at about 1 m/s².
        assert!(now.uncertainty >= drive.time() - last - 1e-3, "{now:?}");
        before = now;
    }
    // A person who is seen again is known at once.
    let mut found = drive.clone();
    found.person = Some(AHEAD);
    for _ in 0..300 {
        found.step();
        assert!(speed(&found).is_some(), "{} s", found.time());
    }
    drive.run(0.1);
    assert_eq!(speed(&drive), None);
}

/// The joints of the trunk are displaced in every other frame, first each in its own direction, then all alike.
#[test]
fn joints_that_disagree_are_nobody_elsewhere() {
    let errors = [
        (Body25::Neck, 0.3),
        (Body25::RightShoulder, 0.25),
        (Body25::LeftShoulder, 0.2),
        (Body25::MidHip, 0.16),
        (Body25::RightHip, -0.1),
        (Body25::LeftHip, -0.2),
    ];
    let parts_with = |error: &dyn Fn(f64) -> f64| {
        let mut drive = seen();
        let alone = drive.controller.safety().person_bodies().len();
        let mut most = 0;
        for tick in 0..600_u32 {
            let mut percept = percept(drive.time(), Some(AHEAD));
            let body = percept.body.as_mut().unwrap();
            if (tick / FRAME).is_multiple_of(2) {
                for (joint, own) in errors {
                    let place = body.get(joint).unwrap().position;
                    let position = Point3::new(place.x + error(own), place.y, place.z);
                    body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
                }
            }
            if tick.is_multiple_of(FRAME) {
                drive.controller.observe(&percept).unwrap();
            }
            drive.camera = false;
            drive.step();
            most = most.max(drive.controller.safety().person_bodies().len());
        }
        (alone, most)
    };
    let (alone, noisy) = parts_with(&|own| own);
    assert_eq!(noisy, alone);
    let (alone, shifted) = parts_with(&|_| 0.2);
    assert_eq!(shifted, 2 * alone, "where they were, and where they seem to be");
}

/// The robot at rest, and its safety.
fn at_home(settings: SafetySettings) -> (Kinematics, Safety) {
    let robot = Kinematics::new(MOCA.clone(), MOCA_TOOL, &settings.bodies, &MOCA_HOME).unwrap();
    let layout = CollaborationStack::layout(MOCA_HOME.len());
    let accelerations: Vec<f64> = MOCA.limits().iter().map(|limits| limits.acceleration).collect();
    let safety = Safety::new(layout, settings, &accelerations, MOCA_AXIS_SPEED, PERIOD).unwrap();
    (robot, safety)
}

/// The speed scale of a robot at rest that retreats from a person who is too near and approaches at this speed.
fn share_in_retreat(towards: f64) -> f64 {
    let (robot, mut safety) = at_home(moca_safety());
    // The trunk is a little nearer than the distance that a robot at rest must keep to a person at 0.45 m/s.
    let distance = |x: f64| {
        let at = |z: f64| Vector3::new(x, 0.0, z);
        let trunk = Capsule::new(at(1.45), at(0.93), 0.15).unwrap();
        let distances = robot.bodies().iter().map(|body| proximity(&body.capsule, &trunk).distance);
        distances.fold(f64::INFINITY, f64::min)
    };
    let x =
        (0..3000).map(|step| 3.0 - 1e-3 * f64::from(step)).find(|&x| distance(x) < 0.165).unwrap();
    // Run up to a frame and a little. The uncertainty of a longer time would leave no direction that surely leads away.
    for tick in 0..=1953_u32 {
        let now = f64::from(tick) * PERIOD;
        if tick == 1700 {
            // The robot recovers from this stop into retreat, and has its speed there, before the person is too near.
            safety.report(FrameFault::Future.into());
        }
        if tick.is_multiple_of(FRAME) {
            // The person is at that place in the last frame.
            safety.observe(&percept(now, Some(x + towards * (1.95 - now)))).unwrap();
        }
        let input = SafetyInput {
            now,
            elapsed: PERIOD,
            age: Age::new(0.0).unwrap(),
            together: false,
            measures_force: false,
        };
        safety.measure(&robot.motion(&[0.0; 10]), robot.bodies(), &input).unwrap();
        safety.decide(robot.bodies(), &input);
    }
    assert_eq!(safety.supervisor().state(), SafetyState::Retreat);
    safety.speed_scale() - 0.15
}

/// The retreat is faster by the speed at which the person approaches.
#[test]
fn retreat_is_faster_by_the_approach_speed() {
    for towards in [0.45, 0.5, 0.55] {
        let more = share_in_retreat(towards) * MOCA_AXIS_SPEED;
        assert!((more - towards).abs() < 0.05, "{more} m/s from somebody at {towards} m/s");
        // The filter has reached that speed except for some millimetres a second.
        assert!(more <= towards + 5e-3, "{more} m/s from somebody at {towards} m/s");
    }
}

/// Standard deviations of the measured joints of a person who walks along x: along x and across \[m\].
#[derive(Clone, Copy)]
struct Noise {
    along: f64,
    across: f64,
}

impl Noise {
    fn see(self, body: &Body, is_known: bool, draw: &mut ChaCha8Rng) -> Body {
        let mut seen = Body::default();
        let sigma = Vector3::new(self.along, self.across, self.across);
        for (joint, keypoint) in body.iter() {
            // Twelve uniform numbers for each axis are nearly normal, with tails.
            let normal =
                sigma.map(|_| (0..12).map(|_| draw.random_range(-0.5..0.5_f64)).sum::<f64>());
            let noise = sigma.component_mul(&normal);
            let keypoint = Keypoint { position: keypoint.position + noise, ..keypoint };
            if is_known {
                let covariance = Matrix3::from_diagonal(&sigma.map(|sigma| sigma * sigma));
                seen.set_measured(joint, keypoint, covariance);
            } else {
                seen.set(joint, Some(keypoint));
            }
        }
        seen
    }
}

/// Checks that a person's velocity is within three of its standard deviations in all but five of a thousand frames. The
/// person also begins to walk, and stops, at 1.5 m/s². `noise` draws the camera's errors; `is_known` says whether the
/// camera reports them.
fn is_as_certain_as_it_says(is_known: bool, noise: impl Fn(&mut ChaCha8Rng) -> Noise) {
    // The controller's tracker, whose joints are known as safety knows them.
    let settings = TrackerSettings { position_sigma: 0.02, ..TrackerSettings::default() };
    let deviations = 3.0;
    let (mut beyond, mut frames, mut most) = (0, 0, 0.0_f64);
    for seed in 0..40 {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        let noise = noise(&mut draw);
        let mut tracker = BodyTracker::new(settings.clone()).unwrap();
        let (mut x, mut speed) = (0.0, 0.0_f64);
        for frame in 0..200_u32 {
            let time = 0.05 * f64::from(frame);
            let wanted = if (60..120).contains(&frame) { 1.2 } else { 0.0 };
            let change = (wanted - speed).clamp(-1.5 * 0.05, 1.5 * 0.05);
            x += (speed + 0.5 * change) * 0.05;
            speed += change;
            let seen = noise.see(&body(2.0 + x), is_known, &mut draw);
            let percept = Percept { time, body: Some(seen), action: None, surface: None };
            tracker.update(&percept).unwrap();
            let Some(person) = tracker.predict(time).filter(|_| frame > 40) else { continue };
            let known = person.velocity_covariance.symmetric_eigenvalues().max().sqrt();
            let error = (person.velocity - Vector2::new(speed, 0.0)).norm();
            frames += 1;
            beyond += u32::from(error > deviations * known);
            most = most.max(error / known);
        }
    }
    assert!(
        beyond * 200 <= frames,
        "{beyond} of {frames} frames beyond, by up to {most} deviations"
    );
}

#[test]
fn velocity_with_covariances_has_stated_uncertainty() {
    is_as_certain_as_it_says(true, |draw| {
        let sigma = draw.random_range(0.01..0.05);
        Noise { along: sigma, across: sigma }
    });
}

/// The depth camera is 1.5 to 3 m away: 9 to 38 mm along the ray, 1.5 pixels across.
#[test]
fn velocity_without_covariances_has_stated_uncertainty() {
    is_as_certain_as_it_says(false, |draw| {
        let distance = draw.random_range(1.5..3.0_f64);
        Noise { along: 0.0042 * distance.powi(2), across: 1.5 / 615.0 * distance }
    });
}

/// The trunk of a person 3 to 4.5 m from a depth camera is measured 100 times. At most twice it is farther from its
/// measured place than Z_d plus the reported uncertainty.
#[test]
fn place_from_covariances_has_stated_uncertainty() {
    let (mut beyond, mut frames) = (0, 0);
    for seed in 0..20 {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        let distance = draw.random_range(3.0..4.5_f64);
        let noise = Noise { along: 0.0042 * distance.powi(2), across: 2.5 / 615.0 * distance };
        let settings = moca_safety();
        let allowed = settings.separation.human_uncertainty;
        let (robot, mut safety) = at_home(settings);
        let truth = body(AHEAD);
        for frame in 0..100_u32 {
            let now = 0.05 * f64::from(frame);
            let seen = Some(noise.see(&truth, true, &mut draw));
            safety
                .observe(&Percept { time: now, body: seen, action: None, surface: None })
                .unwrap();
            let age = Age::new(0.0).unwrap();
            let input =
                SafetyInput { now, elapsed: PERIOD, age, together: false, measures_force: false };
            safety.measure(&robot.motion(&[0.0; 10]), robot.bodies(), &input).unwrap();
            let trunk = safety.person_bodies().first().unwrap();
            let error =
                [(Body25::Neck, trunk.capsule.start()), (Body25::MidHip, trunk.capsule.end())].map(
                    |(joint, place)| (place - truth.get(joint).unwrap().position.coords).norm(),
                );
            frames += 1;
            beyond += u32::from(error[0].max(error[1]) > allowed + trunk.uncertainty);
        }
    }
    assert!(beyond * 50 <= frames, "{beyond} of {frames} frames beyond");
}
