//! RULA.

use std::collections::BTreeMap;

use ergo_map::LoadPattern;
use pyo3::prelude::*;

use super::keywords::{keyword_class, word};
use super::posture::Posture;
use crate::failure::Result;

keyword_class!(
    /// A filled-in RULA sheet (McAtamney and Corlett, Applied Ergonomics 24, 1993): the measured angles [rad, flexion
    /// positive] and the ticked boxes. All are keywords; the defaults are those of an easy task.
    RulaWorksheet {
        /// Flexion of the upper arm.
        upper_arm_flexion: f64 = 0.0,
        /// The shoulder is raised.
        shoulder_raised: bool = false,
        /// The upper arm is abducted.
        arm_abducted: bool = false,
        /// The arm is supported, or the person leans.
        arm_supported: bool = false,
        /// Flexion of the elbow.
        elbow_flexion: f64 = 0.0,
        /// The arm works across the body's middle or out to the side.
        arm_across_or_out: bool = false,
        /// Flexion of the wrist.
        wrist_flexion: f64 = 0.0,
        /// The wrist is bent away from its middle line.
        wrist_deviated: bool = false,
        /// The forearm is twisted to near the end of its range.
        wrist_twisted: bool = false,
        /// Flexion of the neck.
        neck_flexion: f64 = 0.0,
        /// The neck is twisted.
        neck_twisted: bool = false,
        /// The neck is bent sideways.
        neck_bent: bool = false,
        /// Inclination of the trunk from the vertical.
        trunk_flexion: f64 = 0.0,
        /// The trunk is twisted.
        trunk_twisted: bool = false,
        /// The trunk is bent sideways.
        trunk_bent: bool = false,
        /// Legs and feet are not well supported, or out of balance.
        legs_unsupported: bool = false,
        /// The posture is mainly static, or repeats more than four times a minute.
        muscle_use: bool = false,
        /// Load or force [kg].
        load: f64 = 0.0,
        /// Action of the load: "intermittent", "static" (held or repeated) or "shock".
        load_pattern: String = { String::from("intermittent") },
    }
);

#[pymethods]
impl RulaWorksheet {
    /// The score with every sub-score. Raises `Error` for an invalid angle or load.
    fn score(&self) -> Result<Rula> {
        let sheet = ergo_map::RulaWorksheet {
            upper_arm_flexion: self.upper_arm_flexion,
            shoulder_raised: self.shoulder_raised,
            arm_abducted: self.arm_abducted,
            arm_supported: self.arm_supported,
            elbow_flexion: self.elbow_flexion,
            arm_across_or_out: self.arm_across_or_out,
            wrist_flexion: self.wrist_flexion,
            wrist_deviated: self.wrist_deviated,
            wrist_twisted: self.wrist_twisted,
            neck_flexion: self.neck_flexion,
            neck_twisted: self.neck_twisted,
            neck_bent: self.neck_bent,
            trunk_flexion: self.trunk_flexion,
            trunk_twisted: self.trunk_twisted,
            trunk_bent: self.trunk_bent,
            legs_unsupported: self.legs_unsupported,
            muscle_use: self.muscle_use,
            load: self.load,
            load_pattern: word("load_pattern", &self.load_pattern, &PATTERNS)?,
        };
        Ok(Rula(sheet.score()?))
    }
}

const PATTERNS: [(&str, LoadPattern); 3] = [
    ("intermittent", LoadPattern::Intermittent),
    ("static", LoadPattern::StaticOrRepeated),
    ("shock", LoadPattern::Shock),
];

/// A RULA score with all its sub-scores and table values.
#[pyclass(frozen, module = "ahqp.ergo")]
pub(crate) struct Rula(ergo_map::Rula);

#[pymethods]
impl Rula {
    /// The score of a posture with legs supported, no muscle use and no load.
    #[staticmethod]
    fn of_posture(posture: &Posture) -> Result<Self> {
        Ok(Self(ergo_map::RulaWorksheet::from_posture(&posture.inner()?).score()?))
    }

    /// The score, 1 (good) to 7.
    #[getter]
    fn score(&self) -> u8 {
        self.0.rula
    }

    /// The action level: 1 (acceptable) to 4 (change at once).
    #[getter]
    fn action_level(&self) -> u8 {
        self.0.action_level.number()
    }

    /// Sub-scores and tables by their names: upper_arm, lower_arm, wrist, wrist_twist, neck, trunk,
    /// legs, table_a, score_a, table_b, score_b.
    #[getter]
    fn parts(&self) -> BTreeMap<&'static str, u8> {
        let (rula, parts) = (&self.0, &self.0.sub_scores);
        BTreeMap::from([
            ("upper_arm", parts.upper_arm),
            ("lower_arm", parts.lower_arm),
            ("wrist", parts.wrist),
            ("wrist_twist", parts.wrist_twist),
            ("neck", parts.neck),
            ("trunk", parts.trunk),
            ("legs", parts.legs),
            ("table_a", rula.table_a),
            ("score_a", rula.score_a),
            ("table_b", rula.table_b),
            ("score_b", rula.score_b),
        ])
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.ergo.Rula: {}, action level {}>", self.0.rula, self.0.action_level.number())
    }
}
