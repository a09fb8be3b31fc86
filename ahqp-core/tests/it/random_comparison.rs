//! The unrelated random hierarchies of the published comparison.

use ahqp_core::testing::problems::random_comparison;
use ahqp_core::{Settings, Solver};

#[test]
fn every_one_is_solved_and_certified() {
    for share in [0.0, 0.2, 0.5, 0.8, 1.0] {
        for hierarchy in random_comparison(7, share, 5).unwrap() {
            let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
            let x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
            let certificate = solver.certificate(&hierarchy).unwrap();
            let residuals = certificate.residuals(&hierarchy, &x).unwrap();
            assert!(residuals.worst() < 1e-8, "share {share}: {residuals:?}");
        }
    }
}
