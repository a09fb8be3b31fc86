//! Rows whose terms are all small beside the largest variable. They hold relative to their own
//! size. Forces smaller than the rounding of other sums still count.

use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver, Status, solve_reference};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Creates rows, each given as its coefficients followed by its lower and upper bound.
fn rows<const WIDTH: usize>(of: &[[f64; WIDTH]]) -> Rows {
    let variables = WIDTH - 2;
    let matrix = DMatrix::from_fn(of.len(), variables, |row, column| of[row][column]);
    let column = |column: usize| DVector::from_iterator(of.len(), of.iter().map(|row| row[column]));
    Rows::ranges(&matrix, &column(variables), &column(variables + 1)).unwrap()
}

/// Returns the violation of each level at the optimum.
fn violations(hierarchy: &Hierarchy) -> Vec<f64> {
    let mut solver = Solver::new(hierarchy, Settings::default()).unwrap();
    let solution = solver.solve(hierarchy).unwrap();
    assert_eq!(solution.status(), Status::Solved);
    let x = solution.optimum().unwrap();
    hierarchy.levels().iter().map(|level| level.violation(x).unwrap()).collect()
}

#[test]
fn tiny_rows_hold_beside_large_variables() {
    let hard = rows(&[
        [0.0, -1.0, 0.0, -1.0, -3.5e-14],
        [0.0, -1.0, 0.0, -1.0, -3.3e-13],
        [-0.19, 1.0, 1.0, -1.0, -0.15],
    ]);
    let soft = rows(&[[0.0, -1.0, 1.0, 0.0, 1.0], [0.0, 1.0, 0.0, -1.0, 0.0]]);
    let below = rows(&[[1.0, 1.0, 1.0, -1.0, 1.0], [0.0, 1.0, 1.0, -1.0, 1.0]]);
    let last = rows(&[
        [1.0, 1.0, 1.0, -1.0, 0.0],
        [1.0, 1.0, 1.0, -1.0, 0.0],
        [1.0, 1.0, 1.0, -1.0, 0.0],
        [1.0, 1.0, 1.0, 0.0, 0.0],
        [1.0, 1.0, 1.0, -1.847126108114324, 0.0],
        [1.0, 1.0, 1.0, 0.0, 0.0],
    ]);
    let mut problem = Hierarchy::new(3).unwrap();
    problem.push(Level::constraints_only(hard)).unwrap();
    for level in [soft, below, last] {
        problem.push(Level::least_squares(level)).unwrap();
    }
    // ‖x‖ is 0.8, and the remainder is a part in 10¹³ of it.
    assert!(violations(&problem)[0] < 1e-13);
}

#[test]
fn tiny_rows_hold_against_levels_below() {
    let first = rows(&[
        [0.0, -1.0, 1.0, 0.0, 1.0, -1.0, -1.0, 1.0, 0.0, 0.0],
        [0.0, 1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.0],
    ]);
    let hard = rows(&[
        [0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, -1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, -1.0, -1.0, -1.1e-13],
        [0.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, -1.0, -1.0, -2.3e-13],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, -3.3e-13],
        [0.0, 0.036, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, -0.083],
        [1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, -1.0, 0.0],
    ]);
    let soft = rows(&[
        [0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 1.0, 1.0, -1.0, -1.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, -1.0, 0.0],
        [0.0, 0.0, -1.0, 0.0, 0.0, -1.0, 1.0, 1.0, -1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0],
    ]);
    let mut problem = Hierarchy::new(8).unwrap();
    problem.push(Level::least_squares(first)).unwrap();
    problem.push(Level::constraints_only(hard)).unwrap();
    problem.push(Level::least_squares(soft)).unwrap();
    assert!(violations(&problem)[1] < 1e-12);
}

/// Little is left of x₇ along the chain x₇ → x₆ → x₅ → x₄ → x₃ → x₁. The two contradicting rows
/// share 5.4e-10, and the row at the beginning of the chain pulls with 3e-17.
#[test]
fn a_decisive_force_below_rounding_is_kept() {
    let hard = rows(&[[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, -4.9e-3]]);
    let chain = rows(&[
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, -1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, -1.3e-3, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, -1.9e-2, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, -4.5e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]);
    let below = rows(&[[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0011565842716217, -1.0]]);
    let mut problem = Hierarchy::new(8).unwrap();
    problem.push(Level::constraints_only(hard)).unwrap();
    problem.push(Level::least_squares(chain)).unwrap();
    problem.push(Level::least_squares(below)).unwrap();
    let [hard, chain, _] = violations(&problem)[..] else { panic!("three levels") };
    assert!(hard < 1e-15, "{hard}");
    // The least norm of residuals rᵢ with Σ cᵢ rᵢ = gap, where cᵢ is the part of row i that reaches
    // x₁.
    let reach = [4.5e-3, 1.9e-2, 1.3e-3].map({
        let mut product = 1.0;
        move |factor| {
            product *= factor;
            product
        }
    });
    let squares = 2.0 + reach.iter().map(|c| c * c).sum::<f64>() + reach[2] * reach[2];
    let shared = 4.9e-3 * reach[2] / f64::sqrt(squares);
    assert!((chain - shared).abs() < 1e-15, "{chain} instead of {shared}");
}

/// The three rows of the second level depend on each other up to the last of their ten digits,
/// while no bounds are active. The rank neglects their small remainders. These count once bounds
/// become active. Otherwise x would be off by 5e-11, and the range of the first level would hold x₁
/// needlessly.
#[test]
fn neglected_remainders_count_once_bounds_are_active() {
    let first =
        rows(&[[-0.2, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0], [1.0, -1.0, 0.0, 0.0, 0.0, 0.5, 1.0]]);
    let second = rows(&[
        [0.0, 0.0, 0.9992979845, -0.3168244508, -0.5352703617, 1.0, 1.0],
        [0.0, 0.0, 0.0478899684, 0.4200191262, -0.7400931884, 1.0, 1.0],
        [0.0, 0.0, -0.8520702005, 0.6282850894, -0.1315227067, 0.2, 0.2],
    ]);
    let mut problem = Hierarchy::new(5).unwrap();
    let infinity = f64::INFINITY;
    let bounds = [infinity, infinity, 0.0, 0.0, infinity];
    problem.set_bounds(&bounds.map(|bound| -bound), &bounds).unwrap();
    for level in [first, second] {
        problem.push(Level::least_squares(level)).unwrap();
    }
    let mut solver = Solver::new(&problem, Settings::default()).unwrap();
    solver.forget();
    let x = solver.solve(&problem).unwrap().optimum().unwrap();
    // The least squares of the second level in x₄ alone, in rational arithmetic. The other
    // variables take the least norm.
    let least = -1.528_585_886_734_345;
    let expected = [-5.0 * least, -5.0 * least - 1.0, 0.0, 0.0, least];
    for (x, expected) in x.iter().zip(expected) {
        assert!((x - expected).abs() < 1e-13 * (1.0 + expected.abs()), "{x}, expected {expected}");
    }
}

/// The first row has 1e-17 of x₁, which is the rounding of products such as those of a Jacobian. It pulls at nothing,
/// also where a warm start has x₁ at its bound, and the level below moves x₁.
#[test]
fn a_coefficient_below_rounding_holds_no_bound() {
    let problem = |target: f64| {
        let mut problem = Hierarchy::new(2).unwrap();
        problem.set_bounds(&[-1.0, -1.0], &[1.0, 1.0]).unwrap();
        for row in [[1.0, 1e-17, 2.0, 2.0], [0.0, 1.0, target, target]] {
            problem.push(Level::least_squares(rows(&[row]))).unwrap();
        }
        problem
    };
    let mut solver = Solver::new(&problem(5.0), Settings::default()).unwrap();
    for (target, expected) in [(5.0, 1.0), (-5.0, -1.0), (0.25, 0.25), (5.0, 1.0), (0.5, 0.5)] {
        let x = solver.solve(&problem(target)).unwrap().optimum().unwrap();
        assert!(
            (x[1] - expected).abs() < 1e-12 && (x[0] - 1.0).abs() < 1e-12,
            "{x:?}, target {target}"
        );
    }
}

/// The level above leaves 1e-10 of the last row, which is the rank tolerance. If other bounds are
/// active, its last digits decide whether it counts as dependent. That must not move x by 10¹⁰.
#[test]
fn rows_at_the_rank_tolerance_move_nothing_decided() {
    let arm = [
        [-0.237, -0.2366, 0.237441, -0.319163, 0.0, -0.18192, 0.07464, 0.0],
        [0.1431, 0.143143, 0.5009, 0.18183184854452014, 0.0, 0.11567036649151387, 0.136483, 0.0],
        [0.0, 0.0, -0.275085, 0.00481578, 0.0, -0.0132381, 0.166771, 0.0],
        [0.0, 0.0, -0.903617, -0.0736386, 0.0, 0.172443, 0.842278, 0.2688411886582134],
        [0.0, 0.0, 0.428342, -0.15534549491440777, 0.0, 0.375432, -0.535547, 0.318797],
        [1.0, 1.0, 0.0, 0.9851, 0.0, 0.910667, 0.061, -0.9089],
    ];
    let mut first = [[0.0; 13]; 6];
    for (row, joints) in first.iter_mut().zip(arm) {
        row[..8].copy_from_slice(&joints);
    }
    (first[2][8], first[5][9]) = (-1.03, -1.03);
    let free = f64::NEG_INFINITY;
    let mut hard = [[0.0; 13]; 2];
    (hard[0][8], hard[0][11]) = (0.4, free);
    (hard[1][8], hard[1][10], hard[1][11], hard[1][12]) = (-1.92512e-8, -1.0, free, -0.3);
    let mut last = [[0.0; 13]];
    last[0][10] = 1.0;
    let mut problem = Hierarchy::new(11).unwrap();
    for (variable, value) in [(0, 0.0), (4, 0.0), (7, -0.2)] {
        let (lower, upper) = problem.bounds_mut();
        (lower[variable], upper[variable]) = (value, value);
    }
    problem.push(Level::least_squares(rows(&first))).unwrap();
    problem.push(Level::constraints_only(rows(&hard))).unwrap();
    problem.push(Level::least_squares(rows(&last))).unwrap();
    let violations = violations(&problem);
    assert!(violations[1] < 1e-12, "{violations:?}");
}

proptest! {
    /// A level repeats a small row as it is, and hidden in heavy ones that the level above has decided. What
    /// those leave of its residual is rounding, and holds no row of the level that the least norm would let go.
    #[test]
    fn rounding_of_repeated_rows_holds_no_constraint(
        heavy in prop::array::uniform9(-25..=25_i32), small in prop::array::uniform9(-25..=25_i32),
        factors in prop::collection::vec((-4..=4_i32, 1..=2_i32), 2..8),
        side in prop::collection::vec((prop::array::uniform9(-25..=25_i32), -40..=40_i32), 2),
        last in prop::array::uniform9(-25..=25_i32), targets in prop::array::uniform3(-400..=400_i32),
    ) {
        let scaled = |row: &[i32; 9], scale: f64| row.map(|entry| f64::from(entry) * scale);
        let [heavy, small, last] =
            [scaled(&heavy, 1.0), scaled(&small, 1.0 / 128.0), scaled(&last, 1.0 / 128.0)];
        let [at_heavy, at_small, at_last] = [
            f64::from(targets[0]) / 32.0,
            f64::from(targets[1]) / 4096.0,
            f64::from(targets[2]) / 4096.0,
        ];
        let equality = |row: &[f64; 9], at: f64| {
            let mut of = [at; 11];
            of[..9].copy_from_slice(row);
            of
        };
        let mut repeated = vec![equality(&small, at_small)];
        repeated.extend(factors.iter().map(|&(of_heavy, of_small)| {
            let (of_heavy, of_small) = (f64::from(of_heavy), f64::from(of_small));
            let row = std::array::from_fn(|i| of_heavy * heavy[i] + of_small * small[i]);
            equality(&row, of_heavy * at_heavy + of_small * at_small)
        }));
        let limits = |shift: f64| -> Vec<_> {
            let limit = |(row, upper): &([i32; 9], i32)| {
                let mut of = equality(&scaled(row, 1.0 / 16.0), f64::from(*upper) / 16.0 + shift);
                of[9] = f64::NEG_INFINITY;
                of
            };
            side.iter().map(limit).collect()
        };
        let problem = |shift: f64| {
            let mut problem = Hierarchy::new(9).unwrap();
            problem.push(Level::least_squares(rows(&[equality(&heavy, at_heavy)]))).unwrap();
            let middle = Level::least_squares(rows(&repeated)).with_constraints(rows(&limits(shift)));
            problem.push(middle).unwrap();
            problem.push(Level::constraints_only(rows(&[equality(&last, at_last)]))).unwrap();
            problem
        };
        // Each row once, in one level: where all can hold, the least norm is the same.
        let expected = |shift: f64| {
            let mut once = limits(shift);
            once.extend([equality(&heavy, at_heavy), equality(&small, at_small), equality(&last, at_last)]);
            let mut problem = Hierarchy::new(9).unwrap();
            problem.push(Level::constraints_only(rows(&once))).unwrap();
            solve_reference(&problem)
        };
        let mut warm = Solver::new(&problem(0.0), Settings::default()).unwrap();
        for shift in [0.0, -0.5, 0.0, 0.75, 0.0] {
            let Ok(expected) = expected(shift) else { continue };
            let x = warm.solve(&problem(shift)).unwrap().optimum().unwrap();
            let x = DVector::from_column_slice(x);
            prop_assert!((&x - &expected).norm() < 1e-5 * (1.0 + expected.norm()), "{x} {expected}");
        }
    }
}
