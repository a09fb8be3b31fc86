//! The intention of a person towards the robot.

use super::{Action, Tool, WalkingDirection};

/// The intention of a person towards the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intention {
    /// Activity apart from the robot.
    #[default]
    Apart,
    /// Work with the robot on the object that it holds, standing or walking.
    Together {
        /// The direction in which the person walks, in the person's frame. None if the person
        /// stands.
        walking: Option<WalkingDirection>,
        /// The person's tool. None if the hands are empty.
        tool: Option<Tool>,
    },
}

impl Intention {
    /// Returns true if robot and person work together.
    pub fn is_together(self) -> bool {
        matches!(self, Self::Together { .. })
    }

    /// Returns the direction in which the person walks while working with the robot.
    pub fn walking(self) -> Option<WalkingDirection> {
        match self {
            Self::Together { walking, .. } => walking,
            Self::Apart => None,
        }
    }

    /// Returns the same intention without a tool, to compare intentions regardless of the tool.
    #[must_use]
    pub fn regardless_of_tool(self) -> Self {
        match self {
            Self::Together { walking, .. } => Self::Together { walking, tool: None },
            Self::Apart => Self::Apart,
        }
    }

    /// Returns the tool that the person uses on the object.
    pub fn tool(self) -> Option<Tool> {
        match self {
            Self::Together { tool, .. } => tool,
            Self::Apart => None,
        }
    }
}

/// The intention of a person who does this action.
impl From<Action> for Intention {
    fn from(action: Action) -> Self {
        if action.is_collaborative() {
            Self::Together { walking: action.walking_direction(), tool: action.tool() }
        } else {
            Self::Apart
        }
    }
}
