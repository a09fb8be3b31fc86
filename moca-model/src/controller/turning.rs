//! Turns of the object to the side that the person's tool is for.

use std::f64::consts::{PI, TAU};

use nalgebra::{Unit, UnitQuaternion, Vector3};
use vision_models::Intention;

use super::Controller;
use crate::box_side::BoxSide;
use crate::error::Error;
use crate::interaction::{Conditions, Phase, advance};

/// Distance of the desired pose from the shared workspace up to which it counts as within \[m or rad\].
const WITHIN: f64 = 1e-3;

/// Angle between the reference of orientations and its goal up to which it counts as reached \[rad\].
const THERE: f64 = 0.02;

/// Share of the largest component above which two joints count as equally near to the axis of a turn.
const NEARLY: f64 = 0.9;

/// Difference of two turns from which on the shorter one is preferred \[rad\].
const SHORTER: f64 = 0.04;

/// The path of the hand around an object that turns below it, in the tool's axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HandTurn {
    /// Direction from the middle of the object to the hand.
    pub(super) direction: Unit<Vector3<f64>>,
    axis: Unit<Vector3<f64>>,
    /// Remaining turn \[rad\].
    left: f64,
}

impl HandTurn {
    /// Creates a hand at rest.
    pub(super) fn resting(direction: Unit<Vector3<f64>>) -> Self {
        Self { direction, axis: Vector3::z_axis(), left: 0.0 }
    }

    /// Whether a turn remains.
    pub(super) fn is_turning(&self) -> bool {
        self.left > 0.0
    }

    /// Advances by at most `step` \[rad\] and returns the rotation, if there was one.
    pub(super) fn advance(&mut self, step: f64) -> Option<UnitQuaternion<f64>> {
        let step = step.min(self.left);
        if step <= 0.0 {
            return None;
        }
        self.left -= step;
        let rotation = UnitQuaternion::from_axis_angle(&self.axis, step);
        self.direction = Unit::new_normalize(rotation * *self.direction);
        Some(rotation)
    }
}

impl Controller {
    /// The side of the object that the person sees, or will see after a turn.
    pub fn shown(&self) -> BoxSide {
        self.workpiece.shown
    }

    /// Goes on to the next phase if its condition holds, and starts its actions.
    pub(super) fn interact(&mut self, time: f64) -> Result<(), Error> {
        let situation = self.space.situation();
        let intention = if situation.is_shared { situation.intention } else { Intention::Apart };
        let mismatch = self.workpiece.object.as_ref().and_then(|object| {
            let needed = intention.tool()?.surface();
            let shown = object.surface_of(self.workpiece.shown)?;
            let side = object.side_with(needed).filter(|_| needed != shown)?;
            Some((shown, needed, side))
        });
        let conditions = Conditions {
            time,
            intention,
            grasps: self.workpiece.object.is_some(),
            mismatch,
            arrived: self.has_arrived(),
            sight: self.sight(),
        };
        let transition = advance(&mut self.command.phase, &conditions);
        match transition.map(|transition| (transition.from, transition.to)) {
            Some((_, Phase::Turning { to })) => self.turn_to(to)?,
            Some((Phase::Looking, _)) => self.turn_to(self.workpiece.shown)?,
            _ => {}
        }
        self.command.transition = transition;
        Ok(())
    }

    /// Whether the workspace has its place and orientation, and the desired pose is within it.
    fn has_arrived(&self) -> bool {
        let workspace = self.space.workspace();
        let goal = self.space.moving().reference_goal();
        self.space.situation().is_in_place
            && workspace.reference().angle_to(&goal) <= THERE
            && self.workpiece.hand_turn.left == 0.0
            && workspace.violation(&self.command.desired).amax() <= WITHIN
    }

    /// Turns the object so that it shows this side.
    pub(super) fn turn_to(&mut self, side: BoxSide) -> Result<(), Error> {
        let Some(object) = &self.workpiece.object else { return Ok(()) };
        let goal = self.settings.space.tool * object.turn_to_show(side);
        let (out, now) = (object.out_of(side), self.workpiece.hand_turn.direction);
        let way = self.space.workspace().reference().inverse() * goal;
        self.workpiece.shown = side;
        let Some((axis, angle)) = way.axis_angle() else { return Ok(()) };
        // Two ways have the same length for the workspace only at about half a turn.
        let other = angle > PI - 1e-3 && !self.goes_about(&axis);
        let axis = if other { -axis } else { axis };
        self.space.moving_mut().reorient(goal, &axis)?;
        // Seen from the tool, the person goes around the object in the opposite direction.
        self.workpiece.hand_turn.axis = -axis;
        let (flat, end) = (out.cross(&axis), now.cross(&axis));
        // The angle from the hand's present place to its goal about that axis, in [0, 2π).
        let angle = flat.cross(&end).dot(&axis).atan2(flat.dot(&end));
        let angle = angle.rem_euclid(TAU);
        // Rounding must not turn zero into a whole turn.
        self.workpiece.hand_turn.left = if angle > TAU - 1e-6 { 0.0 } else { angle };
        Ok(())
    }

    /// Whether a half turn goes about this axis, in the tool's axes, and not about the opposite one. It goes the
    /// shorter way for the desired pose, if the nearest joint about that axis has room or a joint without limits can
    /// help. Otherwise it goes the way with more room for that joint.
    fn goes_about(&self, axis: &Unit<Vector3<f64>>) -> bool {
        let rooms = self.rooms_about(axis);
        let done = self.turned_about(axis);
        let room = if done > 0.0 { rooms.about } else { rooms.against };
        let can_be_gone = rooms.is_free || room >= PI - done.abs();
        if 2.0 * done.abs() > SHORTER && can_be_gone {
            done > 0.0
        } else {
            rooms.about >= rooms.against
        }
    }

    /// The angle of the desired pose about an axis, in the tool's axes, from the middle of the allowed orientations
    /// \[rad\].
    fn turned_about(&self, axis: &Unit<Vector3<f64>>) -> f64 {
        let workspace = self.space.workspace();
        let middle = workspace.world_from_workspace().rotation * workspace.reference();
        (middle.inverse() * self.command.desired.rotation).scaled_axis().dot(axis)
    }

    /// The room of the joints to turn the tool about an axis, in its own axes.
    fn rooms_about(&self, axis: &Unit<Vector3<f64>>) -> Rooms {
        let axis = self.robot.world_from_tool().rotation * **axis;
        let jacobian = self.robot.jacobian();
        let along = |joint: usize| jacobian.fixed_view::<3, 1>(3, joint).dot(&axis);
        let limits = self.robot.model().limits();
        let is_bounded = |joint: &usize| {
            limits.get(*joint).is_some_and(|limit| (limit.upper - limit.lower).is_finite())
        };
        let bounded = || (0..self.motion.reference.len()).filter(is_bounded);
        let most = bounded().map(|joint| along(joint).abs()).fold(0.0, f64::max);
        let mut others = (0..self.motion.reference.len()).filter(|joint| !is_bounded(joint));
        let is_free = others.any(|joint| along(joint).abs() > NEARLY * most);
        let nearest = bounded().rev().find(|joint| along(*joint).abs() >= NEARLY * most);
        let nearest = nearest.and_then(|joint| {
            let (limit, q) = (limits.get(joint)?, self.motion.reference.get(joint)?);
            let (above, below) = (limit.upper - q, q - limit.lower);
            Some(if along(joint) >= 0.0 { (above, below) } else { (below, above) })
        });
        let (about, against) = nearest.unwrap_or_default();
        Rooms { about, against, is_free }
    }
}

/// The room of the joints to turn the tool.
#[derive(Debug, Clone, Copy)]
struct Rooms {
    /// Room about the axis, of the nearest joint with limits \[rad\].
    about: f64,
    /// Room in the opposite direction \[rad\].
    against: f64,
    /// Whether a joint without limits also turns the tool about the axis.
    is_free: bool,
}
