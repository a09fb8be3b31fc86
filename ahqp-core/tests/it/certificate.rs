//! Contents of certificates and problems that they refuse. A property test shows that they prove
//! every solution.

use ahqp_core::{ConstraintSource, Error, Hierarchy, Level, LevelId, Rows, Settings, Solver};
use nalgebra::{DMatrix, dmatrix, dvector};
use proptest::prelude::*;

use crate::support::id;

fn clamped() -> Hierarchy {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    hierarchy.set_bounds(&dvector![-1.0, -1.0], &dvector![1.0, 1.0]).unwrap();
    let target = Rows::equalities(&DMatrix::identity(2, 2), &dvector![3.0, 0.5]).unwrap();
    hierarchy.push(Level::least_squares(target)).unwrap();
    hierarchy
}

#[test]
fn multipliers_and_active_set_are_named() {
    let hierarchy = clamped();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    assert!(matches!(solver.certificate(&hierarchy), Err(Error::NotSolved)));
    solver.solve(&hierarchy).unwrap();
    let certificate = solver.certificate(&hierarchy).unwrap();
    let bound = ConstraintSource::Bound { variable: 0 };
    assert_eq!(certificate.multipliers(0).len(), 1);
    assert_eq!(certificate.multipliers(0)[0].0, bound);
    assert!((certificate.multipliers(0)[0].1 - 2.0).abs() < 1e-12);
    assert!(certificate.active().contains(&bound));
    assert!(!certificate.active().contains(&ConstraintSource::Bound { variable: 1 }));
}

#[test]
fn a_certificate_of_another_problem_is_refused() {
    let hierarchy = clamped();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
    let certificate = solver.certificate(&hierarchy).unwrap();
    assert!(certificate.residuals(&hierarchy, &x[..1]).is_err());
    let mut longer = clamped();
    let more = Rows::equalities(&dmatrix![1.0, 1.0], &dvector![0.0]).unwrap();
    longer.push(Level::least_squares(more)).unwrap();
    assert!(certificate.residuals(&longer, &x).is_err());
    // The target pulls in the opposite direction.
    let mut other = clamped();
    let target = Rows::equalities(&DMatrix::identity(2, 2), &dvector![-3.0, 0.5]).unwrap();
    let level = id(&other, 0);
    *other.level_mut(level).unwrap() = Level::least_squares(target);
    let row = ConstraintSource::Objective { level, row: 0 };
    assert_eq!(changed(certificate.residuals(&other, &x)), row);
    assert_eq!(changed(solver.certificate(&other)), row);
    assert!(certificate.residuals(&hierarchy, &x).is_ok());
    assert_eq!(solver.certificate(&hierarchy).unwrap(), certificate);
}

/// Returns the row that is reported as changed.
fn changed<T: std::fmt::Debug>(refused: Result<T, Error>) -> ConstraintSource {
    match refused {
        Err(error @ Error::DataChanged { source_of_row, .. }) => {
            assert!(error.to_string().contains(&source_of_row.to_string()), "{error}");
            source_of_row
        }
        other => panic!("{other:?}"),
    }
}

/// Returns a hierarchy with bounds, hard rows, a least-squares objective and two quadratics.
fn of_every_kind() -> Hierarchy {
    let mut hierarchy = Hierarchy::new(3).unwrap();
    hierarchy.set_bounds(&dvector![-1.0, -2.0, -3.0], &dvector![1.0, 2.0, 3.0]).unwrap();
    let rows = dmatrix![1.0, 1.0, 0.0; 0.0, 1.0, 1e-9];
    let hard = Rows::ranges(&rows, &dvector![-1.0, -2.0], &dvector![1.0, f64::INFINITY]).unwrap();
    let soft = Rows::equalities(&dmatrix![1.0, 0.5, 0.0], &dvector![3.0]).unwrap();
    hierarchy.push(Level::least_squares(soft).with_constraints(hard)).unwrap();
    let full = dmatrix![2.0, 1.0, 0.0; 1.0, 2.0, 0.0; 0.0, 0.0, 1.0];
    hierarchy.push(Level::quadratic(&full, &[1.0, 0.0, -1.0]).unwrap()).unwrap();
    let flat = dmatrix![1.0, 0.0, 0.0; 0.0, 0.0, 0.0; 0.0, 0.0, 0.0];
    hierarchy.push(Level::quadratic(&flat, &[1.0, 0.0, 0.0]).unwrap()).unwrap();
    hierarchy
}

#[test]
fn whatever_changes_after_the_solve_is_named() {
    type Change = fn(&mut Hierarchy, [LevelId; 3]);
    let hierarchy = of_every_kind();
    let levels = [0, 1, 2].map(|index| id(&hierarchy, index));
    let bound = |variable| ConstraintSource::Bound { variable };
    let hard = |row| ConstraintSource::Constraint { level: levels[0], row };
    let objective = |level: usize, row| ConstraintSource::Objective { level: levels[level], row };
    let changes: [(Change, ConstraintSource); 9] = [
        (|h, _| h.bounds_mut().1[2] += 1e-15, bound(2)),
        (|h, _| h.bounds_mut().0[1] = f64::NEG_INFINITY, bound(1)),
        (|h, ids| h.constraints_mut(ids[0]).unwrap().row_mut(1).unwrap()[2] *= 2.0, hard(1)),
        (|h, ids| h.constraints_mut(ids[0]).unwrap().upper_mut()[1] = 9.0, hard(1)),
        (|h, ids| h.rows_mut(ids[0]).unwrap().row_mut(0).unwrap()[2] = 1e-12, objective(0, 0)),
        (|h, ids| h.rows_mut(ids[0]).unwrap().set_targets(&[4.0]).unwrap(), objective(0, 0)),
        (|h, ids| h.quadratic_mut(ids[1]).unwrap().0[(2, 2)] = 1.5, objective(1, 2)),
        (|h, ids| h.quadratic_mut(ids[1]).unwrap().1[2] = 1.5, objective(1, 2)),
        (|h, ids| h.quadratic_mut(ids[2]).unwrap().1[1] = 1e-3, objective(2, 1)),
    ];
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
    let certificate = solver.certificate(&hierarchy).unwrap();
    for (change, source_of_row) in changes {
        let mut other = hierarchy.clone();
        change(&mut other, levels);
        assert_eq!(changed(solver.certificate(&other)), source_of_row);
        assert_eq!(changed(certificate.residuals(&other, &x)), source_of_row);
    }
    assert_eq!(solver.certificate(&hierarchy).unwrap(), certificate);
}

#[test]
fn the_proof_ignores_the_solvers_rank_tolerance() {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    for (row, target) in [([1.0, 0.0], 0.0), ([1.0, 1e-6], 1e-6)] {
        let rows = Rows::from_row_slice(1, 2, &row, &[target], &[target]).unwrap();
        hierarchy.push(Level::least_squares(rows)).unwrap();
    }
    for (rank_tolerance, x, off) in [(1e-10, [0.0, 1.0], 0.0), (1e-4, [0.0, 0.0], 1.0)] {
        let settings = Settings { rank_tolerance, ..Settings::default() };
        let mut solver = Solver::new(&hierarchy, settings).unwrap();
        let found = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
        assert!(found.iter().zip(x).all(|(found, x)| (found - x).abs() < 1e-9), "{found:?}");
        let certificate = solver.certificate(&hierarchy).unwrap();
        let residuals = certificate.residuals(&hierarchy, &found).unwrap();
        assert!((residuals.worst() - off).abs() < 1e-9, "{residuals:?}");
    }
}

/// Expects a valid certificate for every tick of a sequence.
pub(crate) fn expect_proofs(sequence: &[Hierarchy]) -> Result<(), TestCaseError> {
    let mut solver = Solver::new(&sequence[0], Settings::default())?;
    for hierarchy in sequence {
        let x = solver.solve(hierarchy)?.optimum()?.to_vec();
        let residuals = solver.certificate(hierarchy)?.residuals(hierarchy, &x)?;
        prop_assert!(residuals.worst() < 1e-8, "{residuals:?}");
    }
    Ok(())
}
