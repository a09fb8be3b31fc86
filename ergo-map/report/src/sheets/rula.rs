//! Columns of the table for RULA: those of REBA, so that one table serves both, and RULA's own.

use ergo_map::{Error, LoadPattern, RulaWorksheet};

use super::column::{Cell, Column};
use super::sheet::Sheet;

impl Sheet for RulaWorksheet {
    type Error = Error;

    const COLUMNS: &'static [Column<Self>] = &[
        Column::needed("trunk_flex_deg", Cell::Angle, |s, x| s.trunk_flexion = x),
        Column::needed("neck_flex_deg", Cell::Angle, |s, x| s.neck_flexion = x),
        Column::needed("upper_arm_flex_deg", Cell::Angle, |s, x| s.upper_arm_flexion = x),
        Column::needed("lower_arm_flex_deg", Cell::Angle, |s, x| s.elbow_flexion = x),
        Column::needed("wrist_flex_deg", Cell::Angle, |s, x| s.wrist_flexion = x),
        Column::optional("load_kg", Cell::Load, |s, x| s.load = x),
        Column::flag("shoulder_raised", |s, x| s.shoulder_raised = x > 0.0),
        Column::flag("arm_supported", |s, x| s.arm_supported = x > 0.0),
        Column::flag("static", held),
        Column::flag("repeated", held),
        Column::flag("shock", |s, x| {
            if x > 0.0 {
                s.load_pattern = LoadPattern::Shock;
            }
        }),
        // RULA's sheet has two boxes where REBA's has one.
        Column::flag("trunk_twist", |s, x| s.trunk_twisted |= x > 0.0),
        Column::flag("trunk_side", |s, x| s.trunk_bent = x > 0.0),
        Column::flag("neck_twist", |s, x| s.neck_twisted |= x > 0.0),
        Column::flag("neck_side", |s, x| s.neck_bent = x > 0.0),
        Column::flag("arm_abducted", |s, x| s.arm_abducted |= x > 0.0),
        Column::flag("arm_across_or_out", |s, x| s.arm_across_or_out = x > 0.0),
        Column::flag("wrist_dev", |s, x| s.wrist_deviated |= x > 0.0),
        Column::flag("wrist_twist", |s, x| s.wrist_twisted = x > 0.0),
        Column::flag("legs_unsupported", |s, x| s.legs_unsupported |= x > 0.0),
        // A column of REBA that stands for two boxes sets the first one.
        Column::flag("trunk_twist_or_side", |s, x| s.trunk_twisted |= x > 0.0),
        Column::flag("neck_twist_or_side", |s, x| s.neck_twisted |= x > 0.0),
        Column::flag("arm_abducted_or_rotated", |s, x| s.arm_abducted |= x > 0.0),
        Column::flag("wrist_dev_or_twist", |s, x| s.wrist_deviated |= x > 0.0),
        Column::flag("unilateral", |s, x| s.legs_unsupported |= x > 0.0),
        // RULA's sheet does not ask for these.
        Column::optional("knee_flex_deg", Cell::Angle, |_, _| ()),
        Column::optional(
            "coupling",
            Cell::Choice(&["good", "fair", "poor", "unacceptable"]),
            |_, _| (),
        ),
        Column::flag("rapid_or_unstable", |_, _| ()),
        Column::flag("sitting", |_, _| ()),
    ];

    const SCORES: &'static [&'static str] = &[
        "s_upper_arm",
        "s_lower_arm",
        "s_wrist",
        "s_wrist_twist",
        "s_neck",
        "s_trunk",
        "s_legs",
        "table_a",
        "score_a",
        "table_b",
        "score_b",
        "rula",
        "action_level",
    ];

    fn scores(&self) -> Result<Vec<String>, Error> {
        let rula = self.score()?;
        let parts = rula.sub_scores;
        let whole = [
            parts.upper_arm,
            parts.lower_arm,
            parts.wrist,
            parts.wrist_twist,
            parts.neck,
            parts.trunk,
            parts.legs,
            rula.table_a,
            rula.score_a,
            rula.table_b,
            rula.score_b,
            rula.rula,
            rula.action_level.number(),
        ];
        Ok(whole.map(|score| score.to_string()).into())
    }
}

/// Sets muscle use, and a static load unless the load has shock, for a posture that is held or
/// repeated.
fn held(sheet: &mut RulaWorksheet, ticked: f64) {
    if ticked > 0.0 {
        sheet.muscle_use = true;
        if sheet.load_pattern == LoadPattern::Intermittent {
            sheet.load_pattern = LoadPattern::StaticOrRepeated;
        }
    }
}
