use super::tables::{TABLE_A, TABLE_B, TABLE_C};

/// The seven sub-scores that enter tables A and B.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RulaSubScores {
    /// Upper arm, 1 to 6.
    pub upper_arm: u8,
    /// Lower arm, 1 to 3.
    pub lower_arm: u8,
    /// Wrist, 1 to 4.
    pub wrist: u8,
    /// Wrist twist, 1 to 2.
    pub wrist_twist: u8,
    /// Neck, 1 to 6.
    pub neck: u8,
    /// Trunk, 1 to 6.
    pub trunk: u8,
    /// Legs, 1 to 2.
    pub legs: u8,
}

/// Urgency of a change of the posture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RulaActionLevel {
    /// Level 1: acceptable, score 1 to 2.
    Acceptable,
    /// Level 2: investigate further, score 3 to 4.
    Investigate,
    /// Level 3: investigate and change soon, score 5 to 6.
    ChangeSoon,
    /// Level 4: investigate and change at once, score 7.
    ChangeNow,
}

impl RulaActionLevel {
    /// Returns the level of a RULA score.
    pub const fn of(rula: u8) -> Self {
        match rula {
            0..=2 => Self::Acceptable,
            3..=4 => Self::Investigate,
            5..=6 => Self::ChangeSoon,
            _ => Self::ChangeNow,
        }
    }

    /// Returns the level as printed: 1 to 4.
    pub const fn number(self) -> u8 {
        match self {
            Self::Acceptable => 1,
            Self::Investigate => 2,
            Self::ChangeSoon => 3,
            Self::ChangeNow => 4,
        }
    }
}

/// A RULA score with all its intermediate results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Rula {
    /// The sub-scores.
    pub sub_scores: RulaSubScores,
    /// Table A at upper arm, lower arm, wrist and wrist twist.
    pub table_a: u8,
    /// Table A plus muscle use and load.
    pub score_a: u8,
    /// Table B at neck, trunk and legs.
    pub table_b: u8,
    /// Table B plus muscle use and load.
    pub score_b: u8,
    /// The score, 1 to 7: table C at scores A and B.
    pub rula: u8,
    /// The level of action of the score.
    pub action_level: RulaActionLevel,
}

impl Rula {
    /// Computes the score of sub-scores, muscle use (0 or 1) and load (0 to 3). Muscle use and load
    /// count both for arm and wrist and for neck, trunk and legs. Indices beyond a table's last row
    /// count as its last row.
    pub fn new(sub_scores: RulaSubScores, muscle_use: u8, load: u8) -> Self {
        let RulaSubScores { upper_arm, lower_arm, wrist, wrist_twist, neck, trunk, legs } =
            sub_scores;
        let table_a = cell(&TABLE_A, upper_arm)
            .and_then(|table| cell(table, lower_arm))
            .and_then(|table| cell(table, wrist))
            .and_then(|table| cell(table, wrist_twist));
        let table_b = cell(&TABLE_B, neck)
            .and_then(|table| cell(table, trunk))
            .and_then(|table| cell(table, legs));
        let table_a = table_a.copied().unwrap_or(0);
        let table_b = table_b.copied().unwrap_or(0);
        let extra = muscle_use.saturating_add(load);
        let (score_a, score_b) = (table_a.saturating_add(extra), table_b.saturating_add(extra));
        let rula = cell(&TABLE_C, score_a).and_then(|table| cell(table, score_b));
        let rula = rula.copied().unwrap_or(0);
        let action_level = RulaActionLevel::of(rula);
        Self { sub_scores, table_a, score_a, table_b, score_b, rula, action_level }
    }
}

/// Returns an entry of a table. Indices count from 1 and are clamped to the table.
fn cell<T, const N: usize>(table: &[T; N], index: u8) -> Option<&T> {
    table.get(usize::from(index).clamp(1, N) - 1)
}
