//! What is called a thousand times a second allocates nothing.
#![allow(unsafe_code)] // a counting allocator cannot be written without
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};

use ergo_map::{
    Conditions, ErgonomicsMap, FitOptions, MapOptions, Mode, Person, PersonPose, Placement,
    PlacementLimits, Posture, Region, Side, Worksheet, ergonomics_score, ergonomics_score_gradient,
};
use nalgebra::Vector3;

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed to the system's allocator unchanged; only a counter is added.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promises are those that the system's allocator asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `alloc` above, that is, from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// The only test of this file: others would allocate beside it.
#[test]
fn a_tick_allocates_nothing() {
    let options = MapOptions { spacing: 0.08, ..MapOptions::default() };
    let map = ErgonomicsMap::build(&Person::average(), &options, None).unwrap();
    let (quadratic, _) = map.fit(&FitOptions::default()).unwrap();
    let pose = PersonPose::new(Vector3::new(1.0, 2.0, 0.0), 0.3).unwrap();
    let mut placement = Placement::new(quadratic, pose, PlacementLimits::default()).unwrap();
    let conditions = Conditions::default();
    let workspace = Region::work_zone(1.75, Side::Right);
    let hand = Vector3::new(0.4, -0.2, 1.1);

    let before = ALLOCATIONS.load(Ordering::Relaxed);
    for tick in 0..1000 {
        let there = Vector3::new(1.0 + f64::from(tick) * 1e-3, 2.0, 0.0);
        placement.observe(PersonPose::new(there, 0.3).unwrap());
        let world = *placement.advance(0.001).unwrap();
        black_box(world.task_terms(&placement.pose().to_world(&hand), 0.2).unwrap());
        black_box(world.value(&hand));
        black_box(quadratic.minimiser());
        black_box(quadratic.minimiser_in(&workspace));
        black_box(map.sample(&hand).unwrap());
        black_box(map.sample(&Vector3::repeat(9.0)).is_err());
        black_box(map.assess(&hand, &conditions).unwrap());
        let posture: Posture = map.posture(&hand).unwrap().posture();
        black_box(ergonomics_score(&posture, &conditions, Mode::Graded));
        black_box(ergonomics_score_gradient(&posture, &conditions, Mode::FAITHFUL));
        black_box(Worksheet::from_posture(&posture, conditions).score().unwrap());
    }
    assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - before, 0);
}
