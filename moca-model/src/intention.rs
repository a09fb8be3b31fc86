//! From recognised actions to what the person wants.

use vision_models::{Action, RecognisedAction, Tool, WalkingDirection};

use crate::error::Error;

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

/// When an action counts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct IntentionSettings {
    /// Confidence from which on an action may change the intention \[-\]. Default 0.6.
    pub enter: f64,
    /// Confidence down to which an action still confirms the present intention \[-\]. Default 0.4.
    pub keep: f64,
    /// How long a new intention must be seen before it replaces the present one \[s\].
    /// Default 0.2.
    pub dwell: f64,
    /// How long the person must be seen apart before working together ends \[s\]. Default 0.6.
    pub release: f64,
}

impl Default for IntentionSettings {
    fn default() -> Self {
        Self { enter: 0.6, keep: 0.4, dwell: 0.2, release: 0.6 }
    }
}

impl IntentionSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Setting`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        for (name, value) in [("intention.enter", self.enter), ("intention.keep", self.keep)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::Setting { name, value, expected: "between 0 and 1" });
            }
        }
        if self.keep > self.enter {
            let expected = "at most intention.enter";
            return Err(Error::Setting { name: "intention.keep", value: self.keep, expected });
        }
        for (name, value) in [("intention.dwell", self.dwell), ("intention.release", self.release)]
        {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "finite and not negative" });
            }
        }
        Ok(())
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
}

impl IntentionFilter {
    /// A filter that starts apart.
    ///
    /// # Errors
    /// [`Error::Setting`] for settings out of range.
    pub fn new(settings: IntentionSettings) -> Result<Self, Error> {
        settings.validate()?;
        let apart = Intention::Apart;
        Ok(Self { settings, present: apart, candidate: apart, since: None })
    }

    /// What the person wants.
    pub fn intention(&self) -> Intention {
        self.present
    }

    /// Apart again, as at the start.
    pub fn forget(&mut self) {
        (self.present, self.candidate) = (Intention::Apart, Intention::Apart);
        self.since = None;
    }

    /// Takes the action recognised in the frame at `time` \[s\], if any.
    pub fn update(&mut self, time: f64, action: Option<&RecognisedAction>) {
        let Some(action) = action else { return };
        let seen = Intention::from(action.action);
        let confidence = action.confidence.value();
        if seen == self.present {
            if confidence >= self.settings.keep {
                self.since = None;
            }
            return;
        }
        if confidence < self.settings.enter {
            return;
        }
        // A change of walking direction does not undo the evidence that work has begun.
        let begins = seen.is_together() && !self.present.is_together();
        let since = match self.since {
            Some(since) if seen == self.candidate => since,
            Some(since) if begins && self.candidate.is_together() => since,
            _ => time,
        };
        self.candidate = seen;
        self.since = Some(since);
        let ends = self.present.is_together() && !seen.is_together();
        let wait = if ends { self.settings.release } else { self.settings.dwell };
        if time - since >= wait {
            self.present = seen;
            self.since = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vision_models::Confidence;

    fn action(action: Action, confidence: f64) -> RecognisedAction {
        RecognisedAction { action, confidence: Confidence::new(confidence).unwrap() }
    }

    fn filter() -> IntentionFilter {
        IntentionFilter::new(IntentionSettings::default()).unwrap()
    }

    proptest! {
        #[test]
        fn a_flicker_shorter_than_the_dwell_time_changes_nothing(
            index in 0_usize..30, frames in 1_u32..4,
        ) {
            let mut filter = filter();
            let work = action(Action::Using(Tool::Drill), 0.9);
            let mut time = 0.0;
            for _ in 0..20 { filter.update(time, Some(&work)); time += 0.05; }
            let before = filter.intention();
            for _ in 0..frames {
                filter.update(time, Some(&action(Action::ALL[index], 1.0)));
                time += 0.05;
            }
            prop_assert_eq!(filter.intention(), before);
        }

        #[test]
        fn what_is_seen_long_enough_is_believed(index in 0_usize..30, start in 0_usize..30) {
            let mut filter = filter();
            let mut time = 0.0;
            for shown in [start, index] {
                for _ in 0..20 {
                    filter.update(time, Some(&action(Action::ALL[shown], 0.8)));
                    time += 0.05;
                }
            }
            prop_assert_eq!(filter.intention(), Intention::from(Action::ALL[index]));
        }

        #[test]
        fn work_begins_whatever_the_walking_directions(
            shown in prop::collection::vec(0_usize..30, 12),
        ) {
            let mut filter = filter();
            let together: Vec<_> = Action::ALL.into_iter().filter(|a| a.is_collaborative()).collect();
            for (frame, index) in (0_u32..).zip(shown) {
                let seen = action(together[index % together.len()], 0.9);
                filter.update(0.05 * f64::from(frame), Some(&seen));
            }
            prop_assert!(filter.intention().is_together());
        }

        #[test]
        fn low_confidence_never_changes_the_intention(
            shown in prop::collection::vec((0_usize..30, 0.0..0.59_f64), 1..60),
        ) {
            let mut filter = filter();
            for (frame, (index, confidence)) in (0_u32..).zip(shown) {
                let seen = action(Action::ALL[index], confidence);
                filter.update(0.05 * f64::from(frame), Some(&seen));
            }
            prop_assert_eq!(filter.intention(), Intention::Apart);
        }
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let bad = [
            IntentionSettings { enter: f64::NAN, ..IntentionSettings::default() },
            IntentionSettings { keep: 0.9, ..IntentionSettings::default() },
            IntentionSettings { dwell: -1.0, ..IntentionSettings::default() },
        ];
        for settings in bad {
            let error = IntentionFilter::new(settings).unwrap_err();
            assert!(error.to_string().contains("intention."), "{error}");
        }
    }
}
