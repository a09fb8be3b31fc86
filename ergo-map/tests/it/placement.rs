//! The quadratic in the world follows the person at bounded rates.

use ergo_map::{ErgonomicsQuadratic, Error, PersonFrame, Placement, PlacementLimits};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

const TICK: f64 = 0.001;

fn quadratic(curvature: Vector3<f64>, optimum: Vector3<f64>) -> ErgonomicsQuadratic {
    let hessian = Matrix3::from_diagonal(&curvature);
    ErgonomicsQuadratic::new(hessian, -hessian * optimum, 0.0).unwrap()
}

fn ours() -> ErgonomicsQuadratic {
    quadratic(Vector3::new(10.0, 5.0, 4.0), Vector3::new(0.3, -0.15, 1.1))
}

fn pose(x: f64, y: f64, heading: f64) -> PersonFrame {
    PersonFrame::new(Vector3::new(x, y, 0.0), heading).unwrap()
}

#[test]
fn a_walking_person_is_followed_without_lag() {
    let mut placement = Placement::new(ours(), pose(0.0, 0.0, 0.0), PlacementLimits::default());
    let placement = placement.as_mut().unwrap();
    for tick in 1..=2000 {
        let there = pose(1.4 * f64::from(tick) * TICK, 0.0, 0.5 * f64::from(tick) * TICK);
        placement.observe(there);
        placement.advance(TICK).unwrap();
        assert!((placement.frame().position() - there.position()).norm() < 1e-9);
        assert_eq!(*placement.world(), ours().placed(placement.frame()));
    }
}

#[test]
fn the_shorter_way_round_is_taken() {
    let mut placement =
        Placement::new(ours(), pose(0.0, 0.0, 3.0), PlacementLimits::default()).unwrap();
    placement.observe(pose(0.0, 0.0, -3.0));
    placement.advance(TICK).unwrap();
    assert!(placement.frame().heading() > 3.0);
    for _ in 0..1000 {
        placement.advance(TICK).unwrap();
    }
    let difference = placement.frame().heading() + 3.0;
    assert!((difference - core::f64::consts::TAU).abs() < 1e-9);
}

#[test]
fn bad_numbers_are_refused() {
    let limits = PlacementLimits { speed: 0.0, ..PlacementLimits::default() };
    assert!(Placement::new(ours(), pose(0.0, 0.0, 0.0), limits).is_err());
    let mut placement =
        Placement::new(ours(), pose(0.0, 0.0, 0.0), PlacementLimits::default()).unwrap();
    for dt in [0.0, -0.001, f64::NAN, 5.0] {
        let error = placement.advance(dt).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { name: "dt", .. } | Error::NotFinite { .. }));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn jumps_change_the_terms_no_faster_than_the_bounds(
        jumps in proptest::collection::vec(
            (-5.0..5.0_f64, -5.0..5.0_f64, -9.0..9.0_f64, any::<bool>()), 1..6),
    ) {
        let other = quadratic(Vector3::new(3.0, 8.0, 2.0), Vector3::new(0.4, 0.1, 1.3));
        let mut placement =
            Placement::new(ours(), pose(0.0, 0.0, 0.0), PlacementLimits::default()).unwrap();
        let mut before = *placement.world();
        for (x, y, heading, swap) in jumps {
            placement.observe(pose(x, y, heading));
            placement.replace(if swap { other } else { ours() });
            for _ in 0..300 {
                let hessian_bound = placement.hessian_rate_bound() * TICK;
                let place = *placement.frame().position();
                let hand = place + Vector3::new(0.3, 0.4, 1.1);
                let gradient_bound = placement.gradient_rate_bound(1.3) * TICK;
                let now = *placement.advance(TICK).unwrap();
                prop_assert!(
                    (now.hessian() - before.hessian()).norm() <= hessian_bound * (1.0 + 1e-9)
                );
                let change = now.gradient_at(&hand) - before.gradient_at(&hand);
                prop_assert!(change.norm() <= gradient_bound * (1.0 + 1e-9));
                // Always convex.
                prop_assert!(now.hessian().symmetric_eigenvalues().min() >= 2.0 - 1e-9);
                before = now;
            }
        }
    }

    #[test]
    fn it_arrives(x in -3.0..3.0_f64, y in -3.0..3.0_f64, heading in -3.0..3.0_f64) {
        let other = quadratic(Vector3::new(3.0, 8.0, 2.0), Vector3::new(0.4, 0.1, 1.3));
        let mut placement =
            Placement::new(ours(), pose(0.0, 0.0, 0.0), PlacementLimits::default()).unwrap();
        placement.observe(pose(x, y, heading));
        placement.replace(other);
        for _ in 0..3000 {
            placement.advance(TICK).unwrap();
        }
        let arrived = other.placed(&pose(x, y, heading));
        prop_assert!((placement.world().hessian() - arrived.hessian()).norm() < 1e-9);
        prop_assert!((placement.world().gradient() - arrived.gradient()).norm() < 1e-9);
    }
}
