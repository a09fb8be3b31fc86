//! Properties of every solution, on random hierarchies.

use ahqp_core::testing::{Sizes, equality_hierarchies, hierarchies, hierarchy_sequences};
use ahqp_core::{
    Error, Hierarchy, Level, Objective, Rows, Settings, Solver, Status, WarmStart, solve_reference,
};
use nalgebra::{DMatrix, DVector};
use proptest::{prelude::*, test_runner::RngSeed};

use crate::certificate::expect_proofs;

/// Uses the same cases on every run. `PROPTEST_RNG_SEED` and `AHQP_CASES` select others and more.
fn config() -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    let cases = number("AHQP_CASES").map_or(300, |cases| u32::try_from(cases).unwrap());
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        cases,
        max_global_rejects: cases.div_ceil(50),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn small() -> Sizes {
    Sizes { variables: 1..=12, levels: 1..=5, rows: 0..=6 }
}

fn cold() -> Settings {
    Settings { warm_start: WarmStart::Cold, ..Settings::default() }
}

fn solve(hierarchy: &Hierarchy) -> Vec<f64> {
    let mut solver = Solver::new(hierarchy, cold()).unwrap();
    let solution = solver.solve(hierarchy).unwrap();
    assert_eq!(solution.status(), Status::Solved);
    solution.optimum().unwrap().to_vec()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Returns the violation of each row, and the size that its rounding is relative to.
fn violations<'a>(rows: &'a Rows, x: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    rows.iter().map(|(a, lower, upper)| {
        let value = dot(a, x);
        (value - value.clamp(lower, upper), 1.0 + dot(a, a).sqrt() * dot(x, x).sqrt())
    })
}

/// Returns the objective's value at x, and the size that its rounding is relative to.
fn residual(level: &Level, x: &[f64]) -> (f64, f64) {
    match level.objective() {
        Objective::LeastSquares(rows) => {
            let squares: f64 = violations(rows, x).map(|(violation, _)| violation.powi(2)).sum();
            (squares.sqrt(), 1.0 + squares.sqrt())
        }
        Objective::Quadratic { hessian, gradient } => {
            let x = DVector::from_column_slice(x);
            let (bent, tilted) = (0.5 * (hessian * &x).dot(&x), gradient.dot(&x));
            // Far away where the Hessian is flat, xᵀHx is the rounding of larger numbers.
            let summands = 1e-7 * hessian.norm() * x.norm_squared();
            (bent + tilted, 1.0 + bent.abs() + tilted.abs() + summands)
        }
        _ => (0.0, 1.0),
    }
}

/// Returns the rows of the matrices of all objectives.
fn objective_rows(hierarchy: &Hierarchy) -> Vec<DVector<f64>> {
    let mut all = Vec::new();
    for level in hierarchy.levels() {
        match level.objective() {
            Objective::LeastSquares(rows) => {
                all.extend(rows.iter().map(|(a, ..)| DVector::from_column_slice(a)));
            }
            Objective::Quadratic { hessian, gradient } => {
                all.extend(hessian.row_iter().map(|row| row.transpose()));
                all.push(gradient.clone());
            }
            _ => {}
        }
    }
    all
}

/// Returns a hierarchy with the same bounds and the levels that `map` returns.
fn rebuilt(hierarchy: &Hierarchy, map: impl Fn(usize, &Level) -> Option<Level>) -> Hierarchy {
    let mut other = Hierarchy::new(hierarchy.variables()).unwrap();
    let (lower, upper) = other.bounds_mut();
    lower.copy_from_slice(hierarchy.lower());
    upper.copy_from_slice(hierarchy.upper());
    for level in hierarchy.levels().iter().enumerate().filter_map(|(k, level)| map(k, level)) {
        other.push(level).unwrap();
    }
    other
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

fn matrix_of(rows: &Rows) -> DMatrix<f64> {
    let entries = rows.iter().flat_map(|(a, ..)| a.iter().copied());
    DMatrix::from_row_iterator(rows.len(), rows.columns(), entries)
}

/// Multiplies the levels' rows by `by(level)` from the left.
fn transformed(hierarchy: &Hierarchy, by: impl Fn(usize, usize) -> DMatrix<f64>) -> Hierarchy {
    rebuilt(hierarchy, |k, level| {
        let Objective::LeastSquares(rows) = level.objective() else { return Some(level.clone()) };
        let factor = by(k, rows.len());
        let target = &factor * DVector::from_column_slice(rows.upper());
        Some(Level::least_squares(Rows::equalities(&(factor * matrix_of(rows)), &target).unwrap()))
    })
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn every_level_reaches_the_residual_of_the_reference(hierarchy in hierarchies(Sizes::default())) {
        let x = solve(&hierarchy);
        let reference = solve_reference(&hierarchy).map_err(|error| {
            // The interior-point method fails on one degenerate problem in a thousand. proptest
            // counts rejected cases, and reports too many as an error.
            TestCaseError::reject(error.to_string())
        })?;
        for (k, level) in hierarchy.levels().iter().enumerate() {
            let (ours, size) = residual(level, &x);
            let (theirs, _) = residual(level, reference.as_slice());
            // A better feasible point proves that the reference stopped too early.
            prop_assume!(theirs <= ours + 1e-6 * size);
            prop_assert!(ours <= theirs + 1e-6 * size, "level {k}: {ours} against {theirs}");
            if (ours - theirs).abs() > 1e-9 * size {
                // A small difference in one level may be a large one in the next.
                return Ok(());
            }
        }
        // Directions that a level depends on only weakly move far for a residual of 1e-6. The
        // certificate proves that the norm is least. A shorter point with the same residuals proves
        // that the reference stopped too early.
        let (ours, theirs) = (dot(&x, &x).sqrt(), reference.norm());
        prop_assert!(ours <= theirs + 1e-3 * (1.0 + ours), "norm {ours} against {theirs}");
    }

    #[test]
    fn the_certificate_proves_every_solution(
        sequence in hierarchy_sequences(Sizes::default(), 3),
    ) {
        expect_proofs(&sequence)?;
    }

    #[test]
    fn the_certificate_proves_no_other_point(
        hierarchy in hierarchies(small()), at in 0..12_usize, step in prop_oneof![-0.5..-0.1, 0.1..0.5],
    ) {
        let mut solver = Solver::new(&hierarchy, cold()).unwrap();
        let mut x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
        let certificate = solver.certificate(&hierarchy).unwrap();
        // The optimum is unique, since it has the least norm.
        let n = x.len();
        x[at % n] += step;
        let residuals = certificate.residuals(&hierarchy, &x).unwrap();
        prop_assert!(residuals.worst() > 1e-7, "{residuals:?}");
    }

    #[test]
    fn bounds_hold_exactly_and_hard_constraints_to_rounding(hierarchy in hierarchies(Sizes::default())) {
        let x = solve(&hierarchy);
        for (i, &value) in x.iter().enumerate() {
            prop_assert!((hierarchy.lower()[i]..=hierarchy.upper()[i]).contains(&value));
        }
        for level in hierarchy.levels() {
            let rows = level.constraints().iter().zip(violations(level.constraints(), &x));
            for ((a, lower, upper), (violation, _)) in rows {
                let terms: f64 = a.iter().zip(&x).map(|(a, x)| (a * x).abs()).sum();
                let nearer = lower.abs().min(upper.abs());
                let size = terms + if nearer.is_finite() { nearer } else { 0.0 };
                let rounding = 1e-12 * dot(a, a).sqrt() * dot(&x, &x).sqrt();
                prop_assert!(violation.abs() <= 1e-9 * size + rounding, "{violation}");
            }
        }
    }

    #[test]
    fn lower_levels_never_cost_higher_ones_anything(hierarchy in hierarchies(small())) {
        let x = solve(&hierarchy);
        for kept in 0..hierarchy.levels().len() {
            let upper_part = rebuilt(&hierarchy, |k, level| (k <= kept).then(|| level.clone()));
            let alone = solve(&upper_part);
            for level in upper_part.levels() {
                let ((with, size), (without, _)) = (residual(level, &x), residual(level, &alone));
                prop_assert!(with <= without + 1e-8 * size, "{with} against {without}");
            }
        }
    }

    #[test]
    fn violations_are_reported_as_they_are(hierarchy in hierarchies(small())) {
        let x = solve(&hierarchy);
        for level in hierarchy.levels() {
            let reported = level.violation(&x)?;
            if let Objective::LeastSquares(_) = level.objective() {
                let (found, size) = residual(level, &x);
                prop_assert!((reported - found).abs() <= 1e-9 * size);
            } else {
                prop_assert_eq!(reported, 0.0);
            }
        }
    }

    #[test]
    fn a_warm_start_changes_nothing_but_the_time(
        sequence in hierarchy_sequences(Sizes { variables: 1..=24, ..Sizes::default() }, 4),
    ) {
        let mut warm = Solver::new(&sequence[0], Settings::default()).unwrap();
        // The sequence mostly returns to the first problem, so that rows have a usual activity too.
        let odd = sequence.iter().chain(&sequence).flat_map(|other| [other, &sequence[0]]);
        for hierarchy in odd {
            let warm = warm.solve(hierarchy).unwrap();
            prop_assert_eq!(warm.status(), Status::Solved);
            let cold = solve(hierarchy);
            let size = 1.0 + dot(&cold, &cold).sqrt();
            let difference = largest_difference(warm.optimum().unwrap(), &cold);
            prop_assert!(difference <= 1e-7 * size, "{difference}");
        }
    }

    #[test]
    fn equal_input_and_history_give_equal_bits(
        sequence in hierarchy_sequences(small(), 3),
    ) {
        let bits = |solver: &mut Solver, hierarchy: &Hierarchy| -> (Vec<u64>, usize) {
            let solution = solver.solve(hierarchy).unwrap();
            (solution.optimum().unwrap().iter().map(|value| value.to_bits()).collect(), solution.iterations())
        };
        let mut one = Solver::new(&sequence[0], Settings::default()).unwrap();
        let mut other = Solver::new(&sequence[0], Settings::default()).unwrap();
        for hierarchy in &sequence {
            prop_assert_eq!(bits(&mut one, hierarchy), bits(&mut other, hierarchy));
        }
        // A cold start has no history, and neither has a solver that was told to forget.
        let mut cold = Solver::new(&sequence[0], cold()).unwrap();
        for hierarchy in sequence.iter().rev() {
            one.forget();
            let mut fresh = Solver::new(hierarchy, Settings::default()).unwrap();
            let expected = bits(&mut fresh, hierarchy);
            prop_assert_eq!(&bits(&mut one, hierarchy), &expected);
            prop_assert_eq!(&bits(&mut cold, hierarchy), &expected);
        }
    }

    #[test]
    fn orthogonal_changes_of_a_levels_rows_keep_x(
        hierarchy in equality_hierarchies(small()),
        entries in prop::collection::vec(-1.0..1.0_f64, 36),
    ) {
        let turned = transformed(&hierarchy, |_, m| {
            let square = DMatrix::from_iterator(m, m, entries.iter().copied().take(m * m));
            square.qr().q()
        });
        let (x, other) = (solve(&hierarchy), solve(&turned));
        let size = 1.0 + dot(&x, &x).sqrt();
        prop_assert!(largest_difference(&x, &other) <= 1e-7 * size);
    }

    #[test]
    fn a_levels_unit_does_not_matter(
        hierarchy in equality_hierarchies(small()),
        exponents in prop::collection::vec(-20..20_i32, 5),
    ) {
        let scaled =
            transformed(&hierarchy, |k, m| DMatrix::identity(m, m) * 2.0_f64.powi(exponents[k]));
        let (x, other) = (solve(&hierarchy), solve(&scaled));
        let size = 1.0 + dot(&x, &x).sqrt();
        prop_assert!(largest_difference(&x, &other) <= 1e-7 * size);
    }

    #[test]
    fn targets_twice_as_far_give_twice_the_solution(
        hierarchy in hierarchies(small()), exponent in -10..10_i32,
    ) {
        let factor = 2.0_f64.powi(exponent);
        let stretched_rows = |rows: &Rows| {
            let mut rows = rows.clone();
            rows.lower_mut().iter_mut().for_each(|bound| *bound *= factor);
            rows.upper_mut().iter_mut().for_each(|bound| *bound *= factor);
            rows
        };
        let mut stretched = rebuilt(&hierarchy, |_, level| {
            let scaled = match level.objective() {
                Objective::LeastSquares(rows) => Level::least_squares(stretched_rows(rows)),
                Objective::Quadratic { hessian, gradient } => {
                    Level::quadratic(hessian, &(gradient * factor)).unwrap()
                }
                _ => Level::constraints_only(Rows::zeros(0, hierarchy.variables())),
            };
            Some(scaled.with_constraints(stretched_rows(level.constraints())))
        });
        let (lower, upper) = stretched.bounds_mut();
        lower.iter_mut().chain(upper).for_each(|bound| *bound *= factor);
        let (x, other) = (solve(&hierarchy), solve(&stretched));
        let size = 1.0 + dot(&x, &x).sqrt();
        let back: Vec<f64> = other.iter().map(|value| value / factor).collect();
        prop_assert!(largest_difference(&x, &back) <= 1e-7 * size);
    }

    #[test]
    fn the_order_of_variables_and_rows_is_irrelevant(
        hierarchy in hierarchies(small()), shift in 0..12_usize,
    ) {
        let n = hierarchy.variables();
        let turned_rows = |rows: &Rows| {
            let mut turned = Rows::zeros(rows.len(), n);
            for (i, (a, lower, upper)) in rows.iter().enumerate() {
                let to = rows.len() - 1 - i;
                let row = turned.row_mut(to).unwrap();
                row.copy_from_slice(a);
                row.rotate_left(shift % n);
                turned.lower_mut()[to] = lower;
                turned.upper_mut()[to] = upper;
            }
            turned
        };
        let at = |i: usize| (i + shift) % n;
        let mut turned = rebuilt(&hierarchy, |_, level| {
            let objective = match level.objective() {
                Objective::LeastSquares(rows) => Level::least_squares(turned_rows(rows)),
                Objective::Quadratic { hessian, gradient } => Level::quadratic(
                    &DMatrix::from_fn(n, n, |i, j| hessian[(at(i), at(j))]),
                    &DVector::from_fn(n, |i, _| gradient[at(i)]),
                )
                .unwrap(),
                _ => Level::constraints_only(Rows::zeros(0, n)),
            };
            Some(objective.with_constraints(turned_rows(level.constraints())))
        });
        let (lower, upper) = turned.bounds_mut();
        lower.rotate_left(shift % n);
        upper.rotate_left(shift % n);
        let mut x = solve(&hierarchy);
        let other = solve(&turned);
        x.rotate_left(shift % n);
        let size = 1.0 + dot(&x, &x).sqrt();
        prop_assert!(largest_difference(&x, &other) <= 1e-7 * size);
    }

    #[test]
    fn too_few_iterations_still_finish_the_upper_levels(
        hierarchy in hierarchies(small()), max_iterations in 1..12_usize,
    ) {
        let mut solver =
            Solver::new(&hierarchy, Settings { max_iterations, ..cold() }).unwrap();
        let solution = solver.solve(&hierarchy)?.clone();
        prop_assert!(solution.iterations() <= max_iterations);
        let done = match solution.status() {
            Status::IterationLimit { level: Some(level) } => level.index(),
            _ => hierarchy.levels().len(),
        };
        let complete = solve(&hierarchy);
        for level in &hierarchy.levels()[..done] {
            let (ours, size) = residual(level, solution.best());
            let (best, _) = residual(level, &complete);
            prop_assert!((ours - best).abs() <= 1e-7 * size);
            for (violation, size) in violations(level.constraints(), solution.best()) {
                prop_assert!(violation.abs() <= 1e-9 * size);
            }
        }
        for (i, value) in solution.best().iter().enumerate() {
            prop_assert!((hierarchy.lower()[i]..=hierarchy.upper()[i]).contains(value));
        }
    }

    /// The budget holds for every start, and later ticks do the remaining work.
    #[test]
    fn a_small_budget_finishes_over_several_ticks(
        sequence in hierarchy_sequences(small(), 2), spare in 0..20_usize,
    ) {
        // A level takes one step for its constraints and one for its objective.
        let max_iterations = 2 * sequence[0].levels().len() + sequence[0].variables() + 2 + spare;
        let mut solver =
            Solver::new(&sequence[0], Settings { max_iterations, ..Settings::default() }).unwrap();
        for hierarchy in &sequence {
            for tick in 0.. {
                let solution = solver.solve(hierarchy)?;
                prop_assert!(solution.iterations() <= max_iterations);
                if solution.status() == Status::Solved {
                    break;
                }
                prop_assert!(tick < 20, "{solution:?}");
            }
            let x = solver.solve(hierarchy)?.optimum().unwrap().to_vec();
            let complete = solve(hierarchy);
            let size = 1.0 + dot(&complete, &complete).sqrt();
            prop_assert!(largest_difference(&x, &complete) <= 1e-7 * size, "{x:?} {complete:?}");
        }
    }
}

#[test]
fn the_reference_refuses_what_the_solver_refuses() {
    let mut hierarchy = Hierarchy::new(1).unwrap();
    hierarchy.bounds_mut().0[0] = f64::NAN;
    assert!(matches!(solve_reference(&hierarchy), Err(Error::Datum { .. })));
    let mut hierarchy = Hierarchy::new(1).unwrap();
    let (one, two) = (DVector::from_element(1, 1.0), DVector::from_element(1, 2.0));
    let identity = DMatrix::identity(1, 1);
    for target in [one, two] {
        let rows = Rows::equalities(&identity, &target).unwrap();
        hierarchy.push(Level::constraints_only(rows)).unwrap();
    }
    assert!(matches!(solve_reference(&hierarchy), Err(Error::Reference { level: 1, .. })));
}

#[test]
fn an_occasional_row_costs_nothing_in_between() {
    let aim = |first: f64| {
        let mut hierarchy = Hierarchy::new(6).unwrap();
        let (lower, upper) = hierarchy.bounds_mut();
        lower.fill(-1.0);
        upper.fill(1.0);
        let mut target = DVector::from_element(6, 0.3);
        target[0] = first;
        let rows = Rows::equalities(&DMatrix::identity(6, 6), &target).unwrap();
        hierarchy.push(Level::least_squares(rows)).unwrap();
        hierarchy
    };
    let (usual, odd) = (aim(0.9), aim(1.1));
    let mut solver = Solver::new(&usual, Settings::default()).unwrap();
    let mut rounds = Vec::new();
    for _ in 0..20 {
        for (hierarchy, first) in [(&usual, 0.9), (&usual, 0.9), (&odd, 1.0), (&usual, 0.9)] {
            let solution = solver.solve(hierarchy).unwrap();
            assert_eq!(solution.status(), Status::Solved);
            assert!((solution.optimum().unwrap()[0] - first).abs() < 1e-12);
            rounds.push(solution.iterations());
        }
    }
    assert_eq!(rounds[40..44], [1, 1, 2, 1]);
}

proptest! {
    // Cases without free directions are rejected. More than four in five are an error.
    #![proptest_config(ProptestConfig { max_global_rejects: 4 * config().cases, ..config() })]

    #[test]
    fn no_free_direction_shortens_x(
        hierarchy in hierarchies(small()),
        direction in prop::collection::vec(-1.0..1.0_f64, 12),
        share in 0.0..1.0_f64,
    ) {
        let x = DVector::from_vec(solve(&hierarchy));
        let n = x.len();
        // A direction that does not change any objective.
        let mut way = DVector::from_iterator(n, direction.into_iter().take(n));
        let mut seen: Vec<DVector<f64>> = Vec::new();
        for mut row in objective_rows(&hierarchy) {
            let size = row.norm();
            for _ in 0..2 {
                for s in &seen {
                    row.axpy(-s.dot(&row.clone()), s, 1.0);
                }
            }
            if row.norm() > 1e-9 * size {
                seen.push(row.normalize());
            }
        }
        for _ in 0..2 {
            for s in &seen {
                way.axpy(-s.dot(&way.clone()), s, 1.0);
            }
        }
        prop_assume!(way.norm() >= 1e-6);
        // Distance along it that the hard rows allow.
        let mut reach = f64::INFINITY;
        let mut limit = |value: f64, slope: f64, lower: f64, upper: f64| {
            if slope > 1e-12 {
                reach = reach.min((upper - value).max(0.0) / slope);
            } else if slope < -1e-12 {
                reach = reach.min((lower - value).min(0.0) / slope);
            }
        };
        for i in 0..n {
            limit(x[i], way[i], hierarchy.lower()[i], hierarchy.upper()[i]);
        }
        for level in hierarchy.levels() {
            for (a, lower, upper) in level.constraints().iter() {
                limit(dot(a, x.as_slice()), dot(a, way.as_slice()), lower, upper);
            }
        }
        let moved = &x + &way * (share * reach.min(1.0));
        prop_assert!(moved.norm() >= x.norm() * (1.0 - 1e-9));
    }
}
