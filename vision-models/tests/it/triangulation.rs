//! Joints from several views: errors against what is claimed, outliers, and several people.

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Rotation3, Vector3, point, vector};
use proptest::prelude::*;
use vision_models::{
    Body, Body25, CalibratedCamera, Confidence, Distortion, Error, ImageBody, ImageKeypoint,
    Intrinsics, JointLayout, PixelNoise, TriangulationSettings, Triangulator,
};

use crate::random::Random;

const SIGMA: f64 = 4.0;
const LENS: [f64; 8] = [-0.12, 0.05, 1e-3, -2e-3, 0.01, 0.0, 0.0, 0.0];

/// Beyond this lies one in a thousand, and one in ten thousand, of squares of three normal numbers.
const THOUSANDTH: f64 = 16.27;
const TEN_THOUSANDTH: f64 = 21.1;

/// A camera written down by itself: rows of its axes in the world, and its place.
struct Eye {
    axes: Matrix3<f64>,
    place: Vector3<f64>,
}

impl Eye {
    fn looking(place: Vector3<f64>, target: Vector3<f64>) -> Self {
        let ahead = (target - place).normalize();
        let right = ahead.cross(&Vector3::z()).normalize();
        let down = ahead.cross(&right);
        let axes = Matrix3::from_rows(&[right.transpose(), down.transpose(), ahead.transpose()]);
        Self { axes, place }
    }

    /// The pixel of a point, by OpenCV's formulas.
    fn pixel(&self, point: &Vector3<f64>) -> Point2<f64> {
        let seen = self.axes * (point - self.place);
        let (x, y) = (seen.x / seen.z, seen.y / seen.z);
        let [k1, k2, p1, p2, k3, ..] = LENS;
        let r2 = x * x + y * y;
        let radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
        let bent_x = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
        let bent_y = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
        Point2::new(639.5 + 1000.0 * bent_x, 359.5 + 1010.0 * bent_y)
    }

    fn calibrated(&self) -> CalibratedCamera {
        let rotation = Rotation3::from_matrix(&self.axes.transpose());
        CalibratedCamera {
            name: "eye".to_owned(),
            intrinsics: Intrinsics::new([1280, 720], [1000.0, 1010.0], [639.5, 359.5]).unwrap(),
            distortion: Distortion::Radial(LENS),
            world_from_camera: Some(Isometry3::from_parts(self.place.into(), rotation.into())),
        }
    }
}

fn eyes(count: usize, random: &mut Random) -> Vec<Eye> {
    let eye = |index: usize| {
        let bearing = std::f64::consts::TAU * (index as f64 + 0.3 * random.uniform()) / 4.3;
        let distance = random.within(3.0, 5.0);
        let height = random.within(0.8, 2.8);
        let place = vector![distance * bearing.cos(), distance * bearing.sin(), height];
        Eye::looking(place, vector![0.0, 0.0, 1.0])
    };
    (0..count).map(eye).collect()
}

fn triangulator(eyes: &[Eye]) -> Triangulator {
    let noise = PixelNoise { constant: SIGMA, share: 0.0 };
    let settings = TriangulationSettings { noise, ..TriangulationSettings::default() };
    Triangulator::new(eyes.iter().map(Eye::calibrated).collect(), settings).unwrap()
}

fn seen(at: Point2<f64>) -> ImageKeypoint {
    ImageKeypoint { position: at, confidence: Confidence::ONE }
}

/// One joint in each view, moved by what `error` gives for the view.
fn views(
    eyes: &[Eye],
    point: &Vector3<f64>,
    mut error: impl FnMut(usize) -> Option<[f64; 2]>,
) -> Vec<Option<ImageBody>> {
    let view = |(index, eye): (usize, &Eye)| {
        let [x, y] = error(index)?;
        let mut body = ImageBody::default();
        let pixel = eye.pixel(point);
        body.set(Body25::Nose, Some(seen(point![pixel.x + x, pixel.y + y])));
        Some(body)
    };
    eyes.iter().enumerate().map(view).collect()
}

fn nose(
    triangulator: &Triangulator,
    views: &[Option<ImageBody>],
) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let views: Vec<_> = views.iter().map(Option::as_ref).collect();
    let body = triangulator.body(&views);
    Some((body.get(Body25::Nose)?.position.coords, body.covariance(Body25::Nose)?))
}

fn square(error: &Vector3<f64>, covariance: &Matrix3<f64>) -> f64 {
    error.dot(&(covariance.try_inverse().unwrap() * error))
}

fn somewhere(random: &mut Random) -> Vector3<f64> {
    vector![random.within(-0.8, 0.8), random.within(-0.8, 0.8), random.within(0.1, 1.9)]
}

#[test]
fn errors_are_as_large_as_covariances_say() {
    for count in [2, 3, 4, 6] {
        let (mut sum, mut beyond, mut given) = (0.0, 0, 0);
        for seed in 0..3000 {
            let mut random = Random::new(seed);
            let eyes = eyes(count, &mut random);
            let point = somewhere(&mut random);
            let views =
                views(&eyes, &point, |_| Some([SIGMA * random.normal(), SIGMA * random.normal()]));
            let Some((found, covariance)) = nose(&triangulator(&eyes), &views) else { continue };
            let square = square(&(found - point), &covariance);
            sum += square;
            beyond += usize::from(square > THOUSANDTH);
            given += 1;
        }
        let mean = sum / f64::from(given);
        // Three numbers each: less where the errors in the images enlarge the covariance.
        assert!((2.0..3.2).contains(&mean), "{count} views: {mean}");
        assert!(beyond <= 6, "{count} views: {beyond} of {given}");
        // One of three views beyond three standard deviations leaves two pairs that nobody can tell apart.
        assert!(given > 2850, "{count} views: {given}");
    }
}

#[test]
fn two_of_four_views_suffice() {
    for wrong in [1, 2] {
        let (mut given, mut off) = (0, 0);
        for (first, seed) in (0..4_usize).cycle().zip(0..2000) {
            let mut random = Random::new(seed);
            let eyes = eyes(4, &mut random);
            let point = somewhere(&mut random);
            let views = views(&eyes, &point, |index| {
                let mut error = [SIGMA * random.normal(), SIGMA * random.normal()];
                if (index + 4 - first) % 4 < wrong {
                    let bearing = random.within(0.0, std::f64::consts::TAU);
                    let far = random.within(50.0, 400.0);
                    error = [far * bearing.cos(), far * bearing.sin()];
                }
                Some(error)
            });
            let Some((found, covariance)) = nose(&triangulator(&eyes), &views) else { continue };
            given += 1;
            off += usize::from(square(&(found - point), &covariance) > TEN_THOUSANDTH);
        }
        // Two that are wrong agree at times by chance: the joint is then left out.
        let least = [1900, 1000][wrong - 1];
        assert!(given > least, "{wrong} wrong: {given} given");
        assert!(off * 100 <= given, "{wrong} wrong: {off} off of {given}");
    }
    // Two that see nothing.
    let mut random = Random::new(7);
    let eyes = eyes(4, &mut random);
    let views = views(&eyes, &vector![0.1, 0.2, 1.0], |index| (index % 3 == 0).then_some([0.0; 2]));
    let (found, _) = nose(&triangulator(&eyes), &views).unwrap();
    assert!((found - vector![0.1, 0.2, 1.0]).norm() < 1e-6);
    let alone: Vec<_> = views.iter().take(2).cloned().chain([None, None]).collect();
    assert_eq!(nose(&triangulator(&eyes), &alone), None);
}

/// Somebody who stands, the pelvis above a place.
fn standing(place: Vector3<f64>) -> [Option<Vector3<f64>>; 17] {
    let joints: [[f64; 3]; 17] = [
        [0.1, 0.0, 1.55],
        [0.08, 0.03, 1.58],
        [0.08, -0.03, 1.58],
        [0.0, 0.08, 1.56],
        [0.0, -0.08, 1.56],
        [0.0, 0.2, 1.43],
        [0.0, -0.2, 1.43],
        [0.0, 0.22, 1.1],
        [0.0, -0.22, 1.1],
        [0.2, 0.22, 1.0],
        [0.2, -0.22, 1.0],
        [0.0, 0.1, 0.93],
        [0.0, -0.1, 0.93],
        [0.02, 0.1, 0.5],
        [0.02, -0.1, 0.5],
        [0.0, 0.1, 0.08],
        [0.0, -0.1, 0.08],
    ];
    joints.map(|joint| Some(Vector3::from(joint) + place))
}

fn image(eye: &Eye, joints: &[Option<Vector3<f64>>; 17], random: &mut Random) -> ImageBody {
    let keypoint = |joint: &Option<Vector3<f64>>| {
        let mut at = eye.pixel(&(*joint)?);
        at += vector![SIGMA * random.normal(), SIGMA * random.normal()];
        Some(seen(at))
    };
    JointLayout::Coco17.body(&joints.iter().map(keypoint).collect::<Vec<_>>())
}

#[test]
fn the_neck_has_the_shoulders_covariance() {
    let mut random = Random::new(3);
    let eyes = eyes(4, &mut random);
    let joints = standing(Vector3::zeros());
    let images: Vec<_> = eyes.iter().map(|eye| image(eye, &joints, &mut random)).collect();
    let body = triangulator(&eyes).body(&images.iter().map(Some).collect::<Vec<_>>());
    let at = |joint| (body.get(joint).unwrap().position, body.covariance(joint).unwrap());
    let [neck, left, right] = [Body25::Neck, Body25::LeftShoulder, Body25::RightShoulder].map(at);
    assert!((neck.0 - nalgebra::center(&left.0, &right.0)).norm() < 1e-12);
    assert!((neck.1 - (left.1 + right.1) * 0.25).norm() < 1e-15);
    assert_eq!(body.get(Body25::LeftHeel), None);
}

/// Distance from a person to the nearest of those that were found, the median of their joints (m).
fn nearest(people: &[Body], joints: &[Option<Vector3<f64>>; 17]) -> f64 {
    let off = |body: &Body| {
        let known = JointLayout::Coco17.joints().filter_map(|(joint, place)| {
            Some((body.get(joint)?.position.coords - joints[place]?).norm())
        });
        let mut known: Vec<f64> = known.collect();
        known.sort_by(f64::total_cmp);
        assert!(known.len() >= 13, "{}", known.len());
        known[known.len() / 2]
    };
    people.iter().map(off).fold(f64::INFINITY, f64::min)
}

#[test]
fn people_are_put_together_from_their_views() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let eyes = eyes(4, &mut random);
        let bearing = random.within(0.0, std::f64::consts::TAU);
        let places =
            [0.35, -0.35].map(|far: f64| vector![far * bearing.cos(), far * bearing.sin(), 0.0]);
        let people = places.map(standing);
        // In another order in each view; the last sees one alone.
        let views: Vec<Vec<_>> = eyes
            .iter()
            .enumerate()
            .map(|(index, eye)| {
                let order = if random.uniform() < 0.5 { [0, 1] } else { [1, 0] };
                let seen = if index == 3 { &order[..1] } else { &order[..] };
                seen.iter().map(|&who| image(eye, &people[who], &mut random)).collect()
            })
            .collect();
        let found = triangulator(&eyes).people(&views);
        assert_eq!(found.len(), 2, "seed {seed}");
        for joints in &people {
            assert!(nearest(&found, joints) < 0.05, "seed {seed}: {}", nearest(&found, joints));
        }
        // One view alone is nobody.
        let mut alone = vec![Vec::new(); 4];
        alone[1].clone_from(&views[1]);
        assert!(triangulator(&eyes).people(&alone).is_empty());
    }
}

#[test]
fn cameras_without_a_place_are_refused() {
    let mut random = Random::new(1);
    let cameras: Vec<_> = eyes(2, &mut random).iter().map(Eye::calibrated).collect();
    let settings = TriangulationSettings::default();
    let refused = |cameras: Vec<CalibratedCamera>| {
        Triangulator::new(cameras, settings).unwrap_err().to_string()
    };
    assert!(refused(cameras[..1].to_vec()).contains("2 to 16"));
    let mut lost = cameras.clone();
    lost[1].world_from_camera = None;
    assert!(refused(lost).contains("not known of eye"));
    let wrong = TriangulationSettings { outlier: f64::NAN, ..settings };
    assert!(matches!(Triangulator::new(cameras, wrong), Err(Error::Value { .. })));
}

proptest! {
    #[test]
    fn a_lens_is_undone(
        x in -0.9..0.9_f64,
        y in -0.7..0.7_f64,
        k1 in -0.15..0.15_f64,
        k2 in -0.03..0.03_f64,
        p in -0.003..0.003_f64,
    ) {
        let ray = Point2::new(x, y);
        for lens in [
            Distortion::None,
            Distortion::Radial([k1, k2, p, -p, 0.01, 0.0, 0.0, 0.0]),
            Distortion::Radial([k1 + 0.2, k2, p, p, 0.01, 0.1, 0.02, 0.001]),
            Distortion::Fisheye([0.3 * k1, k2, 0.001, -0.001]),
        ] {
            let found = lens.undistort(&lens.distort(&ray));
            prop_assert!(found.is_some_and(|found| (found - ray).norm() < 1e-7), "{lens:?}: {found:?}");
        }
    }

    /// Whatever the views say, nothing panics, and what is given is finite.
    #[test]
    fn any_views_are_borne(pixels in prop::collection::vec((-1e5..1e5_f64, -1e5..1e5_f64), 4)) {
        let mut random = Random::new(5);
        let eyes = eyes(4, &mut random);
        let views: Vec<_> = pixels
            .iter()
            .map(|(x, y)| {
                let mut body = ImageBody::default();
                body.set(Body25::Nose, Some(seen(Point2::new(*x, *y))));
                Some(body)
            })
            .collect();
        if let Some((found, covariance)) = nose(&triangulator(&eyes), &views) {
            prop_assert!(found.iter().chain(covariance.iter()).all(|value| value.is_finite()));
            let far = Point3::from(found).coords.norm();
            prop_assert!(far < 1e3);
        }
    }
}
