//! Comparison of shapes with brute force: random points, directions and finite differences.

use crate::support::*;
use hrsw::{
    Bounds, Capsule, Cone, Error, HalfSpace, OrientationShape, OrientedBox, Polytope,
    PositionShape, Workspace,
};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Returns the corners of a box with this pose.
fn corners(bounds: &Bounds, pose: &Isometry3<f64>) -> Vec<Vector3<f64>> {
    let ends = [bounds.min(), bounds.max()];
    let corner = |i: usize| {
        let corner = Vector3::from_fn(|axis, _| ends[i >> axis & 1][axis]);
        (pose * Point3::from(corner)).coords
    };
    (0..8).map(corner).collect()
}

proptest! {
    #[test]
    fn the_nearest_point_is_within_and_nearest(
        shape in position_shape(), point in vector(1.5),
        others in prop::collection::vec(vector(1.0), 200),
    ) {
        let nearest = shape.nearest(&point);
        let distance = (nearest - point).norm();
        prop_assert!(shape.signed_distance(&nearest) < 1e-9);
        prop_assert!((shape.signed_distance(&point).max(0.0) - distance).abs() < 1e-9);
        for other in others {
            if shape.contains(&other) {
                prop_assert!((other - point).norm() >= distance - 1e-9);
            }
        }
    }

    #[test]
    fn within_the_signed_distance_is_the_largest_ball(
        shape in position_shape(), off_center in vector(0.15),
        directions in prop::collection::vec(direction(), 100),
    ) {
        let point = shape.extent().center() + off_center;
        let depth = -shape.signed_distance(&point);
        if depth < 1e-6 {
            return Ok(());
        }
        for direction in directions {
            prop_assert!(shape.contains(&(point + direction * (depth * (1.0 - 1e-9)))));
        }
        let leaves = (0..shape.row_count()).any(|i| {
            let face = shape.half_space(i, &point).unwrap();
            !shape.contains(&(point + face.normal() * (depth + 1e-6)))
        });
        prop_assert!(leaves);
    }

    #[test]
    fn half_spaces_separate_the_shape_from_points_outside(
        shape in position_shape(), point in vector(1.5),
        others in prop::collection::vec(vector(1.0), 100),
    ) {
        let faces: Vec<HalfSpace> =
            (0..shape.row_count()).map(|i| shape.half_space(i, &point).unwrap()).collect();
        prop_assert!(shape.half_space(shape.row_count(), &point).is_none());
        for other in others.iter().filter(|other| shape.contains(other)) {
            prop_assert!(faces.iter().all(|face| face.signed_distance(other) < 1e-9));
        }
        let farthest = faces.iter().map(|f| f.signed_distance(&point)).fold(f64::MIN, f64::max);
        let distance = shape.signed_distance(&point);
        prop_assert!(farthest <= distance + 1e-9);
        prop_assert_eq!(farthest > 1e-9, distance > 1e-9);
        for face in &faces {
            prop_assert!(shape.support(face.normal()) <= face.offset() + 1e-6);
        }
    }

    #[test]
    fn the_support_function_bounds_the_shape_tightly(
        shape in position_shape(), direction in direction(),
        others in prop::collection::vec(vector(1.0), 100),
    ) {
        let (support, extent) = (shape.support(&direction), shape.extent());
        for other in others.into_iter().filter(|other| shape.contains(other)) {
            prop_assert!(direction.dot(&other) <= support + 1e-9);
            prop_assert!(extent.signed_distance(&other) < 1e-6);
        }
        // The nearest point to one far away is nearly the farthest one in that direction.
        let reach = direction.dot(&shape.nearest(&(direction * 1e4)));
        prop_assert!((reach - support).abs() < 1e-3, "{reach} {support}");
    }

    #[test]
    fn a_hull_contains_its_points_as_corners(
        points in prop::collection::vec(vector(1.0), 5..20),
    ) {
        let Ok(hull) = Polytope::hull(&points) else { return Ok(()) };
        for point in &points {
            prop_assert!(hull.signed_distance(point) < 1e-6);
        }
        for vertex in hull.vertices() {
            prop_assert!(points.iter().any(|point| (point - vertex).norm() < 1e-5));
        }
    }

    #[test]
    fn boxes_by_half_spaces_or_corners_are_equal(
        bounds in bounds(), pose in pose(0.5, 1.5), point in vector(1.5),
    ) {
        prop_assume!((bounds.max() - bounds.min()).min() > 1e-4);
        let oriented = PositionShape::from(OrientedBox::new(pose, bounds).unwrap());
        let faces: Vec<HalfSpace> =
            (0..6).map(|i| oriented.half_space(i, &point).unwrap()).collect();
        let corners = corners(&bounds, &pose);
        for polytope in [Polytope::new(&faces).unwrap(), Polytope::hull(&corners).unwrap()] {
            prop_assert_eq!(polytope.faces().len(), 6);
            prop_assert_eq!(polytope.vertices().len(), 8);
            let distance = oriented.signed_distance(&point);
            prop_assert!((polytope.signed_distance(&point) - distance).abs() < 1e-6);
        }
    }

    #[test]
    fn the_nearest_orientation_is_within_and_nearest(
        shape in orientation_shape(), rotation in rotation(),
        others in prop::collection::vec(rotation(), 100),
    ) {
        let nearest = shape.nearest(&rotation);
        prop_assert!(shape.signed_distance(&nearest) < 1e-7);
        prop_assert_eq!(shape.contains(&rotation), shape.signed_distance(&rotation) <= 0.0);
        if let OrientationShape::Cone(_) = shape {
            let distance = rotation.angle_to(&nearest);
            prop_assert!((shape.signed_distance(&rotation).max(0.0) - distance).abs() < 1e-7);
            for other in others.iter().filter(|other| shape.contains(other)) {
                prop_assert!(rotation.angle_to(other) >= distance - 1e-7);
            }
        }
    }

    #[test]
    fn the_roll_of_a_cone_is_free(
        axis in direction(), to in direction(), rotation in rotation(), roll in -3.0..3.0_f64,
    ) {
        let cone = Cone::new(axis, to, 0.5).unwrap();
        let rolled = rotation * UnitQuaternion::from_axis_angle(cone.axis(), roll);
        prop_assert!((cone.angle(&rolled) - cone.angle(&rotation)).abs() < 1e-9);
    }

    /// d excess/dt = gradient · ẋ + drift for every shape, with a moving frame and reference.
    #[test]
    fn rows_give_the_rate_of_their_excess(
        workspace in workspace(), relative in pose(1.0, 1.2), velocity in twist(),
    ) {
        let pose = workspace.world_from_workspace() * relative;
        let step = 1e-6;
        let at = |time: f64| {
            let mut later = moved(&workspace, time);
            let rate = workspace.reference_rate() * time;
            let turned = UnitQuaternion::from_scaled_axis(rate) * workspace.reference();
            later.set_reference(turned, *workspace.reference_rate()).unwrap();
            let pose = ahqp_core::integrate_pose(&pose, &velocity, time);
            later.rows(&pose).map(|row| row.excess).collect::<Vec<_>>()
        };
        let (before, after) = (at(-step), at(step));
        for (i, row) in workspace.rows(&pose).enumerate() {
            let difference = (after[i] - before[i]) / (2.0 * step);
            let rate = row.gradient.dot(&velocity) + row.drift;
            prop_assert!((rate - difference).abs() < 1e-5, "{rate} {difference}");
        }
    }

    #[test]
    fn a_pose_within_exceeds_no_row(
        workspace in workspace(), relative in pose(1.0, 1.0),
    ) {
        let pose = workspace.world_from_workspace() * relative;
        let exceeds = workspace.rows(&pose).map(|row| row.excess).fold(f64::MIN, f64::max);
        prop_assume!(exceeds.abs() > 1e-9);
        prop_assert_eq!(workspace.contains(&pose), exceeds <= 0.0);
        prop_assert_eq!(workspace.violation(&pose).norm() > 0.0, exceeds > 0.0);
    }
}

#[test]
fn bad_shapes_are_named() {
    let face = |x: f64, y: f64, z: f64, d: f64| HalfSpace::new(Vector3::new(x, y, z), d).unwrap();
    let nan = Vector3::new(f64::NAN, 0.0, 0.0);
    assert!(matches!(HalfSpace::new(nan, 0.0), Err(Error::Value { .. })));
    assert!(matches!(HalfSpace::new(Vector3::zeros(), 0.0), Err(Error::Value { .. })));
    assert!(matches!(Polytope::new(&[]), Err(Error::Unbounded { .. })));
    assert!(matches!(Polytope::new(&[face(1.0, 0.0, 0.0, 1.0)]), Err(Error::Unbounded { .. })));
    let empty = [face(1.0, 0.0, 0.0, -1.0), face(-1.0, 0.0, 0.0, -1.0)];
    assert!(matches!(Polytope::new(&empty), Err(Error::NoVolume { .. })));
    let flat = [face(1.0, 0.0, 0.0, 1.0), face(-1.0, 0.0, 0.0, -1.0)];
    let mut walls = vec![
        face(0.0, 1.0, 0.0, 1.0),
        face(0.0, -1.0, 0.0, 1.0),
        face(0.0, 0.0, 1.0, 1.0),
        face(0.0, 0.0, -1.0, 1.0),
    ];
    walls.extend(flat);
    assert!(matches!(Polytope::new(&walls), Err(Error::NoVolume { faces: 6 })));
    let many = vec![face(1.0, 0.0, 0.0, 1.0); 65];
    assert!(matches!(Polytope::new(&many), Err(Error::TooMany { got: 65, .. })));
    assert!(matches!(Polytope::hull(&[]), Err(Error::NoVolume { .. })));
    assert!(matches!(Polytope::hull(&[Vector3::x(); 9]), Err(Error::NoVolume { .. })));
    let plane: Vec<_> =
        (0..9).map(|i| Vector3::new(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
    assert!(matches!(Polytope::hull(&plane), Err(Error::NoVolume { .. })));
    assert!(matches!(Polytope::hull(&[nan; 4]), Err(Error::Value { .. })));

    let zero = Vector3::zeros();
    assert!(matches!(Capsule::sphere(zero, -0.1), Err(Error::Value { .. })));
    assert!(matches!(Capsule::new(zero, nan, 0.1), Err(Error::Value { .. })));
    let z = Vector3::z();
    assert!(matches!(Cone::new(zero, z, 0.1), Err(Error::Value { .. })));
    assert!(matches!(Cone::new(z, z, -0.1), Err(Error::Value { .. })));
    assert!(matches!(Cone::new(z, z, std::f64::consts::PI), Err(Error::Value { .. })));
    assert!(matches!(Cone::new(z, z, f64::NAN), Err(Error::Value { .. })));

    let unit = Bounds::symmetric(Vector3::repeat(1.0)).unwrap();
    let doubled = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(2.0, 0.0, 0.0, 0.0));
    let stretched = Isometry3::from_parts(Vector3::zeros().into(), doubled);
    assert!(matches!(Workspace::new(stretched, unit, unit), Err(Error::Value { .. })));
    assert!(matches!(OrientedBox::new(stretched, unit), Err(Error::Value { .. })));
    let mut workspace = Workspace::new(Isometry3::identity(), unit, unit).unwrap();
    let before = workspace.clone();
    let wide = Bounds::symmetric(Vector3::repeat(2.0)).unwrap();
    assert!(workspace.reshape_orientation(wide, 1.0).is_err());
    assert!(workspace.reshape_position(unit, f64::NAN).is_err());
    assert!(workspace.set_reference(doubled, zero).is_err());
    assert!(workspace.set_reference(UnitQuaternion::identity(), nan).is_err());
    assert_eq!(workspace, before);
}

#[test]
fn a_thin_plate_is_no_plane() {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.988_322);
    for thickness in [1e-2, 1e-3, 1e-4] {
        let half = Bounds::symmetric(Vector3::new(thickness / 2.0, 0.5, 0.43)).unwrap();
        let pose = Isometry3::from_parts(Vector3::new(-0.38, 0.0, 0.1).into(), turn);
        let hull = Polytope::hull(&corners(&half, &pose)).unwrap();
        assert_eq!((hull.faces().len(), hull.vertices().len()), (6, 8));
    }
}
