//! Optimality of MOCA's own stack of tasks: strict priorities, both stacking methods, and the paper's three levels.

use std::cell::Cell;

use ahqp_core::{
    Hierarchy, Level, Objective, Rows, Settings, Solver, Stacking, Status, solve_reference,
};
use ergo_map::ErgonomicsQuadratic;
use moca_model::{Controller, ControllerSettings, Goal, MOCA_HOME, SimulatedRobot};
use nalgebra::{DVector, Matrix3, Vector3};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use vision_models::{Action, Tool};

use crate::drive::{FRAME, PERIOD, doing};
use crate::shared::MOCA;

/// Largest difference of two solutions of one problem \[m/s, rad/s, m or rad\].
const SAME: f64 = 1e-6;
/// Residual of a certificate up to which it proves a point.
const PROVED: f64 = 1e-8;
/// Ticks between two problems that are judged.
const EVERY: u32 = 97;

/// A person and a robot, and how long they move.
#[derive(Debug, Clone)]
struct Meeting {
    paper: bool,
    goal: Goal,
    person: f64,
    action: Action,
    start: Vec<f64>,
    ticks: u32,
}

fn meeting() -> impl Strategy<Value = Meeting> {
    let action = prop::sample::select(vec![
        Action::Using(Tool::Drill),
        Action::Using(Tool::Polisher),
        Action::DeliverObject,
    ]);
    let goal = prop::sample::select(vec![Goal::Ergonomics, Goal::LeastMotion]);
    let start = prop::collection::vec(-0.2..0.2_f64, 10);
    (any::<bool>(), goal, 1.2..2.5_f64, action, start, 800..1500_u32).prop_map(
        |(paper, goal, person, action, change, ticks)| {
            let start = MOCA_HOME.iter().zip(change).map(|(home, change)| home + change).collect();
            Meeting { paper, goal, person, action, start, ticks }
        },
    )
}

impl Meeting {
    fn settings(&self) -> ControllerSettings {
        let settings = ControllerSettings { goal: self.goal, ..ControllerSettings::default() };
        if self.paper { settings.as_in_paper() } else { settings }
    }

    /// Plays the meeting and returns problems on the way, each with the χ* that moved the robot.
    fn problems(&self) -> Vec<(Hierarchy, Vec<f64>)> {
        let hessian = Matrix3::from_diagonal(&Vector3::new(10.0, 5.0, 7.0));
        let best = Vector3::new(0.42, -0.1, 1.1);
        let ergonomics = ErgonomicsQuadratic::new(hessian, -(hessian * best), 8.0).unwrap();
        let mut controller =
            Controller::new(MOCA.clone(), ergonomics, self.settings(), &self.start).unwrap();
        let mut robot = SimulatedRobot::new(&MOCA, &self.start).unwrap();
        let mut problems = Vec::new();
        for tick in 0..self.ticks {
            let now = f64::from(tick) * PERIOD;
            if tick.is_multiple_of(FRAME) {
                controller.observe(doing(self.action, now, Some(self.person))).unwrap();
            }
            let command = controller.step(now, robot.position()).unwrap();
            assert!(command.outcome.is_optimal(), "{:?} at {tick}", command.outcome);
            robot.step(&command.joint_velocity, PERIOD).unwrap();
            if tick % EVERY == EVERY - 1 {
                let stack = controller.stack();
                let x = stack.solution().unwrap().optimum().unwrap().to_vec();
                problems.push((stack.hierarchy().clone(), x));
            }
        }
        problems
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The norm of the violations of rows, each times the root of its weight.
fn violation(rows: &Rows, x: &[f64]) -> f64 {
    let square = |(index, (row, lower, upper)): (usize, (&[f64], f64, f64))| {
        let value = dot(row, x);
        rows.weight(index) * (value - value.clamp(lower, upper)).powi(2)
    };
    rows.iter().enumerate().map(square).sum::<f64>().sqrt()
}

/// Objective of a level, and the size that its rounding is relative to.
fn objective(level: &Level, x: &[f64]) -> (f64, f64) {
    match level.objective() {
        Objective::LeastSquares(rows) => (violation(rows, x), 1.0),
        Objective::Quadratic { hessian, gradient } => {
            let x = DVector::from_column_slice(x);
            (0.5 * (hessian * &x).dot(&x) + gradient.dot(&x), hessian.norm() + gradient.norm())
        }
        _ => (0.0, 1.0),
    }
}

/// The same bounds with the levels that `map` returns.
fn rebuilt(problem: &Hierarchy, map: impl Fn(usize, &Level) -> Option<Level>) -> Hierarchy {
    let mut other = Hierarchy::new(problem.variables()).unwrap();
    let (lower, upper) = other.bounds_mut();
    lower.copy_from_slice(problem.lower());
    upper.copy_from_slice(problem.upper());
    for level in problem.levels().iter().enumerate().filter_map(|(k, level)| map(k, level)) {
        other.push(level).unwrap();
    }
    other
}

/// The level with its objective times a positive factor.
fn scaled(level: &Level, factor: f64) -> Level {
    let other = match level.objective() {
        Objective::LeastSquares(rows) => {
            let weights: Vec<f64> = (0..rows.len()).map(|i| factor * rows.weight(i)).collect();
            let mut rows = rows.clone();
            rows.set_weights(&weights).unwrap();
            Level::least_squares(rows)
        }
        Objective::Quadratic { hessian, gradient } => {
            Level::quadratic(&(hessian * factor), &(gradient * factor)).unwrap()
        }
        _ => return level.clone(),
    };
    other.with_constraints(level.constraints().clone())
}

fn solve(problem: &Hierarchy, settings: Settings) -> Vec<f64> {
    let mut solver = Solver::new(problem, settings).unwrap();
    let solution = solver.solve(problem).unwrap();
    assert_eq!(solution.status(), Status::Solved);
    solution.optimum().unwrap().to_vec()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Returns true if the certificate of x holds by the data alone, and no level of x is worse than that of y.
fn is_proved(problem: &Hierarchy, x: &[f64], y: &[f64]) -> bool {
    let is_as_good = |level: &Level| {
        let ((got, size), (other, _)) = (objective(level, x), objective(level, y));
        got <= other + SAME * size
    };
    let mut solver = Solver::new(problem, Settings::default()).unwrap();
    solver.solve(problem).unwrap();
    let residuals = solver.certificate(problem).unwrap().residuals(problem, x).unwrap();
    residuals.worst() <= PROVED && problem.levels().iter().all(is_as_good)
}

/// The oracle never sees the levels below, and is another method. Where it does not converge it judges nothing.
#[test]
fn levels_below_cost_a_level_nothing() {
    let (judged, all) = (Cell::new(0), Cell::new(0));
    let mut runner = TestRunner::new(ProptestConfig::with_cases(8));
    let outcome = runner.run(&meeting(), |meeting| {
        for (problem, x) in meeting.problems() {
            for (k, level) in problem.levels().iter().enumerate() {
                let above = rebuilt(&problem, |j, level| (j <= k).then(|| level.clone()));
                all.set(all.get() + 1);
                let Ok(best) = solve_reference(&above) else { continue };
                judged.set(judged.get() + 1);
                let (got, size) = objective(level, &x);
                let (least, _) = objective(level, best.as_slice());
                prop_assert!(got <= least + SAME * size, "level {k}: {got:e}, not {least:e}");
            }
        }
        Ok(())
    });
    outcome.unwrap();
    assert!(10 * judged.get() >= 9 * all.get(), "{judged:?} of {all:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// Where rows of levels nearly depend on each other, the reference claims nothing. The proof decides then.
    #[test]
    fn stacked_equalities_give_the_same_optimum(meeting in meeting()) {
        let stacked = Settings { stacking: Stacking::Equalities, ..Settings::default() };
        for (problem, x) in meeting.problems() {
            let other = solve(&problem, stacked);
            let difference = largest_difference(&x, &other);
            prop_assert!(difference <= SAME || is_proved(&problem, &x, &other), "{difference:e}");
        }
    }

    /// A priority is no weight: the factors of the levels do not matter. Where levels nearly depend on each other, two
    /// points may have a proof.
    #[test]
    fn scale_of_a_level_moves_nothing(
        meeting in meeting(), factors in prop::collection::vec(0.1..10.0_f64, 12),
    ) {
        for (problem, x) in meeting.problems() {
            let other = rebuilt(&problem, |k, level| Some(scaled(level, factors[k])));
            let other = solve(&other, Settings::default());
            let difference = largest_difference(&x, &other);
            let is_same = difference <= SAME
                || is_proved(&problem, &x, &other) && is_proved(&problem, &other, &x);
            prop_assert!(is_same, "{difference:e}");
        }
    }

    #[test]
    fn hard_rows_hold_at_every_optimum(meeting in meeting()) {
        for (problem, x) in meeting.problems() {
            for ((x, lower), upper) in x.iter().zip(problem.lower()).zip(problem.upper()) {
                prop_assert!((lower..=upper).contains(&x));
            }
            for level in problem.levels() {
                prop_assert!(violation(level.constraints(), &x) <= 1e-9);
            }
        }
    }

    #[test]
    fn the_papers_stack_has_three_levels(meeting in meeting()) {
        let meeting = Meeting { paper: true, ..meeting };
        let problems = meeting.problems();
        prop_assert!(!problems.is_empty());
        for (problem, _) in problems {
            let objectives = problem.levels().iter().filter(|l| !matches!(l.objective(), Objective::None));
            let names: Vec<_> = objectives.filter_map(Level::name).collect();
            prop_assert_eq!(names, ["inverse kinematics", "shared workspace", "goal"]);
        }
    }
}
