//! The tracker's calls of the control loop allocate nothing.

use nalgebra::Point3;
use vision_models::{
    Body, Body25, BodyTracker, Confidence, Keypoint, Percept, TrackStatus, TrackerSettings,
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
        tracked += u32::from(pose.is_some_and(|pose| pose.status == TrackStatus::Tracked));
    };
    assert_eq!(allocation_counter::measure(|| (0..2000).for_each(tick)).count_total, 0);
    assert!(tracked > 1800, "the person was tracked in {tracked} ticks");
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(Box::new(tracked))));
    assert_eq!(counted.count_total, 1, "the counter counts");
}
