//! Filter from recognised actions to the person's intention.

use vision_models::{Intention, RecognisedAction};

use crate::error::{Error, check_not_negative, check_settings};

/// Confidence with which an action confirms the present intention, if it is less than what begins one \[-\]. A recogniser
/// that hesitates does not end it.
const CONFIRMS: f64 = 0.4;

/// Thresholds and times of the intention filter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct IntentionSettings {
    /// Least confidence with which an action may change the intention \[-\]. Default 0.6.
    pub enter: f64,
    /// Time for which a new intention must be seen before it replaces the present one \[s\]. Default 0.2.
    pub dwell: f64,
    /// Time for which the person must be seen apart before working together ends \[s\]. Default 0.6.
    pub release: f64,
}

impl Default for IntentionSettings {
    fn default() -> Self {
        Self { enter: 0.6, dwell: 0.2, release: 0.6 }
    }
}

impl IntentionSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        let enter = [("intention.enter", self.enter)];
        check_settings(enter, "between 0 and 1", |value| (0.0..=1.0).contains(&value))?;
        check_not_negative([("intention.dwell", self.dwell), ("intention.release", self.release)])
    }
}

/// Filters actions by confidence, hysteresis and dwell time.
///
/// ```
/// use moca_model::{IntentionFilter, IntentionSettings};
/// use vision_models::{Action, Confidence, RecognisedAction};
///
/// let mut filter = IntentionFilter::new(IntentionSettings::default())?;
/// let seen = RecognisedAction { action: Action::DeliverObject, confidence: Confidence::ONE };
/// for frame in 0..10 {
///     filter.update(0.05 * f64::from(frame), Some(&seen));
/// }
/// assert!(filter.intention().is_together());
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntentionFilter {
    settings: IntentionSettings,
    present: Intention,
    candidate: Intention,
    since: Option<f64>,
    /// Time from which on the candidate has had its tool \[s\].
    tool_since: f64,
}

impl IntentionFilter {
    /// Creates a filter whose first intention is apart.
    ///
    /// # Errors
    /// [`Error::Value`] for settings out of range.
    pub fn new(settings: IntentionSettings) -> Result<Self, Error> {
        settings.validate()?;
        let apart = Intention::Apart;
        Ok(Self { settings, present: apart, candidate: apart, since: None, tool_since: 0.0 })
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
            if confidence >= self.settings.enter.min(CONFIRMS) {
                self.since = None;
            }
            return;
        }
        if confidence < self.settings.enter {
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
        let wait = if ends { self.settings.release } else { self.settings.dwell };
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
