//! A simulated depth camera that measures joints.

use nalgebra::{Point3, Rotation2, Vector2, Vector3, Vector4};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vision_models::{Body, Body25, Confidence, Keypoint};

use super::joints::Joints;

/// Place of the camera in the world \[m\], at the height of HRI30's, looking at the workplace.
const EYE: Point3<f64> = Point3::new(0.3, 1.8, 2.3);

/// Distance of the person whom it looks at along x \[m\].
const AHEAD: f64 = 1.1;

/// Standard deviation of the depth at 1 m \[m\], which grows with the square of the distance. It is s / (f B) with s =
/// 0.08 px, f = 385 px and B = 50 mm (RealSense D435i, 640 × 480).
const DEPTH_SIGMA: f64 = 0.08 / (385.0 * 0.05);

/// Standard deviation across the ray at 1 m \[m\], which grows with the distance. It is 1.5 px of the detector at a
/// focal length of 615 px.
const ACROSS_SIGMA: f64 = 1.5 / 615.0;

/// Correlation time of lasting errors \[s\]. Errors of [`CameraSettings::LASTING`] are correlated by 0.69, 0.53 and
/// 0.31 over 0.05, 0.1 and 0.2 s. BlazePose's were measured on film as 0.72, 0.51 and 0.31.
const CORRELATION_TIME: f64 = 0.19;

/// Distance of a jump \[m\].
const JUMP: f64 = 2.0;

/// Quality of the camera.
///
/// ```
/// use simulated_people::CameraSettings;
///
/// let sharp = CameraSettings { noise: 0.5, ..CameraSettings::default() };
/// assert_ne!(sharp, CameraSettings::PERFECT);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSettings {
    /// Factor on the noise of a `RealSense` D435i, whose depth has the standard deviation 4 mm · (z / 1 m)². Default 1.
    pub noise: f64,
    /// Share of the noise's variance that lasts from frame to frame. Default 0; real detectors have
    /// [`LASTING`](Self::LASTING).
    pub lasting: f64,
    /// Largest error of a joint \[m\]. Default infinite.
    pub largest_error: f64,
    /// Probability that a joint is missing in a frame. Default 0.02.
    ///
    /// The probability is a quarter of it that the person is missed for one to six frames. It is a tenth that a frame
    /// is lost, and that a joint is put in the wrong place with little confidence.
    pub drop: f64,
    /// Number of times that the person seems to be two metres away, for up to 2 s. Default 0.
    pub jumps: u32,
    /// Number of times that the person is not seen, for up to 3 s. Default 0.
    pub vanishings: u32,
    /// Distance along x between further cameras for people who leave the range of the first \[m\]. The nearest camera
    /// sees the person. Default none.
    pub spacing: Option<f64>,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self {
            noise: 1.0,
            lasting: 0.0,
            largest_error: f64::INFINITY,
            drop: 0.02,
            jumps: 0,
            vanishings: 0,
            spacing: None,
        }
    }
}

impl CameraSettings {
    /// Share of the variance that lasts in real detectors.
    pub const LASTING: f64 = 0.9;

    /// A camera without errors.
    pub const PERFECT: Self = Self {
        noise: 0.0,
        lasting: 0.0,
        largest_error: f64::INFINITY,
        drop: 0.0,
        jumps: 0,
        vanishings: 0,
        spacing: None,
    };

    /// The place of the camera that sees a person at `place` best, in the world \[m\].
    fn eye(&self, place: &Point3<f64>) -> Point3<f64> {
        let along = self
            .spacing
            .map_or(0.0, |spacing| spacing * ((place.x - EYE.x - AHEAD) / spacing).round());
        EYE + Vector3::x() * along
    }
}

#[derive(Clone, Debug)]
pub(super) struct Camera {
    settings: CameraSettings,
    draw: ChaCha8Rng,
    /// Begin, end \[s\] and displacement \[m\] of each jump.
    jumps: Vec<(f64, f64, Vector2<f64>)>,
    /// Begin and end of each vanishing \[s\].
    vanishings: Vec<(f64, f64)>,
    /// Number of further frames in which the person is missed.
    missed: u32,
    /// Lasting errors of each joint, across the ray and along it, with variance 1, and the time of the last frame \[s\].
    lasting: [Vector4<f64>; Body25::COUNT],
    seen: f64,
}

impl Camera {
    /// Creates a camera whose jumps and vanishings are spread over `duration` \[s\].
    pub(super) fn new(settings: CameraSettings, duration: f64, mut draw: ChaCha8Rng) -> Self {
        let mut interval = |longest: f64| {
            let begin = draw.random_range(0.2..0.8) * duration;
            (begin, begin + draw.random_range(0.3..longest))
        };
        let vanishings = (0..settings.vanishings).map(|_| interval(3.0)).collect();
        let jumps: Vec<_> = (0..settings.jumps).map(|_| interval(2.0)).collect();
        let jumps = jumps
            .into_iter()
            .map(|(begin, end)| {
                let direction = Rotation2::new(draw.random_range(-3.0..3.0));
                (begin, end, direction * Vector2::new(JUMP, 0.0))
            })
            .collect();
        let (lasting, seen) = ([Vector4::zeros(); Body25::COUNT], f64::NEG_INFINITY);
        Self { settings, draw, jumps, vanishings, missed: 0, lasting, seen }
    }

    pub(super) fn set(&mut self, settings: CameraSettings) {
        self.settings = settings;
    }

    /// Returns true if this frame never arrives.
    pub(super) fn loses_frame(&mut self) -> bool {
        self.draw.random_bool(self.settings.drop / 10.0)
    }

    /// The joints \[m, world\] as they are seen at a time \[s\]; `None` if the person is missed.
    pub(super) fn see(&mut self, time: f64, joints: &Joints) -> Option<Body> {
        let within = |begin: f64, end: f64| begin <= time && time < end;
        if self.missed == 0 && self.draw.random_bool(self.settings.drop / 4.0) {
            self.missed = self.draw.random_range(1..=6);
        }
        let jump: Vector2<f64> = self
            .jumps
            .iter()
            .filter(|(begin, end, _)| within(*begin, *end))
            .map(|(.., displacement)| displacement)
            .sum();
        self.let_errors_last(time);
        // The random numbers are always drawn, so that later ones do not depend on the visible person.
        let eye = self.settings.eye(&joints[Body25::MidHip as usize]);
        let lasting = self.lasting;
        let mut places = joints.iter().zip(lasting);
        let seen = std::array::from_fn(|_| {
            let (joint, lasting) = places.next()?;
            self.joint(&eye, joint + jump.push(0.0), &lasting)
        });
        let vanished = self.vanishings.iter().any(|&(begin, end)| within(begin, end));
        let missed = self.missed > 0;
        self.missed = self.missed.saturating_sub(1);
        (!vanished && !missed).then(|| Body::new(seen))
    }

    /// Advances the lasting errors to the frame at `time` \[s\].
    fn let_errors_last(&mut self, time: f64) {
        let fades = (-(time - self.seen) / CORRELATION_TIME).exp();
        self.seen = time;
        if self.settings.lasting == 0.0 {
            return;
        }
        for error in &mut self.lasting {
            let new = Vector4::from_fn(|_, _| StandardNormal.sample(&mut self.draw));
            *error = *error * fades + new * (1.0 - fades * fades).sqrt();
        }
    }

    /// A joint as it is seen in this frame, with these lasting errors of variance 1; `None` if it is missing.
    fn joint(
        &mut self,
        eye: &Point3<f64>,
        joint: Point3<f64>,
        lasting: &Vector4<f64>,
    ) -> Option<Keypoint> {
        let ray = joint - eye;
        let distance = ray.norm();
        let across = self.settings.noise * ACROSS_SIGMA * distance;
        let along = self.settings.noise * DEPTH_SIGMA * distance * distance;
        let mut normal = || -> f64 { StandardNormal.sample(&mut self.draw) };
        let new = Vector4::new(normal(), normal(), normal(), normal());
        let share = self.settings.lasting;
        let errors = new * (1.0 - share).sqrt() + lasting * share.sqrt();
        let (sideways, depth, quality) = (errors.xyz() * across, errors.w * along, normal());
        let drop = self.settings.drop;
        let (missing, misplaced) =
            (self.draw.random_bool(drop), self.draw.random_bool(drop / 10.0));
        let (error, confidence) = if misplaced {
            (Vector3::from_fn(|_, _| self.draw.random_range(-0.4..0.4)), 0.35 + 0.1 * quality)
        } else {
            (sideways + ray * (depth / distance), 0.82 + 0.06 * quality)
        };
        let error = error.cap_magnitude(self.settings.largest_error);
        let confidence = Confidence::new(confidence.clamp(0.05, 0.98)).ok()?;
        (!missing).then(|| Keypoint { position: joint + error, confidence })
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::rand_core::SeedableRng;

    use super::*;

    /// The root mean square error of the depth of a person this far along x \[m\].
    fn error(x: f64, spacing: Option<f64>) -> f64 {
        let settings = CameraSettings { drop: 0.0, spacing, ..CameraSettings::default() };
        let mut camera = Camera::new(settings, 1.0, ChaCha8Rng::seed_from_u64(1));
        let place = Point3::new(x, 0.0, 1.0);
        let squares = (0..500).map(|_| {
            let body = camera.see(0.0, &[place; Body25::COUNT]).unwrap();
            (body.get(Body25::MidHip).unwrap().position.x - x).powi(2)
        });
        (squares.sum::<f64>() / 500.0).sqrt()
    }

    #[test]
    fn lasting_errors_are_correlated_like_those_of_detectors() {
        let errors = |lasting: f64| -> Vec<f64> {
            let settings = CameraSettings { drop: 0.0, lasting, ..CameraSettings::default() };
            let mut camera = Camera::new(settings, 1.0, ChaCha8Rng::seed_from_u64(2));
            let place = Point3::new(1.4, 0.0, 1.0);
            let nose = |frame| {
                let body = camera.see(0.05 * f64::from(frame), &[place; Body25::COUNT]).unwrap();
                body.get(Body25::Nose).unwrap().position.x - place.x
            };
            (0..40_000).map(nose).collect()
        };
        let covariance = |errors: &[f64], frames: usize| {
            let products = errors.iter().zip(&errors[frames..]).map(|(a, b)| a * b);
            products.sum::<f64>() / (errors.len() - frames) as f64
        };
        let (lasting, white) = (errors(CameraSettings::LASTING), errors(0.0));
        let variance = covariance(&lasting, 0);
        assert!((variance / covariance(&white, 0) - 1.0).abs() < 0.1);
        for (frames, measured) in [(1, 0.72), (2, 0.51), (4, 0.31)] {
            let found = covariance(&lasting, frames) / variance;
            assert!((found - measured).abs() < 0.06, "{found} after {frames} frames");
            assert!((covariance(&white, frames) / covariance(&white, 0)).abs() < 0.03);
        }
    }

    #[test]
    fn row_of_cameras_sees_far_people_well() {
        let near = error(1.4, None);
        assert!(near < 0.05, "{near}");
        assert!(error(13.4, None) > 5.0 * near);
        for x in [1.4, 4.0, 8.9, 13.4] {
            assert!(error(x, Some(3.0)) < 2.5 * near, "at {x} m");
        }
        // A person at the workplace is seen as by a single camera.
        assert_eq!(error(1.4, Some(3.0)).to_bits(), near.to_bits());
    }
}
