//! Compares the thirty classes with the list in the HRI30 paper.

use std::collections::HashSet;

use nalgebra::{Rotation2, Vector2};
use vision_models::{Action, Confidence, Error, RecognisedAction, Surface, Tool, WalkingDirection};

/// Iodice, De Momi, Ajoudani: HRI30, ICPR 2022, in alphabetical order.
const NAMES: &str = "Deliver Object; Move Backwards While Drilling; Move Backwards While Polishing; \
    Move Diagonally Backwards Left With Drill; Move Diagonally Backwards Left With Polisher; \
    Move Diagonally Backwards Right With Drill; Move Diagonally Backwards Right With Polisher; \
    Move Diagonally Forwards Left With Drill; Move Diagonally Forwards Left With Polisher; \
    Move Diagonally Forwards Right With Drill; Move Diagonally Forwards Right With Polisher; \
    Move Forwards While Drilling; Move Forwards While Polishing; Move Left While Drilling; \
    Move Left While Polishing; Move Right While Drilling; Move Right While Polishing; \
    No Collaborative With Drill; No Collaborative With Polisher; Pick Up Drill; Pick Up Polisher; \
    Pick Up The Object; Put Down Drill; Put Down Polisher; Using The Drill; Using The Polisher; \
    Walking; Walking With Drill; Walking With Object; Walking With Polisher";

#[test]
fn all_has_the_names_of_hri30_in_order() {
    let names: Vec<_> = NAMES.split("; ").collect();
    let ours: Vec<_> = Action::ALL.iter().map(|action| action.name()).collect();
    assert_eq!(ours, names);
}

#[test]
fn names_are_distinct_and_parse_back() {
    let distinct: HashSet<_> = Action::ALL.into_iter().collect();
    assert_eq!(distinct.len(), 30);
    for action in Action::ALL {
        assert_eq!(Action::from_name(action.name()), Ok(action));
        assert_eq!(action.to_string().parse(), Ok(action));
    }
}

#[test]
fn every_name_says_what_the_action_is() {
    for action in Action::ALL {
        let name = action.name();
        let drill = name.contains("Drill");
        let polisher = name.contains("Polish");
        assert_eq!(action.tool() == Some(Tool::Drill), drill, "{name}");
        assert_eq!(action.tool() == Some(Tool::Polisher), polisher, "{name}");

        let direction = action.walking_direction();
        assert_eq!(direction.is_some(), name.starts_with("Move"), "{name}");
        if let Some(direction) = direction {
            let unit = direction.unit();
            let says = |word| name.contains(word);
            assert_eq!(unit.x > 0.1, says("Forwards"), "{name}");
            assert_eq!(unit.x < -0.1, says("Backwards"), "{name}");
            assert_eq!(unit.y > 0.1, says("Left"), "{name}");
            assert_eq!(unit.y < -0.1, says("Right"), "{name}");
        }

        let collaborative =
            name.starts_with("Move") || name.starts_with("Using") || name == "Deliver Object";
        assert_eq!(action.is_collaborative(), collaborative, "{name}");
    }
}

#[test]
fn wrong_names_are_refused() {
    for name in ["", "using the drill", "Using The Drill ", "Sleeping"] {
        let error = Action::from_name(name).unwrap_err();
        assert!(matches!(error, Error::Name { what: "action", got, .. } if got == name));
    }
    assert_eq!(
        "rough".parse::<Surface>().unwrap_err().to_string(),
        "unknown surface \"rough\": give \"smooth\" or \"drilled\""
    );
}

#[test]
fn nearest_direction_is_within_half_a_sector() {
    for degrees in -360..360 {
        let angle = f64::from(degrees).to_radians();
        let vector = Rotation2::new(angle) * Vector2::new(0.3, 0.0);
        let direction = WalkingDirection::nearest(vector).unwrap();
        assert!(direction.unit().dot(&vector.normalize()) >= (22.51_f64).to_radians().cos());
    }
    assert_eq!(WalkingDirection::nearest(Vector2::zeros()), None);
    assert_eq!(WalkingDirection::nearest(Vector2::new(f64::NAN, 1.0)), None);
    assert_eq!(WalkingDirection::nearest(Vector2::new(f64::INFINITY, 1.0)), None);
}

#[test]
fn serde_uses_names() {
    let seen = RecognisedAction {
        action: Action::MoveWhileUsing(WalkingDirection::BackwardsLeft, Tool::Polisher),
        confidence: Confidence::new(0.75).unwrap(),
    };
    let text = serde_json::to_string(&seen).unwrap();
    assert_eq!(
        text,
        r#"{"action":"Move Diagonally Backwards Left With Polisher","confidence":0.75}"#
    );
    assert_eq!(serde_json::from_str::<RecognisedAction>(&text).unwrap(), seen);
    let wrong = r#"{"action":"Walking","confidence":1.5}"#;
    let error = serde_json::from_str::<RecognisedAction>(wrong).unwrap_err();
    assert!(error.to_string().contains("confidence is 1.5: give a probability in [0, 1]"));
}

/// Every class is found by its name without spaces and without plurals, and no other class has
/// these labels.
#[test]
fn labels_of_copies_are_understood() {
    for action in Action::ALL {
        let joined: String = action.name().split(' ').collect();
        let singular = joined.replace("Backwards", "backward").replace("Forwards", "forward");
        for label in [joined, singular, action.name().to_uppercase().replace(' ', "_")] {
            assert_eq!(Action::from_label(&label).unwrap(), action, "{label}");
        }
        assert_eq!(
            action.group() == vision_models::ActionGroup::Collaboration,
            action.is_collaborative()
        );
    }
    for label in ["", "Walk", "Walking With"] {
        assert!(Action::from_label(label).is_err(), "{label}");
    }
}
