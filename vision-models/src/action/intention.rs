//! What somebody wants of the robot.

use super::{Action, Tool, WalkingDirection};

/// What the person wants of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intention {
    /// Nothing: they do something else.
    #[default]
    Apart,
    /// To work on the object that the robot holds, standing, or walking with it.
    Together {
        /// Where they are walking, in their own frame; none when they stand.
        walking: Option<WalkingDirection>,
        /// What they work with; none with bare hands.
        tool: Option<Tool>,
    },
}

impl Intention {
    /// Whether robot and person work together.
    pub fn is_together(self) -> bool {
        matches!(self, Self::Together { .. })
    }

    /// Where the person is walking while they work with the robot.
    pub fn walking(self) -> Option<WalkingDirection> {
        match self {
            Self::Together { walking, .. } => walking,
            Self::Apart => None,
        }
    }

    /// The same with bare hands, to compare what people want whatever they work with.
    #[must_use]
    pub fn regardless_of_tool(self) -> Self {
        match self {
            Self::Together { walking, .. } => Self::Together { walking, tool: None },
            Self::Apart => Self::Apart,
        }
    }

    /// What the person works with on what the robot holds.
    pub fn tool(self) -> Option<Tool> {
        match self {
            Self::Together { tool, .. } => tool,
            Self::Apart => None,
        }
    }
}

/// What somebody wants who does this.
impl From<Action> for Intention {
    fn from(action: Action) -> Self {
        if action.is_collaborative() {
            Self::Together { walking: action.walking_direction(), tool: action.tool() }
        } else {
            Self::Apart
        }
    }
}
