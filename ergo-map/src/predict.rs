//! Prediction of the posture that brings a hand to a position.

mod effort;
mod normal;
mod solve;

use nalgebra::{Rotation3, Vector3};

use crate::error::{Error, Result, finite, within};
use crate::joints::{JointAngles, POINT_DOF};
use crate::kinematics::Pose;
use crate::person::Person;
use crate::side::Side;
use crate::skeleton::mirror_rotation;
use effort::Effort;
use solve::{Goal, Outcome, Solver};

/// Largest hand error at which a target counts as reached, in statures: below 0.1 mm for everybody.
const REACHED: f64 = 3e-5;
/// Largest orientation error at which a target counts as reached \[rad\].
const ORIENTED: f64 = 1e-3;
/// Radius of the trunk, in statures.
const TRUNK_RADIUS: f64 = 0.06;

/// Target of the working hand, in the person's frame H. The origin of H is on the floor below the
/// pelvis of the person standing upright. x points forward, y left, and z up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandTarget {
    /// Centre of the grip \[m\].
    pub position: Vector3<f64>,
    /// Axes of the hand in H, if they matter: x along the fingers, z out of the back of the hand.
    /// The identity is a flat hand that points forward, palm down. `None` leaves forearm rotation
    /// and wrist at rest.
    pub orientation: Option<Rotation3<f64>>,
}

impl HandTarget {
    /// Creates a target position \[m\] with an arbitrary orientation.
    pub fn point(position: Vector3<f64>) -> Self {
        Self { position, orientation: None }
    }
}

/// Weights of the effort that a posture minimises. The numbers are choices of this crate, and
/// nothing has been fitted to people.
#[derive(Debug, Clone, PartialEq)]
pub struct EffortWeights {
    /// Displacement of each joint from neutral, relative to its range of motion (Marler & Yang's
    /// joint displacement), squared.
    pub displacement: JointAngles,
    /// Angles at which a joint is at rest \[rad\].
    pub neutral: JointAngles,
    /// Gravity's torque at shoulder, lumbar spine, hip and knee relative to its strength, squared.
    pub gravity: f64,
    /// Distance of the centre of mass from its place in quiet standing, relative to half the length
    /// of a foot, squared.
    pub balance: f64,
    /// Distance between the gaze direction at rest (15° down) and the direction to the hand, as
    /// unit vectors, squared.
    pub gaze: f64,
    /// Mass in the hand \[kg\].
    pub load: f64,
}

impl Default for EffortWeights {
    fn default() -> Self {
        Self {
            displacement: JointAngles {
                ankle: 20.0,
                knee: 20.0,
                hip: 20.0,
                lumbar_flexion: 20.0,
                lumbar_side: 10.0,
                lumbar_rotation: 6.0,
                neck_flexion: 3.0,
                neck_rotation: 3.0,
                shoulder_flexion: 6.0,
                shoulder_abduction: 6.0,
                shoulder_rotation: 2.0,
                elbow: 1.0,
                forearm_pronation: 1.0,
                wrist_flexion: 2.0,
                wrist_deviation: 2.0,
            },
            neutral: JointAngles::default(),
            gravity: 0.5,
            balance: 0.5,
            gaze: 0.5,
            load: 0.0,
        }
    }
}

impl EffortWeights {
    /// Checks that the weights are finite, displacement weights positive, the others non-negative.
    ///
    /// # Errors
    /// [`Error::Value`] with the name of the weight.
    pub fn validate(&self) -> Result<()> {
        let weights = self.displacement.to_array();
        for (name, weight) in JointAngles::NAMES.into_iter().zip(weights) {
            within(name, weight, [1e-6, 1e6], "(weight)")?;
        }
        self.neutral.validate()?;
        within("gravity", self.gravity, [0.0, 1e6], "(weight)")?;
        within("balance", self.balance, [0.0, 1e6], "(weight)")?;
        within("gaze", self.gaze, [0.0, 1e6], "(weight)")?;
        within("load", self.load, [0.0, 100.0], "kg")?;
        Ok(())
    }
}

/// The posture that a [`PosturePredictor`] found for a hand position, with its effort.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The joint angles.
    pub angles: JointAngles,
    /// Effort of the posture (weighted sum of squares, no unit).
    pub effort: f64,
    /// Remaining distance between hand and target \[m\].
    pub hand_error: f64,
}

/// Predicts the posture of least effort that brings a hand to a position (paper, Sec. III-B: people
/// "assume a configuration that minimizes the overall human joints activation").
///
/// minimise ½ Σ w ((q - neutral) / range)² + gravity + balance + gaze
/// subject to the hand at its target and the joints within their ranges of motion.
///
/// The solver is an augmented Lagrangian over projected Levenberg–Marquardt. Internally lengths are
/// in statures and masses in body masses. Two people of the same proportions therefore take the
/// same posture for the same relative target.
///
/// ```
/// use ergo_map::{HandTarget, Person, PosturePredictor, Side};
/// use nalgebra::Vector3;
/// let predictor = PosturePredictor::new(&Person::average(), Side::Right);
/// let target = HandTarget::point(Vector3::new(0.40, -0.20, 1.10));
/// let prediction = predictor.predict(&target)?;
/// assert!(prediction.hand_error < 5e-4);
/// assert!(predictor.predict(&HandTarget::point(Vector3::new(3.0, 0.0, 1.0))).is_err());
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct PosturePredictor {
    person: Person,
    side: Side,
    effort: Effort,
}

impl PosturePredictor {
    /// Creates a predictor with the default weights.
    pub fn new(person: &Person, side: Side) -> Self {
        let effort = Effort::new(person, &EffortWeights::default());
        Self { person: person.clone(), side, effort }
    }

    /// Creates a predictor with other weights.
    ///
    /// # Errors
    /// Those of [`EffortWeights::validate`].
    pub fn with_weights(person: &Person, side: Side, weights: &EffortWeights) -> Result<Self> {
        weights.validate()?;
        let effort = Effort::new(person, weights);
        Ok(Self { person: person.clone(), side, effort })
    }

    /// The person.
    pub fn person(&self) -> &Person {
        &self.person
    }

    /// The working hand.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Returns the posture of least effort for this target.
    ///
    /// # Errors
    /// [`Error::Value`] if the target is invalid or beyond a kilometre. [`Error::Unreachable`] with
    /// the reason.
    pub fn predict(&self, target: &HandTarget) -> Result<Prediction> {
        self.predict_from(target, &JointAngles::default())
    }

    /// Returns the posture of least effort, searched from `start` instead of upright standing. The
    /// start is clamped to the ranges of motion.
    ///
    /// # Errors
    /// Those of [`PosturePredictor::predict`], and [`Error::Value`] if the start is invalid.
    pub fn predict_from(&self, target: &HandTarget, start: &JointAngles) -> Result<Prediction> {
        for (name, value) in ["x", "y", "z"].into_iter().zip(target.position.iter()) {
            within(name, *value, [-1e3, 1e3], "m")?;
        }
        if let Some(rotation) = target.orientation {
            for value in rotation.matrix() {
                finite("orientation", *value)?;
            }
        }
        start.validate()?;
        let stature = self.person.stature();
        // The chain works with its right hand. A left hand is mirrored.
        let (goal, start) = match self.side {
            Side::Right => (*target, *start),
            Side::Left => (mirrored(target), start.mirrored()),
        };
        let goal = Goal::new(goal.position / stature, goal.orientation);
        let outcome = Solver::new(&self.effort, &goal).run(start.to_array());
        self.check(target, &goal, &outcome)?;
        let angles = JointAngles::from_array(outcome.q);
        let angles = match self.side {
            Side::Right => angles,
            Side::Left => angles.mirrored(),
        };
        let hand_error = outcome.distance * stature;
        Ok(Prediction { angles, effort: outcome.effort, hand_error })
    }

    fn check(&self, target: &HandTarget, goal: &Goal, outcome: &Outcome) -> Result<()> {
        let pose = Pose::new(self.effort.body(), &outcome.q);
        let distance = outcome.distance * self.person.stature();
        let reason = if outcome.distance > REACHED {
            // Near heel or toe the person would fall before the hand reaches the target.
            let balance = if self.effort.on_edge(&pose) { " in balance" } else { "" };
            format!("the closest posture{balance} leaves it {distance:.4} m away")
        } else if outcome.angle > ORIENTED {
            format!("the closest posture leaves its orientation {:.3} rad away", outcome.angle)
        } else if inside_trunk(&pose, &goal.position) {
            "it lies inside the person's trunk".to_owned()
        } else {
            return Ok(());
        };
        let [x, y, z]: [f64; 3] = target.position.into();
        Err(Error::Unreachable { x, y, z, reason })
    }
}

/// Mirrors the target in the body's midplane.
fn mirrored(target: &HandTarget) -> HandTarget {
    let p = target.position;
    HandTarget {
        position: Vector3::new(p.x, -p.y, p.z),
        orientation: target.orientation.map(|r| mirror_rotation(&r)),
    }
}

/// Returns true if a point is inside the trunk, a capsule from hip to neck.
fn inside_trunk(pose: &Pose, point: &Vector3<f64>) -> bool {
    [(pose.hip, pose.lumbar), (pose.lumbar, pose.neck)].into_iter().any(|(a, b)| {
        let along = b - a;
        let t = ((point - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (point - a - along * t).norm() < TRUNK_RADIUS
    })
}

/// Returns the number of joints that take part in reaching a goal.
const fn active_joints(oriented: bool) -> usize {
    if oriented { crate::joints::DOF } else { POINT_DOF }
}
