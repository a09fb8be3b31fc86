//! Malformed and extreme problems never cause a panic. Every answer is finite and satisfies the
//! hard rows.
//!
//! The property tests and the certificate check on valid data that answers are optimal.
//! `cargo test -p ahqp-core --test it fuzz` tries a few thousand problems.
//! `AHQP_CASES=100000 cargo test --release -p ahqp-core --test it fuzz` tries as many as requested.

use ahqp_core::{Error, Hierarchy, Level, Objective, Rows, Settings, Solution, Solver, Status};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Runs the number of cases in `AHQP_CASES`, the same on every run unless `PROPTEST_RNG_SEED`
/// selects others.
fn config(cases: u32) -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        cases: number("AHQP_CASES").and_then(|c| u32::try_from(c).ok()).unwrap_or(cases),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Generates invalid numbers among valid ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => -2.0..2.0_f64,
        6 => (-4_i8..5).prop_map(f64::from),
        3 => Just(0.0),
        1 => prop::sample::select(vec![
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            f64::from_bits(1),
            -0.0,
            1e300,
            -1e300,
            1e150,
            1e-150,
            1e-300,
            1e16,
            1e-16,
        ]),
    ]
}

/// Generates these numbers without NaN and infinity.
fn finite() -> impl Strategy<Value = f64> {
    number().prop_filter("finite", |value| value.is_finite())
}

fn bound() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => number(),
        1 => Just(f64::INFINITY),
        1 => Just(f64::NEG_INFINITY),
    ]
}

/// Generates a pair of bounds, usually ordered.
fn range() -> impl Strategy<Value = (f64, f64)> {
    prop_oneof![
        1 => (bound(), bound()),
        4 => (number(), number()).prop_map(|(a, b)| if a <= b { (a, b) } else { (b, a) }),
        4 => number().prop_map(|a| (a, a)),
        2 => number().prop_map(|a| (f64::NEG_INFINITY, a)),
    ]
}

fn rows(
    columns: usize,
    entry: impl Strategy<Value = f64> + Clone,
    range: impl Strategy<Value = (f64, f64)> + Clone,
) -> impl Strategy<Value = Rows> {
    (0..6_usize).prop_flat_map(move |m| {
        (prop::collection::vec(entry.clone(), m * columns), prop::collection::vec(range.clone(), m))
            .prop_map(move |(entries, ranges)| {
                let mut rows = Rows::zeros(m, columns);
                for (i, (lower, upper)) in ranges.into_iter().enumerate() {
                    let row = &entries[i * columns..(i + 1) * columns];
                    rows.row_mut(i).unwrap().copy_from_slice(row);
                    (rows.lower_mut()[i], rows.upper_mut()[i]) = (lower, upper);
                }
                rows
            })
    })
}

fn level(
    n: usize,
    entry: impl Strategy<Value = f64> + Clone + 'static,
    range: impl Strategy<Value = (f64, f64)> + Clone + 'static,
) -> impl Strategy<Value = Level> {
    let (hessian, range_too) = (entry.clone(), range.clone());
    let objective = prop_oneof![
        4 => rows(n, entry.clone(), range_too).prop_map(Level::least_squares),
        1 => (prop::collection::vec(hessian.clone(), n * n), prop::collection::vec(hessian, n), any::<bool>())
            .prop_map(move |(entries, gradient, gram)| {
                let mut hessian = DMatrix::from_vec(n, n, entries);
                if gram {
                    hessian = hessian.transpose() * hessian;
                }
                Level::quadratic(&hessian, &gradient).unwrap()
            }),
    ];
    let constraints = prop_oneof![
        2 => Just(Rows::zeros(0, n)),
        1 => rows(n, entry, range),
    ];
    (objective, constraints).prop_map(|(level, rows)| level.with_constraints(rows))
}

fn hierarchy(
    entry: impl Strategy<Value = f64> + Clone + 'static,
    range: impl Strategy<Value = (f64, f64)> + Clone + 'static,
) -> impl Strategy<Value = Hierarchy> {
    (1..7_usize).prop_flat_map(move |n| {
        let bounds = prop_oneof![
            1 => Just(vec![(f64::NEG_INFINITY, f64::INFINITY); n]),
            1 => prop::collection::vec(range.clone(), n),
        ];
        let levels = prop::collection::vec(level(n, entry.clone(), range.clone()), 0..4);
        (bounds, levels).prop_map(move |(bounds, levels)| {
            let mut hierarchy = Hierarchy::new(n).unwrap();
            let (lower, upper) = hierarchy.bounds_mut();
            for (i, (l, u)) in bounds.into_iter().enumerate() {
                (lower[i], upper[i]) = (l, u);
            }
            for level in levels {
                hierarchy.push(level).unwrap();
            }
            hierarchy
        })
    })
}

fn violation(a: &[f64], lower: f64, upper: f64, x: &[f64]) -> f64 {
    let value: f64 = a.iter().zip(x).map(|(p, q)| p * q).sum();
    value - value.clamp(lower, upper)
}

/// Returns the size of the numbers in a row at x, including bounds. Rounding is relative to it. A row
/// without coefficients has nothing to be compared with, and is judged in its own unit.
fn size(a: &[f64], lower: f64, upper: f64, x: &[f64]) -> f64 {
    let largest = |values: &[f64]| values.iter().fold(0.0, |l, v| f64::max(l, v.abs()));
    let bound = |value: f64| if value.is_finite() { value.abs() } else { 0.0 };
    let terms = if largest(a) > 0.0 { largest(a) * largest(x) * a.len() as f64 } else { 1.0 };
    terms + bound(lower).max(bound(upper))
}

/// Expects an answer that is finite and within its bounds and constraints, whatever the data.
fn expect_sound(hierarchy: &Hierarchy, solution: &Solution) -> Result<(), TestCaseError> {
    let x = solution.best();
    prop_assert!(x.iter().all(|value| value.is_finite()), "{x:?}");
    for (i, value) in x.iter().enumerate() {
        prop_assert!((hierarchy.lower()[i]..=hierarchy.upper()[i]).contains(value));
    }
    let done = match solution.status() {
        Status::IterationLimit { level: Some(level) } => level.index(),
        _ => hierarchy.levels().len(),
    };
    for (k, level) in hierarchy.levels()[..done].iter().enumerate() {
        for (a, lower, upper) in level.constraints().iter() {
            let off = violation(a, lower, upper, x).abs();
            // Numbers below the smallest normal one have no correct digits.
            let size = size(a, lower, upper, x).max(f64::MIN_POSITIVE);
            prop_assert!(off <= 1e-7 * size, "level {k}: {off:e} of {size:e}");
        }
    }
    for level in hierarchy.levels() {
        let value = level.violation(x)?;
        prop_assert!(!value.is_nan() && value >= 0.0);
    }
    Ok(())
}

fn has_nan_or_disorder(hierarchy: &Hierarchy) -> bool {
    let bad_range = |l: f64, u: f64| !(l <= u && l < f64::INFINITY && u > f64::NEG_INFINITY);
    let bad_rows = |rows: &Rows| {
        rows.iter().any(|(a, l, u)| bad_range(l, u) || a.iter().any(|v| !v.is_finite()))
    };
    hierarchy.lower().iter().zip(hierarchy.upper()).any(|(&l, &u)| bad_range(l, u))
        || hierarchy.levels().iter().any(|level| {
            bad_rows(level.constraints())
                || match level.objective() {
                    Objective::LeastSquares(rows) => bad_rows(rows),
                    Objective::Quadratic { hessian, gradient } => {
                        !hessian.iter().chain(gradient.iter()).all(|v| v.is_finite())
                    }
                    _ => false,
                }
        })
}

proptest! {
    #![proptest_config(config(3000))]

    #[test]
    fn arbitrary_data_are_solved_soundly_or_refused(
        hierarchies in prop::collection::vec(hierarchy(number().boxed(), range().boxed()), 1..3),
    ) {
        let mut solver = Solver::new(&hierarchies[0], Settings::default()).unwrap();
        for hierarchy in hierarchies.iter().chain(&hierarchies) {
            let result = solver.solve(hierarchy).cloned();
            if has_nan_or_disorder(hierarchy) {
                prop_assert!(result.is_err());
            }
            match result {
                Ok(solution) => expect_sound(hierarchy, &solution)?,
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }

    #[test]
    fn extreme_numbers_are_solved_or_refused_with_reason(
        hierarchy in hierarchy(
            finite().boxed(),
            (finite(), finite()).prop_map(|(a, b)| if a <= b { (a, b) } else { (b, a) }).boxed(),
        ),
    ) {
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        match solver.solve(&hierarchy) {
            Ok(solution) => expect_sound(&hierarchy, &solution.clone())?,
            Err(Error::Datum { got, .. }) if got.is_finite() => {}
            Err(
                Error::Overflow
                | Error::Inaccurate { .. }
                | Error::Infeasible { .. }
                | Error::Unbounded { .. }
                | Error::Hessian { .. },
            ) => {}
            // The square of a Hessian constructed above overflowed.
            Err(Error::Datum { .. }) => prop_assert!(has_nan_or_disorder(&hierarchy)),
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }

    #[test]
    fn constructors_refuse_what_does_not_fit(
        rows in 0..5_usize, columns in 0..5_usize, bounds in 0..5_usize, variables in 0..5_usize,
    ) {
        let made = Rows::equalities(&DMatrix::zeros(rows, columns), &DVector::zeros(bounds));
        prop_assert_eq!(made.is_ok(), rows == bounds);
        let hierarchy = Hierarchy::new(variables);
        prop_assert_eq!(hierarchy.is_ok(), variables > 0);
        if let (Ok(rows), Ok(mut hierarchy)) = (made, hierarchy) {
            let pushed = hierarchy.push(Level::least_squares(rows));
            prop_assert_eq!(pushed.is_ok(), columns == variables);
        }
        let quadratic = Level::quadratic(&DMatrix::zeros(rows, columns), &DVector::zeros(bounds));
        prop_assert_eq!(quadratic.is_ok(), rows == columns && rows == bounds);
    }
}
