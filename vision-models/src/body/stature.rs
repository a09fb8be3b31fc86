//! How tall the person is, from the lengths of the segments.

use super::{heading::Seen, keypoints::Body25};

/// Segments that keep their length in every posture, as fractions of stature (Drillis & Contini
/// 1966): thigh .530 - .285, shank .285 - .039.
const SEGMENTS: [(Body25, Body25, f64); 4] = [
    (Body25::LeftHip, Body25::LeftKnee, 0.245),
    (Body25::LeftKnee, Body25::LeftAnkle, 0.246),
    (Body25::RightHip, Body25::RightKnee, 0.245),
    (Body25::RightKnee, Body25::RightAnkle, 0.246),
];

/// Statures outside this range come from wrong keypoints (m).
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 1.2..=2.3;

/// Frames before the mean is worth reporting.
const ENOUGH: u32 = 20;

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
    /// Standard error of that mean from camera noise alone (m); people whose legs are longer or
    /// shorter for their stature than the average are off by more.
    pub standard_error: f64,
    /// How many frames it comes from.
    pub frames: u32,
}

/// Running mean and variance (Welford).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StatureMean {
    frames: u32,
    mean: f64,
    sum_of_squares: f64,
}

impl StatureMean {
    pub(super) fn update(&mut self, seen: &Seen<'_>) {
        let (mut length, mut fraction) = (0.0, 0.0);
        for (from, to, part) in SEGMENTS {
            if let (Some(from), Some(to)) = (seen.point(from), seen.point(to)) {
                length += (to - from).norm();
                fraction += part;
            }
        }
        // With fraction zero the quotient is NaN, which is in no range.
        let stature = length / fraction;
        if PLAUSIBLE.contains(&stature) && self.frames < u32::MAX {
            self.frames += 1;
            let deviation = stature - self.mean;
            self.mean += deviation / f64::from(self.frames);
            self.sum_of_squares += deviation * (stature - self.mean);
        }
    }

    pub(super) fn estimate(&self) -> Option<StatureEstimate> {
        let n = f64::from(self.frames);
        (self.frames >= ENOUGH).then(|| StatureEstimate {
            stature: self.mean,
            standard_error: (self.sum_of_squares / (n * (n - 1.0))).sqrt(),
            frames: self.frames,
        })
    }
}
