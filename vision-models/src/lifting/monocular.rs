//! One camera without depth: metric joints and the floor place a person.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Vector3};

use super::pixel_noise::PixelNoise;
use crate::body::{Body, Body25, Keypoint, MetricBody, Middle, ObservedBody};
use crate::camera::CalibratedCamera;
use crate::confidence::Confidence;
use crate::error::Error;

/// Thighs and shanks as a part of stature (Drillis and Contini 1966), and how much people differ.
const LEG: f64 = 0.491;
const LEG_SIGMA: f64 = 0.04;

/// The joints of each foot, and how high they are above the floor on which it stands (m).
const FEET: [[(Body25, f64); 3]; 2] = [
    [(Body25::LeftHeel, 0.03), (Body25::LeftBigToe, 0.03), (Body25::LeftAnkle, 0.09)],
    [(Body25::RightHeel, 0.03), (Body25::RightBigToe, 0.03), (Body25::RightAnkle, 0.09)],
];
/// The error of that (m).
const FOOT_SIGMA: f64 = 0.04;
/// A foot is seen that a network is surer of.
const SURE: f64 = 0.5;

/// Distance ahead of the camera of a person whose joints are not in the image (m).
const AHEAD: f64 = 3.0;
/// Fewer joints do not tell where a person is.
const JOINTS: usize = 6;
/// Means are over the last images, about so many.
const IMAGES: f64 = 250.0;

/// Settings of a [`MonocularLifter`]: the person's stature, if it is known, and standard
/// deviations.
///
/// ```
/// use vision_models::MonocularSettings;
///
/// let known = MonocularSettings { stature: Some(1.75), ..MonocularSettings::default() };
/// assert!(known.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonocularSettings {
    /// The error of the joints in the image.
    pub noise: PixelNoise,
    /// Standard deviation of how much farther a joint is than the hips (m).
    pub depth_sigma: f64,
    /// The person's stature (m), if it is known.
    pub stature: Option<f64>,
    /// Relative standard deviation of the network's lengths for people whose stature is not known.
    pub scale_sigma: f64,
    /// Standard deviation of the camera's height (m).
    pub height_sigma: f64,
    /// Standard deviation of the camera's tilt (rad).
    pub tilt_sigma: f64,
}

impl Default for MonocularSettings {
    /// Returns the settings for BlazePose, and for a camera placed with a tape measure and by eye.
    fn default() -> Self {
        Self {
            noise: PixelNoise::default(),
            depth_sigma: 0.1,
            stature: None,
            scale_sigma: 0.06,
            height_sigma: 0.05,
            tilt_sigma: 2_f64.to_radians(),
        }
    }
}

impl MonocularSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Value`].
    pub fn validate(&self) -> Result<(), Error> {
        self.noise.validate()?;
        for (name, value, [least, most]) in [
            ("depth_sigma", self.depth_sigma, [1e-3, 1.0]),
            ("stature", self.stature.unwrap_or(1.7), [0.5, 2.6]),
            ("scale_sigma", self.scale_sigma, [1e-3, 1.0]),
            ("height_sigma", self.height_sigma, [1e-3, 10.0]),
            ("tilt_sigma", self.tilt_sigma, [1e-3, 1.6]),
        ] {
            if !(least..=most).contains(&value) {
                return Err(Error::value(name, value, &format!("{least} to {most}")));
            }
        }
        Ok(())
    }
}

/// Person placed in the world by a [`MonocularLifter`]. Each joint has the covariance of its error
/// relative to the other joints.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedBody {
    /// The joints in the world.
    pub body: Body,
    /// The covariance of the place of the whole person, which all joints share (m²).
    pub common: Matrix3<f64>,
    /// Factor by which the person is larger than the network says.
    pub scale: f64,
    /// Standard deviation of the factor.
    pub scale_sigma: f64,
}

impl PlacedBody {
    /// Returns the joints in the world with the covariances of their whole errors, the common one
    /// included.
    #[must_use]
    pub fn in_world(&self) -> Body {
        let mut body = self.body.clone();
        for (joint, keypoint) in self.body.iter() {
            if let Some(own) = self.body.covariance(joint) {
                body.set_measured(joint, keypoint, own + self.common);
            }
        }
        body
    }
}

/// Places a person by the metric joints of a network, the joints in the image and the camera's place above the floor.
///
/// The metric joints $\boldsymbol m_j$ are turned so that their depth is along the ray to the hips. Their shift
/// $\boldsymbol t$ is the one with which they appear where the image shows them (linear least squares). The scale $s$ is 1
/// or follows from the stature; the lower foot on the floor says it once more. Both count by their variances. A joint is on
/// its ray at the depth $s (t_z + m_{j,z})$.
///
/// ```
/// use vision_models::{
///     CalibratedCamera, Camera, DepthNoise, Distortion, Intrinsics, MonocularLifter, MonocularSettings, ObservedBody,
///     nalgebra::Point3,
/// };
///
/// let intrinsics = Intrinsics::new([1280, 720], [1000.0, 1000.0], [639.5, 359.5])?;
/// let (eye, target) = (Point3::new(0.0, 0.0, 1.5), Point3::new(4.0, 0.0, 1.0));
/// let placed = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I)?;
/// let camera = CalibratedCamera {
///     name: "webcam".to_owned(),
///     intrinsics,
///     distortion: Distortion::None,
///     world_from_camera: Some(*placed.world_from_camera()),
/// };
/// let mut lifter = MonocularLifter::new(camera, MonocularSettings::default())?;
/// // A body without metric joints cannot be placed.
/// assert_eq!(lifter.lift(&ObservedBody::default()), None);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct MonocularLifter {
    camera: CalibratedCamera,
    pose: Isometry3<f64>,
    settings: MonocularSettings,
    /// The length of thigh and shank as the network says it (m).
    leg: Mean,
    /// The scale by the floor.
    floor: Mean,
    /// The last scale and its standard deviation.
    size: Option<[f64; 2]>,
}

/// A mean that forgets slowly.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    value: f64,
    count: f64,
}

impl Mean {
    fn push(&mut self, value: f64) {
        self.count = (self.count + 1.0).min(IMAGES);
        self.value += (value - self.value) / self.count;
    }

    fn get(&self) -> Option<f64> {
        (self.count > 0.0).then_some(self.value)
    }
}

impl MonocularLifter {
    /// Creates a lifter for a camera whose pose in the world is known. The floor is at z = 0.
    ///
    /// # Errors
    /// [`Error::Value`] for a setting, and for a camera without a place.
    pub fn new(camera: CalibratedCamera, settings: MonocularSettings) -> Result<Self, Error> {
        settings.validate()?;
        let pose = camera.world_from_camera.ok_or_else(|| {
            Error::value("the place of the camera", "not known", "its height and tilt")
        })?;
        Ok(Self {
            camera,
            pose,
            settings,
            leg: Mean::default(),
            floor: Mean::default(),
            size: None,
        })
    }

    /// Places a person in the world. `None` if metric joints are missing, or too few joints are in
    /// the image.
    pub fn lift(&mut self, person: &ObservedBody) -> Option<PlacedBody> {
        let metric = person.metric.as_ref()?;
        if let Some(leg) = leg(metric) {
            self.leg.push(leg);
        }
        let (metric, shift) = self.shifted(person, metric)?;
        let [scale, sigma] = self.scale(person, &metric, &shift);
        self.size = Some([scale, sigma]);
        let rotation = *self.pose.rotation.to_rotation_matrix().matrix();
        let pixel = self.settings.noise.sigma(&person.image);
        let [fx, fy] = self.camera.intrinsics.focal();
        let mut body = Body::default();
        for (joint, point) in metric.iter() {
            let whole = (point + shift).coords * scale;
            if whole.z <= 0.0 || is_middle(person, joint) {
                continue;
            }
            let seen = person.image.get(joint);
            let ray = seen.and_then(|seen| self.camera.pinhole(&seen.position));
            let ray = ray.map_or(whole / whole.z, |at| self.camera.intrinsics.ray(&at));
            let across = Vector3::new(whole.z * pixel / fx, whole.z * pixel / fy, 0.0);
            let across = Matrix3::from_diagonal(&across.component_mul(&across));
            let along = ray * ray.transpose() * (scale * self.settings.depth_sigma).powi(2);
            let covariance = rotation * (across + along) * rotation.transpose();
            let confidence = seen.map_or(Confidence::ONE, |seen| seen.confidence);
            let position = self.pose * Point3::from(ray * whole.z);
            body.set_measured(joint, Keypoint { position, confidence }, covariance);
        }
        for middle in Middle::ALL {
            if is_middle(person, middle.joint) {
                body.set_middle(middle);
            }
        }
        let place = self.pose.rotation * shift * scale;
        let MonocularSettings { height_sigma, tilt_sigma, .. } = self.settings;
        let mut common = place * place.transpose() * (sigma / scale).powi(2);
        common[(2, 2)] += height_sigma.powi(2) + (tilt_sigma * place.xy().norm()).powi(2);
        Some(PlacedBody { body, common, scale, scale_sigma: sigma })
    }

    /// Returns the person's stature from the legs in all images, and its standard deviation (m).
    /// The latter includes the variation of people's proportions.
    pub fn stature(&self) -> Option<[f64; 2]> {
        let (leg, [scale, sigma]) = (self.leg.get()?, self.size?);
        let stature = scale * leg / LEG;
        Some([stature, stature * (sigma / scale).hypot(LEG_SIGMA)])
    }

    /// The metric joints in the camera's axes and their shift, both as large as the network says.
    fn shifted(
        &self,
        person: &ObservedBody,
        metric: &MetricBody,
    ) -> Option<(MetricBody, Vector3<f64>)> {
        if person.image.iter().next().is_none() {
            return Some((metric.clone(), Vector3::new(0.0, 0.0, AHEAD)));
        }
        let rays = person.image.iter().filter_map(|(joint, seen)| {
            let at = self.camera.pinhole(&seen.position)?;
            let ray = self.camera.intrinsics.ray(&at);
            Some((joint, ray, metric.get(joint)?, seen.confidence.value()))
        });
        let rays: Vec<_> = rays.collect();
        let hips = |joint| matches!(joint, Body25::LeftHip | Body25::RightHip);
        let to_hips: Vector3<f64> =
            rays.iter().filter(|(joint, ..)| hips(*joint)).map(|(_, ray, ..)| ray).sum();
        let turn = Rotation3::rotation_between(&Vector3::z(), &to_hips)?;
        let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
        for (_, ray, point, weight) in &rays {
            let point = turn * point;
            // The shift is across the ray what the point lacks.
            for row in [Vector3::new(1.0, 0.0, -ray.x), Vector3::new(0.0, 1.0, -ray.y)] {
                matrix += row * row.transpose() * *weight;
                vector -= row * row.dot(&point.coords) * *weight;
            }
        }
        let shift = matrix.cholesky()?.solve(&vector);
        let is_there = rays.len() >= JOINTS && shift.z > 0.0 && shift.norm() < 1e3;
        let mut turned = MetricBody::default();
        metric.iter().for_each(|(joint, point)| turned.set(joint, Some(turn * point)));
        is_there.then_some((turned, shift))
    }

    /// The scale and its standard deviation.
    fn scale(
        &mut self,
        person: &ObservedBody,
        metric: &MetricBody,
        shift: &Vector3<f64>,
    ) -> [f64; 2] {
        let by_stature = self.settings.stature.zip(self.leg.get());
        let by_stature = by_stature.map(|(stature, leg)| [LEG * stature / leg, LEG_SIGMA]);
        let [prior, sigma] = by_stature.unwrap_or([1.0, self.settings.scale_sigma]);
        let height = self.pose.translation.vector.z;
        let foot = |foot: &[(Body25, f64); 3]| {
            let (mut sum, mut count, mut farthest) = (0.0, 0.0, 0.0_f64);
            for (joint, above) in foot {
                let seen = person.image.get(*joint).filter(|seen| seen.confidence.value() > SURE);
                let Some(point) = metric.get(*joint).filter(|_| seen.is_some()) else { continue };
                let place = self.pose.rotation * (point.coords + shift);
                sum += (height - above) / -place.z;
                count += 1.0;
                farthest = farthest.max(place.xy().norm());
            }
            Some((sum / count, farthest)).filter(|(scale, _)| (0.1..10.0).contains(scale))
        };
        let lowest = FEET.iter().filter_map(foot);
        let Some((floor, far)) = lowest.min_by(|one, other| one.0.total_cmp(&other.0)) else {
            return [prior, sigma];
        };
        self.floor.push(floor);
        let floor = self.floor.value;
        let MonocularSettings { height_sigma, tilt_sigma, .. } = self.settings;
        let tilted = tilt_sigma * floor * far;
        let own = floor * height_sigma.hypot(tilted).hypot(FOOT_SIGMA) / height.max(0.1);
        // A foot that stands on something else says nothing.
        if (floor - prior).abs() > 3.0 * own.hypot(sigma) {
            return [prior, sigma];
        }
        let [first, second] = [sigma, own].map(|sigma| sigma.powi(-2));
        [(prior * first + floor * second) / (first + second), (first + second).sqrt().recip()]
    }
}

/// True if the network sees no such joint by itself.
fn is_middle(person: &ObservedBody, joint: Body25) -> bool {
    let nothing = person.image.iter().next().is_none();
    let middle = Middle::ALL.iter().any(|middle| middle.joint == joint);
    middle && (nothing || person.image.is_derived(joint))
}

/// Thigh and shank, the mean of the legs that were told (m).
fn leg(metric: &MetricBody) -> Option<f64> {
    use Body25::{LeftAnkle, LeftHip, LeftKnee, RightAnkle, RightHip, RightKnee};
    let lengths = [[LeftHip, LeftKnee, LeftAnkle], [RightHip, RightKnee, RightAnkle]].map(|leg| {
        let [hip, knee, ankle] = leg.map(|joint| metric.get(joint));
        let (hip, knee, ankle) = (hip?, knee?, ankle?);
        Some((knee - hip).norm() + (ankle - knee).norm()).filter(|length| *length > 0.1)
    });
    let known: Vec<f64> = lengths.into_iter().flatten().collect();
    (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
}
