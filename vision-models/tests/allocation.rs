//! The tracker's calls of the control loop allocate nothing.
#![allow(unsafe_code, clippy::unwrap_used, missing_docs)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use nalgebra::Point3;
use vision_models::{
    Body, Body25, BodyTracker, Confidence, Keypoint, Percept, TrackStatus, TrackerSettings,
};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises hold for the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises hold for the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

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

    let before = ALLOCATIONS.with(Cell::get);
    let mut tracked = 0;
    for tick in 0..2000_u32 {
        let now = 1e-3 * f64::from(tick);
        if tick % 50 == 0 {
            percept.time = now;
            tracker.update(&percept).unwrap();
        }
        let pose = tracker.predict(now);
        tracked += u32::from(pose.is_some_and(|pose| pose.status == TrackStatus::Tracked));
    }
    assert_eq!(ALLOCATIONS.with(Cell::get), before);
    assert!(tracked > 1800, "the person was tracked in {tracked} ticks");
    drop(Box::new(tracked));
    assert!(ALLOCATIONS.with(Cell::get) > before, "the counter counts");
}
