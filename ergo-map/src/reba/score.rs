use super::conditions::Conditions;
use super::table::{table_a, table_b, table_c};

/// The six sub-scores that enter tables A and B.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RebaSubScores {
    /// Neck, 1 to 3.
    pub neck: u8,
    /// Trunk, 1 to 5.
    pub trunk: u8,
    /// Legs, 1 to 4.
    pub legs: u8,
    /// Upper arm, 1 to 6.
    pub upper_arm: u8,
    /// Lower arm, 1 to 2.
    pub lower_arm: u8,
    /// Wrist, 1 to 3.
    pub wrist: u8,
}

/// Urgency of a change of the posture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ActionLevel {
    /// Level 0: negligible risk, REBA 1.
    None,
    /// Level 1: low risk, action may be necessary, REBA 2 to 3.
    MayBeNecessary,
    /// Level 2: medium risk, action necessary, REBA 4 to 7.
    Necessary,
    /// Level 3: high risk, action necessary soon, REBA 8 to 10.
    NecessarySoon,
    /// Level 4: very high risk, action necessary now, REBA 11 to 15.
    NecessaryNow,
}

impl ActionLevel {
    /// Returns the level of a REBA score.
    pub const fn of(reba: u8) -> Self {
        match reba {
            0..=1 => Self::None,
            2..=3 => Self::MayBeNecessary,
            4..=7 => Self::Necessary,
            8..=10 => Self::NecessarySoon,
            _ => Self::NecessaryNow,
        }
    }

    /// Returns the level as printed: 0 to 4.
    pub const fn number(self) -> u8 {
        match self {
            Self::None => 0,
            Self::MayBeNecessary => 1,
            Self::Necessary => 2,
            Self::NecessarySoon => 3,
            Self::NecessaryNow => 4,
        }
    }
}

/// A REBA score with all its intermediate results (Applied Ergonomics 31, 2000).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Reba {
    /// The sub-scores.
    pub sub_scores: RebaSubScores,
    /// Table A at neck, trunk and legs.
    pub table_a: u8,
    /// Table A plus load and shock.
    pub score_a: u8,
    /// Table B at upper arm, lower arm and wrist.
    pub table_b: u8,
    /// Table B plus coupling.
    pub score_b: u8,
    /// Table C at scores A and B.
    pub score_c: u8,
    /// The score, 1 to 15: score C plus activity.
    pub reba: u8,
    /// The level of action of the score.
    pub action_level: ActionLevel,
}

impl Reba {
    /// Computes the score of sub-scores and conditions. Sub-scores beyond a table's last row count
    /// as its last row. The conditions' posture-related fields (support, shoulder, arm) are not
    /// used, since the sub-scores include them.
    pub fn new(sub_scores: RebaSubScores, conditions: &Conditions) -> Self {
        let RebaSubScores { neck, trunk, legs, upper_arm, lower_arm, wrist } = sub_scores;
        let table_a = table_a([neck, trunk, legs]);
        let score_a = table_a + conditions.load_score();
        let table_b = table_b([upper_arm, lower_arm, wrist]);
        let score_b = table_b + conditions.coupling.score();
        let score_c = table_c([score_a, score_b]);
        let reba = score_c + conditions.activity_score();
        let action_level = ActionLevel::of(reba);
        Self { sub_scores, table_a, score_a, table_b, score_b, score_c, reba, action_level }
    }
}
