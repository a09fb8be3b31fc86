//! State machine of the interaction (the paper's Experiments 3 and 4).

use vision_models::{Intention, Surface, WalkingDirection};

use crate::box_side::BoxSide;

/// The phase of the interaction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// Nobody works with the robot.
    #[default]
    Apart,
    /// Nobody uses a hand tool. The robot turns its object towards its camera, which has not identified the surfaces.
    Looking,
    /// A person has extended the arm towards a robot that holds nothing, and the robot approaches.
    Handover,
    /// The robot's tool is at the offered object. The gripper may close; then call
    /// [`Controller::grasp`](crate::Controller::grasp).
    Grasping,
    /// The object turns to show the side that the person's hand tool is for.
    Turning {
        /// The side that the person is to see.
        to: BoxSide,
    },
    /// The person works on the object while standing.
    Working,
    /// The person leads the robot while working.
    Walking {
        /// Direction in the person's own frame.
        direction: WalkingDirection,
    },
}

/// The reason of a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The person extends the arm and takes part in the work.
    Engages,
    /// No side of the object has been identified, and none faces the camera.
    Hidden,
    /// The camera has identified a side.
    Seen,
    /// The person does something else.
    Leaves,
    /// The tool has reached the shared workspace.
    Arrived,
    /// The gripper has closed.
    Grasped,
    /// The object was taken away.
    Released,
    /// The side shown is not the one that the person's hand tool is for.
    WrongSurface {
        /// The surface that the person sees.
        shown: Surface,
        /// The surface that the hand tool is for.
        needed: Surface,
    },
    /// The object shows the side that was needed.
    RightSurface,
    /// The person begins to walk or changes direction.
    Walks,
    /// The person stands still.
    Stands,
}

/// A transition between phases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// Time on the clock of the ticks \[s\].
    pub time: f64,
    /// The phase that ends.
    pub from: Phase,
    /// The phase that begins.
    pub to: Phase,
    /// The reason.
    pub reason: Reason,
}

/// The on-board camera's knowledge of the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// The surfaces are identified; or there is no camera, or no object.
    Known,
    /// The surfaces are not identified, but a side faces the camera.
    Facing,
    /// The surfaces are not identified, and no side faces the camera.
    Hidden,
}

/// Inputs of the conditions of transitions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Conditions {
    /// Time on the clock of the ticks \[s\].
    pub(crate) time: f64,
    /// The person's intention; apart while the shared workspace belongs to nobody.
    pub(crate) intention: Intention,
    /// True if the robot grasps an object.
    pub(crate) grasps: bool,
    /// The surface shown now or after the present turn, the surface that the person's hand tool is for, and its side;
    /// `None` if they agree.
    pub(crate) mismatch: Option<(Surface, Surface, BoxSide)>,
    /// True if the desired pose is within the shared workspace, which has reached its orientation.
    pub(crate) arrived: bool,
    /// The on-board camera's knowledge.
    pub(crate) sight: Sight,
}

/// Makes at most one transition whose condition is met, and returns it.
pub(crate) fn advance(phase: &mut Phase, conditions: &Conditions) -> Option<Transition> {
    let (to, reason) = next(*phase, conditions)?;
    let from = std::mem::replace(phase, to);
    Some(Transition { time: conditions.time, from, to, reason })
}

/// The next phase and the reason, if a condition is met.
fn next(phase: Phase, conditions: &Conditions) -> Option<(Phase, Reason)> {
    let &Conditions { intention, grasps, mismatch, arrived, sight, .. } = conditions;
    let idle = intention.tool().is_none() && intention.walking().is_none();
    if phase == Phase::Looking && idle {
        let back = if intention.is_together() { Phase::Working } else { Phase::Apart };
        return (sight == Sight::Known).then_some((back, Reason::Seen));
    }
    if matches!(phase, Phase::Apart | Phase::Working) && idle && sight == Sight::Hidden {
        return Some((Phase::Looking, Reason::Hidden));
    }
    if !intention.is_together() {
        return (phase != Phase::Apart).then_some((Phase::Apart, Reason::Leaves));
    }
    // The object only turns for a person who works with the robot.
    let turn = mismatch
        .map(|(shown, needed, to)| (Phase::Turning { to }, Reason::WrongSurface { shown, needed }));
    let work = match intention.walking() {
        Some(direction) => Phase::Walking { direction },
        None => Phase::Working,
    };
    match phase {
        Phase::Apart | Phase::Looking if !grasps => Some((Phase::Handover, Reason::Engages)),
        Phase::Apart | Phase::Looking => Some((work, Reason::Engages)),
        Phase::Handover | Phase::Grasping if grasps => Some((Phase::Working, Reason::Grasped)),
        Phase::Handover => {
            let offered = intention.tool().is_none() && intention.walking().is_none();
            (arrived && offered).then_some((Phase::Grasping, Reason::Arrived))
        }
        Phase::Grasping => None,
        _ if !grasps => Some((Phase::Handover, Reason::Released)),
        _ if turn.is_some() => turn,
        Phase::Turning { .. } => arrived.then_some((work, Reason::RightSurface)),
        Phase::Working | Phase::Walking { .. } if work == phase => None,
        Phase::Working | Phase::Walking { .. } => match work {
            Phase::Walking { .. } => Some((work, Reason::Walks)),
            _ => Some((work, Reason::Stands)),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vision_models::Tool;

    const MISMATCH: (Surface, Surface, BoxSide) =
        (Surface::Drilled, Surface::Smooth, BoxSide::Back);

    fn working() -> Conditions {
        let intention = Intention::Together { walking: None, tool: Some(Tool::Polisher) };
        let sight = Sight::Known;
        Conditions { time: 1.0, intention, grasps: true, mismatch: None, arrived: true, sight }
    }

    fn situations() -> impl Strategy<Value = Conditions> {
        let tool = prop_oneof![Just(None), Just(Some(Tool::Drill)), Just(Some(Tool::Polisher))];
        let walking = prop::option::of((0_usize..8).prop_map(|i| WalkingDirection::ALL[i]));
        let together =
            (walking, tool).prop_map(|(walking, tool)| Intention::Together { walking, tool });
        let intention = prop_oneof![Just(Intention::Apart), together];
        let sight = prop_oneof![Just(Sight::Known), Just(Sight::Facing), Just(Sight::Hidden)];
        (intention, any::<[bool; 3]>(), sight).prop_map(|(intention, flags, sight)| {
            let [grasps, wrong, arrived] = flags;
            let mismatch = (wrong && grasps && intention.tool().is_some()).then_some(MISMATCH);
            Conditions { time: 0.0, intention, grasps, mismatch, arrived, sight }
        })
    }

    proptest! {
        #[test]
        fn object_only_turns_for_a_working_person(
            situations in prop::collection::vec(situations(), 1..60),
        ) {
            let mut phase = Phase::default();
            for situation in &situations {
                let before = phase;
                let transition = advance(&mut phase, situation);
                let after = phase;
                prop_assert_eq!(transition.is_some(), before != after
                    || matches!(transition.map(|t| t.reason), Some(Reason::WrongSurface { .. })));
                if !situation.intention.is_together() {
                    prop_assert!(matches!(after, Phase::Apart | Phase::Looking));
                }
                let in_use = situation.intention.tool().is_some();
                prop_assert!(after != Phase::Looking || !in_use);
                if let Some(Reason::WrongSurface { .. }) = transition.map(|t| t.reason) {
                    prop_assert!(situation.mismatch.is_some() && situation.grasps);
                }
            }
        }

        #[test]
        fn a_situation_that_lasts_comes_to_one_phase(
            before in prop::collection::vec(situations(), 0..10), last in situations(),
        ) {
            let mut phase = Phase::default();
            for situation in &before { advance(&mut phase, situation); }
            // The right side counts as shown once the robot has begun to turn to it.
            let lasting = Conditions { mismatch: None, ..last };
            for _ in 0..4 { advance(&mut phase, &lasting); }
            let settled = phase;
            for _ in 0..4 { prop_assert_eq!(advance(&mut phase, &lasting), None); }
            prop_assert_eq!(phase, settled);
        }
    }

    #[test]
    fn phases_follow_handover_work_and_turning() {
        let mut phase = Phase::default();
        let offered = Intention::Together { walking: None, tool: None };
        let empty = Conditions { intention: offered, grasps: false, arrived: false, ..working() };
        let apart = Conditions { intention: Intention::Apart, ..working() };
        let empty_handed = Conditions { intention: offered, ..working() };
        let hidden = Conditions { sight: Sight::Hidden, ..apart };
        let wrong = Conditions { mismatch: Some(MISMATCH), arrived: false, ..working() };
        let direction = WalkingDirection::Left;
        let walking = Intention::Together { walking: Some(direction), tool: Some(Tool::Drill) };
        let walking = Conditions { intention: walking, ..working() };
        let steps = [
            (empty, Phase::Handover, Reason::Engages),
            (Conditions { arrived: true, ..empty }, Phase::Grasping, Reason::Arrived),
            (Conditions { grasps: true, ..empty }, Phase::Working, Reason::Grasped),
            (apart, Phase::Apart, Reason::Leaves),
            (hidden, Phase::Looking, Reason::Hidden),
            (apart, Phase::Apart, Reason::Seen),
            (hidden, Phase::Looking, Reason::Hidden),
            (empty_handed, Phase::Working, Reason::Seen),
            (Conditions { sight: Sight::Hidden, ..empty_handed }, Phase::Looking, Reason::Hidden),
            (wrong, Phase::Working, Reason::Engages),
            (
                wrong,
                Phase::Turning { to: BoxSide::Back },
                Reason::WrongSurface { shown: Surface::Drilled, needed: Surface::Smooth },
            ),
            (working(), Phase::Working, Reason::RightSurface),
            (walking, Phase::Walking { direction }, Reason::Walks),
            (working(), Phase::Working, Reason::Stands),
            (apart, Phase::Apart, Reason::Leaves),
        ];
        for (situation, expected, reason) in steps {
            let transition = advance(&mut phase, &situation).unwrap();
            assert_eq!((transition.to, transition.reason), (expected, reason));
            assert_eq!(phase, expected);
        }
    }
}
