//! The three types of classes in HRI30.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Action;

/// The paper's three types of actions (Sec. "Action Recognition Model"). The paper does not say
/// which type each class has. This crate decides that.
///
/// ```
/// use vision_models::{Action, ActionGroup};
///
/// assert_eq!(Action::Walking.group(), ActionGroup::BodyMotion);
/// assert_eq!(Action::DeliverObject.group(), ActionGroup::Collaboration);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ActionGroup {
    /// Human-object perception: takes, puts down or holds a tool or the object, standing.
    HumanObject,
    /// Body-motion only: walks without working.
    BodyMotion,
    /// Human-robot collaboration: works with the robot ([`Action::is_collaborative`]).
    Collaboration,
}

impl ActionGroup {
    /// The three types in the paper's order.
    pub const ALL: [Self; 3] = [Self::HumanObject, Self::BodyMotion, Self::Collaboration];

    /// Returns the paper's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::HumanObject => "Human-Object Perception",
            Self::BodyMotion => "Body-Motion Only",
            Self::Collaboration => "Human-Robot Collaboration",
        }
    }
}

impl fmt::Display for ActionGroup {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl Action {
    /// Returns the type of the action.
    pub fn group(self) -> ActionGroup {
        match self {
            Self::Walking | Self::WalkingWith(_) | Self::WalkingWithObject => {
                ActionGroup::BodyMotion
            }
            Self::NoCollaborative(_) | Self::PickUp(_) | Self::PickUpObject | Self::PutDown(_) => {
                ActionGroup::HumanObject
            }
            Self::DeliverObject | Self::Using(_) | Self::MoveWhileUsing(..) => {
                ActionGroup::Collaboration
            }
        }
    }
}
