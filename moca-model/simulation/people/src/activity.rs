//! Activities of a person.

use nalgebra::Vector2;
use vision_models::{Action, Tool, WalkingDirection};

use super::motion::Hands;

/// Speed below which the person stands \[m/s\].
const STANDING_SPEED: f64 = 0.08;

/// The activity of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Activity {
    /// Carries the object.
    CarryObject,
    /// Holds the object out to the robot.
    DeliverObject,
    /// Takes the tool from a table.
    PickUp(Tool),
    /// Holds the tool close.
    HoldTool(Tool),
    /// Works with the tool on the object.
    Use(Tool),
    /// Lays the tool on a table.
    PutDown(Tool),
    /// Walks or stands with empty hands.
    Walk,
}

impl Activity {
    /// The HRI30 class of this activity, for the velocity in the person's frame \[m/s\].
    pub(super) fn action(self, velocity: Vector2<f64>) -> Action {
        let direction =
            WalkingDirection::nearest(velocity).filter(|_| velocity.norm() > STANDING_SPEED);
        match (self, direction) {
            (Self::CarryObject, _) => Action::WalkingWithObject,
            (Self::DeliverObject, _) => Action::DeliverObject,
            (Self::PickUp(tool), _) => Action::PickUp(tool),
            (Self::HoldTool(tool), _) => Action::NoCollaborative(tool),
            (Self::Use(tool), Some(direction)) => Action::MoveWhileUsing(direction, tool),
            (Self::Use(tool), None) => Action::Using(tool),
            (Self::PutDown(tool), _) => Action::PutDown(tool),
            (Self::Walk, _) => Action::Walking,
        }
    }

    pub(super) fn hands(self) -> Hands {
        match self {
            Self::CarryObject => Hands::Carrying,
            Self::DeliverObject => Hands::Reaching,
            Self::PickUp(_) | Self::PutDown(_) => Hands::AtTable,
            Self::HoldTool(_) => Hands::Holding,
            Self::Use(_) => Hands::Working,
            Self::Walk => Hands::Swinging,
        }
    }
}
