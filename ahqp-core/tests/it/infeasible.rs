//! Hard constraints that cannot hold together.

use ahqp_core::{ConstraintSource, Error, Hierarchy, Level, Rows, Settings, Solver};
use nalgebra::{dmatrix, dvector};

use crate::support::expect_words;

#[test]
fn hard_constraints_that_contradict_each_other() {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    hierarchy.set_bounds(&dvector![-1.0, -1.0], &dvector![1.0, 1.0]).unwrap();
    let sum = Rows::equalities(&dmatrix![1.0, 1.0], &dvector![1.0]);
    hierarchy.push(Level::least_squares(sum.unwrap())).unwrap();
    let far = Rows::ranges(
        &dmatrix![0.0, 1.0; 1.0, 0.0],
        &dvector![-0.5, 3.0],
        &dvector![0.5, f64::INFINITY],
    );
    let second = hierarchy.push(Level::constraints_only(far.unwrap())).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let error = solver.solve(&hierarchy).unwrap_err();
    let Error::Infeasible { level, worst, violation, members, .. } = error else {
        panic!("{error}")
    };
    assert_eq!(level, second);
    let far = ConstraintSource::Constraint { level, row: 1 };
    assert_eq!(worst, far);
    assert!((violation - 2.0).abs() < 1.5, "{violation}");
    expect_words(&error, &["level 1", "constraint row 1 of level 1", "relax", "soft"]);
    assert_eq!(solver.conflict().len(), members);
    assert!(solver.conflict().contains(&far));
    // Conflicting rows are named, and others are not.
    assert!(!solver.conflict().contains(&ConstraintSource::Constraint { level, row: 0 }));
    // A problem with a solution clears the list.
    hierarchy.constraints_mut(second).unwrap().lower_mut()[1] = -3.0;
    solver.solve(&hierarchy).unwrap();
    assert!(solver.conflict().is_empty());
}

#[test]
fn the_conflicting_subset_cannot_hold_alone() {
    // x ≥ 1, y ≥ 1, z free, and x + y ≤ 1.
    let mut hierarchy = Hierarchy::new(3).unwrap();
    let rows = Rows::ranges(
        &dmatrix![1.0, 0.0, 0.0; 0.0, 1.0, 0.0; 1.0, 1.0, 0.0; 0.0, 0.0, 1.0; 1.0, -1.0, 0.0],
        &dvector![1.0, 1.0, f64::NEG_INFINITY, 1.0, -9.0],
        &dvector![f64::INFINITY, f64::INFINITY, 1.0, 2.0, 9.0],
    );
    let rows = rows.unwrap();
    hierarchy.push(Level::constraints_only(rows.clone())).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    assert!(
        matches!(solver.solve(&hierarchy), Err(Error::Infeasible { level, .. }) if level.index() == 0)
    );
    let named: Vec<usize> = solver
        .conflict()
        .iter()
        .map(|source| match source {
            ConstraintSource::Constraint { row, .. } => *row,
            other => panic!("{other}"),
        })
        .collect();
    let mut alone = Rows::zeros(named.len(), 3);
    for (to, &from) in named.iter().enumerate() {
        alone.row_mut(to).unwrap().copy_from_slice(rows.row(from).unwrap());
        alone.lower_mut()[to] = rows.lower()[from];
        alone.upper_mut()[to] = rows.upper()[from];
    }
    let mut subset = Hierarchy::new(3).unwrap();
    subset.push(Level::constraints_only(alone)).unwrap();
    let result = Solver::new(&subset, Settings::default()).unwrap().solve(&subset).cloned();
    assert!(matches!(result, Err(Error::Infeasible { .. })));
    assert!(!named.contains(&3) && !named.contains(&4), "{named:?}");
}

#[test]
fn a_conflict_with_an_objective_above_names_it() {
    // First x + y = 2 and z = 1 are minimised, then x + y ≥ 3 must hold.
    let mut hierarchy = Hierarchy::new(3).unwrap();
    let wanted = Rows::equalities(&dmatrix![0.0, 0.0, 1.0; 1.0, 1.0, 0.0], &dvector![1.0, 2.0]);
    let wanted = hierarchy.push(Level::least_squares(wanted.unwrap())).unwrap();
    let sum = Rows::ranges(&dmatrix![1.0, 1.0, 0.0], &dvector![3.0], &dvector![f64::INFINITY]);
    let sum = hierarchy.push(Level::constraints_only(sum.unwrap())).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    assert!(
        matches!(solver.solve(&hierarchy), Err(Error::Infeasible { level, .. }) if level == sum)
    );
    let expected = [
        ConstraintSource::Constraint { level: sum, row: 0 },
        ConstraintSource::Objective { level: wanted, row: 1 },
    ];
    assert_eq!(solver.conflict(), expected);
}
