//! What a certificate says, and what it refuses; that it proves every solution is a property.

use ahqp_core::{ConstraintSource, Error, Hierarchy, Level, Rows, Settings, Solver};
use nalgebra::{DMatrix, dmatrix, dvector};

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
    // Pulled the other way, the multiplier points the wrong way.
    let mut other = Hierarchy::new(2).unwrap();
    other.set_bounds(&dvector![-1.0, -1.0], &dvector![1.0, 1.0]).unwrap();
    let target = Rows::equalities(&DMatrix::identity(2, 2), &dvector![-3.0, 0.5]).unwrap();
    other.push(Level::least_squares(target)).unwrap();
    assert!(certificate.residuals(&other, &x).unwrap().worst() > 0.1);
}
