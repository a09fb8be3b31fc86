//! Columns of the table for REBA.

use ergo_map::{ContinuousReba, Coupling, Error, LegSupport, Mode, Worksheet};

use super::column::{Cell, Column};
use super::sheet::{Elsewhere, Sheet};

const COUPLINGS: [Coupling; 4] =
    [Coupling::Good, Coupling::Fair, Coupling::Poor, Coupling::Unacceptable];

/// Creates a box that only RULA's sheet has as a separate box.
const fn of_rula(name: &'static str, here: Option<&'static str>) -> Elsewhere {
    Elsewhere { name, sheet: "RULA", here }
}

impl Sheet for Worksheet {
    type Error = Error;

    const COLUMNS: &'static [Column<Self>] = &[
        Column::needed("trunk_flex_deg", Cell::Angle, |s, x| s.trunk_flexion = x),
        Column::needed("neck_flex_deg", Cell::Angle, |s, x| s.neck_flexion = x),
        Column::needed("knee_flex_deg", Cell::Angle, |s, x| s.knee_flexion = x),
        Column::needed("upper_arm_flex_deg", Cell::Angle, |s, x| s.upper_arm_flexion = x),
        Column::needed("lower_arm_flex_deg", Cell::Angle, |s, x| s.elbow_flexion = x),
        Column::needed("wrist_flex_deg", Cell::Angle, |s, x| s.wrist_flexion = x),
        Column::optional("load_kg", Cell::Load, |s, x| s.conditions.load = x),
        Column::optional(
            "coupling",
            Cell::Choice(&["good", "fair", "poor", "unacceptable"]),
            |s, x| {
                let named = COUPLINGS.into_iter().find(|known| f64::from(known.score()) == x);
                s.conditions.coupling = named.unwrap_or_default();
            },
        ),
        Column::flag("trunk_twist_or_side", |s, x| s.trunk_twisted_or_bent = x > 0.0),
        Column::flag("neck_twist_or_side", |s, x| s.neck_twisted_or_bent = x > 0.0),
        Column::flag("unilateral", |s, x| {
            if x > 0.0 && s.conditions.support == LegSupport::Bilateral {
                s.conditions.support = LegSupport::Unilateral;
            }
        }),
        // A seat supports the body, whatever the legs do.
        Column::flag("sitting", |s, x| {
            if x > 0.0 {
                s.conditions.support = LegSupport::Sitting;
            }
        }),
        Column::flag("arm_abducted_or_rotated", |s, x| s.arm_abducted_or_rotated = x > 0.0),
        Column::flag("shoulder_raised", |s, x| s.conditions.shoulder_raised = x > 0.0),
        Column::flag("arm_supported", |s, x| s.conditions.arm_supported = x > 0.0),
        Column::flag("wrist_dev_or_twist", |s, x| s.wrist_deviated_or_twisted = x > 0.0),
        Column::flag("shock", |s, x| s.conditions.shock = x > 0.0),
        Column::flag("static", |s, x| s.conditions.held_static = x > 0.0),
        Column::flag("repeated", |s, x| s.conditions.repeated = x > 0.0),
        Column::flag("rapid_or_unstable", |s, x| s.conditions.rapid_or_unstable = x > 0.0),
    ];

    const ELSEWHERE: &'static [Elsewhere] = &[
        of_rula("trunk_twist", Some("trunk_twist_or_side")),
        of_rula("trunk_side", Some("trunk_twist_or_side")),
        of_rula("neck_twist", Some("neck_twist_or_side")),
        of_rula("neck_side", Some("neck_twist_or_side")),
        of_rula("arm_abducted", Some("arm_abducted_or_rotated")),
        of_rula("arm_across_or_out", None),
        of_rula("wrist_dev", Some("wrist_dev_or_twist")),
        of_rula("wrist_twist", Some("wrist_dev_or_twist")),
        of_rula("legs_unsupported", Some("unilateral")),
    ];

    const SCORES: &'static [&'static str] = &[
        "s_neck",
        "s_trunk",
        "s_legs",
        "s_upper_arm",
        "s_lower_arm",
        "s_wrist",
        "table_a",
        "score_a",
        "table_b",
        "score_b",
        "score_c",
        "reba",
        "action_level",
        "reba_faithful",
        "e_s",
    ];

    fn scores(&self) -> Result<Vec<String>, Error> {
        let reba = self.score()?;
        let parts = reba.sub_scores;
        let faithful = ContinuousReba::of_worksheet(self, Mode::FAITHFUL)?.reba;
        let continuous = ContinuousReba::of_worksheet(self, Mode::Graded)?.contributions().mean();
        let whole = [
            parts.neck,
            parts.trunk,
            parts.legs,
            parts.upper_arm,
            parts.lower_arm,
            parts.wrist,
            reba.table_a,
            reba.score_a,
            reba.table_b,
            reba.score_b,
            reba.score_c,
            reba.reba,
            reba.action_level.number(),
        ];
        let whole = whole.map(|score| score.to_string()).into_iter();
        Ok(whole.chain([faithful.to_string(), continuous.to_string()]).collect())
    }
}
