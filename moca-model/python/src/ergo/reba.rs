//! REBA.

use std::collections::BTreeMap;

use ergo_map::{Conditions, Coupling, LegSupport};
use pyo3::prelude::*;

use super::keywords::{keyword_class, word};
use super::posture::Posture;
use crate::failure::Result;

keyword_class!(
    /// A filled-in REBA sheet (Hignett and McAtamney, Applied Ergonomics 31, 2000): the measured angles [rad, flexion
    /// positive] and the ticked boxes. All are keywords; the defaults are those of an easy task.
    Worksheet {
        /// Inclination of the trunk from the vertical.
        trunk_flexion: f64 = 0.0,
        /// The trunk is twisted or bent sideways.
        trunk_twisted_or_bent: bool = false,
        /// Flexion of the neck.
        neck_flexion: f64 = 0.0,
        /// The neck is twisted or bent sideways.
        neck_twisted_or_bent: bool = false,
        /// Flexion of the knees.
        knee_flexion: f64 = 0.0,
        /// Flexion of the upper arm.
        upper_arm_flexion: f64 = 0.0,
        /// The upper arm is abducted or rotated.
        arm_abducted_or_rotated: bool = false,
        /// Flexion of the elbow.
        elbow_flexion: f64 = 0.0,
        /// Flexion of the wrist.
        wrist_flexion: f64 = 0.0,
        /// The wrist is deviated or twisted.
        wrist_deviated_or_twisted: bool = false,
        /// Load or force [kg].
        load: f64 = 0.0,
        /// The load is applied with shock or builds up rapidly.
        shock: bool = false,
        /// Quality of the grip: "good", "fair", "poor" or "unacceptable".
        coupling: String = { String::from("good") },
        /// Support of the body: "bilateral", "walking", "unilateral" or "sitting".
        support: String = { String::from("bilateral") },
        /// The shoulder is raised.
        shoulder_raised: bool = false,
        /// The arm is supported, or gravity assists it.
        arm_supported: bool = false,
        /// A body part is held still for more than a minute.
        held_static: bool = false,
        /// Small-range actions repeat more than four times a minute.
        repeated: bool = false,
        /// Rapid large changes of posture, or an unstable base.
        rapid_or_unstable: bool = false,
    }
);

#[pymethods]
impl Worksheet {
    /// The integer score with every sub-score. Raises `Error` for an invalid angle or load.
    fn score(&self) -> Result<Reba> {
        Ok(Reba(self.inner()?.score()?))
    }
}

impl Worksheet {
    fn inner(&self) -> Result<ergo_map::Worksheet> {
        Ok(ergo_map::Worksheet {
            trunk_flexion: self.trunk_flexion,
            trunk_twisted_or_bent: self.trunk_twisted_or_bent,
            neck_flexion: self.neck_flexion,
            neck_twisted_or_bent: self.neck_twisted_or_bent,
            knee_flexion: self.knee_flexion,
            upper_arm_flexion: self.upper_arm_flexion,
            arm_abducted_or_rotated: self.arm_abducted_or_rotated,
            elbow_flexion: self.elbow_flexion,
            wrist_flexion: self.wrist_flexion,
            wrist_deviated_or_twisted: self.wrist_deviated_or_twisted,
            conditions: Conditions {
                load: self.load,
                shock: self.shock,
                coupling: word("coupling", &self.coupling, &COUPLINGS)?,
                support: word("support", &self.support, &SUPPORTS)?,
                shoulder_raised: self.shoulder_raised,
                arm_supported: self.arm_supported,
                held_static: self.held_static,
                repeated: self.repeated,
                rapid_or_unstable: self.rapid_or_unstable,
            },
        })
    }
}

const COUPLINGS: [(&str, Coupling); 4] = [
    ("good", Coupling::Good),
    ("fair", Coupling::Fair),
    ("poor", Coupling::Poor),
    ("unacceptable", Coupling::Unacceptable),
];

const SUPPORTS: [(&str, LegSupport); 4] = [
    ("bilateral", LegSupport::Bilateral),
    ("walking", LegSupport::Walking),
    ("unilateral", LegSupport::Unilateral),
    ("sitting", LegSupport::Sitting),
];

/// A REBA score with all its sub-scores and table values.
#[pyclass(frozen, module = "ahqp.ergo")]
pub(crate) struct Reba(ergo_map::Reba);

#[pymethods]
impl Reba {
    /// The score of a posture in an easy task: no load, good coupling, nothing held or repeated.
    #[staticmethod]
    fn of_posture(posture: &Posture) -> Result<Self> {
        let sheet = ergo_map::Worksheet::from_posture(&posture.inner()?, Conditions::default());
        Ok(Self(sheet.score()?))
    }

    /// The score, 1 (good) to 15.
    #[getter]
    fn score(&self) -> u8 {
        self.0.reba
    }

    /// The action level: 0 (nothing) to 4 (action now).
    #[getter]
    fn action_level(&self) -> u8 {
        self.0.action_level.number()
    }

    /// Sub-scores and tables by their names: neck, trunk, legs, upper_arm, lower_arm, wrist, table_a,
    /// score_a, table_b, score_b, score_c.
    #[getter]
    fn parts(&self) -> BTreeMap<&'static str, u8> {
        let (reba, parts) = (&self.0, &self.0.sub_scores);
        BTreeMap::from([
            ("neck", parts.neck),
            ("trunk", parts.trunk),
            ("legs", parts.legs),
            ("upper_arm", parts.upper_arm),
            ("lower_arm", parts.lower_arm),
            ("wrist", parts.wrist),
            ("table_a", reba.table_a),
            ("score_a", reba.score_a),
            ("table_b", reba.table_b),
            ("score_b", reba.score_b),
            ("score_c", reba.score_c),
        ])
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.ergo.Reba: {}, action level {}>", self.0.reba, self.0.action_level.number())
    }
}
