//! Effort of a posture, as a sum of squares.

use nalgebra::Vector3;

use super::EffortWeights;
use super::normal::Normal;
use crate::joints::DOF;
use crate::kinematics::{Body, Pose};
use crate::person::Person;

/// Torques of full effort, in body mass × g × stature. An entry is a joint, its relevant axes (x:
/// sagittal lever, y: lateral lever) and its strength.
///
/// A person of 75 kg and 1.75 m has about 60 N m at the shoulder and 250 N m at the lumbar spine.
/// The hips have about 200 N m, and both knees 300 N m.
const STRENGTH: [(usize, &[usize], f64); 4] =
    [(8, &[0, 1], 0.047), (3, &[0, 1], 0.194), (2, &[0], 0.155), (1, &[0], 0.233)];
/// Sine and cosine of the gaze's rest direction, 15° below the horizon.
const GAZE: [f64; 2] = [0.258_819_045_102_520_76, 0.965_925_826_289_068_3];
/// Rest position of the centre of mass, ahead of the ankle, in foot lengths.
const REST: f64 = 0.15;
/// Distance from an edge of the feet at which the balance guard starts, in foot lengths.
const GUARD: f64 = 0.1;
/// Stiffness of that guard relative to displacement effort, near the end of the search.
pub(super) const GUARD_STIFFNESS: f64 = 300.0;

/// The effort function of one person.
#[derive(Debug, Clone)]
pub(super) struct Effort {
    body: Body,
    min: [f64; DOF],
    max: [f64; DOF],
    neutral: [f64; DOF],
    /// Factors √weight / range of each joint.
    displacement: [f64; DOF],
    /// Factors √weight.
    gravity: f64,
    balance: f64,
    gaze: f64,
}

/// Returns the positions of heel and toe, ahead of the ankle.
fn support(body: &Body) -> [f64; 2] {
    [-0.25 * body.foot, 0.75 * body.foot]
}

impl Effort {
    pub(super) fn new(person: &Person, weights: &EffortWeights) -> Self {
        let (min, max) = (person.ranges().min.to_array(), person.ranges().max.to_array());
        let mut displacement = weights.displacement.to_array().map(f64::sqrt);
        for (d, (min, max)) in displacement.iter_mut().zip(min.into_iter().zip(max)) {
            *d /= max - min;
        }
        Self {
            body: Body::new(person.proportions(), weights.load / person.mass()),
            min,
            max,
            neutral: weights.neutral.to_array(),
            displacement,
            gravity: weights.gravity.sqrt(),
            balance: weights.balance.sqrt(),
            gaze: weights.gaze.sqrt(),
        }
    }

    pub(super) fn body(&self) -> &Body {
        &self.body
    }

    /// Rest angles of the joints.
    pub(super) fn neutral(&self) -> &[f64; DOF] {
        &self.neutral
    }

    /// Limits of the joints.
    pub(super) fn limits(&self) -> (&[f64; DOF], &[f64; DOF]) {
        (&self.min, &self.max)
    }

    /// Returns the effort of a posture with the hand aimed at `target`, and the balance guarded
    /// with a stiffness.
    pub(super) fn cost(
        &self,
        q: &[f64; DOF],
        pose: &Pose,
        target: &Vector3<f64>,
        guard: f64,
    ) -> f64 {
        let mut sum = 0.0;
        for ((q, neutral), weight) in q.iter().zip(&self.neutral).zip(&self.displacement) {
            let residual = weight * (q - neutral);
            sum += residual * residual;
        }
        for (joint, axes, strength) in STRENGTH {
            let lever = pose.lever(joint) * (self.gravity / strength);
            sum += axes.iter().map(|&axis| lever[axis] * lever[axis]).sum::<f64>();
        }
        sum += self.balance(pose, guard).iter().map(|(r, _)| r * r).sum::<f64>();
        sum += self.gaze(pose, target).norm_squared();
        0.5 * sum
    }

    /// Returns the effort with its derivatives.
    pub(super) fn linearise(
        &self,
        q: &[f64; DOF],
        pose: &Pose,
        target: &Vector3<f64>,
        guard: f64,
    ) -> Normal {
        let mut normal = Normal::new();
        for (i, weight) in self.displacement.into_iter().enumerate() {
            normal.add_joint(i, weight * (q[i] - self.neutral[i]), weight);
        }
        let rates: [Vector3<f64>; DOF] = core::array::from_fn(|i| pose.moment_rate(i));
        for (joint, axes, strength) in STRENGTH {
            let lever = pose.lever(joint);
            let columns = core::array::from_fn(|i| match i {
                i if !moves(joint, i) && !moves(i, joint) => Vector3::zeros(),
                i if i < joint => pose.axis[i].cross(&lever),
                _ => rates[i],
            });
            normal.add_axes(axes, &lever, &columns, self.gravity / strength);
        }
        let mass = pose.total.0;
        let [(x, x_slope), (y, y_slope), (edge, edge_slope)] = self.balance(pose, guard);
        normal.add(x, &rates.map(|rate| rate.x / mass * x_slope));
        normal.add(y, &rates.map(|rate| rate.y / mass * y_slope));
        if edge != 0.0 {
            normal.add(edge, &rates.map(|rate| rate.x / mass * edge_slope));
        }
        let gaze = self.gaze(pose, target);
        let (direction, distance) = sight(pose, target);
        let columns = core::array::from_fn(|i| {
            if i >= 8 {
                return Vector3::zeros();
            }
            let eye = pose.axis[i].cross(&(pose.eye - pose.origin[i]));
            let turn = (direction * direction.dot(&eye) - eye) / distance;
            pose.head.tr_mul(&(turn - pose.axis[i].cross(&direction))) * self.gaze
        });
        normal.add_axes(&[0, 1, 2], &gaze, &columns, 1.0);
        normal
    }

    /// Returns true if the centre of mass is close to heel or toe.
    pub(super) fn on_edge(&self, pose: &Pose) -> bool {
        let [_, _, (edge, _)] = self.balance(pose, GUARD_STIFFNESS);
        edge.abs() > 0.0
    }

    /// Returns the residuals of the centre of mass with their derivatives. These are its distances
    /// from rest forward and sideways, and a stiff guard close to heel and toe.
    fn balance(&self, pose: &Pose, stiffness: f64) -> [(f64, f64); 3] {
        let foot = self.body.foot;
        let centre = pose.total.1 / pose.total.0;
        let scale = self.balance / (0.5 * foot);
        let [heel, toe] = support(&self.body);
        let (low, high) = (heel + GUARD * foot, toe - GUARD * foot);
        let stiff = stiffness.sqrt() / (0.5 * foot);
        let edge = (centre.x - centre.x.clamp(low, high)) * stiff;
        [(scale * (centre.x - REST * foot), scale), (scale * centre.y, scale), (edge, stiff)]
    }

    /// Returns the residual of the gaze: the direction to the target minus the rest direction, in
    /// the head's axes.
    fn gaze(&self, pose: &Pose, target: &Vector3<f64>) -> Vector3<f64> {
        let (direction, _) = sight(pose, target);
        (pose.head.tr_mul(&direction) - Vector3::new(GAZE[1], 0.0, -GAZE[0])) * self.gaze
    }
}

/// Returns direction and distance from the eyes to the target, both smoothed within the breadth of
/// a hand. A target between the eyes then has no direction instead of an arbitrary one.
fn sight(pose: &Pose, target: &Vector3<f64>) -> (Vector3<f64>, f64) {
    const BREADTH: f64 = 0.05;
    let line = target - pose.eye;
    let distance = (line.norm_squared() + BREADTH * BREADTH).sqrt();
    (line / distance, distance)
}

/// Returns true if joint `a` moves joint `b` (or is it). Neck and arm are separate branches.
fn moves(a: usize, b: usize) -> bool {
    a <= b && (a <= 5 || (a <= 7) == (b <= 7))
}
