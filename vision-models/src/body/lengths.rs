//! How long a person's segments are, and how tall the person is.

use super::{
    seen::{Joint, Seen},
    segment::{BodySegment, ENDS},
};

/// Statures outside this range come from wrong keypoints (m).
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 1.2..=2.3;

/// A segment of one frame is left out if it is not within this factor of what statures allow.
const SLACK: f64 = 1.5;

/// Frames before a mean is worth reporting.
const ENOUGH: u32 = 20;

/// Segments from which stature follows, the better before.
const OF_STATURE: [&[BodySegment]; 2] = [
    &[BodySegment::Thigh, BodySegment::Shank, BodySegment::Trunk],
    &[BodySegment::Trunk, BodySegment::UpperArm, BodySegment::Forearm],
];

/// The person's stature as the tracker's frames have it.
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
    /// Standard error of that mean from camera noise alone (m); people whose segments are longer or
    /// shorter for their stature than the average are off by more.
    pub standard_error: f64,
    /// How many frames it comes from.
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
    /// How many measurements it comes from.
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

    /// The length of a segment, once it was seen often enough.
    pub(super) fn length(&self, segment: BodySegment) -> Option<SegmentLength> {
        let mean = self.means.get(segment.index()).filter(|mean| mean.count >= ENOUGH)?;
        Some(SegmentLength {
            length: mean.value,
            standard_error: mean.variance().sqrt(),
            samples: mean.count,
        })
    }

    /// Stature from legs and trunk or, where they are hidden, from trunk and arms.
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
            // With fraction zero the quotient is NaN, which is in no range.
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

    /// Of the mean.
    fn variance(&self) -> f64 {
        let n = f64::from(self.count);
        self.sum_of_squares / (n * (n - 1.0)).max(1.0)
    }
}

/// The distance of two joints (m), less what their errors across the line between them add to it on
/// average: |a + e| ≈ |a| + |e⊥|²/(2|a|).
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

/// Returns true for a length that somebody's segment may have, as one frame shows it.
pub(super) fn is_possible(segment: BodySegment, length: f64) -> bool {
    let fraction = segment.fraction();
    (fraction * PLAUSIBLE.start() / SLACK..=fraction * PLAUSIBLE.end() * SLACK).contains(&length)
}
