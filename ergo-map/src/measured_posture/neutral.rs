//! Zeros of the angles of trunk and neck.

use nalgebra::Vector2;

use super::direction::turned;
use super::{Head, JointPositions, Trunk};

/// Inclinations of body lines of a person who stands upright, as measured joints show them \[rad\].
///
/// A detector's ears and nose are in front of its shoulders, even if a person holds the head
/// upright. The line from the shoulders to the ears is therefore not the zero of a neck.
///
/// The inclination from mid-shoulders to ears differs between people and detectors. In Kendall's
/// ideal plumb line it is 0, with the lobe of the ear above the shoulder. The default is 30° for
/// the ears and 57° for the nose, for detectors such as BlazePose. Extension of the neck counts if
/// the ears are more than 5° behind the trunk's line. Extension of the trunk counts from 5° on, and
/// the sheets tolerate another 5° as upright.
/// [`NeutralEstimate`] measures a person's own posture.
///
/// ```
/// use ergo_map::{JointPositions, NeutralEstimate, NeutralPosture, Side};
/// use nalgebra::Vector3;
///
/// let at = |x, y, z| Some(Vector3::new(x, y, z));
/// let upright = JointPositions {
///     neck: at(-0.04, 0.0, 1.43),
///     pelvis: at(0.0, 0.0, 0.93),
///     ears: [at(0.06, 0.075, 1.56), at(0.06, -0.075, 1.56)],
///     shoulders: [at(-0.04, 0.18, 1.43), at(-0.04, -0.18, 1.43)],
///     ..JointPositions::default()
/// };
/// let mut estimate = NeutralEstimate::default();
/// estimate.push(&upright);
/// let own = estimate.neutral();
/// let posture = upright.posture_from(Side::Right, &own).expect("the trunk is seen").posture;
/// assert!(posture.trunk_flexion.abs() < 1e-9 && posture.neck_flexion.abs() < 1e-9);
/// assert!(own != NeutralPosture::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeutralPosture {
    /// Inclination of the line from pelvis to neck, forward positive.
    pub trunk: f64,
    /// Inclination from the trunk's line to the line from neck to the midpoint of the ears, forward
    /// positive.
    pub ears: f64,
    /// Inclination from the trunk's line to the line from neck to nose, for unseen ears.
    pub nose: f64,
    /// Extension of the trunk beyond which it counts.
    pub trunk_band: f64,
    /// Extension of the neck beyond which it counts.
    pub neck_band: f64,
}

/// Dead band of the neck of a person whose own neutral posture was measured \[rad\].
const OWN_NECK_BAND: f64 = 10.0 * core::f64::consts::PI / 180.0;

/// Landmark that shows the head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Landmark {
    Ears,
    Nose,
}

impl Default for NeutralPosture {
    fn default() -> Self {
        Self {
            trunk: 0.0,
            ears: 30_f64.to_radians(),
            nose: 57_f64.to_radians(),
            trunk_band: 5_f64.to_radians(),
            neck_band: 35_f64.to_radians(),
        }
    }
}

impl NeutralPosture {
    /// Returns the flexion of a trunk with this inclination.
    pub(super) fn trunk_flexion(&self, inclination: f64) -> f64 {
        without_band(inclination - self.trunk, self.trunk_band)
    }

    /// Returns the flexion of a neck whose line has this inclination relative to the trunk.
    pub(super) fn neck_flexion(&self, inclination: f64, by: Landmark) -> f64 {
        let neutral = match by {
            Landmark::Ears => self.ears,
            Landmark::Nose => self.nose,
        };
        without_band(inclination - neutral, self.neck_band)
    }
}

/// Returns an angle in [-π, π] whose extension counts from the end of a band.
fn without_band(angle: f64, band: f64) -> f64 {
    let angle = turned(angle);
    if angle < 0.0 { (angle + band).min(0.0) } else { angle }
}

/// Estimate of the neutral posture of one person, from frames in which they stand upright and look
/// ahead. It is the mean of each line. Several seconds average out the detector's errors from frame
/// to frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NeutralEstimate {
    /// Sums of unit vectors, since angles have no simple mean.
    trunk: Vector2<f64>,
    ears: Vector2<f64>,
    nose: Vector2<f64>,
}

impl NeutralEstimate {
    /// Takes a frame. A frame without a visible trunk has no effect.
    pub fn push(&mut self, joints: &JointPositions) {
        let Some(trunk) = Trunk::of(joints) else { return };
        let unit = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        self.trunk += unit(trunk.flexion);
        let nose_alone = JointPositions { ears: [None, None], ..*joints };
        for (sum, joints, landmark) in [
            (&mut self.ears, joints, Landmark::Ears),
            (&mut self.nose, &nose_alone, Landmark::Nose),
        ] {
            let head = Head::of(joints, &trunk);
            if let Some(line) = head.neck.filter(|_| head.by == landmark) {
                *sum += unit(line.x.atan2(line.z));
            }
        }
    }

    /// Returns the neutral posture as far as it was seen. The rest is average.
    pub fn neutral(&self) -> NeutralPosture {
        let average = NeutralPosture::default();
        let mean = |sum: &Vector2<f64>| {
            (sum.norm() > 0.5 && sum.norm().is_finite()).then(|| sum.y.atan2(sum.x))
        };
        let ears = mean(&self.ears);
        NeutralPosture {
            trunk: mean(&self.trunk).unwrap_or(average.trunk),
            ears: ears.unwrap_or(average.ears),
            nose: mean(&self.nose).unwrap_or(average.nose),
            trunk_band: average.trunk_band,
            neck_band: if ears.is_some() { OWN_NECK_BAND } else { average.neck_band },
        }
    }
}
