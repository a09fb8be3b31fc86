//! Converts pixels and depth to points of the world.

use nalgebra::{Isometry3, Matrix3, Point2, Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use vision_models::{
    Body25, Camera, Confidence, CrossSection, DepthImage, DepthNoise, Error, ImageBody,
    ImageKeypoint, Intrinsics, Lifter, LiftingSettings, SkinDepths, read_depth,
};

const SIZE: [usize; 2] = [160, 120];

fn intrinsics() -> Intrinsics {
    Intrinsics::new(SIZE, [150.0, 152.0], [79.0, 60.5]).unwrap()
}

fn camera() -> Camera {
    let (eye, target) = (Point3::new(0.3, 1.8, 2.3), Point3::new(1.5, 0.0, 1.0));
    Camera::looking_at(intrinsics(), eye, target, DepthNoise::D435I).unwrap()
}

fn lifter(camera: Camera) -> Lifter {
    Lifter::new(camera, LiftingSettings::default()).unwrap()
}

#[allow(clippy::cast_possible_truncation)] // a depth needs no more digits
fn flat(depth: f64) -> DepthImage {
    let depth = depth as f32;
    DepthImage::from_metres(SIZE, vec![depth; SIZE[0] * SIZE[1]]).unwrap()
}

fn image(joints: &[(Body25, Point2<f64>)]) -> ImageBody {
    let mut body = ImageBody::default();
    for &(joint, position) in joints {
        body.set(joint, Some(ImageKeypoint { position, confidence: Confidence::ONE }));
    }
    body
}

proptest! {
    /// A point of the world is recovered from its pixel and its depth, as far behind the skin as
    /// the settings say.
    #[test]
    fn projection_and_lifting_are_inverse(
        x in 1.0..2.0_f64, y in -0.4..0.4_f64, z in 0.7..1.5_f64, skin in 0.0..0.1_f64,
    ) {
        let camera = camera();
        let joint = Point3::new(x, y, z);
        let eye = Point3::from(camera.world_from_camera().translation.vector);
        let on_skin = joint + (eye - joint).normalize() * skin;
        let pixel = camera.project(&joint).unwrap();
        let depth = camera.world_from_camera().inverse_transform_point(&on_skin).z;
        let settings = LiftingSettings {
            skin: SkinDepths { wrists: skin, ..SkinDepths::default() },
            ..LiftingSettings::default()
        };
        let lifter = Lifter::new(camera, settings).unwrap();
        let body = lifter.lift(&image(&[(Body25::LeftWrist, pixel)]), &flat(depth), None).unwrap();
        let found = body.get(Body25::LeftWrist).unwrap().position;
        prop_assert!((found - joint).norm() < 1e-6, "{found} for {joint}");
    }

    /// A joint seen from any side lies behind the outline of its section.
    #[test]
    fn a_joint_is_as_deep_as_its_section(
        width in 0.05..0.3_f64, depth in 0.05..0.3_f64, share in -0.95..0.95_f64, bearing in -4.0..4.0_f64,
    ) {
        let section = CrossSection { half_width: width, half_depth: depth };
        let aside = share * width;
        let skin = section.depth(aside, bearing);
        let [ahead, left] = [skin * bearing.cos(), aside + skin * bearing.sin()];
        let outline = (ahead / depth).powi(2) + (left / width).powi(2);
        prop_assert!(skin > 0.0 && (outline - 1.0).abs() < 1e-9, "{skin}: {outline}");
    }

    /// A motion of the camera moves joints and covariances with it.
    #[test]
    fn lifting_moves_with_the_camera(turn in -3.0..3.0_f64, x in -2.0..2.0_f64) {
        let here = camera();
        let motion = Isometry3::new(Vector3::new(x, 0.5, 0.1), Vector3::z() * turn);
        let there = Camera::new(intrinsics(), motion * here.world_from_camera(), *here.noise());
        let seen = image(&[(Body25::Neck, Point2::new(60.0, 40.0)), (Body25::MidHip, Point2::new(61.0, 80.0))]);
        let depth = flat(2.5);
        let here = lifter(here).lift(&seen, &depth, None).unwrap();
        let there = lifter(there.unwrap()).lift(&seen, &depth, None).unwrap();
        let moved = here.transformed(&motion);
        for joint in [Body25::Neck, Body25::MidHip] {
            let difference = moved.get(joint).unwrap().position - there.get(joint).unwrap().position;
            prop_assert!(difference.norm() < 1e-9);
            let difference = moved.covariance(joint).unwrap() - there.covariance(joint).unwrap();
            prop_assert!(difference.norm() < 1e-12);
        }
    }

    /// Compares the covariance with the errors of a sample of keypoints and depths.
    #[test]
    fn the_covariance_is_that_of_the_errors(column in 30.0..130.0_f64, row in 20.0..100.0_f64, z in 1.0..3.0_f64) {
        let settings = LiftingSettings { skin_sigma: 0.0, ..LiftingSettings::default() };
        let camera = camera();
        let lifter = Lifter::new(camera, settings).unwrap();
        let lift = |du: f64, dv: f64, dz: f64| {
            let seen = image(&[(Body25::LeftWrist, Point2::new(column + du, row + dv))]);
            let body = lifter.lift(&seen, &flat(z + dz), None).unwrap();
            (body.get(Body25::LeftWrist).unwrap().position, body.covariance(Body25::LeftWrist).unwrap())
        };
        // Symmetric points of each error reproduce its variance.
        let (pixels, depth) = (settings.pixel_sigma, camera.noise().sigma(z));
        let mut expected = Matrix3::zeros();
        for [du, dv, dz] in [[pixels, 0.0, 0.0], [0.0, pixels, 0.0], [0.0, 0.0, depth]] {
            let difference = 0.5 * (lift(du, dv, dz).0 - lift(-du, -dv, -dz).0);
            expected += difference * difference.transpose();
        }
        let (_, covariance) = lift(0.0, 0.0, 0.0);
        // The depth of the skin is along the ray, whose direction changes a little with the pixel.
        prop_assert!((covariance - expected).norm() < 0.1 * expected.norm(), "{covariance} for {expected}");
    }
}

/// A person in front of a wall, whose left half is hidden by a post. The hidden joints are left
/// out, because no arm reaches the post.
#[test]
fn joints_beyond_reach_are_left_out() {
    let camera = camera();
    let depths = (0..SIZE[0] * SIZE[1])
        .map(|index| {
            if index % SIZE[0] < 40 {
                1.2
            } else if index % SIZE[0] < 120 {
                2.5
            } else {
                5.0
            }
        })
        .collect();
    let depth = DepthImage::from_metres(SIZE, depths).unwrap();
    let joints = [
        (Body25::Neck, 80.0),
        (Body25::LeftShoulder, 90.0),
        (Body25::MidHip, 80.0),
        (Body25::LeftWrist, 20.0),
        (Body25::RightWrist, 140.0),
        (Body25::RightElbow, 70.0),
    ];
    let joints: Vec<_> = joints.iter().map(|&(joint, x)| (joint, Point2::new(x, 60.0))).collect();
    let body = lifter(camera).lift(&image(&joints), &depth, None).unwrap();
    let seen: Vec<_> = body.iter().map(|(joint, _)| joint).collect();
    assert_eq!(seen, [Body25::Neck, Body25::RightElbow, Body25::LeftShoulder, Body25::MidHip]);
}

/// If a hand hides a hip, the hip is left out, because no person leans so far back.
#[test]
fn hips_behind_a_hand_are_left_out() {
    let eye = Point3::new(-2.0, 0.0, 1.2);
    let camera =
        Camera::looking_at(intrinsics(), eye, Point3::new(0.0, 0.0, 1.2), DepthNoise::D435I)
            .unwrap();
    let lift = |heading: f64| {
        let depths = (0..SIZE[0] * SIZE[1])
            .map(|index| if index / SIZE[0] > 70 { 1.7 } else { 2.0 })
            .collect();
        let depth = DepthImage::from_metres(SIZE, depths).unwrap();
        let seen = image(&[
            (Body25::Neck, Point2::new(79.0, 40.0)),
            (Body25::MidHip, Point2::new(79.0, 90.0)),
        ]);
        lifter(camera).lift(&seen, &depth, Some(heading)).unwrap()
    };
    // A person who faces the camera, and a person who turns their back to it and bends.
    assert!(lift(std::f64::consts::PI).get(Body25::MidHip).is_none());
    assert!(lift(0.0).get(Body25::MidHip).is_some());
}

#[test]
fn at_an_edge_the_depth_is_less_certain() {
    let depths = (0..SIZE[0] * SIZE[1]).map(|index| if index % SIZE[0] < 82 { 2.5 } else { 3.5 });
    let depth = DepthImage::from_metres(SIZE, depths.collect()).unwrap();
    let at = |x: f64| {
        let seen = image(&[(Body25::LeftElbow, Point2::new(x, 60.0))]);
        let body = lifter(camera()).lift(&seen, &depth, None).unwrap();
        body.covariance(Body25::LeftElbow).unwrap().trace()
    };
    assert!(at(80.0) > at(60.0));
}

#[test]
fn images_of_another_size_are_refused() {
    let other = DepthImage::from_metres([80, 60], vec![1.0; 4800]).unwrap();
    let error = lifter(camera()).lift(&ImageBody::default(), &other, None).unwrap_err();
    assert!(matches!(&error, Error::Size { got, .. } if *got == [80, 60]), "{error}");
    assert!(error.to_string().contains("aligned"), "{error}");
    assert!(matches!(
        DepthImage::from_units([3, 2], &[0; 5], 0.001),
        Err(Error::Size { got, .. }) if got == [5]
    ));
    assert!(DepthImage::from_metres([usize::MAX, 2], vec![1.0]).is_err());
    assert!(DepthImage::from_metres([0, 0], Vec::new()).is_err());
    assert!(DepthImage::from_units([1, 1], &[1], f64::NAN).is_err());
}

#[test]
fn a_camera_upside_down_is_refused() {
    let upright = *camera().world_from_camera();
    let about_axis = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
    let rolled = Isometry3::from_parts(upright.translation, upright.rotation * about_axis);
    let error = Camera::new(intrinsics(), rolled, DepthNoise::D435I).unwrap_err();
    assert!(error.to_string().contains("upside down"), "{error}");
    // A camera that looks straight down is allowed.
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let above = Isometry3::from_parts(upright.translation, down);
    assert!(Camera::new(intrinsics(), above, DepthNoise::D435I).is_ok());
    // Gravity that contradicts the pose is rejected.
    let camera = camera();
    let gravity = camera.world_from_camera().rotation.inverse() * -Vector3::z();
    assert!(camera.check_gravity(&gravity).is_ok());
    for wrong in [-gravity, Vector3::zeros(), Vector3::repeat(f64::NAN), Vector3::x()] {
        assert!(matches!(camera.check_gravity(&wrong), Err(Error::Value { .. })), "{wrong}");
    }
}

#[test]
fn wrong_cameras_and_settings_are_named() {
    for (size, focal, centre, expected) in [
        ([0, 4], [1.0, 1.0], [0.0, 0.0], "width"),
        ([4, 4], [f64::NAN, 1.0], [0.0, 0.0], "fx"),
        ([4, 4], [1.0, 0.0], [0.0, 0.0], "fy"),
        ([4, 4], [1.0, 1.0], [9.0, 0.0], "cx"),
        ([4, 4], [1.0, 1.0], [0.0, f64::NAN], "cy"),
    ] {
        match Intrinsics::new(size, focal, centre) {
            Err(Error::Value { what, .. }) => assert_eq!(what, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let error = Camera::new(intrinsics(), nowhere, DepthNoise::D435I).unwrap_err();
    assert!(error.to_string().contains("pose is not finite"), "{error}");
    let base = LiftingSettings::default;
    for (expected, settings) in [
        ("window", LiftingSettings { window: 0.0, ..base() }),
        ("range", LiftingSettings { range: [2.0, 1.0], ..base() }),
        ("edge", LiftingSettings { edge: f64::NAN, ..base() }),
        (
            "skin.knees",
            LiftingSettings { skin: SkinDepths { knees: -1.0, ..SkinDepths::default() }, ..base() },
        ),
    ] {
        match Lifter::new(camera(), settings) {
            Err(Error::Value { what, .. }) => assert_eq!(what, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
}

#[test]
fn depth_files_are_sixteen_bits_of_grey() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("depth.png");
    let units: Vec<u16> = (0..12).map(|value| 1000 + value).collect();
    image::ImageBuffer::<image::Luma<u16>, _>::from_raw(4, 3, units.clone())
        .unwrap()
        .save(&path)
        .unwrap();
    let depth = read_depth(&path, 0.001).unwrap();
    assert_eq!(depth, DepthImage::from_units([4, 3], &units, 0.001).unwrap());
    assert!(read_depth(&path, 0.0).is_err());
    image::RgbImage::new(4, 3).save(&path).unwrap();
    let error = read_depth(&path, 0.001).unwrap_err().to_string();
    assert!(error.contains("depth.png") && error.contains("16 bits"), "{error}");
    std::fs::write(&path, b"no image").unwrap();
    assert!(matches!(read_depth(&path, 0.001), Err(Error::Image { .. })));
    assert!(matches!(
        read_depth(folder.path().join("missing.png"), 0.001),
        Err(Error::File { .. })
    ));
}
