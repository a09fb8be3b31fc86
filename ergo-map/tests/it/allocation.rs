//! Functions that are called a thousand times a second allocate nothing.

use std::hint::black_box;

use ergo_map::{
    Conditions, FitOptions, Mode, PersonFrame, Posture, Region, Side, Worksheet, ergonomics_score,
    ergonomics_score_gradient,
};
use nalgebra::Vector3;

use crate::support::MAP;

#[test]
fn a_tick_allocates_nothing() {
    let map = &*MAP;
    let (quadratic, _) = map.fit(&FitOptions::default()).unwrap();
    let conditions = Conditions::default();
    let workspace = Region::work_zone(1.75, Side::Right);
    let hand = Vector3::new(0.4, -0.2, 1.1);

    let tick = |tick: u32| {
        let there = Vector3::new(1.0 + f64::from(tick) * 1e-3, 2.0, 0.0);
        let person = PersonFrame::new(there, 0.3).unwrap();
        let world = quadratic.placed(&person);
        black_box(world.task_terms(&person.to_world(&hand), 0.2).unwrap());
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
    };
    assert_eq!(allocation_counter::measure(|| (0..1000).for_each(tick)).count_total, 0);
}
