//! An hour of a walking person, as measured by a depth camera, and several people.

use std::f64::consts::{PI, TAU};

use nalgebra::{
    Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector2, Vector3, vector,
};
use vision_models::{
    Body, Body25, BodySegment, BodyTracker, Camera, Confidence, DepthNoise, Error, Intrinsics,
    Keypoint, People, PeopleSettings, Percept, PersonTrack, TrackerSettings,
};

const FRAME: f64 = 0.05;

/// An upright person of 1.75 m with the pelvis above the origin, looking along x.
const JOINTS: [(Body25, [f64; 3]); 12] = [
    (Body25::Neck, [0.0, 0.0, 1.43]),
    (Body25::LeftShoulder, [0.0, 0.2, 1.43]),
    (Body25::RightShoulder, [0.0, -0.2, 1.43]),
    (Body25::LeftElbow, [0.0, 0.2, 1.1045]),
    (Body25::LeftWrist, [0.2555, 0.2, 1.1045]),
    (Body25::MidHip, [0.0, 0.0, 0.9275]),
    (Body25::LeftHip, [0.0, 0.1, 0.9275]),
    (Body25::RightHip, [0.0, -0.1, 0.9275]),
    (Body25::LeftKnee, [0.0, 0.1, 0.49875]),
    (Body25::RightKnee, [0.0, -0.1, 0.49875]),
    (Body25::LeftAnkle, [0.0, 0.1, 0.06825]),
    (Body25::RightAnkle, [0.0, -0.1, 0.06825]),
];

/// A camera's errors: 3 pixels of white noise, and depth errors that are correlated from frame to
/// frame.
struct Noise {
    state: u64,
    camera: Camera,
    drop: f64,
    correlation: f64,
    depth: [f64; Body25::COUNT],
}

impl Noise {
    fn new(drop: f64) -> Self {
        let intrinsics = Intrinsics::new([640, 480], [615.0, 615.0], [319.5, 239.5]).unwrap();
        let (eye, target) = (Point3::new(0.3, 1.8, 2.3), Point3::new(2.0, 0.0, 0.9));
        let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap();
        let correlation = (-FRAME / 0.1).exp();
        Self { state: 1, camera, drop, correlation, depth: [0.0; Body25::COUNT] }
    }

    /// Returns a number in (0, 1) (Knuth's generator, the upper half of its state).
    fn uniform(&mut self) -> f64 {
        let next = self.state.wrapping_mul(6_364_136_223_846_793_005);
        self.state = next.wrapping_add(1_442_695_040_888_963_407);
        ((self.state >> 33) as f64 + 0.5) / f64::from(1_u32 << 31)
    }

    fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    }

    /// Returns a person as measured by the camera, each joint with the covariance of its errors.
    fn see(&mut self, scale: f64, floor: Vector2<f64>, heading: f64) -> Body {
        let motion = Isometry3::from_parts(
            Translation3::new(floor.x, floor.y, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
        );
        let pose = *self.camera.world_from_camera();
        let mut body = Body::default();
        for (joint, place) in JOINTS {
            let truth = pose.inverse() * (motion * (Point3::from(place) * scale));
            let index = joint.index();
            let fresh = (1.0 - self.correlation.powi(2)).sqrt() * self.normal();
            self.depth[index] = self.correlation * self.depth[index] + fresh;
            let sigma = self.camera.noise().sigma(truth.z);
            let across = 3.0 * truth.z / 615.0;
            let ray = truth.coords / truth.z;
            let error = Vector3::new(self.normal(), self.normal(), 0.0) * across
                + ray * (self.depth[index] * sigma);
            let misplaced = self.uniform() < 0.02;
            let error = if misplaced { error + Vector3::new(0.3, 0.1, 0.2) } else { error };
            if self.uniform() < self.drop {
                continue;
            }
            let axes = *pose.rotation.to_rotation_matrix().matrix();
            let of_camera = Matrix3::from_diagonal(&vector![across.powi(2), across.powi(2), 0.0])
                + ray * ray.transpose() * sigma.powi(2);
            let confidence = Confidence::new(0.8).unwrap();
            let keypoint = Keypoint { position: pose * (truth + error), confidence };
            body.set_measured(joint, keypoint, axes * of_camera * axes.transpose());
        }
        body
    }
}

fn percept(time: f64, body: Body) -> Percept {
    Percept { time, body: Some(body), action: None, surface: None }
}

/// Returns the position and heading on a circle of 0.8 m at 1 m/s, looking ahead.
fn walk(time: f64) -> (Vector2<f64>, f64) {
    let turned = time / 0.8;
    (vector![2.0, 0.0] + vector![turned.cos(), turned.sin()] * 0.8, turned + PI / 2.0)
}

#[test]
fn noise_is_no_jump_but_jumps_are_detected() {
    let mut noise = Noise::new(0.2);
    let mut tracker = BodyTracker::new(TrackerSettings::default()).unwrap();
    let (mut squares, mut turns, mut worst, mut inside, mut count) = (0.0, 0.0, 0.0_f64, 0.0, 0.0);
    for frame in 0..72_000 {
        let time = FRAME * f64::from(frame);
        let (floor, heading) = walk(time);
        tracker.update(&percept(time, noise.see(1.0, floor, heading))).unwrap();
        let Some(person) = tracker.predict(time).filter(|_| time > 2.0) else { continue };
        let error = person.floor.coords - floor;
        let turned = person.heading - heading;
        let distance = error.dot(&(person.floor_covariance.try_inverse().unwrap() * error));
        squares += error.norm_squared();
        worst = worst.max(error.norm());
        turns += (turned - TAU * (turned / TAU).round()).powi(2);
        inside += f64::from(u8::from(distance < 5.99));
        count += 1.0;
        assert!(person.freshness.is_usable(), "at {time} s");
    }
    let (position, heading) = (f64::sqrt(squares / count), f64::sqrt(turns / count).to_degrees());
    println!("{position} m, {heading}°, {worst} m at worst, {} inside", inside / count);
    assert_eq!(tracker.jumps(), 0);
    assert!(position < 0.03 && heading < 6.0, "{position} m, {heading}°");

    // The person jumps by two metres.
    for frame in 72_000..72_010 {
        let time = FRAME * f64::from(frame);
        let (floor, heading) = walk(time);
        let body = noise.see(1.0, floor + vector![2.0, 0.0], heading);
        tracker.update(&percept(time, body)).unwrap();
    }
    assert_eq!(tracker.jumps(), 1);
    let time = FRAME * 72_009.0;
    let error = tracker.predict(time).unwrap().floor.coords - walk(time).0 - vector![2.0, 0.0];
    assert!(error.norm() < 0.2, "{error}");
}

#[test]
fn lengths_are_without_the_bias_of_noise() {
    let mut noise = Noise::new(0.2);
    let mut tracker = BodyTracker::new(TrackerSettings::default()).unwrap();
    for frame in 0..400 {
        let time = FRAME * f64::from(frame);
        let (floor, heading) = walk(time);
        tracker.update(&percept(time, noise.see(1.0, floor, heading))).unwrap();
    }
    let stature = tracker.stature().unwrap();
    assert!((stature.stature - 1.75).abs() < 0.025, "{stature:?}");
    for (segment, expected) in [
        (BodySegment::UpperArm, 0.3255),
        (BodySegment::Forearm, 0.2555),
        (BodySegment::Trunk, 0.5025),
    ] {
        let found = tracker.segment(segment).unwrap();
        assert!((found.length - expected).abs() < 0.015, "{segment:?}: {found:?}");
    }
}

#[test]
fn stature_follows_the_person() {
    let mut noise = Noise::new(0.2);
    let mut tracker = BodyTracker::new(TrackerSettings::default()).unwrap();
    let mut time = 0.0;
    let mut stature_after = |scale: f64| {
        // No person for a second, then a person for ten seconds.
        time += 1.0;
        for _ in 0..200 {
            time += FRAME;
            tracker.update(&percept(time, noise.see(scale, vector![2.0, 0.0], PI))).unwrap();
        }
        tracker.stature().unwrap()
    };
    let first = stature_after(1.0);
    let again = stature_after(1.0);
    assert!(again.frames > first.frames + 150, "what was measured before still counts");
    let other = stature_after(1.1);
    for (found, expected) in [(first, 1.75), (other, 1.1 * 1.75)] {
        let error = (found.stature - expected).abs();
        assert!(error < 3.0 * found.standard_error && error < 0.025, "{found:?}");
    }
}

#[test]
fn the_engaged_person_is_selected_and_kept() {
    let mut noise = Noise::new(0.1);
    let mut people = People::new(PeopleSettings::default(), TrackerSettings::default()).unwrap();
    let mut engaged = Vec::new();
    for frame in 0..240 {
        let time = FRAME * f64::from(frame);
        // One person works at the robot. Another walks past behind, turns to the robot and comes
        // nearer. A third is far away. The order in the frame changes.
        let worker = noise.see(1.0, vector![1.9, 0.3], PI);
        let near = 2.8 - 0.1 * (time - 4.0).clamp(0.0, 8.0);
        let passer = noise.see(1.05, vector![near, -0.8], PI);
        let far = noise.see(1.0, vector![4.5, 3.0], 0.0);
        let mut bodies = vec![passer, far];
        bodies.insert([0, 1, 2][usize::from(frame % 2 == 0)], worker);
        people.update(time, &bodies).unwrap();
        engaged.extend(people.engaged().map(PersonTrack::id));
    }
    assert_eq!(people.tracks().len(), 3);
    assert!(engaged.len() > 200);
    engaged.dedup();
    assert_eq!(engaged.len(), 1, "one person, whoever comes nearer");
    let person = people.engaged().unwrap().predict(12.0).unwrap();
    assert!((person.floor.coords - vector![1.9, 0.3]).norm() < 0.1);

    // The worker leaves the image. The passer is near and faces the robot, and is engaged next.
    for frame in 240..300 {
        let time = FRAME * f64::from(frame);
        people.update(time, &[noise.see(1.05, vector![2.0, -0.8], PI)]).unwrap();
    }
    assert_ne!(people.engaged().unwrap().id(), engaged[0]);
    assert_eq!(people.tracks().len(), 1);
    // No person is left.
    people.update(20.0, &[]).unwrap();
    assert!(people.engaged().is_none() && people.tracks().is_empty());
    assert!(matches!(people.update(20.0, &[]), Err(Error::Value { .. })));
    assert!(matches!(people.update(f64::NAN, &[]), Err(Error::Value { .. })));
}

#[test]
fn two_skeletons_of_one_person_are_one_person() {
    let mut noise = Noise::new(0.0);
    let mut people = People::new(PeopleSettings::default(), TrackerSettings::default()).unwrap();
    for frame in 0..40 {
        let time = FRAME * f64::from(frame);
        let bodies = [0, 1].map(|_| noise.see(1.0, vector![1.9, 0.3], PI));
        people.update(time, &bodies).unwrap();
    }
    assert_eq!(people.tracks().len(), 1);
}

/// At the edge of the image only one shoulder of a person is visible. It is enough to follow the
/// person.
#[test]
fn one_shoulder_keeps_a_person_who_is_followed() {
    let mut people = People::new(PeopleSettings::default(), TrackerSettings::default()).unwrap();
    let mut noise = Noise::new(0.2);
    let (speed, whole) = (0.8, 40);
    for k in 0..whole + 20 {
        let time = f64::from(k) * FRAME;
        let place = Vector2::new(2.6 - speed * time.min(2.0), 0.4 * (time - 2.0).max(0.0));
        let mut body = noise.see(1.0, place, PI);
        if k >= whole {
            // The person walks on to the side, which coasting cannot predict.
            for joint in Body25::ALL.into_iter().filter(|&joint| joint != Body25::RightShoulder) {
                body.set(joint, None);
            }
        }
        people.update(time, &[body]).unwrap();
        if time > 1.0 {
            let person = people.engaged().unwrap().predict(time).unwrap();
            assert!(person.freshness.is_usable(), "{:?} at {time} s", person.freshness);
            let error = (person.floor.coords - place).norm();
            assert!(error < 0.15, "{error} m at {time} s");
        }
    }
    // A single shoulder does not begin the track of a person who is not followed yet.
    let mut strangers = People::new(PeopleSettings::default(), TrackerSettings::default()).unwrap();
    let mut body = noise.see(1.0, Vector2::new(2.0, 0.0), PI);
    for joint in Body25::ALL.into_iter().filter(|&joint| joint != Body25::RightShoulder) {
        body.set(joint, None);
    }
    strangers.update(0.0, &[body]).unwrap();
    assert!(strangers.tracks().is_empty());
}
