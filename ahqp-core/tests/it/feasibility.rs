//! Consistent hard rows are never refused, and inconsistent ones always are.
#![allow(clippy::print_stderr)] // how a long run goes

mod oracle;
mod sets;

use ahqp_core::{ConstraintSource, Error, Hierarchy, Level, Rows, Settings, Solver};
use nalgebra::{DMatrix, DVector};

use oracle::{Verdict, feasibility};
use sets::{Form, Random, Set};

const FREE: f64 = f64::INFINITY;

/// Returns the optimum of a hierarchy of this set alone, with a new solver.
fn solve(hierarchy: &Hierarchy) -> Result<Vec<f64>, Error> {
    let mut solver = Solver::new(hierarchy, Settings::default())?;
    solver.solve(hierarchy)?.optimum().map(<[f64]>::to_vec)
}

/// x ≥ 0, x₁ + x₂ = 2, 3x₀ + x₁ + 3x₂ ≤ 2 have one common point, (0, 2, 0). −3x₀ ≤ 0 does not
/// exclude it. Two variables are at bounds there, and the last row has no other variable.
#[test]
fn rows_that_tie_with_active_bounds_hold() {
    let rows = [
        (vec![0.0, -2.0, -2.0], -4.0, -4.0),
        (vec![3.0, 1.0, 3.0], -FREE, 2.0),
        (vec![-3.0, 0.0, 0.0], -FREE, 0.0),
    ];
    for count in [2, 3] {
        let rows = rows[..count].to_vec();
        let set = Set { lower: vec![0.0; 3], upper: vec![FREE; 3], rows };
        for form in Form::ALL {
            let shift = if form == Form::Shifted { 1.0 } else { 0.0 };
            let x = solve(&set.hierarchy(form)).unwrap();
            for (x, expected) in x.iter().zip([0.0, 2.0, 0.0]) {
                assert!((x - expected - shift).abs() < 1e-14, "{count} rows, {form:?}: {x}");
            }
        }
    }
}

/// The bound of a row at zero bounds is what rounding leaves of numbers as large as x₀.
#[test]
fn a_bound_of_rounding_beside_large_variables_holds() {
    let solve_with = |bound: f64| {
        let mut hierarchy = Hierarchy::new(3).unwrap();
        let infinity = f64::INFINITY;
        hierarchy.set_bounds(&[-infinity, 0.0, 0.0], &[infinity; 3]).unwrap();
        let towards = DVector::from_vec(vec![1e3, -1.0, -1.0]);
        let identity = Rows::equalities(&DMatrix::identity(3, 3), &towards).unwrap();
        hierarchy.push(Level::least_squares(identity)).unwrap();
        let row = DMatrix::from_row_slice(1, 3, &[0.0, 1.0, 1.0]);
        let row = Rows::equalities(&row, &DVector::from_element(1, bound)).unwrap();
        hierarchy.push(Level::constraints_only(row)).unwrap();
        solve(&hierarchy)
    };
    let x = solve_with(-1.1e-16).unwrap();
    assert!((x[0] - 1e3).abs() < 1e-10 && x[1] == 0.0 && x[2] == 0.0, "{x:?}");
    let contradiction = solve_with(-1e-9).unwrap_err();
    assert!(matches!(contradiction, Error::Infeasible { .. }), "{contradiction}");
}

/// The bound of a row without coefficients can only be compared with the row's own unit.
#[test]
fn a_row_without_coefficients_holds_to_rounding() {
    let towards = || {
        let target = DVector::from_vec(vec![1.0, -2.0]);
        Level::least_squares(Rows::equalities(&DMatrix::identity(2, 2), &target).unwrap())
    };
    let beside = ([1.0, 1.0], -FREE, 0.5);
    let empty = |upper: f64| ([0.0, 0.0], -FREE, upper);
    let problem = |rows: &[([f64; 2], f64, f64)]| {
        let mut constraints = Rows::zeros(rows.len(), 2);
        for (i, (row, lower, upper)) in rows.iter().enumerate() {
            constraints.set_row(i, row, *lower, *upper).unwrap();
        }
        let mut hierarchy = Hierarchy::new(2).unwrap();
        hierarchy.push(towards().with_constraints(constraints)).unwrap();
        hierarchy
    };
    for rows in [vec![empty(-7e-18)], vec![empty(-7e-18), beside], vec![beside, empty(-7e-18)]] {
        let hierarchy = problem(&rows);
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        // First a cold start, then a warm one.
        for _ in 0..2 {
            let solution = solver.solve(&hierarchy).unwrap();
            assert!(solution.iterations() < 4, "it stands in no search's way");
            let x = solution.optimum().unwrap();
            assert!((x[0] - 1.0).abs() + (x[1] + 2.0).abs() < 1e-14, "{x:?}");
            let x = x.to_vec();
            let certificate = solver.certificate(&hierarchy).unwrap();
            assert!(certificate.residuals(&hierarchy, &x).unwrap().worst() < 1e-9);
        }
    }
    for upper in [-1e-9, -1e-3, -1.0] {
        let hierarchy = problem(&[beside, empty(upper)]);
        let error = solve(&hierarchy).unwrap_err();
        let Error::Infeasible { worst, violation, .. } = error else { panic!("{error}") };
        assert!(matches!(worst, ConstraintSource::Constraint { row: 1, .. }), "{worst}");
        assert_eq!(violation, -upper);
    }
}

/// Solves `count` sets that hold at a point, in each form. Returns those that are refused.
fn refused(count: u64, progress: bool) -> Vec<String> {
    let mut refused = Vec::new();
    for seed in 0..count {
        if progress && seed.is_multiple_of(20_000) {
            eprint!("\r{seed} of {count} sets, {} refused", refused.len());
        }
        let set = Set::feasible(&mut Random::new(seed));
        for form in Form::ALL {
            match solve(&set.hierarchy(form)) {
                Ok(x) => assert!(set.holds(form, &x), "seed {seed}, {form:?}: {x:?}, {set:?}"),
                Err(error) => refused.push(format!("seed {seed}, {form:?}: {error}, {set:?}")),
            }
        }
    }
    refused
}

#[test]
fn no_feasible_set_is_refused() {
    let refused = refused(4_000, false);
    assert!(refused.is_empty(), "{refused:#?}");
}

/// Run it with `cargo test --release -p ahqp-core --test it million -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn none_of_a_million_feasible_sets_is_refused() {
    let refused = refused(1_000_000, true);
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn sets_are_refused_where_exact_arithmetic_refuses_them() {
    let mut counts = [0, 0];
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let set = Set::feasible(&mut random).with_another_bound(&mut random);
        let verdict = feasibility(&set.inequalities());
        let is_feasible = matches!(verdict, Verdict::Point(_));
        counts[usize::from(is_feasible)] += 1;
        for form in Form::ALL {
            match solve(&set.hierarchy(form)) {
                Ok(x) => assert!(is_feasible && set.holds(form, &x), "{seed}, {form:?}: {set:?}"),
                Err(Error::Infeasible { .. }) => assert!(!is_feasible, "{seed}, {form:?}: {set:?}"),
                Err(error) => panic!("{seed}, {form:?}: {error}"),
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 100), "both kinds are there: {counts:?}");
}
