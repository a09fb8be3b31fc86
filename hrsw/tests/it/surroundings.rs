//! Reach and forbidden regions against sampling.

use crate::support::*;
use hrsw::{Bounds, Capsule, Error, ForbiddenRegion, Intersection, Reach, Surroundings, Workspace};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;

fn reach() -> impl Strategy<Value = Reach> {
    (vector(1.0), 0.0..0.4_f64, 0.1..1.0_f64)
        .prop_map(|(center, inner, width)| Reach::new(center, inner, inner + width).unwrap())
}

fn region() -> impl Strategy<Value = ForbiddenRegion> {
    (pose(1.0, 1.5), position_shape(), 0.0..0.1_f64)
        .prop_map(|(pose, shape, margin)| ForbiddenRegion::new(pose, shape, margin).unwrap())
}

fn surroundings() -> impl Strategy<Value = Surroundings> {
    (prop::option::of(reach()), prop::collection::vec(region(), 0..3))
        .prop_map(|(reach, forbidden)| Surroundings { reach, forbidden })
}

proptest! {
    #[test]
    fn rows_are_exceeded_exactly_out_of_reach_or_in_a_region(
        around in surroundings(), at in pose(1.5, 1.0),
    ) {
        let point = at.translation.vector;
        let rows: Vec<_> = around.rows(&at).collect();
        prop_assert_eq!(rows.len(), around.row_count());
        let exceeds = rows.iter().map(|row| row.excess).fold(f64::MIN, f64::max);
        let out = around.reach.iter().map(|reach| reach.signed_distance(&point));
        let within = around.forbidden.iter().map(|region| region.depth(&point));
        let worst = out.chain(within).fold(f64::MIN, f64::max);
        prop_assert!((exceeds - worst).abs() < 1e-9 || exceeds == worst);
    }

    #[test]
    fn rows_give_the_rate_of_their_excess(
        around in surroundings(), at in pose(1.5, 1.0), velocity in twist(),
    ) {
        let step = 1e-6;
        let excess = |time: f64| {
            let moved = ahqp_core::integrate_pose(&at, &velocity, time);
            around.rows(&moved).map(|row| row.excess).collect::<Vec<_>>()
        };
        let (before, after) = (excess(-step), excess(step));
        for (i, row) in around.rows(&at).enumerate() {
            let difference = (after[i] - before[i]) / (2.0 * step);
            prop_assert!((row.gradient.dot(&velocity) + row.drift - difference).abs() < 1e-3);
        }
    }

    /// A point that is found is one; where sampling finds many, one is found.
    #[test]
    fn a_common_position_is_found(
        around in surroundings(), frame in pose(0.5, 1.0), shape in position_shape(),
        samples in prop::collection::vec(vector(1.2), 300),
    ) {
        let turn = Bounds::symmetric(Vector3::repeat(0.1)).unwrap();
        let workspace = Workspace::new(frame, shape.clone(), turn).unwrap();
        let admitted = |point: &Vector3<f64>, tolerance: f64| {
            let local = frame.inverse_transform_point(&Point3::from(*point)).coords;
            shape.signed_distance(&local) <= tolerance
                && around.reach.iter().all(|reach| reach.signed_distance(point) <= tolerance)
                && around.forbidden.iter().all(|region| region.depth(point) <= tolerance)
        };
        if let Intersection::Point(point) = around.intersection(&workspace) {
            prop_assert!(admitted(&point, 1.1e-4));
        } else {
            let points = samples.iter().map(|v| (frame * Point3::from(*v)).coords);
            let many = points.filter(|point| admitted(point, -0.01)).count();
            prop_assert!(many == 0, "{many} of 300");
        }
    }
}

#[test]
fn emptiness_is_reported_with_its_reason() {
    let unit = Bounds::symmetric(Vector3::repeat(0.5)).unwrap();
    let workspace = Workspace::new(Isometry3::identity(), unit, unit).unwrap();
    let far = Reach::new(Vector3::new(3.0, 0.0, 0.0), 0.2, 0.8).unwrap();
    let mut around = Surroundings { reach: Some(far), forbidden: Vec::new() };
    assert_eq!(around.intersection(&workspace), Intersection::OutOfReach);
    if let Some(reach) = &mut around.reach {
        reach.move_to(Vector3::new(1.0, 0.0, 0.0)).unwrap();
    }
    assert!(matches!(around.intersection(&workspace), Intersection::Point(_)));
    let everywhere = Capsule::sphere(Vector3::zeros(), 2.0).unwrap();
    let region = ForbiddenRegion::new(Isometry3::identity(), everywhere, 0.0).unwrap();
    around.forbidden.push(region);
    assert_eq!(around.intersection(&workspace), Intersection::Forbidden { region: 0 });
}

#[test]
fn bad_surroundings_are_named() {
    let zero = Vector3::zeros();
    assert!(matches!(Reach::new(zero, 0.5, 0.5), Err(Error::Parameter { .. })));
    assert!(matches!(Reach::new(zero, -0.5, 0.5), Err(Error::Parameter { .. })));
    assert!(matches!(Reach::new(zero * f64::NAN, 0.1, 0.5), Err(Error::NotFinite { .. })));
    let unit = Bounds::symmetric(Vector3::repeat(0.5)).unwrap();
    assert!(ForbiddenRegion::new(Isometry3::identity(), unit, -0.1).is_err());
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(ForbiddenRegion::new(nowhere, unit, 0.1).is_err());
}
