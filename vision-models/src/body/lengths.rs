//! The lengths of a person's segments, and the person's stature.

use super::{
    seen::{Joint, Seen},
    segment::{BodySegment, ENDS},
};

/// Statures outside this range come from wrong keypoints (m).
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 1.2..=2.3;

/// A measured length is left out if it differs from the lengths of plausible statures by more than
/// this factor.
const SLACK: f64 = 1.5;

/// Smallest number of measurements for a mean.
const ENOUGH: u32 = 20;

/// Segments that give the stature. The first set that is known is used.
const OF_STATURE: [&[BodySegment]; 2] = [
    &[BodySegment::Thigh, BodySegment::Shank, BodySegment::Trunk],
    &[BodySegment::Trunk, BodySegment::UpperArm, BodySegment::Forearm],
];

/// The person's stature, estimated from the tracker's frames.
///
/// ```
/// use vision_models::StatureEstimate;
///
/// let estimate = StatureEstimate { stature: 1.78, standard_error: 0.01, frames: 40 };
/// assert!(estimate.stature > 1.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatureEstimate {
    /// Mean over the frames (m).
    pub stature: f64,
    /// Standard error of that mean from camera noise alone (m). The error is larger for persons
    /// whose segments are unusually long or short for their stature.
    pub standard_error: f64,
    /// Number of frames.
    pub frames: u32,
}

/// The measured length of a segment.
///
/// ```
/// use vision_models::SegmentLength;
///
/// let forearm = SegmentLength { length: 0.26, standard_error: 0.004, samples: 60 };
/// assert!(forearm.length > 0.2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentLength {
    /// Mean over the frames and both sides (m).
    pub length: f64,
    /// Standard error of that mean from camera noise alone (m).
    pub standard_error: f64,
    /// Number of measurements.
    pub samples: u32,
}

/// The lengths of one person's segments.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lengths {
    means: [Mean; BodySegment::COUNT],
    /// Frames in which a segment was seen.
    frames: u32,
}

/// Running mean and variance (Welford).
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    count: u32,
    value: f64,
    sum_of_squares: f64,
}

impl Lengths {
    pub(super) fn update(&mut self, seen: &Seen<'_>) {
        let mut any = false;
        for (segment, from, to) in ENDS {
            let (Some(from), Some(to)) = (seen.joint(from), seen.joint(to)) else { continue };
            let (Some(mean), length) = (self.means.get_mut(segment.index()), length(&from, &to))
            else {
                continue;
            };
            if is_possible(segment, length) {
                mean.push(length);
                any = true;
            }
        }
        self.frames = self.frames.saturating_add(u32::from(any));
    }

    /// Returns the length of a segment, if it was measured often enough.
    pub(super) fn length(&self, segment: BodySegment) -> Option<SegmentLength> {
        let mean = self.means.get(segment.index()).filter(|mean| mean.count >= ENOUGH)?;
        Some(SegmentLength {
            length: mean.value,
            standard_error: mean.variance().sqrt(),
            samples: mean.count,
        })
    }

    /// Returns the stature from legs and trunk or, if the legs are hidden, from trunk and arms.
    pub(super) fn stature(&self) -> Option<StatureEstimate> {
        if self.frames < ENOUGH {
            return None;
        }
        OF_STATURE.into_iter().find_map(|segments| {
            let (mut length, mut fraction, mut variance) = (0.0, 0.0, 0.0);
            for &segment in segments {
                let mean = self.means.get(segment.index())?;
                if mean.count >= ENOUGH {
                    length += mean.value;
                    fraction += segment.fraction();
                    variance += mean.variance();
                }
            }
            // If the fraction is zero, the quotient is NaN, which is in no range.
            let stature = length / fraction;
            PLAUSIBLE.contains(&stature).then_some(StatureEstimate {
                stature,
                standard_error: variance.sqrt() / fraction,
                frames: self.frames,
            })
        })
    }
}

impl Mean {
    fn push(&mut self, value: f64) {
        if self.count < u32::MAX {
            self.count += 1;
            let deviation = value - self.value;
            self.value += deviation / f64::from(self.count);
            self.sum_of_squares += deviation * (value - self.value);
        }
    }

    /// Returns the variance of the mean.
    fn variance(&self) -> f64 {
        let n = f64::from(self.count);
        self.sum_of_squares / (n * (n - 1.0)).max(1.0)
    }
}

/// Returns the distance of two joints (m). Errors across the line between the joints lengthen it on
/// average,
/// |a + e| ≈ |a| + |e⊥|²/(2|a|). This mean error is subtracted.
fn length(from: &Joint, to: &Joint) -> f64 {
    let line = to.position - from.position;
    let distance = line.norm();
    let Some((one, other)) = from.covariance.zip(to.covariance).filter(|_| distance > 0.0) else {
        return distance;
    };
    let covariance = one + other;
    let along = line.dot(&(covariance * line)) / (distance * distance);
    distance - (covariance.trace() - along) / (2.0 * distance)
}

/// Returns true if a segment of some person may have this length in one frame.
pub(super) fn is_possible(segment: BodySegment, length: f64) -> bool {
    let fraction = segment.fraction();
    (fraction * PLAUSIBLE.start() / SLACK..=fraction * PLAUSIBLE.end() * SLACK).contains(&length)
}
