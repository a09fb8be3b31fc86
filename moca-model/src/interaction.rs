//! What the robot does about what the person wants (the paper's Experiments 3 and 4).

use vision_models::{Intention, Surface, WalkingDirection};

use crate::held_object::BoxSide;

/// What robot and person are at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// Nobody works with the robot.
    #[default]
    Apart,
    /// Nobody uses a tool, and the robot turns what it holds to its camera, which has not seen yet which
    /// surface is where.
    Looking,
    /// Somebody has straightened the arm towards a robot that holds nothing: it comes.
    Handover,
    /// The tool is where the person offers the object: the gripper may close, and whoever closes it calls
    /// [`Controller::hold`](crate::Controller::hold).
    Grasping,
    /// The object turns, to show the side that the person's tool is for.
    Turning {
        /// The side that the person is to see.
        to: BoxSide,
    },
    /// The person works on the object where they stand.
    Working,
    /// They lead the robot while they work.
    Walking {
        /// In their own frame.
        direction: WalkingDirection,
    },
}

/// Why a phase ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The person straightens the arm: takes part in the work.
    Engages,
    /// No side of what the robot holds has been seen, nor faces the camera.
    Hidden,
    /// The camera has seen one.
    Seen,
    /// The person does something else.
    Leaves,
    /// The tool has come into the shared workspace.
    Arrived,
    /// The gripper has closed.
    Grasped,
    /// The object was taken away.
    Released,
    /// The side that is shown is not the one that the person's tool is for.
    WrongSurface {
        /// What the person sees.
        shown: Surface,
        /// What their tool is for.
        needed: Surface,
    },
    /// The object shows the side that it was turned to.
    RightSurface,
    /// The person begins to walk, or changes direction.
    Walks,
    /// The person stands.
    Stands,
}

/// A change of the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// On the clock of the ticks \[s\].
    pub time: f64,
    /// The phase that ends.
    pub from: Phase,
    /// The phase that begins.
    pub to: Phase,
    /// Why.
    pub reason: Reason,
}

/// What the on-board camera knows of the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// Which surface is where; or there is no camera, or no object.
    Known,
    /// Not yet, but a side faces it.
    Facing,
    /// Not yet, and no side faces it.
    Hidden,
}

/// What the guards look at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Situation {
    /// On the clock of the ticks \[s\].
    pub(crate) time: f64,
    /// What the person wants; apart while the shared workspace is nobody's.
    pub(crate) intention: Intention,
    /// Whether the robot holds something.
    pub(crate) holds: bool,
    /// The surface that is shown, or that the object turns to show, and the one that the person's tool is
    /// for, with its side: where they differ.
    pub(crate) mismatch: Option<(Surface, Surface, BoxSide)>,
    /// Whether the desired pose lies within the shared workspace, turned to where it is to be.
    pub(crate) arrived: bool,
    /// What the on-board camera knows.
    pub(crate) sight: Sight,
}

/// The phase, and how it changed last.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Interaction {
    phase: Phase,
}

impl Interaction {
    /// What robot and person are at.
    pub(crate) fn phase(self) -> Phase {
        self.phase
    }

    /// Goes on to the next phase if the guard of one holds; at most one a tick.
    pub(crate) fn advance(&mut self, situation: &Situation) -> Option<Transition> {
        let (to, reason) = next(self.phase, situation)?;
        let from = std::mem::replace(&mut self.phase, to);
        Some(Transition { time: situation.time, from, to, reason })
    }
}

/// The phase after this one, if a guard holds, and why.
fn next(phase: Phase, situation: &Situation) -> Option<(Phase, Reason)> {
    let &Situation { intention, holds, mismatch, arrived, sight, .. } = situation;
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
    // Only who works with the robot has it turn what it holds.
    let turn = mismatch
        .map(|(shown, needed, to)| (Phase::Turning { to }, Reason::WrongSurface { shown, needed }));
    let work = match intention.walking() {
        Some(direction) => Phase::Walking { direction },
        None => Phase::Working,
    };
    match phase {
        Phase::Apart | Phase::Looking if !holds => Some((Phase::Handover, Reason::Engages)),
        Phase::Apart | Phase::Looking => Some((work, Reason::Engages)),
        Phase::Handover | Phase::Grasping if holds => Some((Phase::Working, Reason::Grasped)),
        Phase::Handover => {
            let offered = intention.tool().is_none() && intention.walking().is_none();
            (arrived && offered).then_some((Phase::Grasping, Reason::Arrived))
        }
        Phase::Grasping => None,
        _ if !holds => Some((Phase::Handover, Reason::Released)),
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

    fn working() -> Situation {
        let intention = Intention::Together { walking: None, tool: Some(Tool::Polisher) };
        let sight = Sight::Known;
        Situation { time: 1.0, intention, holds: true, mismatch: None, arrived: true, sight }
    }

    fn situations() -> impl Strategy<Value = Situation> {
        let tool = prop_oneof![Just(None), Just(Some(Tool::Drill)), Just(Some(Tool::Polisher))];
        let walking = prop::option::of((0_usize..8).prop_map(|i| WalkingDirection::ALL[i]));
        let together =
            (walking, tool).prop_map(|(walking, tool)| Intention::Together { walking, tool });
        let intention = prop_oneof![Just(Intention::Apart), together];
        let sight = prop_oneof![Just(Sight::Known), Just(Sight::Facing), Just(Sight::Hidden)];
        (intention, any::<[bool; 3]>(), sight).prop_map(|(intention, flags, sight)| {
            let [holds, wrong, arrived] = flags;
            let mismatch = (wrong && holds && intention.tool().is_some()).then_some(MISMATCH);
            Situation { time: 0.0, intention, holds, mismatch, arrived, sight }
        })
    }

    proptest! {
        #[test]
        fn nothing_turns_for_somebody_who_is_apart_or_with_nothing_held(
            situations in prop::collection::vec(situations(), 1..60),
        ) {
            let mut interaction = Interaction::default();
            for situation in &situations {
                let before = interaction.phase();
                let transition = interaction.advance(situation);
                let after = interaction.phase();
                prop_assert_eq!(transition.is_some(), before != after
                    || matches!(transition.map(|t| t.reason), Some(Reason::WrongSurface { .. })));
                if !situation.intention.is_together() {
                    prop_assert!(matches!(after, Phase::Apart | Phase::Looking));
                }
                let in_use = situation.intention.tool().is_some();
                prop_assert!(after != Phase::Looking || !in_use);
                if let Some(Reason::WrongSurface { .. }) = transition.map(|t| t.reason) {
                    prop_assert!(situation.mismatch.is_some() && situation.holds);
                }
            }
        }

        #[test]
        fn a_situation_that_lasts_comes_to_one_phase(
            before in prop::collection::vec(situations(), 0..10), last in situations(),
        ) {
            let mut interaction = Interaction::default();
            for situation in &before { interaction.advance(situation); }
            // What is shown is the right side once the robot has begun to turn it.
            let lasting = Situation { mismatch: None, ..last };
            for _ in 0..4 { interaction.advance(&lasting); }
            let phase = interaction.phase();
            for _ in 0..4 { prop_assert_eq!(interaction.advance(&lasting), None); }
            prop_assert_eq!(interaction.phase(), phase);
        }
    }

    #[test]
    fn an_object_goes_from_hand_to_hand_and_is_turned() {
        let mut interaction = Interaction::default();
        let offered = Intention::Together { walking: None, tool: None };
        let empty = Situation { intention: offered, holds: false, arrived: false, ..working() };
        let apart = Situation { intention: Intention::Apart, ..working() };
        let empty_handed = Situation { intention: offered, ..working() };
        let hidden = Situation { sight: Sight::Hidden, ..apart };
        let wrong = Situation { mismatch: Some(MISMATCH), arrived: false, ..working() };
        let direction = WalkingDirection::Left;
        let walking = Intention::Together { walking: Some(direction), tool: Some(Tool::Drill) };
        let walking = Situation { intention: walking, ..working() };
        let steps = [
            (empty, Phase::Handover, Reason::Engages),
            (Situation { arrived: true, ..empty }, Phase::Grasping, Reason::Arrived),
            (Situation { holds: true, ..empty }, Phase::Working, Reason::Grasped),
            (apart, Phase::Apart, Reason::Leaves),
            (hidden, Phase::Looking, Reason::Hidden),
            (apart, Phase::Apart, Reason::Seen),
            (hidden, Phase::Looking, Reason::Hidden),
            (empty_handed, Phase::Working, Reason::Seen),
            (Situation { sight: Sight::Hidden, ..empty_handed }, Phase::Looking, Reason::Hidden),
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
        for (situation, phase, reason) in steps {
            let transition = interaction.advance(&situation).unwrap();
            assert_eq!((transition.to, transition.reason), (phase, reason));
            assert_eq!(interaction.phase(), phase);
        }
    }
}
