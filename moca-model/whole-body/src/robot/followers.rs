//! Limits of mimic joints, as limits of the joints that they follow.

use super::description::Description;
use super::joint::MimicJoint;
use super::limits::{JointLimits, MissingAcceleration};
use super::model::Model;
use super::warning::Warning;
use crate::limits::limit_kind::{End, LimitKind};

impl Model {
    /// Narrows the limits of a joint so that the mimic joint which follows it stays within its own limits.
    pub(super) fn limit_by_follower(&mut self, number: usize, own: &JointLimits, line: usize) {
        let Some(mimic) = self.mimics.get(number) else { return };
        let Some(joint) = self.joints.get(mimic.follows.index) else { return };
        let (entry, follows) = (joint.velocity_index, joint.name.clone());
        let MimicJoint { name, multiplier, offset, .. } = mimic.clone();
        if multiplier == 0.0 {
            return;
        }
        let (limits, sources) = (&mut self.limits[entry], &mut self.limit_sources[entry]);
        let mut warn = |limit| {
            let (joint, follows) = (name.clone(), follows.clone());
            self.warnings.push(Warning::FollowerLimit { joint, follows, limit });
        };
        let ends = [own.lower, own.upper].map(|end| (end - offset) / multiplier);
        let (lower, upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let is_below = |one: f64, other: f64| one < other - 1e-9 * other.abs().min(1e9);
        if limits.lower.max(lower) >= limits.upper.min(upper) {
            let warning = Warning::FollowerRange { joint: name, follows, line };
            self.warnings.push(warning);
            return;
        }
        let narrower = [is_below(limits.lower, lower), is_below(upper, limits.upper)];
        if narrower[0] {
            (limits.lower, sources.position[0]) = (lower, Some(number));
        }
        if narrower[1] {
            (limits.upper, sources.position[1]) = (upper, Some(number));
        }
        if narrower[0] || narrower[1] {
            warn("range of positions");
        }
        let ratio = multiplier.abs();
        for (limit, own, value, source) in [
            ("velocity", own.velocity, &mut limits.velocity, &mut sources.velocity),
            ("acceleration", own.acceleration, &mut limits.acceleration, &mut sources.acceleration),
            ("jerk", own.jerk, &mut limits.jerk, &mut sources.jerk),
        ] {
            if is_below(own / ratio, *value) {
                (*value, *source) = (own / ratio, Some(number));
                warn(limit);
            }
        }
    }

    /// Applies the description's default acceleration to the speeds that mimic joints allow: these are reached in its
    /// time.
    pub(super) fn limit_default_accelerations(&mut self, description: &Description) {
        let MissingAcceleration::TimeToFullSpeed(time) = description.missing_acceleration else {
            return;
        };
        for joint in self.default_accelerations.iter().filter_map(|id| self.joints.get(id.index)) {
            if let Some(limits) = self.limits.get_mut(joint.velocity_index) {
                limits.acceleration = limits.acceleration.min(limits.velocity / time);
            }
        }
    }

    /// The name of the mimic joint whose limit is in force for an entry of q̇, if there is one.
    pub(crate) fn limiting_follower(
        &self,
        entry: usize,
        kind: LimitKind,
        end: End,
    ) -> Option<&str> {
        let sources = self.limit_sources.get(entry)?;
        let number = match (kind, end) {
            (LimitKind::Position, End::Lower) => sources.position[0],
            (LimitKind::Position, End::Upper) => sources.position[1],
            (LimitKind::Velocity, _) => sources.velocity,
            (LimitKind::Acceleration, _) => sources.acceleration,
            (LimitKind::Jerk, _) => sources.jerk,
            (LimitKind::Caller, _) => None,
        };
        Some(&self.mimics.get(number?)?.name)
    }
}
