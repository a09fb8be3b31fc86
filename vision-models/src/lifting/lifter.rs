//! Lifts each joint to its depth.

use nalgebra::{Matrix3, Point3, Vector3};

use super::{
    hidden::{OTHER_LEG_SIGMA, behind_other_leg, is_behind_skull},
    settings::LiftingSettings,
    window::{self, Surface, Wanted},
};
use crate::body::{Body, Body25, ImageBody, ImageKeypoint, Keypoint};
use crate::camera::{Camera, DepthImage};
use crate::error::Error;

/// Joints whose median range is the trunk's.
const TRUNK: [Body25; 6] = [
    Body25::Neck,
    Body25::MidHip,
    Body25::LeftShoulder,
    Body25::RightShoulder,
    Body25::LeftHip,
    Body25::RightHip,
];

/// Joints of upright parts, whose depth below the skin is measured along the floor.
const UPRIGHT: [Body25; 10] = [
    Body25::Neck,
    Body25::MidHip,
    Body25::LeftShoulder,
    Body25::RightShoulder,
    Body25::LeftHip,
    Body25::RightHip,
    Body25::LeftKnee,
    Body25::RightKnee,
    Body25::LeftAnkle,
    Body25::RightAnkle,
];

/// Joints that hands often hide.
const HIPS: [Body25; 3] = [Body25::MidHip, Body25::LeftHip, Body25::RightHip];

/// People bend forwards, not backwards. A hip farther ahead of the neck than this is a hand or a
/// tool in front of it (m).
const LEANING_BACK: f64 = 0.12;

/// A ray steeper than this (cosine to the floor) does not hit the front of an upright part.
const STEEPEST: f64 = 0.6;

/// Shortest line through shoulders and hips whose direction is used (m).
const SHORTEST_LEFT: f64 = 0.05;

/// Factor of the depth's standard deviation at an edge.
const AT_EDGE: f64 = 1.4;

/// Converts joints in the image to joints in the world, each with its covariance.
///
/// A joint's depth is the median depth of the nearest surface in a window around its pixel. The
/// joint is left out if there is no surface, or if it would be farther from the trunk than an arm
/// reaches.
///
/// The joint lies behind the skin ([`SkinDepths`]): along the ray for arms, head and feet, and
/// along the floor for upright parts. Its covariance has the error of the keypoint across the ray,
/// and those of depth and skin along it.
///
/// A network is as certain of joints that the body itself hides. Nose and eyes of a person who
/// turns away by more than 110° are left out. A joint that may be behind the other leg is known
/// along the ray to 0.1 m.
///
/// [`SkinDepths`]: crate::SkinDepths
///
/// ```
/// use nalgebra::{Point2, Point3};
/// use vision_models::{
///     Body25, Camera, Confidence, DepthImage, DepthNoise, ImageBody, ImageKeypoint, Intrinsics,
///     Lifter, LiftingSettings,
/// };
///
/// let intrinsics = Intrinsics::new([64, 48], [60.0, 60.0], [31.5, 23.5])?;
/// let (eye, target) = (Point3::new(0.0, 0.0, 1.5), Point3::new(1.0, 0.0, 1.5));
/// let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I)?;
/// let lifter = Lifter::new(camera, LiftingSettings::default())?;
///
/// let depth = DepthImage::from_metres([64, 48], vec![2.0; 64 * 48])?;
/// let mut image = ImageBody::default();
/// let position = Point2::new(31.5, 23.5);
/// image.set(Body25::Nose, Some(ImageKeypoint { position, confidence: Confidence::ONE }));
/// let body = lifter.lift(&image, &depth, None)?;
/// let nose = body.get(Body25::Nose).expect("there is a surface");
/// assert!((nose.position - Point3::new(2.0, 0.0, 1.5)).norm() < 1e-6);
/// // Uncertain across the ray by three pixels, and along it by the noise of the depth.
/// let covariance = body.covariance(Body25::Nose).expect("measured");
/// assert!((covariance[(1, 1)].sqrt() - 3.0 * 2.0 / 60.0).abs() < 1e-6);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lifter {
    camera: Camera,
    settings: LiftingSettings,
}

impl Lifter {
    /// Creates a lifter for the images of a camera.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is outside its range.
    pub fn new(camera: Camera, settings: LiftingSettings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(Self { camera, settings })
    }

    /// Returns the camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Returns the joints of a person in the world. It allocates nothing.
    ///
    /// `heading` is the yaw of the person's forward direction (rad, world), as a tracker estimates
    /// it. The depth of the joints of trunk and head below the skin depends on it. If it is
    /// missing, the heading of shoulders and hips in this frame is used.
    ///
    /// # Errors
    /// [`Error::Size`] if the size of the depth image differs from the intrinsics'.
    pub fn lift(
        &self,
        image: &ImageBody,
        depth: &DepthImage,
        heading: Option<f64>,
    ) -> Result<Body, Error> {
        self.lift_facing(image, depth, |_| heading)
    }

    /// Returns the joints of a person whose heading depends on their position.
    ///
    /// `facing` gets the body lifted as if the person faced the camera, and returns the heading.
    /// The depths are read once.
    ///
    /// # Errors
    /// Those of [`lift`](Self::lift).
    pub fn lift_facing(
        &self,
        image: &ImageBody,
        depth: &DepthImage,
        facing: impl FnOnce(&Body) -> Option<f64>,
    ) -> Result<Body, Error> {
        let expected = self.camera.intrinsics().size();
        let found = depth.size();
        if found != expected {
            let [width, height] = expected;
            let wanted = format!(
                "{width} × {height}, which the camera's intrinsics are for: depth that is aligned to the \
                 colour image, and the intrinsics of that size"
            );
            return Err(Error::size("the depth image", &found, "pixels", &wanted));
        }
        let seen = Body25::ALL.map(|joint| self.look(image.get(joint)?, depth));
        let before = self.body(&seen, None);
        let heading = facing(&before).filter(|heading| heading.is_finite());
        let heading = heading.or_else(|| heading_of(&before));
        Ok(heading.map_or(before, |heading| self.body(&seen, Some(heading))))
    }

    /// Returns the body of a person with this heading. If it is missing, the person faces the
    /// camera.
    fn body(&self, seen: &[Option<Look>; Body25::COUNT], heading: Option<f64>) -> Body {
        let hips = HIPS.into_iter().find_map(|hip| seen[hip.index()]);
        let bearing =
            hips.zip(heading).map(|(hips, heading)| self.bearing(&self.ray(&hips)) - heading);
        let behind = behind_other_leg(seen, bearing, self.focal());
        let lifted = Body25::ALL.map(|joint| {
            let index = joint.index();
            self.joint(joint, &seen[index]?, heading, behind[index])
        });
        let motion = self.camera.world_from_camera();
        // The distance ahead of the camera along the floor, or along the axis if the camera looks
        // straight down.
        let axis = motion.rotation * Vector3::z();
        let level = Vector3::new(axis.x, axis.y, 0.0).try_normalize(0.2).unwrap_or(axis);
        let ahead = motion.rotation.inverse() * level;
        let range = |lifted: &Lifted| lifted.position.coords.dot(&ahead);
        let middle = trunk_range(&lifted.map(|lifted| lifted.as_ref().map(range)));
        let upper = [Body25::Neck, Body25::LeftShoulder, Body25::RightShoulder];
        let upper = upper.into_iter().find_map(|joint| lifted[joint.index()]);
        let mut body = Body::default();
        for (joint, lifted) in Body25::ALL.into_iter().zip(lifted) {
            let LiftingSettings { reach, trunk_reach, .. } = self.settings;
            let limit = if TRUNK.contains(&joint) { trunk_reach } else { reach };
            let near = |lifted: &Lifted| {
                middle.is_none_or(|middle| (range(lifted) - middle).abs() <= limit)
            };
            let hidden = |hip: &Lifted| {
                let back = upper.zip(heading).map(|(upper, heading)| {
                    let ahead = motion.rotation * (hip.position - upper.position);
                    ahead.dot(&Vector3::new(heading.cos(), heading.sin(), 0.0))
                });
                HIPS.contains(&joint) && back.is_some_and(|back| back > LEANING_BACK)
            };
            if let Some(lifted) = lifted.filter(near).filter(|lifted| !hidden(lifted)) {
                self.place(&mut body, joint, &lifted);
            }
        }
        body
    }

    /// Returns the surface at a keypoint.
    fn look(&self, keypoint: ImageKeypoint, depth: &DepthImage) -> Option<Look> {
        let settings = &self.settings;
        if keypoint.confidence.value() < settings.least_confidence {
            return None;
        }
        let wanted = Wanted {
            half_side: settings.window,
            focal: self.focal(),
            least_share: settings.least_share,
            range: settings.range,
        };
        let edge = |depth: f64| settings.edge.max(4.0 * self.camera.noise().sigma(depth));
        let surface = window::surface(depth, &keypoint.position, &wanted, edge)?;
        Some(Look { keypoint, surface })
    }

    /// Returns the mean focal length (pixels).
    fn focal(&self) -> f64 {
        let [fx, fy] = self.camera.intrinsics().focal();
        f64::midpoint(fx, fy)
    }

    /// Returns the ray to a keypoint in the optical frame, at a depth of 1.
    fn ray(&self, look: &Look) -> Vector3<f64> {
        self.camera.intrinsics().ray(&look.keypoint.position)
    }

    /// Returns a joint in the optical frame; `None` if the head hides it. If it `may_be_hidden`, the
    /// surface may be that of the other leg, and the joint is less certain along the ray.
    fn joint(
        &self,
        joint: Body25,
        look: &Look,
        heading: Option<f64>,
        may_be_hidden: bool,
    ) -> Option<Lifted> {
        let Look { keypoint, surface } = look;
        let settings = &self.settings;
        let (intrinsics, noise) = (self.camera.intrinsics(), self.camera.noise());
        let [fx, fy] = intrinsics.focal();
        let ray = self.ray(look);
        let length = ray.norm();
        let bearing = heading.map_or(0.0, |heading| self.bearing(&ray) - heading);
        if is_behind_skull(joint, bearing) {
            return None;
        }
        let skin = settings.skin.of(joint, bearing) / self.slant(joint, &ray);
        let position = Point3::from(ray * (surface.depth + skin));
        let at_edge = if surface.at_edge { AT_EDGE } else { 1.0 };
        let of_depth = (at_edge * noise.sigma(surface.depth)).powi(2);
        let hidden = if may_be_hidden { OTHER_LEG_SIGMA } else { 0.0 };
        let of_skin = (settings.skin_sigma.hypot(hidden) / length).powi(2);
        let of_pixel = (settings.pixel_sigma * surface.depth).powi(2);
        let across = Vector3::new(of_pixel / (fx * fx), of_pixel / (fy * fy), 0.0);
        let along = ray * ray.transpose() * (of_depth + of_skin);
        let covariance = Matrix3::from_diagonal(&across) + along;
        let confidence = keypoint.confidence;
        Some(Lifted { position, covariance, keypoint: Keypoint { position, confidence } })
    }

    /// Returns the yaw of the direction from a point on this ray to the camera (rad, world).
    fn bearing(&self, ray: &Vector3<f64>) -> f64 {
        let towards = -(self.camera.world_from_camera().rotation * ray);
        towards.y.atan2(towards.x)
    }

    /// Returns the ratio of the depth below the skin to the depth along the optical axis, for the
    /// part of the body around a joint. The former is measured along the floor for upright parts,
    /// and along the ray for others.
    fn slant(&self, joint: Body25, ray: &Vector3<f64>) -> f64 {
        let length = ray.norm();
        let in_world = self.camera.world_from_camera().rotation * ray;
        let level = (in_world.xy().norm() / length).max(STEEPEST);
        if UPRIGHT.contains(&joint) { length * level } else { length }
    }

    fn place(&self, body: &mut Body, joint: Body25, lifted: &Lifted) {
        let motion = self.camera.world_from_camera();
        let position = motion * lifted.position;
        let rotation = motion.rotation.to_rotation_matrix();
        let covariance = rotation.matrix() * lifted.covariance * rotation.matrix().transpose();
        body.set_measured(joint, Keypoint { position, ..lifted.keypoint }, covariance);
    }
}

/// A keypoint with the surface at its pixel.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) keypoint: ImageKeypoint,
    pub(super) surface: Surface,
}

/// A joint in the optical frame (m, m²).
#[derive(Clone, Copy)]
struct Lifted {
    position: Point3<f64>,
    covariance: Matrix3<f64>,
    keypoint: Keypoint,
}

/// Returns the yaw of a body's forward direction (rad) from its shoulders and hips.
fn heading_of(body: &Body) -> Option<f64> {
    let pair = |left, right| {
        let (left, right) = (body.get(left)?, body.get(right)?);
        Some((left.position - right.position).xy())
    };
    let shoulders = pair(Body25::LeftShoulder, Body25::RightShoulder);
    let hips = pair(Body25::LeftHip, Body25::RightHip);
    let left = shoulders.into_iter().chain(hips).reduce(|one, other| one + other)?;
    (left.norm() > SHORTEST_LEFT).then(|| (-left.x).atan2(left.y))
}

/// Returns the median of the trunk's joints, or of all joints if fewer than two of the trunk's are
/// known.
fn trunk_range(ranges: &[Option<f64>; Body25::COUNT]) -> Option<f64> {
    let range = |joint: Body25| ranges[joint.index()];
    median(TRUNK.into_iter().filter_map(range), 2)
        .or_else(|| median(Body25::ALL.into_iter().filter_map(range), 1))
}

/// Returns the median of at least `least` values.
fn median(values: impl Iterator<Item = f64>, least: usize) -> Option<f64> {
    let mut sorted = [f64::INFINITY; Body25::COUNT];
    let mut count = 0;
    for (slot, value) in sorted.iter_mut().zip(values) {
        *slot = value;
        count += 1;
    }
    sorted.sort_unstable_by(f64::total_cmp);
    let middle = sorted.get(count / 2).copied()?;
    (count >= least && count > 0).then_some(middle)
}
