//! The filter from recognised actions to intentions.

use moca_model::{Intention, IntentionFilter};
use proptest::prelude::*;
use vision_models::{Action, Confidence, RecognisedAction, Tool};

fn action(action: Action, confidence: f64) -> RecognisedAction {
    RecognisedAction { action, confidence: Confidence::new(confidence).unwrap() }
}

fn filter() -> IntentionFilter {
    IntentionFilter::new()
}

proptest! {
    #[test]
    fn flicker_within_dwell_time_changes_nothing(
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

    /// A recogniser confuses two hand tools for a moment as the person begins to work.
    #[test]
    fn work_begins_with_the_tool_seen_long_enough(frames in 1_u32..8, confused in 1_u32..4) {
        let mut filter = filter();
        let drill = action(Action::Using(Tool::Drill), 0.9);
        let polisher = action(Action::Using(Tool::Polisher), 0.7);
        for frame in 0..20 {
            let is_confused = (frames..frames + confused).contains(&frame);
            let seen = if is_confused { &polisher } else { &drill };
            filter.update(0.05 * f64::from(frame), Some(seen));
            prop_assert_ne!(filter.intention().tool(), Some(Tool::Polisher));
        }
        prop_assert_eq!(filter.intention().tool(), Some(Tool::Drill));
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
