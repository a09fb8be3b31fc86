//! Rows of very different weights in one level, judged by exact arithmetic.
//!
//! `AHQP_CASES=100000 cargo test --release -p ahqp-core --test it weights` tries as many as one likes.
#![allow(clippy::print_stderr)] // which cases are wrong, and how many

use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver, Status, WarmStart};
use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use proptest::prelude::*;
use proptest::test_runner::TestRng;

use crate::exact::{double, enumerate_exactly, solve_exactly};

/// What exact arithmetic says of an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Verdict {
    /// Right to 1e-6 (1 + |x|) in each variable.
    Right,
    /// Off by so much, and by how much the exact optimum moves when the data move by 1e-15.
    Wrong { error: f64, sensitivity: f64 },
}

fn cases(default: usize) -> usize {
    std::env::var("AHQP_CASES").ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / (1.0 + b.abs())).fold(0.0, f64::max)
}

fn judge(hierarchy: &Hierarchy, x: &[f64]) -> Verdict {
    let exact = solve_exactly(hierarchy, x).unwrap();
    let exact: Vec<f64> = exact.iter().map(double).collect();
    let error = distance(x, &exact);
    if error <= 1e-6 {
        return Verdict::Right;
    }
    let moved = |seed| {
        let near = perturbed(hierarchy, seed);
        solve_exactly(&near, &exact)
            .map_or(f64::INFINITY, |x| distance(&x.iter().map(double).collect::<Vec<_>>(), &exact))
    };
    Verdict::Wrong { error, sensitivity: (0..4).map(moved).fold(0.0, f64::max) }
}

/// The hierarchy with every coefficient and target off by up to 1e-15 of it.
fn perturbed(hierarchy: &Hierarchy, seed: u64) -> Hierarchy {
    let mut random = random(seed);
    let mut other = hierarchy.clone();
    for id in other.ids() {
        let level = other.level_mut(id).unwrap();
        for hard in [true, false] {
            let rows = if hard { Ok(level.constraints_mut()) } else { level.rows_mut() };
            let Ok(rows) = rows else { continue };
            let mut nudge = |value: &mut f64| *value *= 1.0 + random.random_range(-1e-15..1e-15);
            for i in 0..rows.len() {
                rows.row_mut(i).unwrap().iter_mut().for_each(&mut nudge);
                let is_equality = rows.lower()[i] == rows.upper()[i];
                nudge(&mut rows.upper_mut()[i]);
                if is_equality {
                    rows.lower_mut()[i] = rows.upper()[i];
                } else {
                    nudge(&mut rows.lower_mut()[i]);
                }
            }
        }
    }
    other
}

fn random(seed: u64) -> TestRng {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    TestRng::from_seed(proptest::test_runner::RngAlgorithm::ChaCha, &bytes)
}

fn one_level(bounds: &[(f64, f64)], rows: Rows) -> Hierarchy {
    let mut hierarchy = Hierarchy::new(bounds.len()).unwrap();
    let (lower, upper) = hierarchy.bounds_mut();
    for (i, &(l, u)) in bounds.iter().enumerate() {
        (lower[i], upper[i]) = (l, u);
    }
    hierarchy.push(Level::least_squares(rows)).unwrap();
    hierarchy
}

fn expect_right(solver: &mut Solver, hierarchy: &Hierarchy) {
    let solution = solver.solve(hierarchy).unwrap();
    assert_eq!(solution.status(), Status::Solved);
    let x = solution.optimum().unwrap().to_vec();
    assert_eq!(judge(hierarchy, &x), Verdict::Right, "{x:?}");
    let residuals = solver.certificate(hierarchy).unwrap().residuals(hierarchy, &x).unwrap();
    assert!(residuals.worst() < 1e-8, "{residuals:?}");
}

#[test]
fn a_light_row_follows_its_target_beside_a_heavy_one_that_cannot() {
    for (weight, target) in [(1e6, 50.0), (1e4, 0.51), (1e6, 0.51)] {
        let at = |target: f64| {
            let rows = dmatrix![weight, 0.0; 0.0, 1.0];
            let rows = Rows::equalities(&rows, &dvector![2.0 * weight, target]).unwrap();
            one_level(&[(-1.0, 1.0), (0.5, 100.0)], rows)
        };
        let mut solver = Solver::new(&at(0.0), Settings::default()).unwrap();
        for target in [-2000.0, target] {
            expect_right(&mut solver, &at(target));
        }
        let x = solver.solve(&at(target)).unwrap().optimum().unwrap().to_vec();
        assert!((x[1] - target).abs() < 1e-9, "{x:?}");
    }
}

#[test]
fn light_rows_count_in_what_a_heavy_one_leaves() {
    let mut rows = DMatrix::zeros(4, 3);
    rows.row_mut(0).copy_from_slice(&[-29591.133986942354, 862264.233791402, 97763.13000674319]);
    rows.view_mut((1, 0), (3, 3)).fill_with_identity();
    let targets =
        dvector![-462426.9883742105, -0.7806977756366398, -0.7067743274016007, 0.7809912430805821];
    let hierarchy = one_level(&[(-0.5, 0.5); 3], Rows::equalities(&rows, &targets).unwrap());
    expect_right(&mut Solver::new(&hierarchy, Settings::default()).unwrap(), &hierarchy);
}

#[test]
fn a_light_row_is_heard_where_a_heavy_one_pulls_in_vain() {
    let heavy = dmatrix![0.0, 100.0; 0.01, 0.01];
    let far = dmatrix![0.0, 1.0; 1.0, 1.0];
    for (rows, targets) in [(heavy, dvector![-1e5, -0.1]), (far, dvector![-1e12, -10.0])] {
        let rows = Rows::equalities(&rows, &targets).unwrap();
        let hierarchy = one_level(&[(-1.0, 1.0), (-2.0, 2.0)], rows);
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        expect_right(&mut solver, &hierarchy);
        assert!((solver.solve(&hierarchy).unwrap().optimum().unwrap()[0] + 1.0).abs() < 1e-9);
    }
}

/// Random hierarchies of one shape whose rows have weights 10^U(−spread, spread), all variables
/// bounded, the last level near a target.
struct Shape {
    variables: usize,
    levels: Vec<usize>,
    hard: usize,
    spread: f64,
    /// For each row of the levels, its weight.
    weights: Vec<f64>,
    coefficients: Vec<f64>,
    equality: Vec<bool>,
}

impl Shape {
    fn random(random: &mut TestRng, variables: usize, spread: f64) -> Self {
        let levels: Vec<usize> = (0..random.random_range(1..=3))
            .map(|_| random.random_range(1..=variables.min(5)))
            .collect();
        let hard = random.random_range(0..=2);
        let count = levels.iter().sum::<usize>() + hard;
        Self {
            variables,
            hard,
            spread,
            weights: (0..count)
                .map(|_| 10_f64.powf(random.random_range(-spread..=spread)))
                .collect(),
            coefficients: (0..count * variables).map(|_| random.random_range(-1.0..1.0)).collect(),
            equality: (0..count).map(|_| random.random_bool(0.6)).collect(),
            levels,
        }
    }

    /// A tick: the same rows, slightly moved, with targets that jump.
    fn tick(&self, random: &mut TestRng) -> Hierarchy {
        let n = self.variables;
        let mut hierarchy = Hierarchy::new(n).unwrap();
        let (lower, upper) = hierarchy.bounds_mut();
        lower.fill(-1.0);
        upper.fill(1.0);
        let mut at = 0;
        let mut hard = Some(self.hard);
        for &count in &self.levels {
            let rows = self.rows(random, &mut at, count, false);
            let mut level = Level::least_squares(rows);
            if let Some(hard) = hard.take() {
                level = level.with_constraints(self.rows(random, &mut at, hard, true));
            }
            hierarchy.push(level).unwrap();
        }
        let near = DVector::from_fn(n, |_, _| random.random_range(-1.5..1.5));
        let identity = DMatrix::identity(n, n) * 10_f64.powf(-self.spread);
        let near = near * 10_f64.powf(-self.spread);
        hierarchy.push(Level::least_squares(Rows::equalities(&identity, &near).unwrap())).unwrap();
        hierarchy
    }

    fn rows(&self, random: &mut TestRng, at: &mut usize, count: usize, hard: bool) -> Rows {
        let n = self.variables;
        let mut rows = Rows::zeros(count, n);
        for i in 0..count {
            let weight = self.weights[*at];
            let row = &self.coefficients[*at * n..(*at + 1) * n];
            for (to, from) in rows.row_mut(i).unwrap().iter_mut().zip(row) {
                *to = weight * (from + 1e-3 * random.random_range(-1.0..1.0));
            }
            let far = if random.random_bool(0.1) { 100.0 } else { 2.0 };
            let target = weight * random.random_range(-far..far);
            // Zero satisfies every hard row.
            let (lower, upper) = if hard {
                (-target.abs(), random.random_range(0.0..1.0) * weight)
            } else if self.equality[*at] {
                (target, target)
            } else {
                (target, target + weight * random.random_range(0.0..1.0))
            };
            (rows.lower_mut()[i], rows.upper_mut()[i]) = (lower, upper);
            *at += 1;
        }
        rows
    }
}

/// How many ticks were right, wrong, and beyond double precision.
#[derive(Debug, Default, PartialEq)]
struct Tally {
    right: usize,
    wrong: usize,
    silently_wrong: usize,
    sensitive: usize,
}

impl Tally {
    /// Returns true if few answers were left out because rounded data do not determine them.
    fn is_telling(&self) -> bool {
        100 * self.sensitive <= self.right
    }
}

fn try_sequences(count: usize, variables: std::ops::RangeInclusive<usize>, spread: f64) -> Tally {
    let mut tally = Tally::default();
    let first: u64 =
        std::env::var("AHQP_FIRST").ok().and_then(|value| value.parse().ok()).unwrap_or(0);
    for seed in 0..count as u64 {
        let mut random = random(first + seed);
        let n = random.random_range(variables.clone());
        let shape = Shape::random(&mut random, n, spread);
        let ticks: Vec<Hierarchy> = (0..4).map(|_| shape.tick(&mut random)).collect();
        let cold = Settings { warm_start: WarmStart::Cold, ..Settings::default() };
        let mut solvers =
            [cold, Settings::default()].map(|settings| Solver::new(&ticks[0], settings).unwrap());
        for (k, hierarchy) in ticks.iter().enumerate() {
            for (i, solver) in solvers.iter_mut().enumerate() {
                let solution = solver.solve(hierarchy).unwrap();
                assert_eq!(solution.status(), Status::Solved);
                let x = solution.optimum().unwrap().to_vec();
                match judge(hierarchy, &x) {
                    Verdict::Right => tally.right += 1,
                    Verdict::Wrong { sensitivity, .. } if sensitivity > 1e-7 => {
                        tally.sensitive += 1;
                    }
                    Verdict::Wrong { error, sensitivity } => {
                        let certificate = solver.certificate(hierarchy).unwrap();
                        let worst = certificate.residuals(hierarchy, &x).unwrap().worst();
                        eprintln!(
                            "seed {seed}, tick {k}, warm {i}, n {n}: off by {error:e}, certificate \
                             {worst:e}, sensitivity {sensitivity:e}"
                        );
                        tally.wrong += 1;
                        tally.silently_wrong += usize::from(worst < 1e-8);
                    }
                }
            }
        }
    }
    eprintln!("{tally:?}");
    tally
}

#[test]
fn rows_a_million_times_heavier_than_others_leave_every_variable_right() {
    let tally = try_sequences(cases(5), 3..=10, 3.0);
    assert_eq!(tally.wrong, 0, "{tally:?}");
    assert!(tally.is_telling(), "{tally:?}");
}

#[test]
fn small_hierarchies_of_all_weights_come_out_right() {
    for spread in [1.0, 3.0, 6.0] {
        let tally = try_sequences(cases(12), 1..=4, spread);
        assert_eq!(tally.wrong, 0, "{tally:?}");
        assert!(tally.is_telling(), "{tally:?}");
    }
}

/// Default settings but for one tolerance, of any size that is accepted.
fn random_settings(random: &mut TestRng) -> Settings {
    let mut settings = Settings::default();
    let tolerances = [
        &mut settings.feasibility_tolerance,
        &mut settings.optimality_tolerance,
        &mut settings.rank_tolerance,
    ];
    let index = random.random_range(0..tolerances.len());
    if let Some(tolerance) = tolerances.into_iter().nth(index) {
        *tolerance = 10_f64.powf(random.random_range(-11.0..=-4.0));
    }
    settings
}

#[test]
fn the_answer_depends_on_no_tolerance_and_no_start() {
    for seed in 0..cases(40) as u64 {
        let mut random = random(seed);
        let variables = random.random_range(1..=4);
        let spread = [1.0, 3.0][random.random_range(0..2)];
        let shape = Shape::random(&mut random, variables, spread);
        let ticks: Vec<Hierarchy> = (0..4).map(|_| shape.tick(&mut random)).collect();
        let warm = random_settings(&mut random);
        let cold = Settings { warm_start: WarmStart::Cold, ..warm };
        let mut solvers = [warm, cold].map(|settings| Solver::new(&ticks[0], settings).unwrap());
        for (k, hierarchy) in ticks.iter().enumerate() {
            let [warm, cold] = solvers
                .each_mut()
                .map(|solver| solver.solve(hierarchy).unwrap().optimum().unwrap().to_vec());
            let context = format!("seed {seed}, tick {k}: {warm:?}, {cold:?}");
            assert!(distance(&warm, &cold) < 1e-7, "{context}");
            assert_eq!(judge(hierarchy, &warm), Verdict::Right, "{context}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn the_exact_optimum_depends_on_no_guess_and_is_what_all_active_sets_give(
        seed in 0..1000_u64, off in prop::collection::vec(-1.0..1.0_f64, 2),
    ) {
        let mut random = random(seed);
        let hierarchy = Shape::random(&mut random, 2, 1.0).tick(&mut random);
        let exact = solve_exactly(&hierarchy, &[0.0; 2]);
        prop_assert!(exact.is_some());
        prop_assert_eq!(&exact, &solve_exactly(&hierarchy, &off));
        prop_assert_eq!(&exact, &enumerate_exactly(&hierarchy, &off));
    }
}
