//! Postures over time, from single frames weighted by their accuracy.

use nalgebra::{Matrix3, Vector3};

use super::direction::{between, towards, turned};
use super::support::Gait;
use super::{JointPositions, MeasuredPosture};
use crate::measured_posture::neutral::NeutralPosture;
use crate::posture::Posture;
use crate::reba::LegSupport;
use crate::side::Side;
use crate::upper_arm::UpperArm;

/// An angle that was not measured for this time counts as not seen \[s\].
const KEPT: f64 = 1.0;

/// Correlation time of errors of measured joints \[s\]. Successive frames contain nearly the same
/// information.
const CORRELATION_TIME: f64 = 0.15;

/// Standard deviation of each joint that no filter averages out, for each axis \[m\]: its depth
/// below skin and clothes.
const LASTING: f64 = 0.015;

/// Larger innovations, in standard deviations, are limited to this. A hidden joint is rarely at its
/// apparent place.
const LARGEST_INNOVATION: f64 = 2.0;

/// Time constant of the mean that decides whether a person sits \[s\].
const SEATED: f64 = 0.5;

/// Variation of an angle of people at work: its mean, standard deviation and time constant.
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

/// Habits in the order of [`Posture::NAMES`]. They are a choice of this crate, wide enough to keep
/// accurate measurements unchanged.
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

/// Indices of the upper arm's flexion and abduction in [`Posture::NAMES`].
const FLEXION: usize = 7;
const ABDUCTION: usize = 8;

/// Habit of the upper arm's direction. Its mean is that of flexion and abduction.
const ARM_HABIT: Habit = habit(0.0, 30.0, 2.0);

/// Filters the angles of a person's posture, with the arm of one side, by a Kalman filter for each.
///
/// An angle varies about a mean (an Ornstein-Uhlenbeck process). The covariances of the joints give
/// the accuracy of its measurement. Noise therefore does not bend a neutral posture, and an angle
/// that is briefly not seen stays known. Angles are filtered on the circle, and the direction of
/// the upper arm on the sphere. An arm that makes a full turn ends where it started.
///
/// A pelvis that moves over the floor means that the person walks, [`LegSupport::Walking`].
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
    neutral: NeutralPosture,
    /// Filters of the angles. Those of flexion and abduction are unused, since these follow from
    /// `arm`.
    angles: [Option<Known<f64>>; Posture::LEN],
    arm: Option<Known<Vector3<f64>>>,
    gait: Gait,
    /// Recent share of the time in which the person sat, and its time \[s\].
    seated: Option<(f64, f64)>,
}

/// Estimate of an angle or of a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Known<T> {
    value: T,
    /// Variance \[rad²\]. That of a direction is about each of its two axes.
    variance: f64,
    /// Time of the last measurement, and time of `value` \[s\].
    seen: f64,
    time: f64,
}

/// An angle on the circle or a direction on the sphere.
trait Place: Copy {
    /// Returns the angle between the two.
    fn distance(self, other: Self) -> f64;
    /// Moves towards another one by an angle.
    fn towards(self, other: Self, angle: f64) -> Self;
    fn is_finite(self) -> bool;
}

impl Place for f64 {
    fn distance(self, other: Self) -> f64 {
        turned(other - self).abs()
    }

    fn towards(self, other: Self, angle: f64) -> Self {
        turned(self + angle.copysign(turned(other - self)))
    }

    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }
}

impl Place for Vector3<f64> {
    fn distance(self, other: Self) -> f64 {
        between(&self, &other)
    }

    fn towards(self, other: Self, angle: f64) -> Self {
        towards(&self, &other, angle)
    }

    fn is_finite(self) -> bool {
        self.iter().all(|value| value.is_finite())
    }
}

impl PostureFilter {
    /// Creates a filter without observations, for a person with an average neutral posture.
    pub fn new(side: Side) -> Self {
        let (angles, gait) = ([None; Posture::LEN], Gait::default());
        Self { side, neutral: NeutralPosture::default(), angles, arm: None, gait, seated: None }
    }

    /// Sets the neutral posture of the person. Forgets all observations.
    #[must_use]
    pub fn with_neutral(self, neutral: NeutralPosture) -> Self {
        Self { neutral, ..Self::new(self.side) }
    }

    /// Takes a frame, and returns the posture at its time \[s\].
    ///
    /// `None` if the trunk's flexion was not seen in the last second. `covariances` are those of
    /// the joints' positions \[m²\] in the order of [`JointPositions::to_array`]. Allocates
    /// nothing. A time that is not later than the one before restarts the filter.
    pub fn update(
        &mut self,
        time: f64,
        joints: &JointPositions,
        covariances: &[Matrix3<f64>; JointPositions::LEN],
    ) -> Option<MeasuredPosture> {
        let measured = joints.posture_from(self.side, &self.neutral);
        let variances = measured.map(|measured| self.variances(joints, &measured, covariances));
        let frame = measured.zip(variances);
        for (index, (known, habit)) in self.angles.iter_mut().zip(&HABITS).enumerate() {
            let value = frame.filter(|(measured, _)| measured.seen[index]);
            let value = value.map(|(measured, variances)| {
                (measured.posture.to_array()[index], variances.angles[index])
            });
            Known::follow(known, time, value, habit, habit.mean.to_radians());
        }
        let arm = frame.filter(|(measured, _)| measured.seen[FLEXION]);
        let arm = arm
            .map(|(measured, variances)| (measured.posture.upper_arm().to_vector(), variances.arm));
        let [flexion, abduction] =
            [FLEXION, ABDUCTION].map(|index| HABITS[index].mean.to_radians());
        let mean = UpperArm::of_angles(flexion, abduction).to_vector();
        Known::follow(&mut self.arm, time, arm, &ARM_HABIT, mean);
        let support = self.support(time, joints, measured.map(|measured| measured.support));

        let recent = |seen: f64| time - seen <= KEPT;
        let mut angles = self.angles.map(|known| known.filter(|known| recent(known.seen)));
        angles[0]?;
        let arm = self.arm.filter(|known| recent(known.seen));
        for index in [FLEXION, ABDUCTION] {
            angles[index] = None;
        }
        let mut posture = angles.map(|known| known.map_or(0.0, |known| known.value));
        let mut seen = angles.map(|known| known.is_some());
        if let Some(direction) = arm.and_then(|known| UpperArm::of_vector(&known.value)) {
            [posture[FLEXION], posture[ABDUCTION]] = direction.angles();
            [seen[FLEXION], seen[ABDUCTION]] = [true; 2];
        }
        Some(MeasuredPosture { posture: Posture::from_array(posture), support, seen })
    }

    /// Returns the support of the body, by the last half second.
    fn support(
        &mut self,
        time: f64,
        joints: &JointPositions,
        measured: Option<LegSupport>,
    ) -> LegSupport {
        let walks = self.gait.update(time, joints);
        let before = self.seated.filter(|(_, last)| *last < time);
        if let Some(support) = measured {
            let now = f64::from(u8::from(support == LegSupport::Sitting));
            let share = before
                .map_or(now, |(share, last)| now + (share - now) * (-(time - last) / SEATED).exp());
            self.seated = Some((share, time));
        }
        match self.seated {
            _ if walks => LegSupport::Walking,
            Some((share, _)) if share > 0.5 => LegSupport::Sitting,
            _ => LegSupport::Bilateral,
        }
    }

    /// Returns the variances of the angles, by moving each joint along the axes of its covariance.
    fn variances(
        &self,
        joints: &JointPositions,
        measured: &MeasuredPosture,
        covariances: &[Matrix3<f64>; JointPositions::LEN],
    ) -> Variances {
        let (angles, positions) = (measured.posture.to_array(), joints.to_array());
        let arm = measured.posture.upper_arm().to_vector();
        let mut variances = Variances { angles: [0.0; Posture::LEN], arm: 0.0 };
        for (index, (position, covariance)) in positions.into_iter().zip(covariances).enumerate() {
            let lasting = Matrix3::identity() * LASTING.powi(2);
            let Some((position, factor)) = position.zip((covariance + lasting).cholesky()) else {
                continue;
            };
            for axis in factor.l().column_iter() {
                let mut moved = positions;
                moved[index] = Some(position + axis);
                let moved = JointPositions::from_array(moved);
                let Some(moved) = moved.posture_from(self.side, &self.neutral) else { continue };
                for (variance, (one, other)) in variances
                    .angles
                    .iter_mut()
                    .zip(moved.posture.to_array().into_iter().zip(angles))
                {
                    *variance += turned(one - other).powi(2);
                }
                // Two axes share the variance.
                let way = between(&moved.posture.upper_arm().to_vector(), &arm);
                variances.arm += 0.5 * way.powi(2);
            }
        }
        variances
    }
}

/// Variances of a frame's angles, and of the upper arm's direction \[rad²\].
#[derive(Clone, Copy)]
struct Variances {
    angles: [f64; Posture::LEN],
    arm: f64,
}

impl<T: Place> Known<T> {
    /// Updates an estimate with a frame's value and variance.
    fn follow(
        known: &mut Option<Self>,
        time: f64,
        frame: Option<(T, f64)>,
        habit: &Habit,
        mean: T,
    ) {
        let now =
            known.filter(|known| known.time < time).map(|known| known.advanced(time, habit, mean));
        *known = match frame {
            Some((value, variance)) if value.is_finite() && variance.is_finite() => {
                // The prior is the habit of people.
                let spread = habit.spread.to_radians();
                let before = now.unwrap_or(Self {
                    value: mean,
                    variance: spread.powi(2),
                    seen: f64::NEG_INFINITY,
                    time,
                });
                Some(before.corrected(value, variance))
            }
            _ => now,
        };
    }

    fn advanced(&self, time: f64, habit: &Habit, mean: T) -> Self {
        let spread = habit.spread.to_radians();
        let kept = (-(time - self.time) / habit.time).exp();
        let value = self.value.towards(mean, (1.0 - kept) * self.value.distance(mean));
        let variance = spread * spread + kept * kept * (self.variance - spread * spread);
        Self { value, variance, time, ..*self }
    }

    /// Returns the estimate corrected by a measurement at its time.
    fn corrected(&self, value: T, variance: f64) -> Self {
        let interval = if self.seen.is_finite() { self.time - self.seen } else { f64::INFINITY };
        let correlation = (-interval / CORRELATION_TIME).exp();
        let variance = variance * (1.0 + correlation) / (1.0 - correlation).max(1e-3);
        let expected = self.variance + variance;
        let limit = LARGEST_INNOVATION * expected.sqrt();
        let innovation = self.value.distance(value).min(limit);
        let gain = self.variance / expected;
        Self {
            value: self.value.towards(value, gain * innovation),
            variance: self.variance * (1.0 - gain),
            seen: self.time,
            time: self.time,
        }
    }
}
