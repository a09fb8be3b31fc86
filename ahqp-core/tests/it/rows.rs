//! Construction of rows, and their weights.

use ahqp_core::testing::{Sizes, hierarchies};
use ahqp_core::{
    Error, Hierarchy, Level, Objective, Rows, Settings, Solver, WarmStart, solve_reference,
};
use nalgebra::{Vector2, dmatrix, dvector};
use proptest::prelude::*;

fn optimum(hierarchy: &Hierarchy) -> Vec<f64> {
    let mut solver = Solver::new(hierarchy, Settings::default()).unwrap();
    solver.solve(hierarchy).unwrap().optimum().unwrap().to_vec()
}

fn small() -> Sizes {
    Sizes { variables: 1..=8, levels: 1..=4, rows: 0..=5 }
}

/// Generates weights for every row of every least-squares level, some zero and some equal.
fn weights() -> impl Strategy<Value = Vec<f64>> {
    let weight = prop_oneof![1 => Just(0.0), 2 => Just(1.0), 3 => (-6..=6_i32).prop_map(|e| 4.0_f64.powi(e))];
    prop::collection::vec(weight, 4 * 5)
}

/// Returns the hierarchy with the weights, and with its rows multiplied by their roots.
fn weighted(hierarchy: &Hierarchy, weights: &[f64]) -> [Hierarchy; 2] {
    let (mut by_weights, mut by_hand) = (hierarchy.clone(), hierarchy.clone());
    let mut rest = weights;
    for id in hierarchy.ids() {
        let Objective::LeastSquares(rows) = hierarchy.level(id).unwrap().objective() else {
            continue;
        };
        let (own, after) = rest.split_at(rows.len());
        rest = after;
        by_weights.rows_mut(id).unwrap().set_weights(own).unwrap();
        for (index, ((row, lower, upper), weight)) in rows.iter().zip(own).enumerate() {
            let root = weight.sqrt();
            let scaled: Vec<f64> = row.iter().map(|entry| root * entry).collect();
            let free = (f64::NEG_INFINITY, f64::INFINITY);
            let (lower, upper) = if *weight == 0.0 { free } else { (root * lower, root * upper) };
            by_hand.rows_mut(id).unwrap().set_row(index, &scaled, lower, upper).unwrap();
        }
    }
    [by_weights, by_hand]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: prop::test_runner::RngSeed::Fixed(1), ..ProptestConfig::with_cases(300) })]

    /// Roots of powers of four are exact, so that both are the same problem to the last bit.
    #[test]
    fn a_weight_is_the_square_of_a_factor(
        hierarchy in hierarchies(Sizes { levels: 1..=4, ..small() }), weights in weights(),
    ) {
        let constrained = hierarchy.levels().iter().any(|level| !level.constraints().is_empty());
        // Constraints are feasible for the hierarchy as it is, but not for other weights.
        prop_assume!(!constrained);
        let [by_weights, by_hand] = weighted(&hierarchy, &weights);
        let x = optimum(&by_weights);
        prop_assert_eq!(&x, &optimum(&by_hand));
        for (one, other) in by_weights.levels().iter().zip(by_hand.levels()) {
            let (one, other) = (one.violation(&x)?, other.violation(&x)?);
            prop_assert!((one - other).abs() <= 1e-12 * (1.0 + other));
        }
        // The proof is checked against the weights, from the data alone.
        let mut solver = Solver::new(&by_weights, Settings::default())?;
        let x = solver.solve(&by_weights)?.optimum()?.to_vec();
        let residuals = solver.certificate(&by_weights)?.residuals(&by_weights, &x)?;
        prop_assert!(residuals.worst() < 1e-8, "{residuals:?}");
    }

    #[test]
    fn changing_weights_leave_nothing_behind(
        hierarchy in hierarchies(small()), first in weights(), second in weights(), warm in any::<bool>(),
    ) {
        prop_assume!(hierarchy.levels().iter().all(|level| level.constraints().is_empty()));
        let warm_start = if warm { WarmStart::PreviousActiveSet } else { WarmStart::Cold };
        let mut solver = Solver::new(&hierarchy, Settings { warm_start, ..Settings::default() })?;
        let [first, _] = weighted(&hierarchy, &first);
        let [second, _] = weighted(&first, &second);
        for problem in [&first, &second, &hierarchy] {
            let x = solver.solve(problem)?.optimum()?.to_vec();
            let fresh = optimum(problem);
            prop_assert!(distance(&x, &fresh) <= 1e-7 * (1.0 + distance(&fresh, &vec![0.0; x.len()])));
        }
    }
}

#[test]
fn heavier_rows_count_for_more() {
    // x = 0 and x = 1, where the second row has three times the weight: x is the weighted mean.
    let mut rows = Rows::equalities(&dmatrix![1.0; 1.0], &[0.0, 1.0]).unwrap();
    rows.set_weights(&dvector![1.0, 3.0]).unwrap();
    let mut hierarchy = Hierarchy::new(1).unwrap();
    let level = hierarchy.push(Level::least_squares(rows)).unwrap();
    assert!((optimum(&hierarchy)[0] - 0.75).abs() < 1e-15);
    assert!((solve_reference(&hierarchy).unwrap()[0] - 0.75).abs() < 1e-7);
    let violation = hierarchy.level(level).unwrap().violation(&[0.75]).unwrap();
    assert!((violation.powi(2) - (0.75_f64.powi(2) + 3.0 * 0.25_f64.powi(2))).abs() < 1e-15);
    // New weights replace the old ones instead of multiplying them.
    for weights in [[3.0, 1.0], [3.0, 1.0], [1.0, 1.0], [0.0, 1.0]] {
        hierarchy.rows_mut(level).unwrap().set_weights(&weights).unwrap();
        let mean = weights[1] / (weights[0] + weights[1]);
        assert!((optimum(&hierarchy)[0] - mean).abs() < 1e-15, "{weights:?}");
        assert!((solve_reference(&hierarchy).unwrap()[0] - mean).abs() < 1e-7, "{weights:?}");
    }
}

#[test]
fn a_row_of_weight_zero_is_left_out() {
    let mut rows = Rows::equalities(&dmatrix![1.0, 0.0; 0.0, 1.0], &[5.0, 7.0]).unwrap();
    rows.set_weights(&[0.0, 1.0]).unwrap();
    let mut hierarchy = Hierarchy::new(2).unwrap();
    hierarchy.push(Level::least_squares(rows)).unwrap();
    let below = Rows::equalities(&dmatrix![1.0, 1.0], &[0.0]).unwrap();
    hierarchy.push(Level::least_squares(below)).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
    assert!(distance(&x, &[-7.0, 7.0]) < 1e-12, "{x:?}");
    let certificate = solver.certificate(&hierarchy).unwrap();
    assert!(certificate.residuals(&hierarchy, &x).unwrap().worst() < 1e-12);
}

#[test]
fn weights_say_nothing_about_constraints_and_other_levels() {
    let weigh = |mut rows: Rows, weight: f64| {
        rows.set_weights(&vec![weight; rows.len()]).unwrap();
        rows
    };
    let problem = |weight: f64| {
        let mut hierarchy = Hierarchy::new(2).unwrap();
        let limit = Rows::at_most(&dmatrix![1.0, 1.0], &[1.0]).unwrap();
        let first = Rows::equalities(&dmatrix![1.0, 0.0], &[2.0]).unwrap();
        let second = Rows::equalities(&dmatrix![1.0, -1.0], &[7.0]).unwrap();
        let first = Level::least_squares(weigh(first, weight));
        hierarchy.push(first.with_constraints(weigh(limit, weight))).unwrap();
        hierarchy.push(Level::least_squares(second)).unwrap();
        hierarchy
    };
    for weight in [1e-8, 1.0, 1e8] {
        assert!(distance(&optimum(&problem(weight)), &[2.0, -5.0]) < 1e-9, "{weight:e}");
    }
}

#[test]
fn invalid_weights_are_refused() {
    let mut rows = Rows::zeros(2, 1);
    rows.set_weights(&[2.0, 3.0]).unwrap();
    for weight in [f64::NAN, -1.0, f64::INFINITY, f64::NEG_INFINITY, 1e-101, 1e101] {
        let error = rows.set_weights(&[1.0, weight]).unwrap_err();
        assert!(matches!(error, Error::Value { index: Some(1), .. }), "{error}");
        assert!(error.to_string().contains("weight of row 1"), "{error}");
        // The earlier weights stay.
        assert_eq!(rows.weights(), Some(&[2.0, 3.0][..]));
    }
    assert_eq!((rows.weight(1), Rows::zeros(1, 1).weight(0)), (3.0, 1.0));
    // Each number is in range, but together they are too large for double precision.
    let mut hierarchy = Hierarchy::new(1).unwrap();
    let mut rows = Rows::equalities(&dmatrix![1e60], &[0.0]).unwrap();
    rows.set_weights(&[1e100]).unwrap();
    hierarchy.push(Level::least_squares(rows).named("heavy")).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let error = solver.solve(&hierarchy).unwrap_err();
    assert!(matches!(error, Error::Datum { entry: None, .. }), "{error}");
    assert!(error.to_string().contains("heavy"), "{error}");
    // NaN is refused even in a row that is left out.
    let rows = hierarchy.rows_mut(hierarchy.ids().next().unwrap()).unwrap();
    rows.set_weights(&[0.0]).unwrap();
    rows.row_mut(0).unwrap()[0] = f64::NAN;
    assert!(matches!(solver.solve(&hierarchy), Err(Error::Datum { entry: Some(_), .. })));
}

#[test]
fn rows_are_made_from_vectors_and_slices() {
    let a = dmatrix![1.0, 2.0; 3.0, 4.0];
    let (low, high) = ([-1.0, -2.0], [5.0, 6.0]);
    let infinite = [f64::INFINITY; 2];
    let ranges = Rows::ranges(&a, &low, &high).unwrap();
    // Vectors of any kind, slices and arrays are accepted.
    assert_eq!(Rows::ranges(&a, &Vector2::from(low), &dvector![5.0, 6.0]).unwrap(), ranges);
    assert_eq!(Rows::ranges(&a, &low[..], &high.to_vec()).unwrap(), ranges);
    let slice = [1.0, 2.0, 3.0, 4.0];
    assert_eq!(Rows::from_row_slice(2, 2, &slice, &low, &high).unwrap(), ranges);
    assert_eq!(Rows::at_least(&a, &low).unwrap(), Rows::ranges(&a, &low, &infinite).unwrap());
    let below = infinite.map(|bound| -bound);
    assert_eq!(Rows::at_most(&a, &high).unwrap(), Rows::ranges(&a, &below, &high).unwrap());
    let mut equal = ranges.clone();
    equal.set_targets(&high).unwrap();
    assert_eq!(equal, Rows::equalities(&a, &high).unwrap());
    let mut copy = Rows::zeros(2, 2).with_names(["one", "two"]).unwrap();
    copy.copy_from(&ranges).unwrap();
    assert_eq!((copy.iter().collect::<Vec<_>>(), copy.names().len()), (ranges.iter().collect(), 2));
    copy.set_free();
    assert_eq!((copy.lower(), copy.upper()), (&below[..], &infinite[..]));
}
