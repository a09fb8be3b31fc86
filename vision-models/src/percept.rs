//! The recognition results of one camera frame.

use serde::{Deserialize, Serialize};

use crate::action::Action;
use crate::body::Body;
use crate::confidence::Confidence;
use crate::surface::Surface;

/// Recognition results of one camera frame. `None` means not seen.
///
/// ```
/// use vision_models::{Action, Confidence, Percept, RecognisedAction, Tool};
///
/// let percept = Percept {
///     time: 1.25,
///     body: None,
///     action: Some(RecognisedAction {
///         action: Action::Using(Tool::Drill),
///         confidence: Confidence::new(0.93)?,
///     }),
///     surface: None,
/// };
/// assert!(percept.action.is_some_and(|seen| seen.action.is_collaborative()));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Percept {
    /// Time at which the camera took the frame (s).
    pub time: f64,
    /// The person, in the world frame.
    pub body: Option<Body>,
    /// The person's action.
    pub action: Option<RecognisedAction>,
    /// The surface of the object that faces the on-board camera.
    pub surface: Option<RecognisedSurface>,
}

/// The most probable of the thirty actions.
///
/// ```
/// use vision_models::{Action, Confidence, RecognisedAction};
///
/// let seen = RecognisedAction { action: Action::Walking, confidence: Confidence::ONE };
/// assert!(!seen.action.is_collaborative());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecognisedAction {
    /// The class.
    pub action: Action,
    /// The class's probability.
    pub confidence: Confidence,
}

/// The more probable of the two surfaces.
///
/// ```
/// use vision_models::{Confidence, RecognisedSurface, Surface, Tool};
///
/// let seen = RecognisedSurface { surface: Surface::Smooth, confidence: Confidence::ONE };
/// assert_eq!(seen.surface.tool(), Tool::Polisher);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecognisedSurface {
    /// The class.
    pub surface: Surface,
    /// The class's probability.
    pub confidence: Confidence,
}
