//! People whom one camera without depth sees: where they are, how large, and how sure that is.

use nalgebra::{Matrix3, Point3, Rotation3, Vector3, point, vector};
use vision_models::{
    Body25, CalibratedCamera, Camera, Confidence, DepthNoise, Distortion, Error, ImageBody,
    ImageKeypoint, Intrinsics, MetricBody, MonocularLifter, MonocularSettings, ObservedBody,
    PixelNoise, PlacedBody,
};

use crate::random::Random;

/// Somebody of 1.7 m who bends forward a little, the mid hip above the origin (m).
const JOINTS: [(Body25, [f64; 3]); 17] = [
    (Body25::Nose, [0.25, 0.0, 1.48]),
    (Body25::Neck, [0.12, 0.0, 1.36]),
    (Body25::LeftShoulder, [0.12, 0.18, 1.36]),
    (Body25::RightShoulder, [0.12, -0.18, 1.36]),
    (Body25::LeftElbow, [0.22, 0.2, 1.08]),
    (Body25::RightElbow, [0.2, -0.2, 1.08]),
    (Body25::LeftWrist, [0.42, 0.15, 1.02]),
    (Body25::RightWrist, [0.4, -0.18, 0.98]),
    (Body25::MidHip, [0.0, 0.0, 0.9]),
    (Body25::LeftHip, [0.0, 0.09, 0.9]),
    (Body25::RightHip, [0.0, -0.09, 0.9]),
    (Body25::LeftKnee, [0.05, 0.1, 0.487]),
    (Body25::RightKnee, [0.03, -0.1, 0.487]),
    (Body25::LeftAnkle, [0.0, 0.1, 0.09]),
    (Body25::RightAnkle, [0.0, -0.1, 0.09]),
    (Body25::LeftBigToe, [0.18, 0.12, 0.03]),
    (Body25::RightBigToe, [0.18, -0.12, 0.03]),
];

/// Thighs and shanks of `JOINTS` (m).
const LEG: f64 = 0.8155;

const PIXEL: f64 = 3.0;
const DEPTH: f64 = 0.08;

fn camera(height: f64) -> CalibratedCamera {
    let intrinsics = Intrinsics::new([1280, 720], [1000.0, 1000.0], [639.5, 359.5]).unwrap();
    let (eye, target) = (point![0.0, 0.0, height], point![3.0, 0.0, 1.0]);
    let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap();
    let world_from_camera = Some(*camera.world_from_camera());
    let (name, distortion) = (String::new(), Distortion::None);
    CalibratedCamera { name, intrinsics, distortion, world_from_camera }
}

fn settings() -> MonocularSettings {
    let noise = PixelNoise { constant: PIXEL, share: 0.0 };
    MonocularSettings { noise, depth_sigma: DEPTH, ..MonocularSettings::default() }
}

/// The joints of the same person, `size` times as large, who stands at a place and faces a way.
fn joints(size: f64, place: Vector3<f64>, facing: f64) -> Vec<(Body25, Point3<f64>)> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), facing);
    let at = |(joint, [x, y, z]): (Body25, [f64; 3])| {
        (joint, Point3::from(turn * vector![x, y, z] * size + place))
    };
    JOINTS.map(at).to_vec()
}

/// Output of a network for them: the image, and joints in metres `size` times too small. The network sees each person as
/// if they were straight ahead.
fn observed(
    camera: &CalibratedCamera,
    joints: &[(Body25, Point3<f64>)],
    size: f64,
    [pixel, depth]: [f64; 2],
    random: &mut Random,
) -> ObservedBody {
    let pose = camera.world_from_camera.unwrap();
    let hips = joints.iter().find(|(joint, _)| *joint == Body25::MidHip).unwrap().1;
    let hips = pose.inverse_transform_point(&hips);
    let turn = Rotation3::rotation_between(&hips.coords, &Vector3::z()).unwrap();
    let (mut image, mut metric) = (ImageBody::default(), MetricBody::default());
    for (joint, place) in joints {
        let mut position = camera.project(place).unwrap();
        position += vector![pixel * random.normal(), pixel * random.normal()];
        image.set(*joint, Some(ImageKeypoint { position, confidence: Confidence::ONE }));
        let mut point = turn * (pose.inverse_transform_point(place) - hips) / size;
        point.z += depth * random.normal();
        metric.set(*joint, Some(point.into()));
    }
    ObservedBody { image, metric: Some(metric) }
}

fn at(placed: &PlacedBody, joint: Body25) -> Point3<f64> {
    placed.body.get(joint).unwrap().position
}

#[test]
fn a_person_without_errors_is_where_they_are() {
    let camera = camera(1.6);
    for (place, facing) in [(vector![3.0, 0.4, 0.0], 3.0), (vector![4.0, -1.2, 0.0], 1.0)] {
        let truth = joints(1.0, place, facing);
        let observed = observed(&camera, &truth, 1.0, [0.0; 2], &mut Random::new(1));
        let mut lifter = MonocularLifter::new(camera.clone(), settings()).unwrap();
        let placed = lifter.lift(&observed).unwrap();
        // The hips are seen in the middle of two rays.
        assert!((placed.scale - 1.0).abs() < 1e-4, "{}", placed.scale);
        for (joint, place) in truth {
            assert!((at(&placed, joint) - place).norm() < 1e-3, "{joint:?}");
        }
    }
}

#[test]
fn the_floor_tells_how_large_somebody_is() {
    for size in [0.88, 1.1] {
        let camera = camera(1.6);
        let truth = joints(size, vector![3.0, 0.2, 0.0], 2.5);
        let observed = observed(&camera, &truth, size, [0.0; 2], &mut Random::new(1));
        let lift = |settings| {
            let mut lifter = MonocularLifter::new(camera.clone(), settings).unwrap();
            lifter.lift(&observed).unwrap()
        };
        // The tape measure alone tells it, the camera's height alone, and both.
        let blind = MonocularSettings { height_sigma: 10.0, ..settings() };
        assert!((lift(blind).scale - 1.0).abs() < 0.01);
        let stature = Some(LEG * size / 0.491);
        let known = lift(MonocularSettings { stature, ..blind });
        assert!((known.scale - size).abs() < 0.01, "{}", known.scale);
        let floor = lift(settings());
        assert!((floor.scale - size).abs() < 3.0 * floor.scale_sigma);
        assert!((floor.scale - size).abs() < 0.7 * (1.0 - size).abs(), "{}", floor.scale);
        let both = lift(MonocularSettings { stature, ..settings() });
        assert!(both.scale_sigma < known.scale_sigma.min(floor.scale_sigma));
        let mut lifter = MonocularLifter::new(camera.clone(), settings()).unwrap();
        assert_eq!(lifter.stature(), None);
        lifter.lift(&observed).unwrap();
        let [own, sigma] = lifter.stature().unwrap();
        assert!((own - LEG * size / 0.491).abs() < 2.0 * sigma && sigma < 0.15, "{own} {sigma}");
    }
}

/// People of several sizes at several places: errors of joints, and of where the person is.
#[test]
fn placed_people_are_off_as_claimed() {
    let (mut own, mut world, mut count) = (0.0, 0.0, 0.0);
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let place = vector![random.within(2.5, 5.0), random.within(-1.0, 1.0), 0.0];
        let size = 1.0 + 0.06 * random.normal();
        let truth = joints(size, place, random.within(-3.0, 3.0));
        // The camera is not quite where it is said to be.
        let believed = camera(1.6 + 0.05 * random.normal());
        let observed = observed(&camera(1.6), &truth, size, [PIXEL, DEPTH], &mut random);
        let mut lifter = MonocularLifter::new(believed, settings()).unwrap();
        let placed = lifter.lift(&observed).unwrap();
        let everywhere = placed.in_world();
        let hips = |joint| at(&placed, joint).coords;
        let shift = hips(Body25::MidHip) - truth[8].1.coords;
        for (joint, truth) in truth {
            let square = |error: Vector3<f64>, covariance: Matrix3<f64>| {
                error.dot(&(covariance.try_inverse().unwrap() * error))
            };
            let error = at(&placed, joint) - truth;
            world += square(error, everywhere.covariance(joint).unwrap());
            if joint != Body25::MidHip {
                let covariance = placed.body.covariance(joint).unwrap();
                own += square(
                    error - shift,
                    covariance + placed.body.covariance(Body25::MidHip).unwrap(),
                );
            }
            count += 1.0;
        }
    }
    let (own, world) = (own / count, world / count);
    assert!((1.5..4.5).contains(&own), "against the hips {own}");
    assert!((1.0..4.5).contains(&world), "in the world {world}");
}

#[test]
fn without_an_image_somebody_stands_ahead() {
    let camera = camera(1.6);
    let truth = joints(1.0, vector![3.0, 0.0, 0.0], 2.0);
    let mut observed = observed(&camera, &truth, 1.0, [0.0; 2], &mut Random::new(1));
    let whole = observed.clone();
    observed.image = ImageBody::default();
    let mut lifter = MonocularLifter::new(camera.clone(), settings()).unwrap();
    let placed = lifter.lift(&observed).unwrap();
    let hips = at(&placed, Body25::LeftHip);
    assert!((hips - at(&placed, Body25::LeftKnee)).norm() > 0.4);
    let few = ObservedBody { metric: None, ..whole };
    assert_eq!(lifter.lift(&few), None);
    let lost = CalibratedCamera { world_from_camera: None, ..camera };
    assert!(matches!(MonocularLifter::new(lost, settings()), Err(Error::Value { .. })));
    let wrong = MonocularSettings { stature: Some(9.0), ..settings() };
    assert!(matches!(wrong.validate(), Err(Error::Value { .. })));
}
