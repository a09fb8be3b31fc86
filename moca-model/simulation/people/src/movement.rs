//! Movements on the spot at human speeds: a head over a standing pelvis at 1 to 1.5 m/s, hands at 2 to 4 m/s.

use std::collections::VecDeque;
use std::f64::consts::PI;

use nalgebra::Vector3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Rates at which a kept posture is taken \[rad/s, statures/s\], accelerations \[rad/s², statures/s²\], and the time
/// constant at the end \[s\]. The accelerations are those of the quickest movements.
const LEAN_RATE: f64 = 0.8;
const DROP_RATE: f64 = 0.2;
const LEAN_ACCELERATION: f64 = 6.0;
const DROP_ACCELERATION: f64 = 1.2;
const BEND_TIME: f64 = 0.2;

/// A movement that ends where it began.
///
/// ```
/// use simulated_people::Movement;
///
/// assert_eq!(Movement::from_name("bow"), Some(Movement::Bow));
/// assert_eq!(Movement::Bow.name(), "bow");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Movement {
    /// Leans forwards from the hips.
    Bow,
    /// Goes down on both knees, and up.
    Kneel,
    /// Sits down, and stays for a moment.
    SitDown,
    /// Sits, and gets up.
    GetUp,
    /// Leans to a side.
    LeanSideways,
    /// Raises both hands above the head.
    ReachOverhead,
    /// Turns on the spot, and back.
    Turn,
    /// Bends the knees, arms forwards.
    Squat,
    /// Takes something from the floor with the right hand.
    PickUp,
    /// Steps to a side, and back.
    StepSideways,
    /// Swings both arms to and fro.
    SwingArms,
}

/// The difference of a body from one that stands; lengths are fractions of stature, angles are in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Posture {
    /// Flexion of the trunk, and its bending to the left.
    pub(super) lean: f64,
    pub(super) aside: f64,
    /// Lowering of the pelvis, its displacement to the back, and that of the feet.
    pub(super) drop: f64,
    pub(super) back: f64,
    pub(super) feet_back: f64,
    /// Displacements of left and right hand from where they would hang on the trunk.
    pub(super) hands: [Vector3<f64>; 2],
    /// Turn to the left on the spot.
    pub(super) turn: f64,
    pub(super) step: f64,
}

/// A movement under way, and the posture that is kept besides.
#[derive(Clone, Debug, Default)]
pub(super) struct Moving {
    /// Lean and drop that are asked for, and as far as they have come.
    kept: Posture,
    bent: Posture,
    /// Rates of that lean and drop \[rad/s, statures/s\].
    bending: [f64; 2],
    from: Posture,
    now: Posture,
    /// Next postures, each with the time to reach it \[s\].
    to_come: VecDeque<(Posture, f64)>,
    /// Time since the beginning of the first of them \[s\].
    elapsed: f64,
}

impl Movement {
    /// Movements in the order of the enum.
    pub const ALL: [Self; 11] = [
        Self::Bow,
        Self::Kneel,
        Self::SitDown,
        Self::GetUp,
        Self::LeanSideways,
        Self::ReachOverhead,
        Self::Turn,
        Self::Squat,
        Self::PickUp,
        Self::StepSideways,
        Self::SwingArms,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bow => "bow",
            Self::Kneel => "kneel",
            Self::SitDown => "sit-down",
            Self::GetUp => "get-up",
            Self::LeanSideways => "lean-sideways",
            Self::ReachOverhead => "reach-overhead",
            Self::Turn => "turn",
            Self::Squat => "squat",
            Self::PickUp => "pick-up",
            Self::StepSideways => "step-sideways",
            Self::SwingArms => "swing-arms",
        }
    }

    /// The movement with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|movement| movement.name() == name)
    }

    /// The postures of the movement, each with the time to reach it \[s\].
    fn postures(self, draw: &mut ChaCha8Rng) -> Vec<(Posture, f64)> {
        let still = Posture::default();
        let time = draw.random_range(0.9..1.25);
        let rest = draw.random_range(0.1..1.0);
        let side = if draw.random_bool(0.5) { 1.0 } else { -1.0 };
        let size = draw.random_range(0.75..1.0);
        let there_and_back =
            |there: Posture, time: f64| vec![(there, time), (there, rest), (still, time)];
        let both = |hand: Vector3<f64>| [hand, Vector3::new(hand.x, -hand.y, hand.z)];
        let seated = Posture { lean: 0.1, drop: 0.24, back: 0.2, ..still };
        let sitting = Posture { lean: 0.7, drop: 0.12, back: 0.1, ..still };
        match self {
            Self::Bow => there_and_back(Posture { lean: 0.87 * size, ..still }, time),
            Self::Kneel => {
                let kneeling = Posture { drop: 0.235, feet_back: 0.22, lean: 0.1, ..still };
                there_and_back(kneeling, 1.2 * time)
            }
            Self::SitDown => {
                let pause = rest + 1.0;
                vec![
                    (sitting, 0.9 * time),
                    (seated, 0.9 * time),
                    (seated, pause),
                    (sitting, 1.1 * time),
                    (still, 1.1 * time),
                ]
            }
            Self::GetUp => vec![
                (sitting, 1.1 * time),
                (seated, 1.1 * time),
                (seated, rest),
                (sitting, 0.9 * time),
                (still, 0.9 * time),
            ],
            Self::LeanSideways => {
                there_and_back(Posture { aside: side * 0.65 * size, ..still }, 0.9 * time)
            }
            Self::ReachOverhead => {
                let hands = both(Vector3::new(0.1, 0.12, 0.6 * size));
                there_and_back(Posture { hands, ..still }, 0.9 * time)
            }
            Self::Turn => there_and_back(Posture { turn: side * PI * size, ..still }, 1.9 * time),
            Self::Squat => {
                let hands = both(Vector3::new(0.15, 0.0, 0.15));
                there_and_back(Posture { drop: 0.2 * size, lean: 0.5, hands, ..still }, time)
            }
            Self::PickUp => {
                let hands = [Vector3::zeros(), Vector3::new(0.1, 0.05, -0.15)];
                let down = Posture { drop: 0.14, lean: 1.0 * size, hands, ..still };
                there_and_back(down, 1.4 * time)
            }
            Self::StepSideways => {
                there_and_back(Posture { step: side * 0.3 * size, ..still }, 0.87 * time)
            }
            Self::SwingArms => {
                let at = |forwards: f64| {
                    let up = 0.9 * forwards * forwards;
                    Posture { hands: both(Vector3::new(forwards, 0.0, up)), ..still }
                };
                let swing = 0.5 * time;
                let mut swings = vec![(at(0.3 * size), 0.6 * time)];
                for _ in 0..3 {
                    swings.extend([(at(-0.08 * size), swing), (at(0.3 * size), swing)]);
                }
                swings.push((still, 0.6 * time));
                swings
            }
        }
    }
}

impl Moving {
    /// Starts a movement after those in progress.
    pub(super) fn begin(&mut self, movement: Movement, draw: &mut ChaCha8Rng) {
        self.to_come.extend(movement.postures(draw));
    }

    /// Returns true if no movement is in progress.
    pub(super) fn is_over(&self) -> bool {
        self.to_come.is_empty()
    }

    /// The posture at present.
    pub(super) fn posture(&self) -> Posture {
        let mut posture = self.now;
        posture.lean += self.bent.lean;
        posture.drop += self.bent.drop;
        posture
    }

    /// Leans \[rad\] and squats \[statures\] from now on, besides what movements do.
    pub(super) fn keep(&mut self, lean: f64, drop: f64) {
        (self.kept.lean, self.kept.drop) = (lean, drop);
    }

    /// Advances by a time \[s\], from posture to posture with least jerk.
    pub(super) fn advance(&mut self, elapsed: f64) {
        let bent = [
            (&mut self.bent.lean, self.kept.lean, (LEAN_RATE, LEAN_ACCELERATION)),
            (&mut self.bent.drop, self.kept.drop, (DROP_RATE, DROP_ACCELERATION)),
        ];
        for ((bent, kept, (most, acceleration)), rate) in bent.into_iter().zip(&mut self.bending) {
            let towards = ((kept - *bent) / BEND_TIME).clamp(-most, most);
            let change = acceleration * elapsed;
            *rate += (towards - *rate).clamp(-change, change);
            *bent += *rate * elapsed;
        }
        let Some((to, time)) = self.to_come.front().copied() else { return };
        self.elapsed += elapsed;
        if self.elapsed >= time {
            self.to_come.pop_front();
            (self.from, self.now, self.elapsed) = (to, to, 0.0);
        } else {
            let s = self.elapsed / time;
            self.now = self.from.towards(&to, s * s * s * (10.0 + s * (6.0 * s - 15.0)));
        }
    }
}

impl Posture {
    fn towards(&self, to: &Self, share: f64) -> Self {
        let between = |from: f64, to: f64| from + (to - from) * share;
        Self {
            lean: between(self.lean, to.lean),
            aside: between(self.aside, to.aside),
            drop: between(self.drop, to.drop),
            back: between(self.back, to.back),
            feet_back: between(self.feet_back, to.feet_back),
            hands: [0, 1].map(|side| self.hands[side].lerp(&to.hands[side], share)),
            turn: between(self.turn, to.turn),
            step: between(self.step, to.step),
        }
    }
}
