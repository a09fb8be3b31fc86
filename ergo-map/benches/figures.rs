//! Times of the functions that the control loop calls, and of building a map.
//! `cargo bench -p ergo-map`.
#![allow(clippy::unwrap_used, missing_docs)]

use divan::{Bencher, black_box};
use ergo_map::{
    Conditions, ContinuousReba, ErgonomicsMap, ErgonomicsQuadratic, FitOptions, HandTarget,
    MapOptions, Mode, Person, PersonFrame, Posture, PosturePredictor, Region, Side, Worksheet,
    ergonomics_score, ergonomics_score_gradient,
};
use nalgebra::Vector3;

fn main() {
    divan::main();
}

/// A grid of 14 × 10 × 20 = 2,800 points over the work zone of a person of 1.75 m.
fn options() -> MapOptions {
    let zone = Region::work_zone(1.75, Side::Right);
    let spacing = 0.0242;
    let cells = Vector3::new(13.0, 9.0, 19.0) * (spacing * 1.75);
    let region = Region::new(*zone.min(), zone.min() + cells).unwrap();
    MapOptions { spacing, region: Some(region), ..MapOptions::default() }
}

fn map() -> ErgonomicsMap {
    ErgonomicsMap::build(&Person::average(), &options(), None).unwrap()
}

fn quadratic() -> ErgonomicsQuadratic {
    map().fit(&FitOptions::default()).unwrap().0
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn map_of_2800_points_on_cores(bencher: Bencher, cores: usize) {
    let (person, options) = (Person::average(), options());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(cores).build().unwrap();
    let map = map();
    assert_eq!(map.len(), 2800);
    bencher.bench_local(|| {
        pool.install(|| ErgonomicsMap::build(black_box(&person), &options, None).unwrap())
    });
}

#[divan::bench(sample_count = 5)]
fn whole_reachable_volume(bencher: Bencher) {
    let person = Person::average();
    let options = MapOptions::default();
    bencher.bench_local(|| ErgonomicsMap::build(black_box(&person), &options, None).unwrap());
}

#[divan::bench]
fn one_posture(bencher: Bencher) {
    let predictor = PosturePredictor::new(&Person::average(), Side::Right);
    let target = HandTarget::point(Vector3::new(0.4, -0.2, 1.1));
    bencher.bench_local(|| predictor.predict(black_box(&target)).unwrap());
}

#[divan::bench(sample_count = 20)]
fn one_fit_with_report(bencher: Bencher) {
    let map = map();
    bencher.bench_local(|| map.fit(black_box(&FitOptions::default())).unwrap());
}

#[divan::bench]
fn one_local_refit(bencher: Bencher) {
    let map = map();
    let hand = Vector3::new(0.45, -0.15, 1.1);
    let options = FitOptions::default();
    bencher.bench_local(|| map.fit_around(black_box(&hand), 0.12, &options).unwrap());
}

fn posture() -> Posture {
    Posture::from_array(core::array::from_fn(|i| 0.07 * (i as f64 + 1.0)))
}

#[divan::bench]
fn one_score_e_s(bencher: Bencher) {
    let (posture, conditions) = (posture(), Conditions::default());
    bencher.bench_local(|| ergonomics_score(black_box(&posture), &conditions, Mode::Graded));
}

#[divan::bench]
fn one_score_e_s_with_gradient(bencher: Bencher) {
    let (posture, conditions) = (posture(), Conditions::default());
    bencher
        .bench_local(|| ergonomics_score_gradient(black_box(&posture), &conditions, Mode::Graded));
}

#[divan::bench]
fn one_score_continuous_reba(bencher: Bencher) {
    let (posture, conditions) = (posture(), Conditions::default());
    bencher.bench_local(|| {
        ContinuousReba::of_posture(black_box(&posture), &conditions, Mode::Graded).unwrap()
    });
}

#[divan::bench]
fn one_score_faithful_reba(bencher: Bencher) {
    let (posture, conditions) = (posture(), Conditions::default());
    bencher.bench_local(|| {
        ContinuousReba::of_posture(black_box(&posture), &conditions, Mode::FAITHFUL).unwrap()
    });
}

#[divan::bench]
fn one_score_integer_reba(bencher: Bencher) {
    let (posture, conditions) = (posture(), Conditions::default());
    bencher
        .bench_local(|| Worksheet::from_posture(black_box(&posture), conditions).score().unwrap());
}

#[divan::bench]
fn one_map_sample(bencher: Bencher) {
    let map = map();
    let hand = Vector3::new(0.4, -0.2, 1.1);
    bencher.bench_local(|| map.sample(black_box(&hand)).unwrap());
}

#[divan::bench]
fn one_quadratic_value(bencher: Bencher) {
    let quadratic = quadratic();
    let hand = Vector3::new(0.4, -0.2, 1.1);
    bencher.bench_local(|| quadratic.value(black_box(&hand)));
}

#[divan::bench]
fn one_quadratic_value_and_gradient(bencher: Bencher) {
    let quadratic = quadratic();
    let hand = Vector3::new(0.4, -0.2, 1.1);
    bencher.bench_local(|| {
        let hand = black_box(&hand);
        (quadratic.value(hand), quadratic.gradient_at(hand))
    });
}

#[divan::bench]
fn one_tick(bencher: Bencher) {
    let person = PersonFrame::new(Vector3::new(1.0, 0.0, 0.0), 0.1).unwrap();
    let (quadratic, hand) = (quadratic(), Vector3::new(0.4, -0.2, 1.1));
    bencher.bench_local(|| {
        quadratic.placed(black_box(&person)).task_terms(black_box(&hand), 0.2).unwrap()
    });
}
