//! The grasped object, and the hand of the person who works on it.

use nalgebra::Vector3;

use super::Controller;
use super::looking::SeenSurface;
use super::turning::HandTurn;
use crate::box_side::BoxSide;
use crate::error::Error;
use crate::grasped_object::GraspedObject;

/// Assumed speed of the person's hand when the hand tool changes \[m/s\], a slow reach.
const HAND_SPEED: f64 = 0.25;

/// The object that the robot holds for the person to work on, and how it is shown.
#[derive(Debug, Clone)]
pub(super) struct Workpiece {
    pub(super) object: Option<GraspedObject>,
    /// The side of the object that the person sees, or will see after a turn.
    pub(super) shown: BoxSide,
    pub(super) hand_turn: HandTurn,
    pub(super) seen_surface: SeenSurface,
}

impl Workpiece {
    /// Creates the state of a robot that holds nothing.
    pub(super) fn none() -> Self {
        Self {
            object: None,
            shown: BoxSide::Front,
            hand_turn: HandTurn::resting(Vector3::x_axis()),
            seen_surface: SeenSurface::default(),
        }
    }
}

impl Controller {
    /// Sets the object that the tool holds. Ergonomics and workspace then refer to the person's hand, which is behind
    /// their own tool. The object's mass counts. It is kept apart from people and from the robot, as the robot's bodies
    /// are.
    ///
    /// # Errors
    /// Those of [`GraspedObject::validate`]; the robot then keeps what it held before.
    pub fn grasp(&mut self, object: GraspedObject) -> Result<(), Error> {
        self.robot.attach(&object)?;
        let shown = object.faces.first().map_or(BoxSide::Front, |face| face.side);
        self.workpiece.hand_turn = HandTurn::resting(object.out_of(shown));
        // A robot without bodies keeps nothing apart.
        if !self.robot.bodies().is_empty() {
            let count = self.settings.safety.bodies.len() + 1;
            self.safety.attach(self.robot.bodies().get(..count).unwrap_or_default());
        }
        self.workpiece.object = Some(object);
        self.workpiece.seen_surface = SeenSurface::default();
        self.turn_to(shown)
    }

    /// Releases the grasped object and returns it.
    ///
    /// # Errors
    /// Never.
    pub fn release(&mut self) -> Result<Option<GraspedObject>, Error> {
        self.robot.detach()?;
        self.safety.detach();
        let upright = self.settings.space.tool;
        self.space.moving_mut().reorient(upright, &Vector3::z_axis())?;
        Ok(self.workpiece.object.take())
    }

    /// The grasped object.
    pub fn object(&self) -> Option<&GraspedObject> {
        self.workpiece.object.as_ref()
    }

    /// Moves the hand towards its place for the person's tool. The desired pose moves along, so that the robot need not
    /// move.
    pub(super) fn advance_hand(&mut self, elapsed: f64) -> Result<(), Error> {
        let elapsed = elapsed.max(0.0);
        let tool = self.space.situation().intention.tool();
        // The hand stays in place while the object turns below it.
        let turn =
            self.workpiece.hand_turn.advance(self.settings.desired.angular_velocity * elapsed);
        let goal = match &self.workpiece.object {
            Some(object) => {
                if let Some(turn) = turn {
                    let middle = object.tool_from_object.translation.vector;
                    let hand = middle + turn * (self.robot.tool_from_hand() - middle);
                    self.robot.set_hand(hand)?;
                }
                object
                    .towards(&self.workpiece.hand_turn.direction, self.settings.hand.distance(tool))
            }
            None => Vector3::zeros(),
        };
        let way = goal - self.robot.tool_from_hand();
        if way == Vector3::zeros() {
            return Ok(());
        }
        let step = way.cap_magnitude(HAND_SPEED * elapsed);
        self.robot.set_hand(self.robot.tool_from_hand() + step)?;
        let desired = &mut self.command.desired;
        desired.translation.vector += desired.rotation * step;
        Ok(())
    }
}
