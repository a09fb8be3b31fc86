//! The tracker's calls from the control loop, and lifting and tracking of people, allocate nothing.

use nalgebra::Point3;
use vision_models::{
    Body, Body25, BodyTracker, Camera, Confidence, DepthImage, DepthNoise, Freshness, ImageBody,
    ImageKeypoint, Intrinsics, Keypoint, Lifter, LiftingSettings, People, PeopleSettings, Percept,
    TrackerSettings,
};

#[test]
fn predicting_and_updating_allocate_nothing() {
    let mut body = Body::default();
    for (joint, y, z) in [
        (Body25::LeftShoulder, 0.2, 1.4),
        (Body25::RightShoulder, -0.2, 1.4),
        (Body25::MidHip, 0.0, 0.9),
    ] {
        let position = Point3::new(1.0, y, z);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    let mut tracker = BodyTracker::new(TrackerSettings::default()).unwrap();
    let mut percept = Percept { time: 0.0, body: Some(body), action: None, surface: None };

    let mut tracked = 0;
    let tick = |tick: u32| {
        let now = 1e-3 * f64::from(tick);
        if tick.is_multiple_of(50) {
            percept.time = now;
            tracker.update(&percept).unwrap();
        }
        let pose = tracker.predict(now);
        tracked += u32::from(pose.is_some_and(|pose| pose.freshness == Freshness::Tracked));
    };
    assert_eq!(allocation_counter::measure(|| (0..2000).for_each(tick)).count_total, 0);
    assert!(tracked > 1800, "the person was tracked in {tracked} ticks");
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(Box::new(tracked))));
    assert_eq!(counted.count_total, 1, "the counter counts");
}

#[test]
fn lifting_and_following_people_allocate_nothing() {
    let intrinsics = Intrinsics::new([64, 48], [60.0, 60.0], [31.5, 23.5]).unwrap();
    let (eye, target) = (Point3::new(0.0, 0.0, 1.2), Point3::new(1.0, 0.0, 1.2));
    let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap();
    let lifter = Lifter::new(camera, LiftingSettings::default()).unwrap();
    let depth = DepthImage::from_metres([64, 48], vec![2.0; 64 * 48]).unwrap();
    let mut image = ImageBody::default();
    for (joint, x, y) in [
        (Body25::LeftShoulder, 37.0, 17.0),
        (Body25::RightShoulder, 25.0, 17.0),
        (Body25::Neck, 31.0, 17.0),
        (Body25::MidHip, 31.0, 33.0),
        (Body25::LeftWrist, 38.0, 32.0),
    ] {
        let position = nalgebra::Point2::new(x, y);
        image.set(joint, Some(ImageKeypoint { position, confidence: Confidence::ONE }));
    }
    let settings = PeopleSettings { facing: 4.0, ..PeopleSettings::default() };
    let mut people = People::new(settings, TrackerSettings::default()).unwrap();
    let frame = |frame: u32| {
        let body = lifter.lift(&image, &depth, None).unwrap();
        people.update(0.05 * f64::from(frame), std::slice::from_ref(&body)).unwrap();
    };
    assert_eq!(allocation_counter::measure(|| (0..100).for_each(frame)).count_total, 0);
    assert!(people.engaged().is_some_and(vision_models::PersonTrack::is_in_frame));
}
