//! Postures and the paper's score.

use ergo_map::Conditions;
use pyo3::prelude::*;

use super::keywords::{keyword_class, mode};
use crate::failure::Result;

keyword_class!(
    /// The angles that REBA and RULA use [rad], as keywords. The default 0.0 is upright standing with hanging arms.
    /// Flexion is positive; side bends and twists count by magnitude.
    Posture {
        /// Inclination of the trunk from the vertical, forward positive.
        trunk_flexion: f64 = 0.0,
        /// Side bend of the trunk.
        trunk_side: f64 = 0.0,
        /// Twist of the trunk about its long axis.
        trunk_twist: f64 = 0.0,
        /// Flexion of the neck, forward positive.
        neck_flexion: f64 = 0.0,
        /// Side bend of the neck.
        neck_side: f64 = 0.0,
        /// Rotation of the head about the neck's long axis.
        neck_twist: f64 = 0.0,
        /// Flexion of the knees.
        knee_flexion: f64 = 0.0,
        /// Flexion of the upper arm in the sagittal plane of the trunk, forward positive.
        upper_arm_flexion: f64 = 0.0,
        /// Angle of the upper arm out of the sagittal plane of the trunk, outward positive.
        upper_arm_abduction: f64 = 0.0,
        /// Rotation of the upper arm about its long axis.
        upper_arm_rotation: f64 = 0.0,
        /// Flexion of the elbow.
        elbow_flexion: f64 = 0.0,
        /// Flexion of the wrist, extension negative.
        wrist_flexion: f64 = 0.0,
        /// Radial or ulnar deviation of the wrist.
        wrist_deviation: f64 = 0.0,
        /// Pronation or supination of the forearm from its middle.
        wrist_twist: f64 = 0.0,
    }
);

impl From<ergo_map::Posture> for Posture {
    fn from(posture: ergo_map::Posture) -> Self {
        let ergo_map::Posture {
            trunk_flexion,
            trunk_side,
            trunk_twist,
            neck_flexion,
            neck_side,
            neck_twist,
            knee_flexion,
            upper_arm_flexion,
            upper_arm_abduction,
            upper_arm_rotation,
            elbow_flexion,
            wrist_flexion,
            wrist_deviation,
            wrist_twist,
        } = posture;
        Self {
            trunk_flexion,
            trunk_side,
            trunk_twist,
            neck_flexion,
            neck_side,
            neck_twist,
            knee_flexion,
            upper_arm_flexion,
            upper_arm_abduction,
            upper_arm_rotation,
            elbow_flexion,
            wrist_flexion,
            wrist_deviation,
            wrist_twist,
        }
    }
}

impl Posture {
    /// Checks the angles and returns the posture.
    pub(crate) fn inner(&self) -> Result<ergo_map::Posture> {
        let posture = ergo_map::Posture {
            trunk_flexion: self.trunk_flexion,
            trunk_side: self.trunk_side,
            trunk_twist: self.trunk_twist,
            neck_flexion: self.neck_flexion,
            neck_side: self.neck_side,
            neck_twist: self.neck_twist,
            knee_flexion: self.knee_flexion,
            upper_arm_flexion: self.upper_arm_flexion,
            upper_arm_abduction: self.upper_arm_abduction,
            upper_arm_rotation: self.upper_arm_rotation,
            elbow_flexion: self.elbow_flexion,
            wrist_flexion: self.wrist_flexion,
            wrist_deviation: self.wrist_deviation,
            wrist_twist: self.wrist_twist,
        };
        posture.validate()?;
        Ok(posture)
    }
}

/// The paper's score e_s of a posture, from 0 (good) to 4.25: the mean of the contributions of arms, trunk, legs and
/// neck. `mode` is "graded", piecewise linear, or "faithful", close to the printed classes.
#[pyfunction]
#[pyo3(signature = (posture, *, mode="graded"))]
pub(crate) fn ergonomics_score(posture: &Posture, mode: &str) -> Result<f64> {
    let mode = self::mode(mode)?;
    Ok(ergo_map::ergonomics_score(&posture.inner()?, &Conditions::default(), mode))
}
