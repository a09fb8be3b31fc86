//! Problems on which solvers are known to fail, each with its outcome computed by hand or fixed by
//! a property.

use ahqp_core::{
    ConstraintSource, Error, Hierarchy, Level, Rows, Settings, Solution, Solver, Status,
    solve_reference,
};
use nalgebra::{DMatrix, DVector, RowDVector, dmatrix, dvector};

const FREE: f64 = f64::INFINITY;

fn solved(hierarchy: &Hierarchy) -> Solution {
    let solution =
        Solver::new(hierarchy, Settings::default()).unwrap().solve(hierarchy).unwrap().clone();
    assert_eq!(solution.status(), Status::Solved);
    solution
}

fn violations(hierarchy: &Hierarchy, solution: &Solution) -> Vec<f64> {
    let x = solution.optimum().unwrap();
    hierarchy.levels().iter().map(|level| level.violation(x).unwrap()).collect()
}

fn equalities(a: &DMatrix<f64>, b: &DVector<f64>) -> Level {
    Level::least_squares(Rows::equalities(a, b).unwrap())
}

fn upper_limits(a: &DMatrix<f64>, upper: &DVector<f64>) -> Rows {
    Rows::ranges(a, &DVector::repeat(upper.len(), -FREE), upper).unwrap()
}

/// Returns the level min ‖x − target‖².
fn towards(target: &DVector<f64>) -> Level {
    equalities(&DMatrix::identity(target.len(), target.len()), target)
}

fn hierarchy(variables: usize, levels: impl IntoIterator<Item = Level>) -> Hierarchy {
    let mut hierarchy = Hierarchy::new(variables).unwrap();
    for level in levels {
        hierarchy.push(level).unwrap();
    }
    hierarchy
}

fn boxed(mut hierarchy: Hierarchy, size: f64) -> Hierarchy {
    let (lower, upper) = hierarchy.bounds_mut();
    lower.fill(-size);
    upper.fill(size);
    hierarchy
}

/// Returns numbers without a pattern, the same on every run.
fn entries(rows: usize, columns: usize, seed: u32) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |i, j| {
        let t = f64::from(seed) + 12.9898 * i as f64 + 78.233 * j as f64;
        2.0 * (t.sin() * 43758.5453).rem_euclid(1.0) - 1.0
    })
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance, "{found:?} against {expected:?}");
    }
}

fn vector(solution: &Solution) -> DVector<f64> {
    DVector::from_column_slice(solution.optimum().unwrap())
}

#[test]
fn soft_inequalities_that_contradict_settle_at_least_violation() {
    // x ≥ 1, x ≤ −1 and x ≤ −1.5: least squares puts x at the mean of the violated bounds.
    let top = Rows::ranges(
        &dmatrix![1.0, 0.0; 1.0, 0.0; 1.0, 0.0],
        &dvector![1.0, -FREE, -FREE],
        &dvector![FREE, -1.0, -1.5],
    );
    let below = equalities(&dmatrix![0.0, 1.0], &dvector![2.0]);
    let problem = hierarchy(2, [Level::least_squares(top.unwrap()), below]);
    let solution = solved(&problem);
    assert_near(solution.optimum().unwrap(), &[-0.5, 2.0], 1e-12);
    assert_near(
        &violations(&problem, &solution),
        &[(1.5_f64.powi(2) + 0.5_f64.powi(2) + 1.0).sqrt(), 0.0],
        1e-12,
    );
}

#[test]
fn hard_inequalities_that_contradict_are_named() {
    let rows = Rows::ranges(
        &dmatrix![1.0, 0.0; 1.0, 0.0; 0.0, 1.0],
        &dvector![1.0, -FREE, 0.0],
        &dvector![FREE, -1.0, 9.0],
    );
    let hierarchy = hierarchy(2, [Level::constraints_only(rows.unwrap())]);
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    assert!(
        matches!(solver.solve(&hierarchy), Err(Error::Infeasible { level, .. }) if level.index() == 0)
    );
    let level = hierarchy.ids().next().unwrap();
    let named = |row| ConstraintSource::Constraint { level, row };
    assert!(solver.conflict().contains(&named(0)) && solver.conflict().contains(&named(1)));
    assert!(!solver.conflict().contains(&named(2)));
}

#[test]
fn equalities_repeated_within_and_across_levels() {
    let a = entries(2, 5, 1);
    let sum = a.row(0) + a.row(1);
    let stacked = DMatrix::from_rows(
        &[a.row(0), a.row(1), a.row(0), a.row(1), sum.as_view()].map(nalgebra::Matrix::into_owned),
    );
    let top = equalities(&stacked, &dvector![1.0, 2.0, 1.0, 2.0, 3.0]);
    let again = equalities(&(&a * 2.0), &dvector![2.0, 4.0]);
    let problem = hierarchy(5, [top, again, towards(&DVector::zeros(5))]);
    let solution = solved(&problem);
    let expected = a.transpose() * (&a * a.transpose()).lu().solve(&dvector![1.0, 2.0]).unwrap();
    assert_near(solution.optimum().unwrap(), expected.as_slice(), 1e-11);
    assert!(violations(&problem, &solution)[..2].iter().all(|violation| *violation < 1e-12));
}

#[test]
fn directions_between_levels_that_differ_little() {
    // aᵀx = 1, then (a + εd)ᵀx = 1.5 with a, d orthonormal: x = a + (0.5/ε)d, if within ±10.
    let solve = |epsilon: f64| {
        let (a, d) = (dmatrix![0.6, 0.8, 0.0], dmatrix![0.0, 0.0, 1.0]);
        let levels = [
            equalities(&a, &dvector![1.0]),
            equalities(&(&a + &d * epsilon), &dvector![1.5]),
            towards(&DVector::zeros(3)),
        ];
        let problem = boxed(hierarchy(3, levels), 10.0);
        let solution = solved(&problem);
        (violations(&problem, &solution), solution)
    };
    for exponent in [3, 5, 7, 9] {
        let epsilon = 10.0_f64.powi(-exponent);
        let (violations, solution) = solve(epsilon);
        // The bound is reached long before that.
        assert_near(solution.optimum().unwrap(), &[0.6, 0.8, 10.0], 1e-6);
        assert!((violations[1] - (0.5 - 10.0 * epsilon)).abs() < 1e-9);
    }
    // Below the rank tolerance the second level has no direction of its own, and has no effect.
    for exponent in [11, 13] {
        let (_, solution) = solve(10.0_f64.powi(-exponent));
        assert_near(solution.optimum().unwrap(), &[0.6, 0.8, 0.0], 1e-9);
    }
}

#[test]
fn directions_within_a_level_that_differ_little() {
    // Rows a and a + εd with the targets of the point a + d.
    for (exponent, tolerance) in [(4, 1e-9), (8, 1e-5)] {
        let epsilon = 10.0_f64.powi(-exponent);
        let a = RowDVector::from_row_slice(&[0.6, 0.8, 0.0, 0.0]);
        let d = RowDVector::from_row_slice(&[0.0, 0.0, 1.0, 0.0]);
        let level = equalities(
            &DMatrix::from_rows(&[a.clone(), &a + &d * epsilon]),
            &dvector![1.0, 1.0 + epsilon],
        );
        let solution = solved(&hierarchy(4, [level, towards(&dvector![0.0, 0.0, 0.0, 3.0])]));
        assert_near(solution.optimum().unwrap(), &[0.6, 0.8, 1.0, 3.0], tolerance);
    }
    // At 1e-12 the second row equals the first one.
    let level = equalities(&dmatrix![0.6, 0.8, 0.0; 0.6, 0.8, 1e-12], &dvector![1.0, 1.0 + 1e-12]);
    let solution = solved(&hierarchy(3, [level, towards(&dvector![0.0, 0.0, 2.0])]));
    assert_near(solution.optimum().unwrap(), &[0.6, 0.8, 2.0], 1e-9);
}

#[test]
fn a_vertex_where_twenty_inequalities_meet() {
    // All rows hold with equality at `vertex`, and the objective pulls along their sum.
    let vertex = dvector![0.3, -0.7, 1.1, 0.2];
    let rows = entries(20, 4, 2);
    let constraints = upper_limits(&rows, &(&rows * &vertex));
    let target = &vertex + rows.row_sum().transpose();
    let solution = solved(&hierarchy(4, [Level::constraints_only(constraints), towards(&target)]));
    // The target lies in the cone of the rows, so the vertex is the nearest point.
    assert_near(solution.optimum().unwrap(), vertex.as_slice(), 1e-9);
}

#[test]
fn inequalities_given_three_times() {
    let once = entries(3, 4, 3);
    let rows = DMatrix::from_fn(9, 4, |i, j| once[(i % 3, j)] * if i < 6 { 1.0 } else { 2.0 });
    let bounds = DVector::from_fn(9, |i, _| if i < 6 { 1.0 } else { 2.0 });
    let target = once.row_sum().transpose() * 5.0;
    let problem = |rows, bounds: &DVector<f64>| {
        hierarchy(4, [Level::constraints_only(upper_limits(rows, bounds)), towards(&target)])
    };
    let thrice = solved(&problem(&rows, &bounds));
    let once = solved(&problem(&once, &dvector![1.0, 1.0, 1.0]));
    assert_near(thrice.optimum().unwrap(), once.optimum().unwrap(), 1e-10);
}

#[test]
fn rows_of_very_different_scale() {
    for scale in [1e3, 1e6, 1e8] {
        let factors = dvector![scale, 1.0, 1.0 / scale];
        let a = entries(3, 8, 4);
        let scaled = DMatrix::from_diagonal(&factors) * &a;
        let c = entries(3, 8, 5);
        let levels = [
            equalities(&scaled, &factors),
            equalities(&(&c / scale), &(dvector![1.0, 2.0, -1.0] / scale)),
            towards(&DVector::zeros(8)),
        ];
        let solution = solved(&boxed(hierarchy(8, levels), 50.0));
        let x = vector(&solution);
        assert!((&a * &x - dvector![1.0, 1.0, 1.0]).amax() < 1e-7, "scale {scale}");
        assert!((&c * &x - dvector![1.0, 2.0, -1.0]).amax() < 1e-7, "scale {scale}");
    }
}

#[test]
fn rows_and_levels_that_are_zero() {
    let a = entries(2, 3, 6);
    let levels = [
        equalities(&DMatrix::zeros(2, 3), &dvector![0.0, 1.0]),
        equalities(&a, &dvector![1.0, 2.0]),
        equalities(&DMatrix::zeros(1, 3), &dvector![5.0]),
        towards(&dvector![1.0, 1.0, 1.0]),
    ];
    let problem = hierarchy(3, levels);
    let solution = solved(&problem);
    assert!((&a * vector(&solution) - dvector![1.0, 2.0]).amax() < 1e-12);
    assert_near(&violations(&problem, &solution)[..3], &[1.0, 0.0, 5.0], 1e-12);
}

#[test]
fn a_zero_hard_row_holds_or_is_named() {
    let zero = |lower, upper| {
        let row = Rows::ranges(&dmatrix![0.0, 0.0], &dvector![lower], &dvector![upper]).unwrap();
        hierarchy(2, [Level::constraints_only(row), towards(&dvector![1.0, 2.0])])
    };
    assert_near(solved(&zero(-1.0, 1.0)).optimum().unwrap(), &[1.0, 2.0], 1e-12);
    assert_near(solved(&zero(0.0, 0.0)).optimum().unwrap(), &[1.0, 2.0], 1e-12);
    let impossible = zero(1.0, 2.0);
    let result = Solver::new(&impossible, Settings::default()).unwrap().solve(&impossible).cloned();
    assert!(
        matches!(result, Err(Error::Infeasible { level, .. }) if level.index() == 0),
        "{result:?}"
    );
}

#[test]
fn an_empty_level_between_others() {
    let a = entries(2, 3, 7);
    let empty = || Level::least_squares(Rows::zeros(0, 3));
    let target = dvector![1.0, 1.0, 1.0];
    let with = [empty(), equalities(&a, &dvector![1.0, 2.0]), empty(), towards(&target), empty()];
    let without = [equalities(&a, &dvector![1.0, 2.0]), towards(&target)];
    let (with, without) = (solved(&hierarchy(3, with)), solved(&hierarchy(3, without)));
    assert_near(with.optimum().unwrap(), without.optimum().unwrap(), 1e-13);
}

#[test]
fn inequality_rows_as_small_as_a_control_period() {
    // Δt v − s ≤ c: s is minimised before v is free.
    for period in [1e-3, 1e-6] {
        let rows = dmatrix![period, 0.0, -1.0, 0.0; 0.0, period, 0.0, -1.0];
        let constraints = upper_limits(&rows, &(dvector![-1.0, 0.2] * period));
        let slack =
            equalities(&dmatrix![0.0, 0.0, 1.0, 0.0; 0.0, 0.0, 0.0, 1.0], &DVector::zeros(2));
        let wish =
            equalities(&dmatrix![1.0, 0.0, 0.0, 0.0; 0.0, 1.0, 0.0, 0.0], &dvector![1.0, 1.0]);
        let levels = [Level::constraints_only(constraints), slack, wish];
        let solution = solved(&hierarchy(4, levels));
        assert_near(solution.optimum().unwrap(), &[-1.0, 0.2, 0.0, 0.0], 1e-8);
    }
}

#[test]
fn cones_on_which_active_sets_cycle() {
    // Integer rows through the origin make every vertex degenerate.
    for seed in 0..40 {
        let integers = |rows: usize, size: f64, salt: u32| {
            entries(rows, 6, 100 * seed + salt).map(|entry| (entry * (size + 0.49)).round())
        };
        let cone = upper_limits(&integers(25, 1.0, 11), &DVector::zeros(25));
        let below = upper_limits(&integers(8, 1.0, 12), &DVector::repeat(8, -1.0));
        let b = integers(4, 3.0, 13).column(0).into_owned();
        let target = integers(1, 2.0, 14).transpose().column(0).into_owned();
        let problem = hierarchy(
            6,
            [
                Level::least_squares(cone),
                equalities(&integers(4, 2.0, 15), &b),
                Level::least_squares(below),
                towards(&target),
            ],
        );
        let solution = solved(&problem);
        let reference = solve_reference(&problem).unwrap();
        for (level, ours) in problem.levels().iter().zip(violations(&problem, &solution)) {
            let ahqp_core::Objective::LeastSquares(rows) = level.objective() else { continue };
            let theirs: f64 = rows
                .iter()
                .map(|(a, lower, upper)| {
                    let value = RowDVector::from_row_slice(a).transpose().dot(&reference);
                    (value - value.clamp(lower, upper)).powi(2)
                })
                .sum();
            assert!((ours - theirs.sqrt()).abs() < 1e-6 * (1.0 + ours), "seed {seed}");
        }
    }
}

#[test]
fn an_equality_written_as_two_inequalities() {
    let a = dmatrix![1.0, -2.0, 0.5, 0.0];
    let rows = DMatrix::from_rows(&[a.row(0).into_owned(), -a.row(0)]);
    for soft in [true, false] {
        let pair = upper_limits(&rows, &dvector![1.0, -1.0]);
        let level = if soft { Level::least_squares(pair) } else { Level::constraints_only(pair) };
        let solution = solved(&hierarchy(4, [level, towards(&DVector::zeros(4))]));
        let expected = a.transpose() / a.norm_squared();
        assert_near(solution.optimum().unwrap(), expected.as_slice(), 1e-10);
    }
}

#[test]
fn bounds_that_are_equal_to_rounding() {
    let a = dmatrix![1.0, -2.0, 0.5, 0.0];
    let row = Rows::ranges(&a, &dvector![1.0], &dvector![1.0 + 1e-12]).unwrap();
    let solution = solved(&hierarchy(4, [Level::least_squares(row), towards(&DVector::zeros(4))]));
    let expected = a.transpose() / a.norm_squared();
    assert_near(solution.optimum().unwrap(), expected.as_slice(), 1e-10);
}

#[test]
fn nothing_left_after_the_first_level() {
    let m = entries(5, 5, 8);
    let levels = [
        equalities(&m, &DVector::repeat(5, 1.0)),
        equalities(&entries(5, 5, 9), &DVector::repeat(5, 1.0)),
        Level::least_squares(
            Rows::ranges(
                &DMatrix::identity(5, 5),
                &DVector::repeat(5, -1e-3),
                &DVector::repeat(5, 1e-3),
            )
            .unwrap(),
        ),
        towards(&DVector::repeat(5, 1.0)),
    ];
    let solution = solved(&hierarchy(5, levels));
    let expected = m.lu().solve(&DVector::repeat(5, 1.0)).unwrap();
    assert_near(solution.optimum().unwrap(), expected.as_slice(), 1e-9 * (1.0 + expected.amax()));
}

#[test]
fn ten_levels_of_equal_rows_with_different_targets() {
    let a = entries(3, 6, 10);
    let first = dvector![0.5, -1.0, 0.25];
    let mut levels: Vec<_> =
        (0..10).map(|k| equalities(&a, &first.add_scalar(f64::from(k)))).collect();
    levels.push(towards(&DVector::zeros(6)));
    let problem = hierarchy(6, levels);
    let solution = solved(&problem);
    assert!((&a * vector(&solution) - first).amax() < 1e-12);
    for (k, violation) in violations(&problem, &solution)[..10].iter().enumerate() {
        assert!((violation - k as f64 * 3.0_f64.sqrt()).abs() < 1e-11);
    }
}

#[test]
fn an_equality_that_bounds_forbid() {
    let sum = equalities(&dmatrix![1.0, 1.0, 1.0], &dvector![10.0]);
    let problem = boxed(hierarchy(3, [sum, towards(&DVector::zeros(3))]), 1.0);
    let solution = solved(&problem);
    assert_near(solution.optimum().unwrap(), &[1.0, 1.0, 1.0], 1e-12);
    assert_near(&violations(&problem, &solution)[..1], &[7.0], 1e-12);
}

#[test]
fn unbounded_directions_take_the_least_norm() {
    let solution =
        solved(&hierarchy(4, [equalities(&dmatrix![3.0, 4.0, 0.0, 0.0], &dvector![25.0])]));
    assert_near(solution.optimum().unwrap(), &[3.0, 4.0, 0.0, 0.0], 1e-12);
}

#[test]
fn hard_rows_that_meet_at_the_origin() {
    // At the only feasible point, x = 0, rounding has nothing to be relative to.
    let rows = dmatrix![
        -1.3125, -1.0; 0.625, -1.0; -1.625, -1.0; -1.25, -1.0; 2.875, -1.0; -0.3125, -1.0;
        0.1, 1.0; -0.1, 1.0; -1.0, 0.0
    ];
    let meeting = upper_limits(&rows, &DVector::zeros(9));
    let pull = equalities(&dmatrix![3.0, 0.7; 0.3, -1.0], &dvector![5.0, 2.0]);
    let problem = hierarchy(2, [pull.with_constraints(meeting)]);
    let mut solver = Solver::new(&problem, Settings::default()).unwrap();
    for _ in 0..3 {
        assert_near(solver.solve(&problem).unwrap().optimum().unwrap(), &[0.0, 0.0], 1e-12);
    }
}

#[test]
fn a_warm_start_after_everything_turned_round() {
    // The active set of the first problem is as wrong as possible for the second.
    let rows = entries(12, 6, 20);
    let problem = |sign: f64| {
        let constraints = upper_limits(&(&rows * sign), &DVector::repeat(12, 0.1));
        let target = entries(1, 6, 21).transpose().column(0) * (5.0 * sign);
        boxed(hierarchy(6, [Level::constraints_only(constraints), towards(&target)]), 0.3)
    };
    let mut solver = Solver::new(&problem(1.0), Settings::default()).unwrap();
    for k in 0..6 {
        let problem = problem(if k % 2 == 0 { 1.0 } else { -1.0 });
        let warm = solver.solve(&problem).unwrap().clone();
        assert_near(warm.optimum().unwrap(), solved(&problem).optimum().unwrap(), 1e-9);
    }
}

#[test]
fn a_row_left_open_by_rounding_alone() {
    // The second constraint lies in the span of what the quadratic decides, up to rounding.
    let first = dmatrix![-0.09375, -0.0625, -0.0390625, -0.0546875, -0.015625, 0.203125];
    let first = Rows::ranges(&first, &dvector![0.1373291], &dvector![0.5748291]).unwrap();
    let second = dmatrix![0.0, 15.0, -34.0, 21.0, -10.0, 21.0];
    let second = upper_limits(&second, &dvector![-17.60938]);
    #[rustfmt::skip]
    let hessian = dmatrix![
        6351.37451171875, -3034.5849609375, -5582.6402587890625, 3716.1026611328125, -1980.573486328125, 2021.827392578125;
        -3034.5849609375, 1920.130859375, 2659.644287109375, -1242.479248046875, 304.43896484375, -1211.89404296875;
        -5582.6402587890625, 2659.644287109375, 5867.9261474609375, -3280.248291015625, 2913.5467529296875, -2077.54833984375;
        3716.1026611328125, -1242.479248046875, -3280.248291015625, 2778.6539306640625, -1892.6236572265625, 906.046142578125;
        -1980.573486328125, 304.43896484375, 2913.5467529296875, -1892.6236572265625, 2899.52783203125, -663.070556640625;
        2021.827392578125, -1211.89404296875, -2077.54833984375, 906.046142578125, -663.070556640625, 868.74853515625
    ];
    let gradient = dvector![
        -4088.9156131744385,
        1969.2513999938965,
        3604.112009048462,
        -2374.801612854004,
        1266.239309310913,
        -1313.1487426757813
    ];
    let quadratic = Level::quadratic(&hessian, &gradient).unwrap().with_constraints(second);
    let problem = hierarchy(6, [Level::constraints_only(first), quadratic]);
    let mut with_norm = problem.clone();
    with_norm.push(towards(&DVector::zeros(6))).unwrap();
    let expected = solve_reference(&with_norm).unwrap();
    assert_near(solved(&problem).optimum().unwrap(), expected.as_slice(), 1e-6);
    assert_near(solved(&with_norm).optimum().unwrap(), expected.as_slice(), 1e-6);
}

/// Variables with zero coefficients in the contradicting rows may be large.
#[test]
fn large_variables_hide_no_contradiction_of_others() {
    let soft = Rows::at_least(&dmatrix![1.0, 0.0, 0.0; 1.0, 0.002, 0.0], &[1.0, 2.0]).unwrap();
    let hard = Rows::ranges(
        &dmatrix![0.0, 0.0, 1.0; 0.0, 0.0, 1.0],
        &dvector![2e-9, -FREE],
        &dvector![FREE, -2e-9],
    )
    .unwrap();
    let problem = hierarchy(3, [Level::least_squares(soft), Level::constraints_only(hard)]);
    let mut solver = Solver::new(&problem, Settings::default()).unwrap();
    let error = solver.solve(&problem).unwrap_err();
    assert!(matches!(error, Error::Infeasible { level, .. } if level.index() == 1), "{error}");
}

/// One of two equal variables is factored. The rounding of the other's row then meets a gradient of
/// zero, and is no slope.
#[test]
fn a_quadratic_that_only_rounding_tilts_is_bounded() {
    let hessian = dmatrix![1.0, 1.0, 1.0; 1.0, 2.0, 2.0; 1.0, 2.0, 2.0];
    let level = Level::quadratic(&hessian, &dvector![1.0, 0.0, 0.0]).unwrap();
    let solution = solved(&hierarchy(3, [level]));
    assert_near(solution.optimum().unwrap(), &[-2.0, 0.5, 0.5], 1e-12);
}

/// The row changes by 1e-5 of the step to the target, which lies beyond it. The optimum is the target's projection.
#[test]
fn coarse_ranks_let_no_hard_row_pass() {
    let (row, bound) = (dvector![1e-5, 1.0], 1e-3);
    let target = dvector![1000.0, 0.0];
    let beyond = row.dot(&target) - bound;
    let expected = &target - &row * (beyond / row.norm_squared());
    let hard = upper_limits(&DMatrix::from_row_slice(1, 2, row.as_slice()), &dvector![bound]);
    let problem = hierarchy(2, [Level::constraints_only(hard), towards(&target)]);
    for rank_tolerance in [1e-10, 1e-6, 1e-4] {
        let settings = Settings { rank_tolerance, ..Settings::default() };
        let mut solver = Solver::new(&problem, settings).unwrap();
        for _cold_then_warm in 0..2 {
            let solution = solver.solve(&problem).unwrap();
            assert_near(solution.optimum().unwrap(), expected.as_slice(), 1e-9);
        }
    }
}
