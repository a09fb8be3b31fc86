//! The trunk of a person whose joints were measured.

use core::f64::consts::FRAC_1_SQRT_2;

use nalgebra::Vector3;

use super::{JointPositions, between, unit};

/// The trunk: its axes and its inclination.
pub(super) struct Trunk {
    pub(super) forward: Vector3<f64>,
    left: Vector3<f64>,
    pub(super) up: Vector3<f64>,
    /// Inclination, forward positive \[rad\].
    pub(super) flexion: f64,
    pub(super) side: f64,
    /// Angle from the line of the hips to that of the shoulders about the trunk's axis, to the left
    /// positive \[rad\].
    pub(super) twist: Option<f64>,
}

impl Trunk {
    pub(super) fn of(joints: &JointPositions) -> Option<Self> {
        let pelvis = joints.pelvis.or_else(|| between(&joints.hips))?;
        let neck = joints.neck.or_else(|| between(&joints.shoulders))?;
        let up = unit(&(neck - pelvis))?;
        let pair = |[left, right]: [Option<Vector3<f64>>; 2]| Some(left? - right?);
        let (shoulders, hips) = (pair(joints.shoulders), pair(joints.hips));
        let across = |line: &Vector3<f64>| unit(&(line - up * line.dot(&up)));
        let left = across(&shoulders.or(hips)?)?;
        let forward = left.cross(&up);
        // The inclination of a twisted trunk is in the common direction of hips and shoulders.
        let lines = shoulders.unwrap_or_default() + hips.unwrap_or_default();
        let level = unit(&Vector3::new(lines.x, lines.y, 0.0))?;
        let ahead = level.cross(&Vector3::z());
        let twist = shoulders.zip(hips).and_then(|(_, hips)| {
            let hips = across(&hips)?;
            Some(hips.cross(&left).dot(&up).atan2(hips.dot(&left)))
        });
        Some(Self {
            forward,
            left,
            up,
            flexion: inclination(up.dot(&ahead), up.dot(&level), up.z),
            side: up.dot(&level).clamp(-1.0, 1.0).asin(),
            twist,
        })
    }

    /// Returns a direction in the trunk's axes: x forward, y left, z along the trunk.
    pub(super) fn local(&self, line: &Vector3<f64>) -> Option<Vector3<f64>> {
        let line = unit(line)?;
        Some(Vector3::new(line.dot(&self.forward), line.dot(&self.left), line.dot(&self.up)))
    }
}

/// Returns the inclination of a trunk with these components. Nobody stands inclined sideways by
/// more than 45°. Beyond that the lateral component counts too, so that a trunk lying on its side
/// is inclined by 90°.
fn inclination(ahead: f64, aside: f64, up: f64) -> f64 {
    let lying = (aside.abs() - FRAC_1_SQRT_2).max(0.0);
    ahead.hypot(lying).atan2(up).copysign(ahead)
}
