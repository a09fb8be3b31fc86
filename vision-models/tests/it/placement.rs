//! Places of cameras found from points.

use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use vision_models::CameraPlacement;

fn vectors(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

/// A pose, and points of a metre around the origin with errors of their places in the camera.
fn scenes(error: f64) -> impl Strategy<Value = (Isometry3<f64>, Vec<[Point3<f64>; 2]>)> {
    let pose = (vectors(3.0), vectors(1.8)).prop_map(|(place, turn)| Isometry3::new(place, turn));
    let points = prop::collection::vec((vectors(1.0), vectors(error)), 4..12);
    (pose, points).prop_map(|(pose, points)| {
        let seen = points.into_iter().map(|(point, error)| {
            let point = Point3::from(point);
            [pose.inverse_transform_point(&point) + error, point]
        });
        (pose, seen.collect())
    })
}

fn squares(pose: &Isometry3<f64>, pairs: &[[Point3<f64>; 2]]) -> f64 {
    pairs.iter().map(|[seen, world]| (pose * seen - world).norm_squared()).sum()
}

proptest! {
    #[test]
    fn exact_points_give_the_pose((pose, pairs) in scenes(1e-300)) {
        let found = CameraPlacement::fit(&pairs);
        prop_assume!(found.is_ok());
        let found = found.unwrap();
        let wrong = found.world_from_camera.inverse() * pose;
        prop_assert!(wrong.translation.vector.norm() < 1e-9 && wrong.rotation.angle() < 1e-9);
        prop_assert!(found.deviation() < 1e-9);
    }

    /// No pose nearby, and not the true one, has a smaller sum of squares.
    #[test]
    fn no_other_pose_fits_better(
        (pose, pairs) in scenes(0.02), place in vectors(0.01), turn in vectors(0.01),
    ) {
        let found = CameraPlacement::fit(&pairs);
        prop_assume!(found.is_ok());
        let found = found.unwrap();
        let least = squares(&found.world_from_camera, &pairs);
        let near = Isometry3::new(place, turn) * found.world_from_camera;
        prop_assert!(least <= squares(&near, &pairs) + 1e-12);
        prop_assert!(least <= squares(&pose, &pairs) + 1e-12);
        let root = (least / pairs.len() as f64).sqrt();
        prop_assert!((found.deviation() - root).abs() < 1e-9);
    }
}

#[test]
fn unusable_points_are_refused() {
    let pair = |x: f64, y: f64| [Point3::new(x, y, 1.0), Point3::new(x, y, 0.0)];
    let refused = |pairs: &[[Point3<f64>; 2]]| CameraPlacement::fit(pairs).unwrap_err().to_string();
    assert!(refused(&[pair(0.0, 0.0), pair(1.0, 0.0)]).contains("three or more"));
    let line = [pair(0.0, 0.0), pair(0.5, 0.01), pair(1.0, 0.0), pair(2.0, 0.0)];
    assert!(refused(&line).contains("away from a common line"));
    assert!(refused(&[pair(0.0, 0.0), pair(1.0, 0.0), pair(0.0, f64::NAN)]).contains("NaN"));
    assert!(CameraPlacement::fit(&[pair(0.0, 0.0), pair(1.0, 0.0), pair(0.0, 1.0)]).is_ok());
}
