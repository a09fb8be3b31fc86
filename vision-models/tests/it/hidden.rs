//! Joints that the body itself hides from a depth camera, though a detector states them.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Point3, Vector2};
use proptest::prelude::*;
use vision_models::{
    Body, Body25, Camera, Confidence, DepthImage, DepthNoise, ImageBody, ImageKeypoint, Intrinsics,
    Lifter, LiftingSettings,
};

const SIZE: [usize; 2] = [160, 200];
/// Radius of a leg \[m\]. The lifter's depths of knees and ankles below the skin are others.
const LEG: f64 = 0.07;

/// A camera at the height of a hip, 2.5 m before the origin, that looks along x.
fn camera() -> Camera {
    let intrinsics = Intrinsics::new(SIZE, [200.0, 200.0], [79.5, 99.5]).unwrap();
    let (eye, target) = (Point3::new(-2.5, 0.0, 0.9), Point3::new(0.0, 0.0, 0.9));
    Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap()
}

/// Depths of upright cylinders with these places, and of a wall behind them.
#[allow(clippy::cast_possible_truncation, reason = "a depth needs no more digits")]
fn legs(places: [Vector2<f64>; 2]) -> DepthImage {
    let camera = camera();
    let eye = camera.world_from_camera().translation.vector.xy();
    let depth = |index: usize| {
        let pixel = [index % SIZE[0], index / SIZE[0]].map(|pixel| pixel as f64);
        let ray = camera.intrinsics().ray(&pixel.into());
        let along = (camera.world_from_camera() * ray).xy();
        let first = places.iter().filter_map(|place| {
            let (square, towards) = (along.norm_squared(), along.dot(&(place - eye)));
            let root = towards.powi(2) - square * ((place - eye).norm_squared() - LEG.powi(2));
            (root > 0.0).then(|| (towards - root.sqrt()) / square)
        });
        first.fold(4.0, f64::min) as f32
    };
    DepthImage::from_metres(SIZE, (0..SIZE[0] * SIZE[1]).map(depth).collect()).unwrap()
}

/// Hip, knee and ankle of the left and of the right leg.
const JOINTS: [[(Body25, f64); 3]; 2] = [
    [(Body25::LeftHip, 0.9), (Body25::LeftKnee, 0.5), (Body25::LeftAnkle, 0.1)],
    [(Body25::RightHip, 0.9), (Body25::RightKnee, 0.5), (Body25::RightAnkle, 0.1)],
];

/// Lifts legs at these places, of a person with this heading, whose joints are all stated.
fn lift(places: [Vector2<f64>; 2], heading: f64) -> Body {
    let mut image = ImageBody::default();
    for (place, leg) in places.iter().zip(JOINTS) {
        for (joint, height) in leg {
            let position = camera().project(&Point3::new(place.x, place.y, height)).unwrap();
            image.set(joint, Some(ImageKeypoint { position, confidence: Confidence::ONE }));
        }
    }
    let lifter = Lifter::new(camera(), LiftingSettings::default()).unwrap();
    lifter.lift(&image, &legs(places), Some(heading)).unwrap()
}

/// Error of a joint in standard deviations.
fn deviations(body: &Body, joint: Body25, truth: Point3<f64>) -> f64 {
    let error = body.get(joint).unwrap().position - truth;
    let weight = body.covariance(joint).unwrap().try_inverse().unwrap();
    error.dot(&(weight * error)).sqrt()
}

proptest! {
    /// Knees and ankles are within three standard deviations of where they are, also if the other leg hides them.
    #[test]
    fn hidden_legs_are_known_to_be_uncertain(
        ahead in -0.3..0.3_f64, apart in -0.25..0.25_f64, turned in 0..4_u8,
    ) {
        let places = match turned {
            // Stands sideways: the legs are beside each other along the ray.
            0 => [Vector2::new(-0.1, ahead / 2.0), Vector2::new(0.1, -ahead / 2.0)],
            1 => [Vector2::new(0.1, ahead / 2.0), Vector2::new(-0.1, -ahead / 2.0)],
            _ => [Vector2::new(-ahead / 2.0, apart / 2.0), Vector2::new(ahead / 2.0, -apart / 2.0)],
        };
        let heading = [FRAC_PI_2, -FRAC_PI_2, PI, 0.0][usize::from(turned)];
        let body = lift(places, heading);
        for (place, leg) in places.iter().zip(JOINTS) {
            for (joint, height) in &leg[1..] {
                let off = deviations(&body, *joint, Point3::new(place.x, place.y, *height));
                prop_assert!(off < 3.5, "{joint:?} is off by {off} standard deviations");
            }
        }
    }

    /// A detector states the nose of somebody from behind. Behind the skull it is not measured.
    #[test]
    fn face_behind_the_skull_is_not_measured(heading in -PI..PI) {
        let nose = Point3::new(0.11 * heading.cos(), 0.11 * heading.sin(), 0.9);
        let mut image = ImageBody::default();
        let position = camera().project(&nose).unwrap();
        image.set(Body25::Nose, Some(ImageKeypoint { position, confidence: Confidence::ONE }));
        let lifter = Lifter::new(camera(), LiftingSettings::default()).unwrap();
        let flat = DepthImage::from_metres(SIZE, vec![2.4; SIZE[0] * SIZE[1]]).unwrap();
        let is_measured = lifter.lift(&image, &flat, Some(heading)).unwrap().get(Body25::Nose).is_some();
        // A head of 9 cm radius is between the camera and the nose, or the nose is on the camera's side of it.
        let is_hidden = nose.x > 0.0 && nose.y.abs() < 0.09;
        prop_assert!(!(is_hidden && is_measured), "a nose behind the head");
        prop_assert!(nose.x > 0.0 || is_measured, "a nose before the head");
    }
}

/// Legs beside each other in the image are as certain as one alone.
#[test]
fn legs_beside_each_other_are_certain() {
    let body = lift([Vector2::new(0.0, -0.1), Vector2::new(0.0, 0.1)], PI);
    for joint in [Body25::LeftKnee, Body25::RightKnee, Body25::LeftAnkle, Body25::RightAnkle] {
        let along = body.covariance(joint).unwrap()[(0, 0)].sqrt();
        assert!(along < 0.05, "{joint:?}: {along}");
    }
}

/// From the side the nearer leg is seen. Only the farther one may be hidden.
#[test]
fn nearer_leg_is_certain_from_the_side() {
    let body = lift([Vector2::new(-0.1, 0.0), Vector2::new(0.1, 0.0)], FRAC_PI_2);
    let along = |joint| body.covariance(joint).unwrap()[(0, 0)].sqrt();
    assert!(along(Body25::LeftKnee) < 0.05 && along(Body25::RightKnee) > 0.09);
}
