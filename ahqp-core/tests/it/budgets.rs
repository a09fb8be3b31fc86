//! Budgets of a solve, and settings that change between solves.

use std::time::Duration;

use ahqp_core::testing::problems::humanoid_sequence;
use ahqp_core::testing::{Sizes, hierarchies, hierarchy_sequences};
use ahqp_core::{
    Budget, Error, Hierarchy, Level, LevelId, Rows, Settings, Solver, Status, WarmStart,
};
use nalgebra::{dmatrix, dvector};
use proptest::prelude::*;

const LONG: Duration = Duration::from_secs(3600);

fn small() -> Sizes {
    Sizes { variables: 1..=10, levels: 1..=4, rows: 0..=6 }
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: prop::test_runner::RngSeed::Fixed(1), ..ProptestConfig::with_cases(200) })]

    #[test]
    fn a_budget_equals_max_iterations_of_the_settings(
        sequence in hierarchy_sequences(small(), 3), iterations in 1..20_usize,
    ) {
        let settings = Settings { max_iterations: iterations, ..Settings::default() };
        let mut by_settings = Solver::new(&sequence[0], settings)?;
        let mut by_budget = Solver::new(&sequence[0], Settings::default())?;
        for hierarchy in &sequence {
            // A long time has no effect, and neither has a budget above the settings' number.
            let time = Some(LONG);
            let one = by_settings.solve_within(hierarchy, Budget { iterations: Some(500), time })?;
            let other = by_budget.solve_within(hierarchy, Budget::iterations(iterations))?;
            prop_assert_eq!(one, other);
            prop_assert!(one.iterations() <= iterations);
        }
    }

    /// The result never gets worse with a larger budget, and stays solved once it is, cold and
    /// warm.
    #[test]
    fn more_iterations_never_end_worse(sequence in hierarchy_sequences(small(), 2)) {
        let levels = sequence[0].levels().len();
        let mut before = Solver::new(&sequence[0], Settings::default())?;
        for hierarchy in &sequence {
            let (mut farthest, mut optimum) = (0, None);
            let needed = before.clone().solve(hierarchy)?.iterations();
            for iterations in 1..=needed + 3 {
                let mut solver = before.clone();
                let solution = solver.solve_within(hierarchy, Budget::iterations(iterations))?;
                let place = match solution.status() {
                    Status::Solved => levels + 1,
                    Status::IterationLimit { level } => level.map_or(levels, LevelId::index),
                    other => return Err(TestCaseError::fail(other.to_string())),
                };
                prop_assert!(place >= farthest, "{place} after {farthest} at {iterations}");
                farthest = place;
                if let Ok(x) = solution.optimum() {
                    let first = optimum.get_or_insert_with(|| x.to_vec());
                    let size = first.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
                    let near = x.iter().zip(first.iter()).all(|(x, y)| (x - y).abs() <= 1e-6 * size);
                    prop_assert!(near, "{x:?} after {first:?} at {iterations}");
                }
            }
            prop_assert_eq!(farthest, levels + 1);
            before.solve(hierarchy)?;
        }
    }

    /// Each solve makes a few iterations. If these are at least two for each level and one for each
    /// variable, repeated solves reach the optimum.
    #[test]
    fn without_time_there_is_progress(
        hierarchy in prop_oneof![
            hierarchies(small()),
            hierarchies(Sizes { variables: 1..=2, levels: 1..=2, rows: 0..=6 }),
        ],
    ) {
        let mut solver = Solver::new(&hierarchy, Settings::default())?;
        let enough = 2 * hierarchy.levels().len() + hierarchy.variables() + 2 <= 8;
        for tick in 0..20 {
            let solution = solver.solve_within(&hierarchy, Budget::time(Duration::ZERO))?;
            match solution.status() {
                Status::Solved => break,
                Status::TimeLimit { .. } => {
                    let unfinished = Error::Unfinished { status: solution.status() };
                    prop_assert_eq!(solution.optimum(), Err(unfinished));
                    // The clock is checked every eighth iteration.
                    let iterations = solution.iterations();
                    prop_assert!(iterations >= 8 && iterations.is_multiple_of(8));
                    for (i, x) in solution.best().iter().enumerate() {
                        prop_assert!((hierarchy.lower()[i]..=hierarchy.upper()[i]).contains(x));
                    }
                }
                other => return Err(TestCaseError::fail(other.to_string())),
            }
            prop_assert!(!enough || tick < 19, "{hierarchy:?}");
        }
    }
}

#[test]
fn what_ran_out_is_said() {
    let hierarchy = humanoid_sequence(1, 1).unwrap().remove(0);
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let mut end = |budget| {
        solver.forget();
        solver.solve_within(&hierarchy, budget).unwrap().status()
    };
    let Status::IterationLimit { level: Some(early) } = end(Budget::iterations(1)) else {
        panic!()
    };
    let Status::TimeLimit { level: Some(_) } = end(Budget::time(Duration::ZERO)) else { panic!() };
    // The iterations run out before the clock is checked.
    let both = Budget { iterations: Some(3), time: Some(Duration::ZERO) };
    assert!(matches!(end(both), Status::IterationLimit { .. }));
    assert!(matches!(end(Budget::iterations(0)), Status::IterationLimit { .. }));
    assert_eq!(end(Budget { iterations: Some(1000), time: Some(LONG) }), Status::Solved);
    assert_eq!(end(Budget { iterations: None, time: Some(Duration::MAX) }), Status::Solved);
    let error = Error::Unfinished { status: Status::TimeLimit { level: Some(early) } };
    let words = error.to_string();
    assert!(words.contains("the time ran out in level") && words.contains("best"), "{words}");
    let error = Error::Unfinished { status: Status::IterationLimit { level: None } };
    assert!(
        error.to_string().contains("iterations ran out in the choice of least norm"),
        "{error}"
    );
}

#[test]
fn settings_change_on_a_solver_that_lives() {
    let hierarchy = humanoid_sequence(1, 1).unwrap().remove(0);
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
    // Invalid settings are refused and change nothing.
    let bad = Settings { rank_tolerance: f64::NAN, ..Settings::default() };
    assert!(matches!(solver.set_settings(bad), Err(Error::Value { what: "rank_tolerance", .. })));
    assert_eq!(solver.settings(), &Settings::default());
    // A budget does not affect the warm start.
    solver.set_settings(Settings { max_iterations: 3, ..Settings::default() }).unwrap();
    let warm = solver.solve(&hierarchy).unwrap().optimum().unwrap();
    assert!(warm.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-9));
    solver.forget();
    assert!(solver.solve(&hierarchy).unwrap().optimum().is_err());
    // Other tolerances cause a cold start, and give the result of a new solver.
    for warm_start in [WarmStart::PreviousActiveSet, WarmStart::Cold] {
        let settings = Settings { rank_tolerance: 1e-6, warm_start, ..Settings::default() };
        solver.set_settings(settings).unwrap();
        let mut fresh = Solver::new(&hierarchy, settings).unwrap();
        assert_eq!(solver.solve(&hierarchy).unwrap(), fresh.solve(&hierarchy).unwrap());
    }
}

#[test]
fn tolerances_that_change_decide_the_next_solve() {
    // The second row differs from the first by 1e-8, which makes one direction or two.
    let mut hierarchy = Hierarchy::new(2).unwrap();
    let first = Rows::equalities(&dmatrix![1.0, 0.0], &[1.0]).unwrap();
    let second = Rows::equalities(&dmatrix![1.0, 1e-8], &[2.0]).unwrap();
    hierarchy.push(Level::least_squares(first)).unwrap();
    hierarchy.push(Level::least_squares(second)).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    for (rank_tolerance, second) in [(1e-10, 1e8), (1e-7, 0.0), (1e-10, 1e8)] {
        let settings = Settings { rank_tolerance, ..Settings::default() };
        solver.set_settings(settings).unwrap();
        let x = solver.solve(&hierarchy).unwrap().optimum().unwrap();
        assert!((x[1] - second).abs() < 1.0, "{x:?}");
    }
    let bad = Settings { max_iterations: 0, ..Settings::default() };
    assert!(solver.set_settings(bad).is_err());
}

/// Also at a vertex that the objective alone reaches, rounding makes a bound active and inactive in
/// turn. A repair cycles there, and must leave iterations for the search.
#[test]
fn a_bound_flickering_by_rounding_leaves_some_budget() {
    let hessian = dmatrix![
        4.4296875, 0.13671875, 0.140625, -6.734375, 1.671875, -0.1484375;
        0.13671875, 7.45703125, 1.23828125, -2.22265625, -2.70703125, -0.59765625;
        0.140625, 1.23828125, 3.58203125, 0.19921875, -3.3046875, 0.50390625;
        -6.734375, -2.22265625, 0.19921875, 15.29296875, -5.3671875, 1.375;
        1.671875, -2.70703125, -3.3046875, -5.3671875, 7.40625, -2.43359375;
        -0.1484375, -0.59765625, 0.50390625, 1.375, -2.43359375, 2.08984375
    ];
    let gradient = dvector![
        -2.71405029296875,
        0.93267822265625,
        2.09539794921875,
        6.19781494140625,
        -4.41351318359375,
        0.74615478515625
    ];
    let mut hierarchy = Hierarchy::new(6).unwrap();
    let (lower, upper) = hierarchy.bounds_mut();
    lower.copy_from_slice(&[-0.03125, -0.171875, -0.5, -0.8125, -1.6875, 0.0]);
    upper.copy_from_slice(&[0.21875, 0.078125, 0.375, 1.5, 0.8125, 1.25]);
    hierarchy.push(Level::quadratic(&hessian, &gradient).unwrap()).unwrap();
    let settings = Settings { max_iterations: 10, ..Settings::default() };
    let mut solver = Solver::new(&hierarchy, settings).unwrap();
    for _ in 0..5 {
        let x = solver.solve(&hierarchy).unwrap().optimum().unwrap();
        assert!((x[3] + 0.4375).abs() < 1e-12, "{x:?}");
    }
}
