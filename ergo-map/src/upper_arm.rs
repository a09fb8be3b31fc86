//! The direction of the upper arm in the trunk's axes.

use core::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Vector3;

/// Largest elevation behind the trunk that counts as extension \[°\]. The shoulder extends by 60°
/// (AAOS). An arm that is higher has come over the head.
pub(crate) const LARGEST_EXTENSION: f64 = 70.0;

/// A direction closer to the trunk's frontal plane than this is in it, since a converted angle may
/// be off by an ulp.
const ON_PLANE: f64 = 1e-9;

/// A unit vector along the upper arm, from the shoulder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UpperArm {
    pub(crate) forward: f64,
    /// Away from the body's midplane.
    pub(crate) outward: f64,
    /// Along the trunk.
    pub(crate) down: f64,
}

impl UpperArm {
    /// Creates the direction of an arm that is flexed, and then abducted out of the sagittal plane
    /// \[rad\].
    pub(crate) fn of_angles(flexion: f64, abduction: f64) -> Self {
        Self {
            forward: flexion.sin() * abduction.cos(),
            outward: abduction.sin(),
            down: flexion.cos() * abduction.cos(),
        }
    }

    /// Creates the direction from a vector of forward, outward and down. `None` if it has no
    /// direction.
    pub(crate) fn of_vector(vector: &Vector3<f64>) -> Option<Self> {
        let unit = vector.try_normalize(1e-9)?;
        let known = unit.iter().all(|value| value.is_finite());
        known.then_some(Self { forward: unit.x, outward: unit.y, down: unit.z })
    }

    /// Returns the vector of forward, outward and down.
    pub(crate) fn to_vector(self) -> Vector3<f64> {
        Vector3::new(self.forward, self.outward, self.down)
    }

    /// Returns flexion in [-π/2, 3π/2) and abduction in [-π/2, π/2] \[rad\]. An arm that goes up in
    /// front of the trunk and on behind the head has a flexion above π.
    pub(crate) fn angles(self) -> [f64; 2] {
        let flexion = self.forward.atan2(self.down);
        let flexion = if flexion < -FRAC_PI_2 { flexion + TAU } else { flexion };
        [flexion, self.outward.clamp(-1.0, 1.0).asin()]
    }

    /// Returns the elevation from hanging \[rad\], 0 to π.
    pub(crate) fn elevation(self) -> f64 {
        self.forward.hypot(self.outward).atan2(self.down)
    }

    /// Returns true if the arm is behind the trunk's frontal plane.
    pub(crate) fn is_behind(self) -> bool {
        self.forward < -ON_PLANE
    }

    /// Returns the flexion in the sense of a sheet: the elevation, negative for extension \[rad\].
    pub(crate) fn sheet_flexion(self) -> f64 {
        let elevation = self.elevation();
        let extended = self.is_behind() && elevation <= LARGEST_EXTENSION.to_radians();
        if extended { -elevation } else { elevation }
    }

    /// Returns the angle out of the sagittal plane of the trunk \[rad\], outward positive.
    pub(crate) fn abduction(self) -> f64 {
        self.outward.clamp(-1.0, 1.0).asin()
    }
}
