//! Problems as data, in `written/*.txt`, and what must be true of them.
//!
//! A problem is written as `problem VARIABLES LEVELS`, a line `LOWER UPPER` for each variable, and
//! its levels. A level is `constraints COUNT`, then `rows COUNT` or `quadratic COUNT`, each followed
//! by its rows: coefficients, lower and upper bound. A row of a quadratic is one of the Hessian,
//! followed by the entry of the gradient.

use proptest::prelude::*;
use std::str::Lines;

use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver, Status, WarmStart};
use nalgebra::{DMatrix, DVector};

/// Reads the problems of a text.
pub(crate) fn read(text: &str) -> Vec<Hierarchy> {
    let mut lines = text.lines();
    let mut problems = Vec::new();
    while let Some(head) = lines.next() {
        let [variables, levels] = counts(head, "problem");
        let mut problem = Hierarchy::new(variables).unwrap();
        for (variable, bounds) in numbers(&mut lines, variables).iter().enumerate() {
            let (lower, upper) = problem.bounds_mut();
            (lower[variable], upper[variable]) = (bounds[0], bounds[1]);
        }
        for _ in 0..levels {
            let [count] = counts(lines.next().unwrap(), "constraints");
            let constraints = rows(variables, &numbers(&mut lines, count));
            let head = lines.next().unwrap();
            let level = if head.starts_with("quadratic") {
                let rows = numbers(&mut lines, variables);
                let hessian = DMatrix::from_fn(variables, variables, |i, j| rows[i][j]);
                let gradient = DVector::from_fn(variables, |i, _| rows[i][variables]);
                Level::quadratic(&hessian, &gradient).unwrap()
            } else {
                let [count] = counts(head, "rows");
                Level::least_squares(rows(variables, &numbers(&mut lines, count)))
            };
            problem.push(level.with_constraints(constraints)).unwrap();
        }
        problems.push(problem);
    }
    problems
}

fn counts<const COUNT: usize>(line: &str, word: &str) -> [usize; COUNT] {
    let mut words = line.split(' ');
    assert_eq!(words.next(), Some(word), "{line}");
    [(); COUNT].map(|()| words.next().unwrap().parse().unwrap())
}

fn numbers(lines: &mut Lines<'_>, count: usize) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(' ').map(|number| number.parse().unwrap()).collect();
    lines.take(count).map(numbers).collect()
}

fn rows(variables: usize, of: &[Vec<f64>]) -> Rows {
    let matrix = DMatrix::from_fn(of.len(), variables, |i, j| of[i][j]);
    let column = |j: usize| DVector::from_fn(of.len(), |i, _| of[i][j]);
    Rows::ranges(&matrix, &column(variables), &column(variables + 1)).unwrap()
}

/// Expects that the answer is certified, from nothing and from the answer itself.
fn expect_proof(problem: &Hierarchy) {
    let mut solver = Solver::new(problem, Settings::default()).unwrap();
    expect_proofs([problem; 2], &mut solver);
}

/// Expects that all answers are certified, each from the one before.
fn expect_proofs<'a>(problems: impl IntoIterator<Item = &'a Hierarchy>, solver: &mut Solver) {
    for problem in problems {
        let solution = solver.solve(problem).unwrap();
        assert_eq!(solution.status(), Status::Solved);
        let x = solution.optimum().unwrap().to_vec();
        let residuals = solver.certificate(problem).unwrap().residuals(problem, &x).unwrap();
        assert!(residuals.worst() < 1e-8, "{residuals:?}");
    }
}

/// Expects that all answers to the problems of a text are certified, each from the one before.
fn expect_proofs_of(text: &str) {
    let problems = read(text);
    let mut solver = Solver::new(&problems[0], Settings::default()).unwrap();
    expect_proofs(&problems, &mut solver);
}

/// Expects that an answer is certified, or that its status says that the iterations ran out.
fn expect_proof_or_limit(problem: &Hierarchy) {
    let mut solver = Solver::new(problem, Settings::default()).unwrap();
    match solver.solve(problem).unwrap().status() {
        Status::Solved => expect_proof(problem),
        status => assert!(matches!(status, Status::IterationLimit { .. }), "{status}"),
    }
}

/// Solves the problems one after the other, each by ticks of `max_iterations`. Expects that each is
/// solved within twenty ticks, to what a solve without limit finds.
fn expect_ticks(problems: &[Hierarchy], max_iterations: usize) {
    let mut solver =
        Solver::new(&problems[0], Settings { max_iterations, ..Settings::default() }).unwrap();
    for problem in problems {
        let ended = (0..20).find(|_| solver.solve(problem).unwrap().status() == Status::Solved);
        assert!(ended.is_some(), "{:?}", solver.solution());
        let x = solver.solution().unwrap().optimum().unwrap().to_vec();
        let settings = Settings { warm_start: WarmStart::Cold, ..Settings::default() };
        let mut complete = Solver::new(problem, settings).unwrap();
        let complete = complete.solve(problem).unwrap().optimum().unwrap();
        let difference = DVector::from_column_slice(&x) - DVector::from_column_slice(complete);
        assert!(difference.amax() < 1e-7, "{x:?} {complete:?}");
    }
}

/// Making the hard rows hold takes more iterations than one tick has. The next tick goes on from
/// the point that the last one reached.
#[test]
fn a_tick_continues_where_the_last_one_ended() {
    expect_ticks(&read(include_str!("written/budget_for_constraints.txt")), 10);
}

/// Three hard rows have the same coefficients, and rounding leaves a variable 1e-12 off its bound.
#[test]
fn a_variable_near_its_bound_still_counts() {
    let problems = read(include_str!("written/bounds_off_by_rounding.txt"));
    for problem in &problems {
        expect_proof(problem);
    }
    expect_ticks(&problems, 15);
}

/// Rounding drops a row that immediately becomes active again, which must not go on until the
/// iterations run out.
#[test]
fn a_row_that_comes_back_at_once_stays() {
    for problem in read(include_str!("written/row_that_comes_back.txt")) {
        expect_proof(&problem);
    }
}

/// Five rows meet, and a search from the tick before comes back to them again and again. It is a tick of a controller near
/// a person.
#[test]
fn rows_that_come_back_together_stay() {
    expect_proofs_of(include_str!("written/rows_that_come_back.txt"));
}

/// Robots near rest: forty rows and the bounds of joints nearly meet, so that rounding grows through rows that nearly
/// depend on others. They are a tick of a controller after the tick before it, and one alone.
#[test]
fn rows_that_meet_at_rest_hold() {
    let problems = read(include_str!("written/rows_that_meet_at_rest.txt"));
    let mut solver = Solver::new(&problems[0], Settings::default()).unwrap();
    expect_proofs(&problems, &mut solver);
    expect_proof(&read(include_str!("written/rows_near_the_threshold.txt"))[0]);
}

/// Two rows that nearly agree and two bounds meet within their tolerances only. A search from the tick before held all of
/// them, where there is no such point. They are ticks of a robot of six joints that keeps its own bodies apart.
#[test]
fn rows_that_meet_within_tolerance_hold() {
    expect_proofs_of(include_str!("written/rows_within_tolerance.txt"));
}

/// The optimum is zero. A search from a long x before leaves its rounding, which is all of x.
#[test]
fn x_that_becomes_zero_is_zero() {
    expect_proofs_of(include_str!("written/ends_at_zero.txt"));
}

/// A row is met only if a variable leaves its bound, whose coefficient is 2e-7 of the row.
#[test]
fn tiny_coefficient_meets_its_row() {
    expect_proof(&read(include_str!("written/tiny_coefficient.txt"))[0]);
}

/// Two of these rows differ by a millionth. Their violation is only known from x.
#[test]
fn rows_that_nearly_agree_hold_together() {
    for text in [
        include_str!("written/nearly_agreeing.txt"),
        include_str!("written/nearly_agreeing_bounded.txt"),
        include_str!("written/nearly_agreeing_plane.txt"),
        include_str!("written/nearly_agreeing_levels.txt"),
    ] {
        expect_proof(&read(text)[0]);
    }
}

/// Rows that differ by a millionth balance a row that no pivot contains. The rounding of x along
/// their difference is 1e-8, but the residual of that row, 2e-7, is known to 1e-13.
#[test]
fn a_residual_is_known_better_than_x() {
    expect_proof(&read(include_str!("written/nearly_agreeing_forces.txt"))[0]);
}

/// A light row is repeated, also hidden in a heavy one, whose rounding passes to its residual.
#[test]
fn rounding_of_heavy_rows_holds_no_light_one() {
    expect_proofs_of(include_str!("written/repeated_rows.txt"));
}

/// Rows are met, and some depend on others. Rounding of their residuals must not decide which bounds the least norm keeps.
#[test]
fn rows_that_are_met_pull_at_nothing() {
    expect_proofs_of(include_str!("written/rows_that_are_met.txt"));
}

/// Violated rows depend on others, with norms of up to 197. The rounding of multipliers of bounds must keep no
/// bound.
#[test]
fn rounding_of_multipliers_keeps_no_bound() {
    expect_proofs_of(include_str!("written/heavy_dependent_rows.txt"));
}

/// Three hard rows that nearly agree hold the objective's row, which is one of them. The
/// multipliers of the other two are zero, and rounding makes them 1e-8. The least norm must still
/// be chosen.
#[test]
fn unneeded_rows_leave_the_next_level_free() {
    expect_proof(&read(include_str!("written/unneeded_rows.txt"))[0]);
}

/// Five hard rows are active in four dimensions. The one that depends on the others moves with
/// them, and returns to its bound when one of them is dropped.
#[test]
fn a_dependent_hard_row_moves_with_the_others() {
    expect_proof(&read(include_str!("written/dependent_hard_row.txt"))[0]);
}

/// The coefficients of problems as text with relative noise of 5e-14, and all bounds as they are. Zeros and ones stay.
fn disturbed(text: &str, noise: &[f64]) -> String {
    let mut noise = noise.iter().cycle();
    let mut disturb = |number: f64| number * (1.0 + 5e-14 * noise.next().unwrap());
    let mut lines = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let (coefficients, bounds) = words.split_at(words.len().saturating_sub(2));
        let coefficients = coefficients.iter().map(|word| match word.parse::<f64>() {
            Ok(number) if number != 0.0 && number.abs() != 1.0 => format!("{:e}", disturb(number)),
            _ => (*word).to_owned(),
        });
        let words: Vec<_> =
            coefficients.chain(bounds.iter().map(|&word| word.to_owned())).collect();
        lines.push(words.join(" "));
    }
    lines.join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    /// Rounding of the data decides which of the rows that meet are active, and no answer.
    #[test]
    fn noise_in_the_data_spoils_no_answer(noise in prop::collection::vec(-1.0..1.0_f64, 97)) {
        for text in [
            include_str!("written/bounds_off_by_rounding.txt"),
            include_str!("written/dependent_hard_row.txt"),
            include_str!("written/row_that_comes_back.txt"),
            include_str!("written/rows_that_come_back.txt"),
            include_str!("written/rows_that_meet_at_rest.txt"),
            include_str!("written/unneeded_rows.txt"),
        ] {
            let problems = read(&disturbed(text, &noise));
            let mut solver = Solver::new(&problems[0], Settings::default()).unwrap();
            expect_proofs(&problems, &mut solver);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Noise leaves more or less of rows that repeat others than the rank tolerance. Either way the answer is certified.
    #[test]
    fn noise_in_dependent_rows_spoils_no_answer(noise in prop::collection::vec(-1.0..1.0_f64, 97)) {
        let problems = read(&disturbed(include_str!("written/repeated_rows.txt"), &noise));
        let mut solver = Solver::new(&problems[0], Settings::default()).unwrap();
        expect_proofs(&problems, &mut solver);
        expect_proof_or_limit(&read(&disturbed(include_str!("written/rows_near_the_threshold.txt"), &noise))[0]);
    }
}
