//! The joints of people whom several cameras see at the same time.

use nalgebra::Point3;

use super::{
    pixel_noise::PixelNoise,
    views::{Agreed, Sight, nearest, refine},
};
use crate::body::{Body, Body25, ImageBody, Keypoint, Middle};
use crate::camera::CalibratedCamera;
use crate::confidence::Confidence;
use crate::error::Error;

/// The most cameras: pairs of them are tried.
const MOST: usize = 16;

/// Views of one person agree on so many joints at least.
const JOINTS: usize = 4;

/// The median squared error of the joints of one person in two views is smaller (standard deviations²).
const AGREE: f64 = 4.0;

/// Settings of a [`Triangulator`].
///
/// ```
/// use vision_models::TriangulationSettings;
///
/// assert!(TriangulationSettings::default().validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangulationSettings {
    /// The error of the joints in an image.
    pub noise: PixelNoise,
    /// Error beyond which a view is an outlier, in standard deviations.
    pub outlier: f64,
    /// Smallest confidence of a joint that is used, from 0 to 1.
    pub least_confidence: f64,
    /// Largest standard deviation of a joint along any axis (m). Other joints are left out.
    pub largest_sigma: f64,
}

impl Default for TriangulationSettings {
    fn default() -> Self {
        let noise = PixelNoise::default();
        Self { noise, outlier: 3.0, least_confidence: 0.2, largest_sigma: 0.15 }
    }
}

impl TriangulationSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Value`].
    pub fn validate(&self) -> Result<(), Error> {
        self.noise.validate()?;
        for (name, value, [least, most]) in [
            ("outlier", self.outlier, [1.0, 20.0]),
            ("least_confidence", self.least_confidence, [0.0, 1.0]),
            ("largest_sigma", self.largest_sigma, [1e-3, 10.0]),
        ] {
            if !(least..=most).contains(&value) {
                return Err(Error::value(name, value, &format!("{least} to {most}")));
            }
        }
        Ok(())
    }
}

/// Triangulates joints that calibrated cameras see at the same time, robustly against wrong views. Two views that agree
/// are enough, whatever the others show.
///
/// Every pair of views proposes a point. The views within [`TriangulationSettings::outlier`] standard deviations support it.
/// The point with the most support, then the least error, is refined over those views. It has the covariance of that
/// least-squares problem, enlarged where the errors are larger than expected. If two views alone support it, and other pairs
/// support another place, the joint is left out.
///
/// ```
/// use nalgebra::{Point2, Point3};
/// use vision_models::{
///     Body25, Camera, CalibratedCamera, Confidence, DepthNoise, Distortion, ImageBody, ImageKeypoint, Intrinsics,
///     TriangulationSettings, Triangulator,
/// };
///
/// let intrinsics = Intrinsics::new([640, 480], [600.0, 600.0], [319.5, 239.5])?;
/// let nose = Point3::new(0.1, 0.2, 1.6);
/// let eyes = [Point3::new(-3.0, 0.0, 1.5), Point3::new(0.0, -3.0, 1.5)];
/// let mut cameras = Vec::new();
/// for eye in eyes {
///     let camera = Camera::looking_at(intrinsics, eye, Point3::new(0.0, 0.0, 1.5), DepthNoise::D435I)?;
///     let world_from_camera = Some(*camera.world_from_camera());
///     let (name, distortion) = (String::new(), Distortion::None);
///     cameras.push(CalibratedCamera { name, intrinsics, distortion, world_from_camera });
/// }
/// let views: Vec<_> = cameras.iter().map(|camera| {
///     let mut body = ImageBody::default();
///     let seen = camera.project(&nose).map(|position| ImageKeypoint { position, confidence: Confidence::ONE });
///     body.set(Body25::Nose, seen);
///     Some(body)
/// }).collect();
/// let triangulator = Triangulator::new(cameras, TriangulationSettings::default())?;
/// let body = triangulator.body(&views.iter().map(Option::as_ref).collect::<Vec<_>>());
/// assert!((body.get(Body25::Nose).expect("seen twice").position - nose).norm() < 1e-6);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Triangulator {
    cameras: Vec<CalibratedCamera>,
    settings: TriangulationSettings,
}

impl Triangulator {
    /// Creates a triangulator for two to sixteen cameras whose poses are known.
    ///
    /// # Errors
    /// [`Error::Value`] for a setting or a camera whose place is not known, [`Error::Size`] for fewer than two cameras or
    /// more than sixteen.
    pub fn new(
        cameras: Vec<CalibratedCamera>,
        settings: TriangulationSettings,
    ) -> Result<Self, Error> {
        settings.validate()?;
        if !(2..=MOST).contains(&cameras.len()) {
            return Err(Error::size("a triangulation", &[cameras.len()], "cameras", "2 to 16"));
        }
        if let Some(camera) = cameras.iter().find(|camera| camera.world_from_camera.is_none()) {
            let wanted = "a calibration with rotation and translation";
            return Err(Error::value(
                "the place of a camera",
                format!("not known of {}", camera.name),
                wanted,
            ));
        }
        Ok(Self { cameras, settings })
    }

    /// Returns the cameras, in the order of the views.
    pub fn cameras(&self) -> &[CalibratedCamera] {
        &self.cameras
    }

    /// Triangulates the joints of one person, each with its covariance. Neck and mid hip that a network
    /// does not see are the middles of shoulders and hips, with their covariances.
    pub fn body(&self, views: &[Option<&ImageBody>]) -> Body {
        let views: Vec<_> = self
            .cameras
            .iter()
            .zip(views)
            .filter_map(|(camera, view)| {
                view.map(|view| (camera, view, self.settings.noise.sigma(view)))
            })
            .collect();
        let mut body = Body::default();
        for joint in Body25::ALL {
            let sights = views
                .iter()
                .filter_map(|(camera, view, sigma)| self.sight(camera, view, *sigma, joint));
            let sights: Vec<_> = sights.collect();
            if let Some((Agreed { point, covariance, .. }, confidence)) = self.agreed(&sights) {
                body.set_measured(joint, Keypoint { position: point, confidence }, covariance);
            }
        }
        for middle in Middle::ALL {
            let is_derived = views.iter().any(|(_, view, _)| view.is_derived(middle.joint));
            if is_derived && body.get(middle.joint).is_none() {
                body.set_middle(middle);
            }
        }
        body
    }

    /// Triangulates all people whom at least two cameras see. Two views are of one person where the median error of the
    /// joints that both show is small. Views are put together from those pairs on that most other cameras agree with,
    /// and never where two of them disagree.
    pub fn people(&self, views: &[Vec<ImageBody>]) -> Vec<Body> {
        let seen: Vec<(usize, &ImageBody)> = views
            .iter()
            .take(self.cameras.len())
            .enumerate()
            .flat_map(|(camera, people)| people.iter().map(move |person| (camera, person)))
            .collect();
        let errors: Vec<Vec<f64>> = seen
            .iter()
            .map(|one| seen.iter().map(|other| self.disagreement(*one, *other)).collect())
            .collect();
        let agree = |one: usize, other: usize| errors[one][other] <= AGREE;
        let mut pairs = Vec::new();
        for one in 0..seen.len() {
            for other in (one + 1..seen.len()).filter(|other| agree(one, *other)) {
                let support =
                    (0..seen.len()).filter(|&third| agree(one, third) && agree(other, third));
                pairs.push((support.count(), one, other));
            }
        }
        pairs.sort_by(|one, other| {
            let error = |pair: &(usize, usize, usize)| errors[pair.1][pair.2];
            other.0.cmp(&one.0).then(error(one).total_cmp(&error(other)))
        });
        // The views of each person.
        let mut groups: Vec<Vec<usize>> = (0..seen.len()).map(|view| vec![view]).collect();
        for (_, one, other) in pairs {
            let of = |view| groups.iter().position(|group| group.contains(&view));
            let (Some(one), Some(other)) = (of(one), of(other)) else { continue };
            let is_one =
                groups[one].iter().all(|&own| groups[other].iter().all(|&their| agree(own, their)));
            if one != other && is_one {
                let joined = std::mem::take(&mut groups[other]);
                groups[one].extend(joined);
            }
        }
        let body = |group: &Vec<usize>| {
            let mut views = vec![None; self.cameras.len()];
            for &view in group {
                views[seen[view].0] = Some(seen[view].1);
            }
            let body = self.body(&views);
            (body.iter().count() >= JOINTS).then_some(body)
        };
        groups.iter().filter_map(body).collect()
    }

    fn sight<'a>(
        &self,
        camera: &'a CalibratedCamera,
        view: &ImageBody,
        sigma: f64,
        joint: Body25,
    ) -> Option<Sight<'a>> {
        let seen = view.get(joint).filter(|_| !view.is_derived(joint))?;
        let confidence = seen.confidence;
        let is_sure = confidence.value() >= self.settings.least_confidence;
        let at = camera.pinhole(&seen.position)?;
        is_sure.then_some(Sight { camera, at, sigma, confidence })
    }

    /// The median over joints of the squared error of two views, in standard deviations; infinite for views of one camera
    /// and for those that share too few joints.
    fn disagreement(&self, one: (usize, &ImageBody), other: (usize, &ImageBody)) -> f64 {
        if one.0 == other.0 {
            return f64::INFINITY;
        }
        let mut squares = Vec::new();
        for joint in Body25::ALL {
            let sight = |(camera, view): (usize, &ImageBody)| {
                self.sight(&self.cameras[camera], view, self.settings.noise.sigma(view), joint)
            };
            let Some((one, other)) = sight(one).zip(sight(other)) else { continue };
            let pair = [&one, &other];
            let point = nearest(&pair).and_then(|point| refine(&pair, point));
            squares.push(point.map_or(f64::INFINITY, |agreed| agreed.cost));
        }
        squares.sort_by(f64::total_cmp);
        let median = squares.get(squares.len() / 2).filter(|_| squares.len() >= JOINTS);
        median.copied().unwrap_or(f64::INFINITY)
    }

    /// The point that most views agree on, and how sure they are.
    fn agreed(&self, sights: &[Sight<'_>]) -> Option<(Agreed, Confidence)> {
        let limit = self.settings.outlier.powi(2);
        let supports = |point: &Point3<f64>| -> Vec<&Sight<'_>> {
            sights.iter().filter(|sight| sight.square(point) <= limit).collect()
        };
        let mut found: Vec<(Vec<&Sight<'_>>, Agreed)> = Vec::new();
        for (index, one) in sights.iter().enumerate() {
            for other in &sights[index + 1..] {
                let pair = [one, other];
                let proposed = nearest(&pair).and_then(|point| refine(&pair, point));
                // A point of all its views is nearer to others than the pair's is.
                let support =
                    proposed.and_then(|pair| supported(&supports(&pair.point), pair.point));
                let Some(all) = support else { continue };
                let support = supports(&all.point);
                if let Some(agreed) = supported(&support, all.point) {
                    found.push((support, agreed));
                }
            }
        }
        let (support, mut agreed) = found
            .iter()
            .max_by(|(one, agreed), (other, rival)| {
                one.len().cmp(&other.len()).then(rival.cost.total_cmp(&agreed.cost))
            })
            .cloned()?;
        let freedom = (2 * support.len() - 3) as f64;
        agreed.covariance *= (agreed.cost / freedom).max(1.0);
        let sigma = agreed.covariance.symmetric_eigenvalues().max().sqrt();
        let is_elsewhere =
            |(_, rival): &(_, Agreed)| (rival.point - agreed.point).norm() > 3.0 * sigma;
        let is_doubtful = support.len() == 2 && found.iter().any(is_elsewhere);
        if is_doubtful || sigma.is_nan() || sigma > self.settings.largest_sigma {
            return None;
        }
        let sum: f64 = support.iter().map(|sight| sight.confidence.value()).sum();
        let confidence = Confidence::new(sum / support.len() as f64).ok()?;
        Some((agreed, confidence))
    }
}

/// The point of views, two at least.
fn supported(support: &[&Sight<'_>], from: Point3<f64>) -> Option<Agreed> {
    (support.len() >= 2).then(|| refine(support, from)).flatten()
}
