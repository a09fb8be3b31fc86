//! The person's ergonomics, and their share in the third level.

use ergo_map::{ErgonomicsQuadratic, PersonFrame};
use hrsw::Workspace;
use nalgebra::Vector3;

/// Time in which ergonomics fade in and out as person and robot begin and stop to work together \[s\].
pub(super) const ACTIVATES_OVER: f64 = 0.5;
/// Times in which ergonomics fade out while separation is at its limit, and return afterwards \[s\].
const HELD_WITHIN: f64 = 0.02;
const BACK_WITHIN: f64 = 20.0;
/// Time in which ergonomics return while the workspace moves, or the tool is away from its best place \[s\].
const FOLLOWS_WITHIN: f64 = 0.5;
/// Largest gain of e_s from moving the tool to its best place at which it counts as near.
const AT_PLACE: f64 = 0.35;

/// The person's ergonomics e_s in their own frame, and their share in the third level.
#[derive(Debug, Clone)]
pub(super) struct ErgonomicGoal {
    pub(super) ergonomics: ErgonomicsQuadratic,
    pub(super) share: GoalShare,
}

impl ErgonomicGoal {
    /// Creates a goal that has no share yet.
    pub(super) fn new(ergonomics: ErgonomicsQuadratic) -> Self {
        Self { ergonomics, share: GoalShare::NONE }
    }

    /// What e_s would fall by if the tool, now at `tool`, were at the point of the workspace nearest to its minimum.
    /// `None` if it has not a single minimum. While the workspace changes its shape, the final one counts.
    pub(super) fn gain_at_best_place(
        &self,
        person: &PersonFrame,
        workspace: &Workspace,
        tool: &Vector3<f64>,
    ) -> Option<f64> {
        let best = person.to_world(&self.ergonomics.minimiser()?);
        let world_from_workspace = workspace.world_from_workspace();
        let best = world_from_workspace.inverse_transform_point(&best.into());
        let best = workspace.position_shape().nearest(&best.coords);
        let best = world_from_workspace.transform_point(&best.into()).coords;
        let [now, best] =
            [*tool, best].map(|place| self.ergonomics.value(&person.to_person(&place)));
        Some(now - best)
    }
}

/// The share of ergonomics, from 0 to 1.
///
/// It rises when person and robot begin to work together. The best place of the tool may be nearer to the person than
/// separation allows. That limit changes with every camera frame, and a tool that pushes against it never rests. So
/// ergonomics are switched off at the limit while the workspace rests with the tool near its best place, and return
/// slowly.
#[derive(Debug, Clone, Copy)]
pub(super) struct GoalShare {
    together: f64,
    free: f64,
    /// Whether separation was at its limit in the last tick.
    pub(super) at_limit: bool,
}

impl GoalShare {
    /// The share while nobody works with the robot.
    pub(super) const NONE: Self = Self { together: 0.0, free: 1.0, at_limit: false };

    /// Advances the share by `elapsed` \[s\] and returns it. Ergonomics are wanted or not, and come and go in
    /// `activation_time` \[s\]. The workspace rests or not, and e_s may fall by `gain`, if it has a minimum.
    pub(super) fn advance(
        &mut self,
        wanted: bool,
        rests: bool,
        gain: Option<f64>,
        elapsed: f64,
        activation_time: f64,
    ) -> f64 {
        let step = elapsed / activation_time;
        self.together = (self.together + if wanted { step } else { -step }).clamp(0.0, 1.0);
        let rests = rests && gain.is_none_or(|gain| gain <= AT_PLACE);
        let rate = match (rests, self.at_limit) {
            (false, _) => 1.0 / FOLLOWS_WITHIN,
            (true, true) => -1.0 / HELD_WITHIN,
            (true, false) => 1.0 / BACK_WITHIN,
        };
        self.free = (self.free + elapsed * rate).clamp(0.0, 1.0);
        self.together * self.free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 1e-3;

    /// The share after so many milliseconds of these conditions.
    fn after(share: &mut GoalShare, ticks: u32, rests: bool, gain: f64, at_limit: bool) -> f64 {
        share.at_limit = at_limit;
        (0..ticks).fold(0.0, |_, _| share.advance(true, rests, Some(gain), PERIOD, 0.5))
    }

    #[test]
    fn ergonomics_without_a_minimum_fade_at_limit() {
        let mut share = GoalShare::NONE;
        after(&mut share, 500, false, 0.1, true);
        assert!((0..21).fold(1.0, |_, _| share.advance(true, true, None, PERIOD, 0.5)) <= 0.0);
    }

    #[test]
    fn ergonomics_fade_at_limit_while_workspace_rests() {
        let mut share = GoalShare::NONE;
        let halfway = after(&mut share, 250, false, 0.1, true);
        assert!((halfway - 0.5).abs() < 1e-9, "halfway after 0.25 s");
        let moving = after(&mut share, 300, false, 0.1, true);
        assert!(moving >= 1.0, "a workspace that moves has no limit");
        assert!(after(&mut share, 101, true, 1.0, true) >= 1.0, "far away there is none");
        assert!(after(&mut share, 21, true, 0.1, true) <= 0.0, "held within 0.02 s");
        assert!((after(&mut share, 10_000, true, 0.1, false) - 0.5).abs() < 0.01, "back over 20 s");
        assert!(after(&mut share, 260, false, 0.1, false) >= 1.0, "and at once where it moves");
    }
}
