//! The certificate proves optimal points, and refuses others.
#![allow(clippy::unwrap_used, missing_docs)]

use ahqp_core::testing::{Sizes, hierarchies, hierarchy_sequences};
use ahqp_core::{ConstraintSource, Error, Hierarchy, Level, Rows, Settings, Solver};
use nalgebra::{DMatrix, dmatrix, dvector};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn every_solution_is_proved(hierarchy in hierarchies(Sizes::default())) {
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        let x = solver.solve(&hierarchy).unwrap().x().to_vec();
        let certificate = solver.certificate(&hierarchy).unwrap();
        let residuals = certificate.residuals(&hierarchy, &x).unwrap();
        prop_assert!(residuals.worst() < 1e-8, "{residuals:?}");
    }

    #[test]
    fn so_is_every_warm_one(sequence in hierarchy_sequences(Sizes::default(), 4)) {
        let mut solver: Option<Solver> = None;
        for hierarchy in &sequence {
            let solver = solver
                .get_or_insert_with(|| Solver::new(hierarchy, Settings::default()).unwrap());
            let x = solver.solve(hierarchy).unwrap().x().to_vec();
            let certificate = solver.certificate(hierarchy).unwrap();
            let residuals = certificate.residuals(hierarchy, &x).unwrap();
            prop_assert!(residuals.worst() < 1e-8, "{residuals:?}");
        }
    }

    /// A point that is not optimal cannot be proved with the multipliers of one that is.
    #[test]
    fn a_point_beside_the_optimum_is_refused(
        hierarchy in hierarchies(Sizes::default()),
        move_by in prop::collection::vec(-1.0..1.0_f64, 40),
    ) {
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        let mut x = solver.solve(&hierarchy).unwrap().x().to_vec();
        let certificate = solver.certificate(&hierarchy).unwrap();
        let mut moved = 0.0_f64;
        for (value, by) in x.iter_mut().zip(move_by) {
            *value += by;
            moved = moved.max(by.abs());
        }
        prop_assume!(moved > 0.5);
        let residuals = certificate.residuals(&hierarchy, &x).unwrap();
        prop_assert!(residuals.worst() > 1e-6, "{residuals:?}");
    }
}

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
    let x = solver.solve(&hierarchy).unwrap().x().to_vec();
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
