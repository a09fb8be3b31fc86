//! Rows of very different weights in one level, judged by extended precision and exact arithmetic.
//!
//! `AHQP_CASES=100000 cargo test --release -p ahqp-core --test it weights -- --nocapture` tries as
//! many cases as requested, and reports the progress. `AHQP_FIRST=100000` continues where that
//! ends.
#![allow(clippy::print_stderr)] // which cases are wrong, and how many

mod judge;
mod sequences;

use std::ops::Range;

use ahqp_core::{Error, Hierarchy, Level, Rows, Settings, Solver, Status, WarmStart};
use nalgebra::{DMatrix, dmatrix, dvector};
use proptest::prelude::*;
use proptest::test_runner::TestRng;

use crate::exact::{enumerate_exactly, solve_exactly};
use crate::extended::solve_extended;
use crate::written::read;
use judge::{Verdict, distance, exact_optimum, judge, judge_against};
use sequences::{Shape, sequence, task_over_posture, with_ties};

/// Returns the number in an environment variable.
fn given(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|value| value.parse().ok())
}

fn seeds(default_count: u64) -> Range<u64> {
    let first = given("AHQP_FIRST").unwrap_or(0);
    first..first + given("AHQP_CASES").unwrap_or(default_count)
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
fn possible_rounding_is_left_to_exact_arithmetic() {
    let range = |row: [f64; 2], lower: f64, upper: f64| {
        let (lower, upper) = (dvector![lower], dvector![upper]);
        Rows::ranges(&DMatrix::from_row_slice(1, 2, &row), &lower, &upper).unwrap()
    };
    let hierarchy = |tasks: [Rows; 2], hard: Rows| {
        let mut hierarchy = Hierarchy::new(2).unwrap();
        let [first, second] = tasks.map(Level::least_squares);
        hierarchy.push(first.with_constraints(hard)).unwrap();
        hierarchy.push(second).unwrap();
        hierarchy
    };
    let task = || [range([1.0, 0.0], 1.0, 1.0), range([1.0, 1.0], 3.0, 3.0)];
    let next = 1.0 + f64::EPSILON;
    let no_limit = f64::NEG_INFINITY;
    let agreeing = [range([1.0, 1.0], 2.0, 2.0), range([1.0, 1.0 + 1e-12], 3.0, 3.0)];
    for (tasks, hard, x, is_decided) in [
        (task(), range([1.0, 0.0], no_limit, 2.0), [1.0, 2.0], true),
        (task(), range([1.0, 0.0], no_limit, 1.0), [1.0, 2.0], true),
        (task(), range([1.0, 0.0], no_limit, next), [1.0, 2.0], false),
        (agreeing, range([1.0, 0.0], -1e3, 1e3), [-1e3, 1002.0], false),
    ] {
        let hierarchy = hierarchy(tasks, hard);
        let extended = solve_extended(&hierarchy, &x);
        assert_eq!(extended.is_some(), is_decided, "{extended:?}");
        assert_eq!(judge(&hierarchy, &x), Verdict::Right);
    }
}

#[test]
fn an_answer_that_is_off_is_called_wrong() {
    for seed in 0..10 {
        let hierarchy = &sequence(&mut random(seed), 1..=5, 3.0)[0];
        let mut x = exact_optimum(hierarchy, &vec![0.0; hierarchy.variables()]).unwrap();
        assert_eq!(judge(hierarchy, &x), Verdict::Right);
        x[0] += 1e-5 * (1.0 + x[0].abs());
        let verdict = judge(hierarchy, &x);
        assert!(
            matches!(verdict, Verdict::Wrong { error, sensitivity }
                if (error - 1e-5).abs() < 1e-9 && sensitivity < 1e-7),
            "seed {seed}: {verdict:?}"
        );
    }
}

#[test]
fn light_rows_reach_their_targets_beside_heavy_rows() {
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
fn light_rows_decide_what_heavy_rows_leave_free() {
    let mut rows = DMatrix::zeros(4, 3);
    rows.row_mut(0).copy_from_slice(&[-29591.133986942354, 862264.233791402, 97763.13000674319]);
    rows.view_mut((1, 0), (3, 3)).fill_with_identity();
    let targets =
        dvector![-462426.9883742105, -0.7806977756366398, -0.7067743274016007, 0.7809912430805821];
    let hierarchy = one_level(&[(-0.5, 0.5); 3], Rows::equalities(&rows, &targets).unwrap());
    expect_right(&mut Solver::new(&hierarchy, Settings::default()).unwrap(), &hierarchy);
}

#[test]
fn light_rows_count_beside_a_blocked_heavy_row() {
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

/// Counts of the verdicts on answers.
///
/// Answers are right and certified, right but doubted by their certificates, or wrong. Others are
/// refused as inaccurate by the solver, or beyond double precision. Ticks that extended precision
/// leaves to exact arithmetic are counted too.
#[derive(Debug, Default, PartialEq)]
struct Tally {
    right: usize,
    doubted: usize,
    wrong: usize,
    silently_wrong: usize,
    refused: usize,
    sensitive: usize,
    left_to_exact: usize,
}

impl Tally {
    /// Returns true if few answers were excluded because rounded data do not determine them, and
    /// almost no right answer was doubted.
    fn is_telling(&self) -> bool {
        100 * (self.sensitive + self.refused) <= self.right && 1000 * self.doubted <= self.right
    }

    /// Returns true if 99.9 % of all answers are right and certified, and no wrong one is.
    fn is_nearly_all_right(&self) -> bool {
        let others = self.doubted + self.wrong + self.refused + self.sensitive;
        1000 * others <= self.right + others && self.silently_wrong == 0
    }
}

/// Solves the ticks of random sequences one after the other, cold and warm, and judges every
/// answer.
fn try_sequences(seeds: Range<u64>, sequence: impl Fn(&mut TestRng) -> Vec<Hierarchy>) -> Tally {
    let mut tally = Tally::default();
    let certify_all = given("AHQP_CASES").is_some();
    for seed in seeds.clone() {
        let ticks = sequence(&mut random(seed));
        let n = ticks[0].variables();
        let cold = Settings { warm_start: WarmStart::Cold, ..Settings::default() };
        let mut solvers =
            [cold, Settings::default()].map(|settings| Solver::new(&ticks[0], settings).unwrap());
        for (k, hierarchy) in ticks.iter().enumerate() {
            let answers = solvers.each_mut().map(|solver| match solver.solve(hierarchy) {
                Ok(solution) => {
                    assert_eq!(solution.status(), Status::Solved, "seed {seed}, tick {k}");
                    Some(solution.optimum().unwrap().to_vec())
                }
                Err(Error::Inaccurate { .. }) => None,
                Err(error) => panic!("seed {seed}, tick {k}: {error}"),
            });
            let guess = answers.iter().flatten().next().cloned().unwrap_or_else(|| vec![0.0; n]);
            let optimum = solve_extended(hierarchy, &guess).unwrap_or_else(|| {
                tally.left_to_exact += 1;
                exact_optimum(hierarchy, &guess).unwrap()
            });
            for (i, answer) in answers.iter().enumerate() {
                let which = format!("seed {seed}, tick {k}, warm {i}, n {n}");
                let Some(x) = answer else {
                    eprintln!("{which}: refused");
                    tally.refused += 1;
                    continue;
                };
                let verdict = judge_against(hierarchy, x, &optimum);
                // Certificates take longer than solves. If there are few cases, only some right
                // answers are certified.
                if verdict == Verdict::Right && !certify_all && seed % 8 > 0 {
                    tally.right += 1;
                    continue;
                }
                let certificate = solvers[i].certificate(hierarchy).unwrap();
                let worst = certificate.residuals(hierarchy, x).unwrap().worst();
                match verdict {
                    Verdict::Right if worst < 1e-8 => tally.right += 1,
                    Verdict::Right => {
                        eprintln!("{which}: right, but its certificate says {worst:e}");
                        tally.doubted += 1;
                    }
                    Verdict::Wrong { sensitivity, .. } if sensitivity > 1e-7 => {
                        tally.sensitive += 1;
                    }
                    Verdict::Wrong { error, sensitivity } => {
                        eprintln!(
                            "{which}: off by {error:e}, certificate {worst:e}, sensitivity \
                             {sensitivity:e}"
                        );
                        tally.wrong += 1;
                        tally.silently_wrong += usize::from(worst < 1e-8);
                    }
                }
            }
        }
        let done = seed + 1 - seeds.start;
        let is_told = done.is_multiple_of(1000) || seed + 1 == seeds.end;
        if is_told && given("AHQP_CASES").is_some() {
            eprintln!("{done} sequences from {}: {tally:?}", seeds.start);
        }
    }
    tally
}

#[test]
fn weights_of_a_million_leave_every_variable_right() {
    let tally = try_sequences(seeds(100), |random| sequence(random, 3..=10, 3.0));
    assert_eq!(tally.wrong, 0, "{tally:?}");
    assert!(tally.is_telling(), "{tally:?}");
}

#[test]
fn weights_of_a_hundred_million_nearly_always_succeed() {
    let tally = try_sequences(seeds(100), |random| sequence(random, 3..=10, 4.0));
    assert!(tally.is_nearly_all_right(), "{tally:?}");
}

#[test]
fn a_task_over_posture_is_nearly_always_right() {
    let tally = try_sequences(seeds(100), task_over_posture);
    assert!(tally.is_nearly_all_right(), "{tally:?}");
}

#[test]
fn small_hierarchies_of_all_weights_come_out_right() {
    for spread in [1.0, 3.0, 6.0] {
        let tally = try_sequences(seeds(100), |random| sequence(random, 1..=4, spread));
        assert_eq!(tally.wrong, 0, "{tally:?}");
        assert!(tally.is_telling(), "{tally:?}");
    }
}

fn ties(spread: f64) -> impl Fn(&mut TestRng) -> Vec<Hierarchy> {
    move |random| sequence(random, 2..=4, spread).into_iter().map(with_ties).collect()
}

/// Rounding drops a row that immediately becomes active again, and must not repeat this endlessly.
#[test]
fn a_row_that_returns_at_once_never_cycles() {
    for text in [
        include_str!("written/tie.txt"),
        include_str!("written/tie_of_weights.txt"),
        include_str!("written/tie_of_great_weights.txt"),
    ] {
        let ticks = read(text);
        let cold = Settings { warm_start: WarmStart::Cold, ..Settings::default() };
        for settings in [cold, Settings::default()] {
            let mut solver = Solver::new(&ticks[0], settings).unwrap();
            for hierarchy in &ticks {
                let solution = solver.solve(hierarchy).unwrap();
                assert_eq!(solution.status(), Status::Solved);
                assert_eq!(judge(hierarchy, solution.optimum().unwrap()), Verdict::Right);
            }
        }
    }
}

#[test]
fn rows_that_tie_come_out_right() {
    for spread in [0.0, 3.0, 4.0] {
        let tally = try_sequences(seeds(100), ties(spread));
        assert!(tally.is_telling(), "spread {spread}: {tally:?}");
        assert_eq!(tally.silently_wrong, 0, "spread {spread}: {tally:?}");
        // The forces of a level differ by up to 10^(4 spread), which exceeds double precision.
        let most = tally.right / if spread < 4.0 { 100_000 } else { 1000 };
        assert!(tally.wrong <= most, "spread {spread}: {tally:?}");
    }
}

/// The heavy row is held at its bound, where the hard row and the light one tie. Multipliers in
/// doubles do not show the light row, but the certificate does.
#[test]
fn a_light_row_counts_at_a_degenerate_point() {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    hierarchy.set_bounds(&dvector![-1.0, -1.0], &dvector![1.0, 1.0]).unwrap();
    let soft = Rows::equalities(&dmatrix![0.0, 1e4; 2e-4, 1e-4], &dvector![1.5e4, -1.5e-4]);
    let hard = Rows::ranges(&dmatrix![1.0, -1.0], &dvector![-1.5], &dvector![1.5]);
    let level = Level::least_squares(soft.unwrap()).with_constraints(hard.unwrap());
    hierarchy.push(level).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
    assert!((x[0] + 0.5).abs() < 1e-9 && (x[1] - 1.0).abs() < 1e-12, "{x:?}");
    let certificate = solver.certificate(&hierarchy).unwrap();
    assert!(certificate.residuals(&hierarchy, &x).unwrap().worst() < 1e-9);
    let off = certificate.residuals(&hierarchy, &[0.5, 1.0]).unwrap();
    assert!((off.distance.unwrap() - 1.0).abs() < 1e-9, "{off:?}");
}

/// Extended precision almost always decides, from a good or a bad guess, and then agrees with exact
/// arithmetic.
#[test]
fn extended_precision_finds_the_exact_optimum() {
    let (mut decided, mut count) = (0, 0);
    for seed in seeds(12) {
        for (k, spread) in [1.0, 3.0, 4.0, 6.0].into_iter().enumerate() {
            let mut random = random(4 * seed + k as u64);
            let ticks = match seed % 4 {
                0 => task_over_posture(&mut random),
                1 => sequence(&mut random, 3..=8, spread),
                _ => sequence(&mut random, 1..=4, spread),
            };
            let mut solver = Solver::new(&ticks[0], Settings::default()).unwrap();
            let answer = solver.solve(&ticks[0]).unwrap().optimum().unwrap().to_vec();
            let exact = exact_optimum(&ticks[0], &answer).unwrap();
            for off in [1e-12, 0.1] {
                let nearby = exact.iter().map(|x| x + off * random.random_range(-1.0..1.0));
                let guess: Vec<f64> = nearby.map(|x| x.clamp(-1.0, 1.0)).collect();
                let extended = solve_extended(&ticks[0], &guess);
                if off < 1e-9 {
                    count += 1;
                    decided += usize::from(extended.is_some());
                }
                if let Some(x) = extended {
                    let error = distance(&x, &exact);
                    assert!(error <= 1e-12, "seed {seed}, spread {spread}: off by {error:e}");
                }
            }
        }
    }
    assert!(100 * decided >= 95 * count, "{decided} of {count}");
}

/// Returns default settings except one tolerance, which has a random accepted value.
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
fn the_answer_is_independent_of_tolerances_and_start() {
    for seed in seeds(40) {
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
    fn the_exact_optimum_is_independent_of_the_guess(
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
