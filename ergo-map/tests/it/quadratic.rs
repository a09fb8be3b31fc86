//! The convex quadratic: the fit, its report, and its terms.

use crate::support::{MAP, Random};
use ergo_map::{
    Conditions, ContinuousReba, Contributions, ErgonomicsMap, ErgonomicsQuadratic, Error,
    FitOptions, MapOptions, Mode, Person, PersonFrame, Region, ScoredPoint, Side,
};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

/// Matches the error of a Hessian with a negative eigenvalue.
macro_rules! not_convex {
    () => {
        Error::Value { what: "the smallest eigenvalue of the Hessian", .. }
    };
}

/// Matches the error of a Hessian that is not its transpose.
macro_rules! not_symmetric {
    () => {
        Error::Value { what: "the difference between the Hessian and its transpose", .. }
    };
}

/// Checks the quality requirements of the work zone, for one person and one hand.
fn meets_the_floors(person: &Person, side: Side, spacing: f64) {
    let stature = person.stature();
    let zone = Region::work_zone(stature, side);
    let options = MapOptions { spacing, side, region: Some(zone), ..MapOptions::default() };
    let map = ErgonomicsMap::build(person, &options, None).unwrap();
    let (quadratic, report) = map.fit(&FitOptions::default()).unwrap();
    let regret = report.regret.unwrap();
    println!(
        "{stature} m, {side:?}: R² {:.3} (weighted {:.3}), RMSE {:.3}, max {:.2}, Spearman {:.3}, \
         eigenvalues {:.2?}, optimum {:.3?} ({:.3} of stature), regret {:.3}, boxes mean {:.3}, \
         p95 {:.3}, max {:.3}, {} samples",
        report.r_squared,
        report.weighted_r_squared,
        report.rmse,
        report.max_error,
        report.spearman,
        report.eigenvalues.as_slice(),
        report.optimum.as_slice(),
        report.optimum.z / stature,
        regret.at_optimum,
        regret.boxes_mean,
        regret.boxes_p95,
        regret.boxes_max,
        report.samples,
    );
    assert!(report.r_squared >= 0.87 && report.rmse <= 0.13);
    assert!(regret.at_optimum <= 0.10 && regret.boxes_p95 <= 0.09 && regret.boxes == 400);
    assert!((report.optimum.z - person.elbow_height()).abs() <= 0.06 * stature);
    assert!(report.spearman > 0.9 && !report.bound_active);
    assert!(report.eigenvalues.min() >= FitOptions::default().min_curvature);
    assert!((quadratic.minimiser().unwrap() - report.optimum).norm() < 1e-9);
}

#[test]
fn the_work_zone_meets_the_floors_for_everyone() {
    meets_the_floors(&Person::average(), Side::Right, 0.025);
    for person in [Person::short(), Person::tall()] {
        meets_the_floors(&person, Side::Right, 0.04);
    }
    meets_the_floors(&Person::average(), Side::Left, 0.04);
}

#[test]
fn the_default_map_meets_the_floors_too() {
    let (_, report) = MAP.fit(&FitOptions::default()).unwrap();
    let regret = report.regret.unwrap();
    println!("default map: {report:?}");
    assert!(report.r_squared >= 0.87 && report.rmse <= 0.13);
    assert!(regret.at_optimum <= 0.10 && regret.boxes_p95 <= 0.09);
}

#[test]
fn the_fit_scales_with_stature() {
    let (a, _) = MAP.fit(&FitOptions::default()).unwrap();
    let scale = 1.94 / 1.75;
    let tall = MAP.for_stature(1.94).unwrap();
    let (b, _) = tall.fit(&FitOptions::default()).unwrap();
    let hessian = (a.hessian() / (scale * scale) - b.hessian()).amax();
    let gradient = (a.gradient() / scale - b.gradient()).amax();
    println!("H → H/s² to {hessian:.1e}, g → g/s to {gradient:.1e}");
    assert!(hessian <= 1e-6 && gradient <= 1e-6);
}

#[test]
fn weighting_buys_a_better_optimum() {
    let plain = FitOptions { temperature: f64::INFINITY, ..FitOptions::default() };
    let (_, plain) = MAP.fit(&plain).unwrap();
    let (_, weighted) = MAP.fit(&FitOptions::default()).unwrap();
    assert!(plain.r_squared > weighted.r_squared);
    assert!(plain.regret.unwrap().at_optimum > weighted.regret.unwrap().at_optimum);
}

#[test]
fn a_local_refit_is_tighter_and_still_convex() {
    let options = FitOptions::default();
    let (global, _) = MAP.fit(&options).unwrap();
    let radius = 0.12;
    let mut random = Random(9);
    let (mut ours, mut theirs, mut count) = (0.0, 0.0, 0);
    for _ in 0..50 {
        let centre = Vector3::new(
            random.uniform(0.3, 0.65),
            random.uniform(-0.4, 0.1),
            random.uniform(0.8, 1.55),
        );
        let (local, report) = MAP.fit_around(&centre, radius, &options).unwrap();
        assert!(local.hessian().symmetric_eigenvalues().min() >= options.min_curvature);
        assert!(report.regret.is_none());
        for _ in 0..20 {
            let way = Vector3::from_fn(|_, _| random.uniform(-0.1, 0.1));
            let Ok(truth) = MAP.sample(&(centre + way)) else { continue };
            ours += (local.value(&(centre + way)) - truth.score).powi(2);
            theirs += (global.value(&(centre + way)) - truth.score).powi(2);
            count += 1;
        }
    }
    let (ours, theirs) = ((ours / f64::from(count)).sqrt(), (theirs / f64::from(count)).sqrt());
    println!("RMSE within 0.1 m: local {ours:.4}, global {theirs:.4}, {count} points");
    assert!(ours < 0.7 * theirs);
}

#[test]
fn single_contributions_need_the_bound_and_get_it() {
    let zone = Region::work_zone(1.75, Side::Right);
    let options = FitOptions { region: Some(zone), ..FitOptions::default() };
    let fit = |part: fn(&Contributions) -> f64| {
        let points: Vec<ScoredPoint> = MAP
            .nodes()
            .map(|node| {
                let posture = node.angles.posture();
                let reba =
                    ContinuousReba::of_posture(&posture, &Conditions::default(), Mode::Graded);
                let score = part(&reba.unwrap().contributions());
                ScoredPoint { position: node.position, score }
            })
            .collect();
        let (quadratic, report) = ErgonomicsQuadratic::fit(&points, &options).unwrap();
        assert!(quadratic.hessian().symmetric_eigenvalues().min() >= options.min_curvature);
        report.bound_active
    };
    let active = [fit(|c| c.arms), fit(|c| c.trunk), fit(|c| c.legs), fit(|c| c.neck)];
    println!("bound active for arms, trunk, legs, neck: {active:?}");
    assert!(active.contains(&true) && active.contains(&false));
    assert!(!fit(Contributions::mean));
}

#[test]
fn bad_samples_and_options_are_refused() {
    let point =
        |x: f64, y: f64, z: f64| ScoredPoint { position: Vector3::new(x, y, z), score: x * x + y };
    let few: Vec<_> = (0..10).map(|i| point(f64::from(i), 0.0, 1.0)).collect();
    let options = FitOptions::default();
    let fit = |points: &[ScoredPoint]| ErgonomicsQuadratic::fit(points, &options).unwrap_err();
    assert!(matches!(fit(&few), Error::TooFewSamples { got: 10, wanted: 20, .. }));
    let flat: Vec<_> = (0..400).map(|i| point(f64::from(i % 20), f64::from(i / 20), 1.0)).collect();
    assert_eq!(fit(&flat), Error::DegenerateSamples);
    let line: Vec<_> = (0..40).map(|i| point(f64::from(i), f64::from(i), f64::from(i))).collect();
    assert_eq!(fit(&line), Error::DegenerateSamples);
    let mut nan = flat;
    nan[7].score = f64::NAN;
    assert!(matches!(fit(&nan), Error::Value { .. }));
    for options in [
        FitOptions { temperature: 0.0, ..options },
        FitOptions { min_curvature: -1.0, ..options },
        FitOptions { temperature: f64::NAN, ..options },
    ] {
        assert!(matches!(MAP.fit(&options), Err(Error::Value { .. })));
    }
    let nowhere = Region::new(Vector3::repeat(50.0), Vector3::repeat(51.0)).unwrap();
    let options = FitOptions { region: Some(nowhere), ..options };
    assert!(matches!(MAP.fit(&options), Err(Error::TooFewSamples { got: 0, .. })));
    assert!(MAP.fit_around(&Vector3::zeros(), f64::NAN, &FitOptions::default()).is_err());
    assert!(MAP.fit_around(&Vector3::repeat(f64::NAN), 0.1, &FitOptions::default()).is_err());

    let zero = Vector3::zeros();
    let saddle = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -0.1));
    assert!(matches!(ErgonomicsQuadratic::new(saddle, zero, 0.0), Err(not_convex!())));
    let skewed = Matrix3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let error = ErgonomicsQuadratic::new(skewed, zero, 0.0).unwrap_err();
    assert!(matches!(error, not_symmetric!()));
    assert!(ErgonomicsQuadratic::new(Matrix3::repeat(f64::NAN), zero, 0.0).is_err());
    let flat = ErgonomicsQuadratic::new(Matrix3::zeros(), zero, 0.0).unwrap();
    assert_eq!(flat.minimiser(), None);
    assert!(flat.task_terms(&zero, 0.0).is_err());
}

fn refusal(hessian: Matrix3<f64>) -> Option<Error> {
    ErgonomicsQuadratic::new(hessian, Vector3::zeros(), 0.0).err()
}

#[test]
fn small_blocks_are_judged_by_their_own_size() {
    for (entry, size) in [(1e10, 1.0), (1.0, 1e-12), (1e-12, 1e10)] {
        let with = |a: f64, b: f64, c: f64, d: f64| {
            refusal(Matrix3::new(entry, 0.0, 0.0, 0.0, a * size, b * size, 0.0, c * size, d * size))
        };
        assert!(matches!(with(5.0, 2.0, -2.0, 5.0), Some(not_symmetric!())));
        assert!(matches!(with(1.0, 2.0, 2.0, 1.0), Some(not_convex!())));
        assert!(matches!(with(1.0, 0.0, 0.0, -1.0), Some(not_convex!())));
        assert!(matches!(with(1.0, 1e-3, 1e-3, 0.0), Some(not_convex!())));
        assert_eq!(with(2.0, 1.0, 1.0, 2.0), None);
        assert_eq!(with(1.0, 1.0, 1.0, 1.0), None);
        assert_eq!(with(0.0, 0.0, 0.0, 0.0), None);
    }
}

/// Returns the squared error of a quadratic on points.
fn loss(points: &[ScoredPoint], h: &Matrix3<f64>, g: &Vector3<f64>, c: f64) -> f64 {
    let e = |x: &Vector3<f64>| 0.5 * x.dot(&(h * x)) + g.dot(x) + c;
    points.iter().map(|p| (e(&p.position) - p.score).powi(2)).sum()
}

fn matrix() -> impl Strategy<Value = Matrix3<f64>> {
    proptest::array::uniform9(-3.0..3.0_f64).prop_map(|m| Matrix3::from_row_slice(&m))
}

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    proptest::array::uniform3(-size..size).prop_map(Vector3::from)
}

/// Returns random points whose scores come from a quadratic, possibly concave, with noise.
fn cloud(h: &Matrix3<f64>, g: &Vector3<f64>, noise: f64, seed: u64) -> Vec<ScoredPoint> {
    let mut random = Random(seed);
    (0..200)
        .map(|_| {
            let x = Vector3::new(
                random.uniform(0.2, 0.8),
                random.uniform(-0.5, 0.2),
                random.uniform(0.7, 1.7),
            );
            let score = 0.5 * x.dot(&(h * x)) + g.dot(&x) + random.uniform(-noise, noise);
            ScoredPoint { position: x, score }
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn units_of_the_axes_change_no_verdict(
        m in matrix(), units in proptest::array::uniform3(-6.0..6.0_f64),
        at in (0..3_usize, 0..3_usize), change in prop_oneof![Just(0.0_f64), -0.1..-1e-6, 1e-6..0.1],
    ) {
        // The rank is 2, so that a smaller diagonal entry makes it indefinite.
        let flat = m * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
        let mut hessian = flat * flat.transpose();
        let largest = (hessian[(at.0, at.0)] * hessian[(at.1, at.1)]).sqrt();
        // In units with a diagonal of ones, the change is this part of the direction without curvature.
        let flattest = flat.column(0).cross(&flat.column(1));
        let flattest = flattest.component_mul(&hessian.diagonal().map(f64::sqrt));
        let part = (flattest[at.0] / flattest.norm()).powi(2);
        let is_diagonal = at.0 == at.1;
        prop_assume!(largest > 0.0 && (!is_diagonal || change == 0.0 || change.abs() * part > 1e-7));
        hessian[at] += if is_diagonal { -change.abs() } else { change } * largest;
        let units = Matrix3::from_diagonal(&Vector3::from(units.map(|unit| 10_f64.powf(unit))));
        for hessian in [hessian, units * hessian * units] {
            match (change == 0.0, is_diagonal, refusal(hessian)) {
                (true, _, None)
                | (false, true, Some(not_convex!()))
                | (false, false, Some(not_symmetric!())) => {}
                verdict => prop_assert!(false, "{verdict:?} of {hessian}"),
            }
        }
    }

    /// The curvature that a rotation leaves of a flat quadratic is small, and never negative.
    #[test]
    fn a_quadratic_stays_convex_wherever_it_is_placed(
        m in matrix(), rank in 0..4_usize, p in vector(5.0), heading in -10.0..10.0_f64,
    ) {
        let kept = Matrix3::from_fn(|i, j| if i == j && i < rank { 1.0 } else { 0.0 });
        let half = m * kept;
        let quadratic =
            ErgonomicsQuadratic::new(half * half.transpose(), Vector3::zeros(), 0.0).unwrap();
        let person = PersonFrame::new(p, heading).unwrap();
        let placed = *quadratic.placed(&person).hessian();
        prop_assert!(refusal(placed).is_none(), "{placed}");
        let rotation = person.rotation();
        let expected = rotation * quadratic.hessian() * rotation.transpose();
        prop_assert!((placed - expected).amax() <= 1e-13 * (1.0 + expected.amax()));
    }

    #[test]
    fn the_smallest_eigenvalue_always_keeps_the_bound(
        m in matrix(),
        g in vector(5.0),
        noise in 0.0..2.0_f64,
        seed: u64,
        exponent in -6.0..1.0_f64,
        weighted: bool,
    ) {
        let points = cloud(&(m + m.transpose()), &g, noise, seed);
        let min_curvature = 10_f64.powf(exponent);
        let temperature = if weighted { 1.0 } else { f64::INFINITY };
        let options = FitOptions { region: None, temperature, min_curvature };
        let (quadratic, report) = ErgonomicsQuadratic::fit(&points, &options).unwrap();
        let smallest = quadratic.hessian().symmetric_eigenvalues().min();
        prop_assert!(smallest >= min_curvature, "{smallest} {min_curvature}");
        prop_assert_eq!(*quadratic.hessian(), quadratic.hessian().transpose());
        prop_assert!((report.eigenvalues.min() - smallest).abs() < 1e-9);
    }

    #[test]
    fn a_convex_quadratic_is_found_again(m in matrix(), g in vector(5.0), seed: u64) {
        let h = m * m.transpose() + Matrix3::identity() * 0.1;
        let points = cloud(&h, &g, 0.0, seed);
        let options = FitOptions { temperature: f64::INFINITY, ..FitOptions::default() };
        let (quadratic, report) = ErgonomicsQuadratic::fit(&points, &options).unwrap();
        prop_assert!((quadratic.hessian() - h).amax() < 1e-6);
        prop_assert!((quadratic.gradient() - g).amax() < 1e-6);
        prop_assert!(quadratic.constant().abs() < 1e-6);
        prop_assert!(report.r_squared > 1.0 - 1e-9 && !report.bound_active);
    }

    #[test]
    fn no_convex_quadratic_fits_better(
        m in matrix(), g in vector(3.0), seed: u64, other in matrix(), step in 1e-4..0.5_f64,
        way in vector(0.3), shift in -0.3..0.3_f64,
    ) {
        let points = cloud(&(m + m.transpose()), &g, 0.3, seed);
        let options = FitOptions { region: None, temperature: f64::INFINITY, min_curvature: 0.01 };
        let (fit, _) = ErgonomicsQuadratic::fit(&points, &options).unwrap();
        let best = loss(&points, fit.hessian(), fit.gradient(), fit.constant());
        // The step goes towards any feasible Hessian, with any slope and constant.
        let target = other * other.transpose() + Matrix3::identity() * 0.01;
        let h = fit.hessian() * (1.0 - step) + target * step;
        let g = fit.gradient() + way * step;
        let candidate = loss(&points, &h, &g, fit.constant() + shift * step);
        prop_assert!(candidate >= best * (1.0 - 1e-7), "{candidate} {best}");
        // The comparison also uses the best slope and constant for that Hessian, by a fit of the
        // rest.
        let rest: Vec<ScoredPoint> = points
            .iter()
            .map(|p| ScoredPoint {
                position: p.position,
                score: p.score - 0.5 * p.position.dot(&(h * p.position)),
            })
            .collect();
        let n = rest.len() as f64;
        let mean = rest.iter().map(|p| p.position).sum::<Vector3<f64>>() / n;
        let level = rest.iter().map(|p| p.score).sum::<f64>() / n;
        let (mut a, mut b) = (Matrix3::zeros(), Vector3::zeros());
        for p in &rest {
            let d = p.position - mean;
            a += d * d.transpose();
            b += d * (p.score - level);
        }
        let g = a.cholesky().unwrap().solve(&b);
        let candidate = loss(&points, &h, &g, level - g.dot(&mean));
        prop_assert!(candidate >= best * (1.0 - 1e-7), "{candidate} {best}");
    }

    #[test]
    fn placing_moves_the_function_with_the_person(
        m in matrix(), g in vector(5.0), x in vector(2.0), p in vector(5.0), heading in -7.0..7.0_f64,
    ) {
        let quadratic = ErgonomicsQuadratic::new(m * m.transpose(), g, 0.7).unwrap();
        let pose = PersonFrame::new(p, heading).unwrap();
        let placed = quadratic.placed(&pose);
        let world = pose.to_world(&x);
        let scale = 1.0 + quadratic.value(&x).abs() + placed.hessian().amax() * 100.0;
        prop_assert!((placed.value(&world) - quadratic.value(&x)).abs() < 1e-12 * scale);
        let turned = pose.rotation() * quadratic.gradient_at(&x);
        prop_assert!((placed.gradient_at(&world) - turned).norm() < 1e-11 * scale);
    }

    #[test]
    fn gradients_and_task_terms_match_the_quadratic(
        m in matrix(), g in vector(5.0), x in vector(2.0), v in vector(2.0), tau in 1e-3..1.0_f64,
    ) {
        let quadratic = ErgonomicsQuadratic::new(m * m.transpose(), g, -0.3).unwrap();
        let step = 1e-5;
        for axis in 0..3 {
            let mut way = Vector3::zeros();
            way[axis] = step;
            let slope = (quadratic.value(&(x + way)) - quadratic.value(&(x - way))) / (2.0 * step);
            prop_assert!((slope - quadratic.gradient_at(&x)[axis]).abs() < 1e-5);
        }
        let terms = quadratic.task_terms(&x, tau).unwrap();
        let change = 0.5 * v.dot(&(terms.hessian * v)) + terms.gradient.dot(&v);
        let direct = quadratic.value(&(x + v * tau)) - quadratic.value(&x);
        prop_assert!((change - direct).abs() < 1e-9);
    }

    #[test]
    fn the_minimum_in_a_box_is_the_minimum(
        m in matrix(), g in vector(3.0), corner in vector(1.0), edge in 0.05..1.0_f64,
        t in proptest::array::uniform3(0.0..1.0_f64), singular: bool,
    ) {
        let shift = if singular { 0.0 } else { 0.1 };
        let h = m * m.transpose() + Matrix3::identity() * shift;
        let quadratic = ErgonomicsQuadratic::new(h, g, 0.0).unwrap();
        let region = Region::new(corner, corner.add_scalar(edge)).unwrap();
        let best = quadratic.minimiser_in(&region);
        prop_assert!(region.contains(&best));
        let other = corner + Vector3::from(t) * edge;
        prop_assert!(quadratic.value(&best) <= quadratic.value(&other) + 1e-9);
    }
}
