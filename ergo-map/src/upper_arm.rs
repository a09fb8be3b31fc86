//! The direction of the upper arm in the trunk's axes.

use core::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Vector3;

/// Behind the trunk an elevation of up to so much is extension \[°\]. The shoulder extends by 60°
/// (AAOS); an arm further up there has come over the head.
pub(crate) const LARGEST_EXTENSION: f64 = 70.0;

/// Closer to the trunk's frontal plane than this is in it: a converted angle may miss by an ulp.
const ON_PLANE: f64 = 1e-9;

/// A unit vector along the upper arm, from the shoulder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UpperArm {
    pub(crate) forward: f64,
    /// Away from the middle of the body.
    pub(crate) outward: f64,
    /// Along the trunk.
    pub(crate) down: f64,
}

impl UpperArm {
    /// Flexed, and then abducted out of the sagittal plane \[rad\].
    pub(crate) fn of_angles(flexion: f64, abduction: f64) -> Self {
        Self {
            forward: flexion.sin() * abduction.cos(),
            outward: abduction.sin(),
            down: flexion.cos() * abduction.cos(),
        }
    }

    /// From a vector of forward, outward and down; `None` for one without a direction.
    pub(crate) fn of_vector(vector: &Vector3<f64>) -> Option<Self> {
        let unit = vector.try_normalize(1e-9)?;
        let known = unit.iter().all(|value| value.is_finite());
        known.then_some(Self { forward: unit.x, outward: unit.y, down: unit.z })
    }

    /// Forward, outward, down.
    pub(crate) fn to_vector(self) -> Vector3<f64> {
        Vector3::new(self.forward, self.outward, self.down)
    }

    /// Flexion in [-π/2, 3π/2) and abduction in [-π/2, π/2] \[rad\]: an arm that goes up in front of the
    /// trunk and on behind the head is flexed by more than π.
    pub(crate) fn angles(self) -> [f64; 2] {
        let flexion = self.forward.atan2(self.down);
        let flexion = if flexion < -FRAC_PI_2 { flexion + TAU } else { flexion };
        [flexion, self.outward.clamp(-1.0, 1.0).asin()]
    }

    /// From hanging \[rad\], 0 to π.
    pub(crate) fn elevation(self) -> f64 {
        self.forward.hypot(self.outward).atan2(self.down)
    }

    /// Returns true for an arm behind the trunk's frontal plane.
    pub(crate) fn is_behind(self) -> bool {
        self.forward < -ON_PLANE
    }

    /// What a sheet calls flexion, extension being negative \[rad\]: the elevation.
    pub(crate) fn sheet_flexion(self) -> f64 {
        let elevation = self.elevation();
        let extended = self.is_behind() && elevation <= LARGEST_EXTENSION.to_radians();
        if extended { -elevation } else { elevation }
    }

    /// Out of the sagittal plane of the trunk \[rad\], outward positive.
    pub(crate) fn abduction(self) -> f64 {
        self.outward.clamp(-1.0, 1.0).asin()
    }
}
