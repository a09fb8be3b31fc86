//! Filter from recognised actions to the person's intention.

use vision_models::{Intention, RecognisedAction};

/// Least confidence with which an action may change the intention \[-\]: recognised rather than guessed.
pub(crate) const ENTER: f64 = 0.6;
/// Time for which a new intention must be seen before it replaces the present one \[s\]: longer than a few wrong frames,
/// shorter than people wait for an answer.
pub(crate) const DWELL: f64 = 0.2;
/// Time for which the person must be seen apart before working together ends \[s\]: longer than [`DWELL`], since hands
/// that rest for a moment have not finished.
const RELEASE: f64 = 0.6;
/// Confidence with which an action confirms the present intention \[-\]. A recogniser that hesitates does not end it.
const CONFIRMS: f64 = 0.4;

/// Filters actions by confidence, hysteresis and dwell time.
///
/// ```
/// use moca_model::IntentionFilter;
/// use vision_models::{Action, Confidence, RecognisedAction};
///
/// let mut filter = IntentionFilter::new();
/// let seen = RecognisedAction { action: Action::DeliverObject, confidence: Confidence::ONE };
/// for frame in 0..10 {
///     filter.update(0.05 * f64::from(frame), Some(&seen));
/// }
/// assert!(filter.intention().is_together());
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct IntentionFilter {
    present: Intention,
    candidate: Intention,
    since: Option<f64>,
    /// Time from which on the candidate has had its tool \[s\].
    tool_since: f64,
}

impl IntentionFilter {
    /// Creates a filter whose first intention is apart.
    pub fn new() -> Self {
        Self::default()
    }

    /// The person's intention.
    pub fn intention(&self) -> Intention {
        self.present
    }

    /// Resets the intention to apart.
    pub fn forget(&mut self) {
        (self.present, self.candidate) = (Intention::Apart, Intention::Apart);
        self.since = None;
    }

    /// Takes the action recognised in the frame at `time` \[s\], if there is one.
    pub fn update(&mut self, time: f64, action: Option<&RecognisedAction>) {
        let Some(action) = action else { return };
        let seen = Intention::from(action.action);
        let confidence = action.confidence.value();
        if seen == self.present {
            if confidence >= CONFIRMS {
                self.since = None;
            }
            return;
        }
        if confidence < ENTER {
            return;
        }
        // A change of walking direction or tool does not reset the evidence that work has begun.
        let begins = seen.is_together() && !self.present.is_together();
        let since = match self.since {
            Some(since) if seen == self.candidate => since,
            Some(since) if begins && self.candidate.is_together() => since,
            _ => time,
        };
        if self.since.is_none() || seen.tool() != self.candidate.tool() {
            self.tool_since = time;
        }
        self.candidate = seen;
        self.since = Some(since);
        let ends = self.present.is_together() && !seen.is_together();
        let wait = if ends { RELEASE } else { DWELL };
        if time - since >= wait {
            // The object turns for a tool, which must therefore itself be seen for the time.
            self.present = match seen {
                Intention::Together { walking, .. } if time - self.tool_since < wait => {
                    Intention::Together { walking, tool: None }
                }
                _ => seen,
            };
            self.since = None;
        }
    }
}
