//! The actions that the recogniser distinguishes.

mod direction;
mod group;
mod intention;
mod tool;

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

pub use direction::WalkingDirection;
pub use group::ActionGroup;
pub use intention::Intention;
pub use tool::Tool;

use crate::error::Error;

/// Action of a person: a class of the HRI30 data set (Iodice, De Momi, Ajoudani, ICPR 2022), which
/// has thirty.
///
/// ```
/// use vision_models::{Action, Tool, WalkingDirection};
///
/// let action = Action::from_name("Move Backwards While Drilling")?;
/// assert_eq!(action.walking_direction(), Some(WalkingDirection::Backwards));
/// assert_eq!(action.tool(), Some(Tool::Drill));
/// assert!(action.is_collaborative());
/// assert_eq!(Action::ALL.len(), 30);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum Action {
    /// Hands the object over to the robot.
    DeliverObject,
    /// Walks while working on the object. The person leads the robot in this way.
    MoveWhileUsing(WalkingDirection, Tool),
    /// Holds a tool and does not work with the robot.
    NoCollaborative(Tool),
    /// Takes a tool from the table.
    PickUp(Tool),
    /// Takes the object from the table.
    PickUpObject,
    /// Puts a tool down.
    PutDown(Tool),
    /// Stands and works on the object that the robot holds.
    Using(Tool),
    /// Walks with empty hands.
    Walking,
    /// Walks with a tool in the hand.
    WalkingWith(Tool),
    /// Walks with the object in the hands.
    WalkingWithObject,
}

/// Returns the error for a name that no action has.
pub(crate) fn unknown(name: &str) -> Error {
    let wanted = "one of the thirty HRI30 class names exactly as they are written, such as \
                  \"Using The Drill\"";
    Error::unknown("action", name, wanted)
}

impl Action {
    /// The thirty classes in the alphabetical order of their names. A network's label file may have
    /// another order.
    pub const ALL: [Self; 30] = {
        use Tool::{Drill, Polisher};
        use WalkingDirection::{
            Backwards, BackwardsLeft, BackwardsRight, Forwards, ForwardsLeft, ForwardsRight, Left,
            Right,
        };
        [
            Self::DeliverObject,
            Self::MoveWhileUsing(Backwards, Drill),
            Self::MoveWhileUsing(Backwards, Polisher),
            Self::MoveWhileUsing(BackwardsLeft, Drill),
            Self::MoveWhileUsing(BackwardsLeft, Polisher),
            Self::MoveWhileUsing(BackwardsRight, Drill),
            Self::MoveWhileUsing(BackwardsRight, Polisher),
            Self::MoveWhileUsing(ForwardsLeft, Drill),
            Self::MoveWhileUsing(ForwardsLeft, Polisher),
            Self::MoveWhileUsing(ForwardsRight, Drill),
            Self::MoveWhileUsing(ForwardsRight, Polisher),
            Self::MoveWhileUsing(Forwards, Drill),
            Self::MoveWhileUsing(Forwards, Polisher),
            Self::MoveWhileUsing(Left, Drill),
            Self::MoveWhileUsing(Left, Polisher),
            Self::MoveWhileUsing(Right, Drill),
            Self::MoveWhileUsing(Right, Polisher),
            Self::NoCollaborative(Drill),
            Self::NoCollaborative(Polisher),
            Self::PickUp(Drill),
            Self::PickUp(Polisher),
            Self::PickUpObject,
            Self::PutDown(Drill),
            Self::PutDown(Polisher),
            Self::Using(Drill),
            Self::Using(Polisher),
            Self::Walking,
            Self::WalkingWith(Drill),
            Self::WalkingWithObject,
            Self::WalkingWith(Polisher),
        ]
    };

    /// Returns the class's name in HRI30.
    pub fn name(self) -> &'static str {
        use Tool::{Drill, Polisher};
        match self {
            Self::DeliverObject => "Deliver Object",
            Self::MoveWhileUsing(direction, Drill) => direction.name_while_drilling(),
            Self::MoveWhileUsing(direction, Polisher) => direction.name_while_polishing(),
            Self::NoCollaborative(Drill) => "No Collaborative With Drill",
            Self::NoCollaborative(Polisher) => "No Collaborative With Polisher",
            Self::PickUp(Drill) => "Pick Up Drill",
            Self::PickUp(Polisher) => "Pick Up Polisher",
            Self::PickUpObject => "Pick Up The Object",
            Self::PutDown(Drill) => "Put Down Drill",
            Self::PutDown(Polisher) => "Put Down Polisher",
            Self::Using(Drill) => "Using The Drill",
            Self::Using(Polisher) => "Using The Polisher",
            Self::Walking => "Walking",
            Self::WalkingWith(Drill) => "Walking With Drill",
            Self::WalkingWith(Polisher) => "Walking With Polisher",
            Self::WalkingWithObject => "Walking With Object",
        }
    }

    /// Returns the class with this name.
    ///
    /// # Errors
    /// [`Error::Name`] if no class has exactly this name.
    pub fn from_name(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|action| action.name() == name).ok_or_else(|| unknown(name))
    }

    /// Returns the class that a label of a copy of HRI30 names. The words may be joined in any way,
    /// in any case, with or without a plural s (`MoveDiagonallyBackwardLeftWithDrill`,
    /// `move_backwards_while_drilling`).
    ///
    /// ```
    /// use vision_models::Action;
    ///
    /// let action = Action::from_label("MoveDiagonallyBackwardLeftWithDrill")?;
    /// assert_eq!(action.name(), "Move Diagonally Backwards Left With Drill");
    /// # Ok::<(), vision_models::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Name`] if the label names no class.
    pub fn from_label(label: &str) -> Result<Self, Error> {
        let letters = |name: &str| -> String {
            let letters = name.chars().filter(|letter| letter.is_alphanumeric());
            letters.flat_map(char::to_lowercase).filter(|letter| *letter != 's').collect()
        };
        let own = letters(label);
        Self::ALL
            .into_iter()
            .find(|action| letters(action.name()) == own)
            .ok_or_else(|| unknown(label))
    }

    /// Returns the direction in which the person walks while working, in the person's frame. `None`
    /// for every other action: plain walking has no direction in HRI30 and does not lead the robot.
    pub fn walking_direction(self) -> Option<WalkingDirection> {
        match self {
            Self::MoveWhileUsing(direction, _) => Some(direction),
            _ => None,
        }
    }

    /// Returns the action with left and right exchanged. Only walking while working changes.
    ///
    /// ```
    /// use vision_models::Action;
    ///
    /// let left = Action::from_name("Move Left While Drilling")?;
    /// assert_eq!(left.mirrored().name(), "Move Right While Drilling");
    /// assert_eq!(Action::Walking.mirrored(), Action::Walking);
    /// # Ok::<(), vision_models::Error>(())
    /// ```
    #[must_use]
    pub fn mirrored(self) -> Self {
        match self {
            Self::MoveWhileUsing(direction, tool) => {
                Self::MoveWhileUsing(direction.mirrored(), tool)
            }
            other => other,
        }
    }

    /// Returns the tool that belongs to the action.
    pub fn tool(self) -> Option<Tool> {
        match self {
            Self::MoveWhileUsing(_, tool)
            | Self::NoCollaborative(tool)
            | Self::PickUp(tool)
            | Self::PutDown(tool)
            | Self::Using(tool)
            | Self::WalkingWith(tool) => Some(tool),
            Self::DeliverObject | Self::PickUpObject | Self::Walking | Self::WalkingWithObject => {
                None
            }
        }
    }

    /// Returns true if the person works with the robot: delivers the object to it, or uses a tool
    /// on the object, standing or walking.
    ///
    /// Paper, Experiment 3: the person becomes collaborative by straightening the arm towards the
    /// robot. Carrying a tool, taking it or putting it down is therefore not collaborative.
    pub fn is_collaborative(self) -> bool {
        matches!(self, Self::DeliverObject | Self::Using(_) | Self::MoveWhileUsing(..))
    }
}

impl fmt::Display for Action {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Action {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::from_name(name)
    }
}

impl TryFrom<String> for Action {
    type Error = Error;

    fn try_from(name: String) -> Result<Self, Error> {
        Self::from_name(&name)
    }
}

impl From<Action> for &'static str {
    fn from(action: Action) -> Self {
        action.name()
    }
}
