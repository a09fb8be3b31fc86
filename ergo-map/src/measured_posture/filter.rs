//! Postures over time: what single frames say, weighed by how well they say it.

use nalgebra::Matrix3;

use super::{JointPositions, MeasuredPosture};
use crate::{posture::Posture, side::Side};

/// An angle that was not measured for so long counts as not seen \[s\].
const KEPT: f64 = 1.0;

/// Errors of measured joints last so long \[s\]: frames that follow each other say nearly the same.
const CORRELATION_TIME: f64 = 0.15;

/// Each joint's standard deviation that no filter averages out, each axis \[m\]: how deep it lies below
/// skin and clothes.
const LASTING: f64 = 0.015;

/// Innovations of more standard deviations than this count as so many: a hidden joint is seldom where it
/// seems to be.
const LARGEST_INNOVATION: f64 = 2.0;

/// How an angle varies as people work: about its mean, with a standard deviation, and over a time.
struct Habit {
    /// \[°\]
    mean: f64,
    /// \[°\]
    spread: f64,
    /// \[s\]
    time: f64,
}

const fn habit(mean: f64, spread: f64, time: f64) -> Habit {
    Habit { mean, spread, time }
}

/// In the order of [`Posture::NAMES`]. A choice of this crate: wide enough that what is measured well
/// stays as it is.
const HABITS: [Habit; Posture::LEN] = [
    habit(0.0, 30.0, 3.0),
    habit(0.0, 10.0, 3.0),
    habit(0.0, 10.0, 3.0),
    habit(0.0, 20.0, 3.0),
    habit(0.0, 10.0, 3.0),
    habit(0.0, 20.0, 3.0),
    habit(20.0, 30.0, 0.3),
    habit(20.0, 40.0, 2.0),
    habit(10.0, 20.0, 2.0),
    habit(0.0, 30.0, 2.0),
    habit(45.0, 40.0, 2.0),
    habit(0.0, 30.0, 2.0),
    habit(0.0, 10.0, 2.0),
    habit(0.0, 40.0, 2.0),
];

/// Follows the angles of a person's posture, with the arm of one side, by a Kalman filter each: an angle
/// wanders about a mean (an Ornstein-Uhlenbeck process), and is measured as well as the covariances of
/// the joints say. So noise does not make a neutral posture a bent one, and an angle that is not seen for
/// a moment stays known.
///
/// ```
/// use ergo_map::{JointPositions, PostureFilter, Side};
/// use nalgebra::{Matrix3, Vector3};
///
/// let joints = JointPositions {
///     neck: Some(Vector3::new(0.25, 0.0, 1.33)),
///     pelvis: Some(Vector3::new(0.0, 0.0, 0.9)),
///     shoulders: [Some(Vector3::new(0.25, 0.2, 1.33)), Some(Vector3::new(0.25, -0.2, 1.33))],
///     ..JointPositions::default()
/// };
/// // Each joint is known to 2 cm, each axis.
/// let covariances = [Matrix3::identity() * 0.02_f64.powi(2); JointPositions::LEN];
/// let mut filter = PostureFilter::new(Side::Right);
/// let mut flexion = f64::NAN;
/// for frame in 0..40 {
///     let measured = filter.update(0.05 * f64::from(frame), &joints, &covariances);
///     flexion = measured.expect("the trunk is seen").posture.trunk_flexion;
/// }
/// assert!((flexion - (0.25_f64 / 0.43).atan()).abs() < 0.02);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PostureFilter {
    side: Side,
    angles: [Option<Angle>; Posture::LEN],
}

/// What is known of an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Angle {
    value: f64,
    variance: f64,
    /// When it was measured last, and the time of `value` \[s\].
    seen: f64,
    time: f64,
}

impl PostureFilter {
    /// A filter that has seen nothing yet.
    pub fn new(side: Side) -> Self {
        Self { side, angles: [None; Posture::LEN] }
    }

    /// Takes a frame in and gives the posture at its time \[s\]; `None` as long as the trunk's flexion was
    /// not seen in the last second. `covariances` are those of the joints' positions \[m²\] in the order of
    /// [`JointPositions::to_array`]. It allocates nothing. A time that is not later than the one before
    /// begins anew.
    pub fn update(
        &mut self,
        time: f64,
        joints: &JointPositions,
        covariances: &[Matrix3<f64>; JointPositions::LEN],
    ) -> Option<MeasuredPosture> {
        let measured = joints.posture(self.side);
        let variances =
            measured.map(|measured| variances(joints, self.side, &measured, covariances));
        for (index, (angle, habit)) in self.angles.iter_mut().zip(&HABITS).enumerate() {
            let now =
                angle.filter(|angle| angle.time < time).map(|angle| angle.advanced(time, habit));
            let value = measured.filter(|measured| measured.seen[index]);
            let value = value.map(|measured| measured.posture.to_array()[index]);
            let frame = value.zip(variances.map(|variances| variances[index]));
            *angle = match frame.filter(|(value, variance)| (value + variance).is_finite()) {
                None => now,
                Some((value, variance)) => {
                    let before = now.unwrap_or_else(|| Angle::before_any(time, habit));
                    Some(before.corrected(value, variance))
                }
            };
        }
        let known = self.angles.map(|angle| angle.filter(|angle| time - angle.seen <= KEPT));
        known[0]?;
        Some(MeasuredPosture {
            posture: Posture::from_array(known.map(|angle| angle.map_or(0.0, |angle| angle.value))),
            seen: known.map(|angle| angle.is_some()),
        })
    }
}

impl Angle {
    /// As people are.
    fn before_any(time: f64, habit: &Habit) -> Self {
        let (value, variance) = (habit.mean.to_radians(), habit.spread.to_radians().powi(2));
        Self { value, variance, seen: f64::NEG_INFINITY, time }
    }

    fn advanced(&self, time: f64, habit: &Habit) -> Self {
        let (mean, spread) = (habit.mean.to_radians(), habit.spread.to_radians());
        let kept = (-(time - self.time) / habit.time).exp();
        let value = mean + kept * (self.value - mean);
        let variance = spread * spread + kept * kept * (self.variance - spread * spread);
        Self { value, variance, time, ..*self }
    }

    /// With a measurement at its time taken in.
    fn corrected(&self, value: f64, variance: f64) -> Self {
        let interval = if self.seen.is_finite() { self.time - self.seen } else { f64::INFINITY };
        let correlation = (-interval / CORRELATION_TIME).exp();
        let variance = variance * (1.0 + correlation) / (1.0 - correlation).max(1e-3);
        let expected = self.variance + variance;
        let limit = LARGEST_INNOVATION * expected.sqrt();
        let innovation = turned(value - self.value).clamp(-limit, limit);
        let gain = self.variance / expected;
        Self {
            value: self.value + gain * innovation,
            variance: self.variance * (1.0 - gain),
            seen: self.time,
            time: self.time,
        }
    }
}

/// The variances of the angles \[rad²\], by moving each joint along the axes of its covariance.
fn variances(
    joints: &JointPositions,
    side: Side,
    measured: &MeasuredPosture,
    covariances: &[Matrix3<f64>; JointPositions::LEN],
) -> [f64; Posture::LEN] {
    let (angles, positions) = (measured.posture.to_array(), joints.to_array());
    let mut variances = [0.0; Posture::LEN];
    for (index, (position, covariance)) in positions.into_iter().zip(covariances).enumerate() {
        let lasting = Matrix3::identity() * LASTING.powi(2);
        let Some((position, factor)) = position.zip((covariance + lasting).cholesky()) else {
            continue;
        };
        for axis in factor.l().column_iter() {
            let mut moved = positions;
            moved[index] = Some(position + axis);
            let Some(moved) = JointPositions::from_array(moved).posture(side) else { continue };
            for (variance, (one, other)) in
                variances.iter_mut().zip(moved.posture.to_array().into_iter().zip(angles))
            {
                *variance += turned(one - other).powi(2);
            }
        }
    }
    variances
}

/// An angle in [-π, π].
fn turned(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}
