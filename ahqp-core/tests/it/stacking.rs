//! Selection of the stacking method of a solver.

use ahqp_core::{Error, Hierarchy, Level, Rows, Settings, Solver, Stacking, Status};
use nalgebra::dmatrix;

/// Two levels that want x₀ = `first` and x₀ + x₁ = `second`, with x₁ at most 1.
fn problem(first: f64, second: f64) -> Hierarchy {
    let mut problem = Hierarchy::new(3).unwrap();
    problem.bounds_mut().1[1] = 1.0;
    for (row, target) in [(dmatrix![1.0, 0.0, 0.0], first), (dmatrix![1.0, 1.0, 0.0], second)] {
        let rows = Rows::equalities(&row, &[target]).unwrap();
        problem.push(Level::least_squares(rows)).unwrap();
    }
    problem
}

fn stacked() -> Settings {
    Settings { stacking: Stacking::Equalities, ..Settings::default() }
}

#[test]
fn stacked_equalities_keep_the_upper_level() {
    let problem = problem(3.0, 5.0);
    let mut solver = Solver::new(&problem, stacked()).unwrap();
    let solution = solver.solve(&problem).unwrap();
    // x₀ = 3 stays; x₁ would be 2 but for its bound; nothing needs x₂.
    for (value, expected) in solution.optimum().unwrap().iter().zip([3.0, 1.0, 0.0]) {
        assert!((value - expected).abs() < 1e-9, "{solution:?}");
    }
    assert_eq!((solution.status(), solution.iterations()), (Status::Solved, 2));
    assert!(solver.solution().is_some());
    assert!(matches!(solver.certificate(&problem), Err(Error::NotSolved)));
}

#[test]
fn methods_change_between_solves() {
    let (one, other) = (problem(3.0, 5.0), problem(-2.0, 0.5));
    let mut solver = Solver::new(&one, stacked()).unwrap();
    let _ = solver.solve(&one).unwrap();
    solver.set_settings(Settings::default()).unwrap();
    assert!(solver.solution().is_none());
    assert_eq!(solver.solve(&other).unwrap().optimum().unwrap(), [-2.0, 1.0, 0.0]);
    assert!(solver.certificate(&other).is_ok());
}

#[test]
fn stacked_equalities_refuse_what_elimination_refuses() {
    let sound = problem(3.0, 5.0);
    let mut solver = Solver::new(&sound, stacked()).unwrap();
    let larger = Hierarchy::new(4).unwrap();
    assert!(matches!(solver.solve(&larger), Err(Error::ShapeChanged { .. })));
    let mut broken = problem(3.0, 5.0);
    broken.bounds_mut().0[1] = f64::NAN;
    assert!(solver.solve(&broken).is_err() && solver.solution().is_none());
    assert!(solver.solve(&sound).is_ok());
}
