//! How much of the third level is ergonomics.

/// How soon ergonomics are held where separation is at its limit, and how soon they come back \[s\].
const HELD_WITHIN: f64 = 0.1;
const BACK_WITHIN: f64 = 3.0;
/// The same where the workspace moves \[s\].
const FOLLOWS_WITHIN: f64 = 0.5;

/// The share of ergonomics, from 0 to 1.
///
/// It rises when person and robot begin to work together. The best place of the tool may be nearer to the person than
/// separation allows, and that limit changes with every camera frame. A tool that pushes against it never rests.
/// So ergonomics are held there while the workspace rests, and come back slowly.
#[derive(Debug, Clone, Copy)]
pub(super) struct GoalShare {
    together: f64,
    free: f64,
}

/// What a tick knows of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GoalConditions {
    /// Whether ergonomics are wanted at all.
    pub(super) wanted: bool,
    /// Whether the workspace rests.
    pub(super) rests: bool,
    /// Whether separation was at its limit.
    pub(super) at_limit: bool,
}

impl GoalShare {
    /// None.
    pub(super) const NONE: Self = Self { together: 0.0, free: 1.0 };

    /// Goes on by a time \[s\]; `activation_time` is that in which ergonomics come and go \[s\]. Returns the share.
    pub(super) fn advance(
        &mut self,
        conditions: GoalConditions,
        elapsed: f64,
        activation_time: f64,
    ) -> f64 {
        let GoalConditions { wanted, rests, at_limit } = conditions;
        let step = elapsed / activation_time;
        self.together = (self.together + if wanted { step } else { -step }).clamp(0.0, 1.0);
        let rate = match (rests, at_limit) {
            (false, _) => 1.0 / FOLLOWS_WITHIN,
            (true, true) => -1.0 / HELD_WITHIN,
            (true, false) => 1.0 / BACK_WITHIN,
        };
        self.free = (self.free + elapsed * rate).clamp(0.0, 1.0);
        self.together * self.free
    }
}
