//! The body as a kinematic chain: the places of all parts for given joint angles, and the motion of
//! the centre of mass with each joint. Lengths are in statures and masses in body masses. The right
//! arm is the working one.

use nalgebra::{Matrix3, Vector3};

use crate::joints::DOF;
use crate::person::Proportions;

/// Masses as fractions of the body's (Dempster, in Winter's table). Centres of mass are fractions
/// of the segment from its lower or proximal end.
pub(crate) mod mass {
    /// Hand. Its centre of mass is assumed at the grip.
    pub(crate) const HAND: f64 = 0.006;
    pub(crate) const FOREARM: f64 = 0.016;
    pub(crate) const FOREARM_COM: f64 = 0.430;
    pub(crate) const UPPER_ARM: f64 = 0.028;
    pub(crate) const UPPER_ARM_COM: f64 = 0.436;
    pub(crate) const FOOT: f64 = 0.0145;
    pub(crate) const SHANK: f64 = 0.0465;
    /// Fraction from the ankle. Winter gives .433 from the knee.
    pub(crate) const SHANK_COM: f64 = 1.0 - 0.433;
    pub(crate) const THIGH: f64 = 0.100;
    /// Fraction from the knee. Winter gives .433 from the hip.
    pub(crate) const THIGH_COM: f64 = 1.0 - 0.433;
    pub(crate) const HEAD: f64 = 0.081;
    pub(crate) const THORAX: f64 = 0.355;
    /// Fraction from the lumbar joint. Winter gives .63 from C7.
    pub(crate) const THORAX_COM: f64 = 1.0 - 0.63;
    pub(crate) const PELVIS: f64 = 0.142;
    /// Fraction from the hip. Winter gives .105 from the lumbar joint.
    pub(crate) const PELVIS_COM: f64 = 1.0 - 0.105;
    pub(crate) const ARM: f64 = HAND + FOREARM + UPPER_ARM;
}

/// Lengths and masses of the chain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Body {
    pub(crate) ankle: f64,
    pub(crate) shank: f64,
    pub(crate) thigh: f64,
    pub(crate) pelvis: f64,
    /// Lumbar joint to neck joint.
    pub(crate) thorax: f64,
    /// Lumbar joint to the height of the shoulders.
    pub(crate) shoulder: f64,
    pub(crate) shoulder_half_width: f64,
    /// Neck joint to the eyes, up and forward.
    pub(crate) eye: [f64; 2],
    pub(crate) upper_arm: f64,
    pub(crate) forearm: f64,
    pub(crate) grip: f64,
    pub(crate) foot: f64,
    /// Mass held in the hand.
    pub(crate) load: f64,
}

impl Body {
    /// Creates the chain of a body with these proportions.
    ///
    /// The lumbar joint is a fifth of the way from hip to shoulder (L5/S1, Chaffin). The neck joint
    /// is .44 of the way from shoulder to eye (Drillis & Contini's .870 of stature). The eyes are
    /// .055 of stature ahead of the neck (a choice).
    pub(crate) fn new(p: &Proportions, load: f64) -> Self {
        let lumbar = p.hip + 0.2 * (p.shoulder - p.hip);
        let neck = p.shoulder + 0.44 * (p.eye - p.shoulder);
        Self {
            ankle: p.ankle,
            shank: p.knee - p.ankle,
            thigh: p.hip - p.knee,
            pelvis: lumbar - p.hip,
            thorax: neck - lumbar,
            shoulder: p.shoulder - lumbar,
            shoulder_half_width: p.shoulder_half_width,
            eye: [p.eye - neck, 0.055],
            upper_arm: p.upper_arm,
            forearm: p.forearm,
            grip: p.grip,
            foot: p.foot,
            load,
        }
    }
}

/// Places of the body's parts.
#[derive(Debug, Clone)]
pub(crate) struct Pose {
    /// Axis of each joint, unit, in H.
    pub(crate) axis: [Vector3<f64>; DOF],
    /// A point on each joint's axis.
    pub(crate) origin: [Vector3<f64>; DOF],
    /// Mass that each joint moves.
    pub(crate) moved_mass: [f64; DOF],
    /// First moment of the mass that each joint moves.
    pub(crate) moved_moment: [Vector3<f64>; DOF],
    /// Total mass (load included) and its first moment.
    pub(crate) total: (f64, Vector3<f64>),
    pub(crate) knee: Vector3<f64>,
    pub(crate) hip: Vector3<f64>,
    pub(crate) lumbar: Vector3<f64>,
    pub(crate) neck: Vector3<f64>,
    pub(crate) eye: Vector3<f64>,
    pub(crate) shoulder: Vector3<f64>,
    pub(crate) other_shoulder: Vector3<f64>,
    pub(crate) elbow: Vector3<f64>,
    pub(crate) wrist: Vector3<f64>,
    pub(crate) hand: Vector3<f64>,
    /// Axes of the head. x is the direction of the face.
    pub(crate) head: Matrix3<f64>,
    /// Axes of the hand with the fingers along -z and the palm towards +y.
    pub(crate) palm: Matrix3<f64>,
}

/// Turns a frame about its own axis `axis` (0 x, 1 y, 2 z).
fn turned(frame: &Matrix3<f64>, axis: usize, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut out = *frame;
    out.set_column(u, &(frame.column(u) * cos + frame.column(v) * sin));
    out.set_column(v, &(frame.column(v) * cos - frame.column(u) * sin));
    out
}

impl Pose {
    /// Computes the forward kinematics.
    #[allow(clippy::too_many_lines)] // one walk along the chain
    pub(crate) fn new(body: &Body, q: &[f64; DOF]) -> Self {
        const X: usize = 0;
        const Y: usize = 1;
        const Z: usize = 2;
        let zero = Vector3::zeros();
        let (mut axis, mut origin) = ([zero; DOF], [zero; DOF]);
        let mut joint = |frame: &mut Matrix3<f64>, i: usize, about: usize, sign: f64, at| {
            axis[i] = frame.column(about) * sign;
            origin[i] = at;
            *frame = turned(frame, about, sign * q[i]);
        };
        let up = |frame: &Matrix3<f64>| -> Vector3<f64> { frame.column(2).into_owned() };

        let mut frame = Matrix3::identity();
        let ankle = Vector3::new(0.0, 0.0, body.ankle);
        joint(&mut frame, 0, Y, 1.0, ankle);
        let shank = up(&frame) * body.shank;
        let knee = ankle + shank;
        joint(&mut frame, 1, Y, -1.0, knee);
        let thigh = up(&frame) * body.thigh;
        let hip = knee + thigh;
        joint(&mut frame, 2, Y, 1.0, hip);
        let pelvis = up(&frame) * body.pelvis;
        let lumbar = hip + pelvis;
        joint(&mut frame, 3, Y, 1.0, lumbar);
        joint(&mut frame, 4, X, -1.0, lumbar);
        joint(&mut frame, 5, Z, 1.0, lumbar);
        let thorax = up(&frame) * body.thorax;
        let neck = lumbar + thorax;
        let across = frame.column(1) * body.shoulder_half_width;
        let shoulders = lumbar + up(&frame) * body.shoulder;
        let (shoulder, other_shoulder) = (shoulders - across, shoulders + across);

        let mut head = frame;
        joint(&mut head, 6, Y, 1.0, neck);
        joint(&mut head, 7, Z, 1.0, neck);
        let eye = neck + head.column(2) * body.eye[0] + head.column(0) * body.eye[1];

        joint(&mut frame, 8, Y, -1.0, shoulder);
        joint(&mut frame, 9, X, -1.0, shoulder);
        joint(&mut frame, 10, Z, 1.0, shoulder);
        let upper_arm = up(&frame) * -body.upper_arm;
        let elbow = shoulder + upper_arm;
        joint(&mut frame, 11, Y, -1.0, elbow);
        joint(&mut frame, 12, Z, 1.0, elbow);
        let forearm = up(&frame) * -body.forearm;
        let wrist = elbow + forearm;
        joint(&mut frame, 13, X, 1.0, wrist);
        joint(&mut frame, 14, Y, 1.0, wrist);
        let hand = wrist - up(&frame) * body.grip;

        let hand_mass = mass::HAND + body.load;
        let hand_moment = hand * hand_mass;
        let fore_mass = hand_mass + mass::FOREARM;
        let fore_moment = hand_moment + (elbow + forearm * mass::FOREARM_COM) * mass::FOREARM;
        let arm_mass = fore_mass + mass::UPPER_ARM;
        let arm_moment =
            fore_moment + (shoulder + upper_arm * mass::UPPER_ARM_COM) * mass::UPPER_ARM;
        let head_moment = (neck + head.column(2) * body.eye[0]) * mass::HEAD;
        // The other arm hangs from its shoulder and acts there as a force. Its length only lowers
        // the body's centre of mass.
        let hanging = mass::UPPER_ARM * mass::UPPER_ARM_COM * body.upper_arm
            + mass::FOREARM * (body.upper_arm + mass::FOREARM_COM * body.forearm)
            + mass::HAND * (body.upper_arm + body.forearm + body.grip);
        let other_arm = other_shoulder * mass::ARM;
        let upper_mass = arm_mass + mass::HEAD + mass::ARM + mass::THORAX;
        let upper_moment = arm_moment
            + head_moment
            + other_arm
            + (lumbar + thorax * mass::THORAX_COM) * mass::THORAX;
        let hip_mass = upper_mass + mass::PELVIS;
        let hip_moment = upper_moment + (hip + pelvis * mass::PELVIS_COM) * mass::PELVIS;
        let knee_mass = hip_mass + 2.0 * mass::THIGH;
        let knee_moment = hip_moment + (knee + thigh * mass::THIGH_COM) * (2.0 * mass::THIGH);
        let ankle_mass = knee_mass + 2.0 * mass::SHANK;
        let ankle_moment = knee_moment + (ankle + shank * mass::SHANK_COM) * (2.0 * mass::SHANK);
        // The foot's midpoint is a quarter of its length ahead of the ankle.
        let feet = Vector3::new(0.25 * body.foot, 0.0, 0.5 * body.ankle) * (2.0 * mass::FOOT);

        Self {
            axis,
            origin,
            moved_mass: [
                ankle_mass,
                knee_mass,
                hip_mass,
                upper_mass,
                upper_mass,
                upper_mass,
                mass::HEAD,
                mass::HEAD,
                arm_mass,
                arm_mass,
                arm_mass,
                fore_mass,
                fore_mass,
                hand_mass,
                hand_mass,
            ],
            moved_moment: [
                ankle_moment,
                knee_moment,
                hip_moment,
                upper_moment,
                upper_moment,
                upper_moment,
                head_moment,
                head_moment,
                arm_moment,
                arm_moment,
                arm_moment,
                fore_moment,
                fore_moment,
                hand_moment,
                hand_moment,
            ],
            total: (ankle_mass + 2.0 * mass::FOOT, ankle_moment + feet - Vector3::z() * hanging),
            knee,
            hip,
            lumbar,
            neck,
            eye,
            shoulder,
            other_shoulder,
            elbow,
            wrist,
            hand,
            head,
            palm: frame,
        }
    }

    /// Returns the derivative of the first moment of the moved mass with respect to joint i.
    pub(crate) fn moment_rate(&self, i: usize) -> Vector3<f64> {
        self.axis[i].cross(&(self.moved_moment[i] - self.origin[i] * self.moved_mass[i]))
    }

    /// Returns the moment arm of the mass beyond joint i about that joint: mass × (centre - joint).
    pub(crate) fn lever(&self, i: usize) -> Vector3<f64> {
        self.moved_moment[i] - self.origin[i] * self.moved_mass[i]
    }
}

#[cfg(test)]
mod tests {
    use super::mass::{ARM, FOOT, HEAD, PELVIS, SHANK, THIGH, THORAX};

    #[test]
    fn segment_masses_add_up_to_the_body() {
        let sum = 2.0 * (ARM + FOOT + SHANK + THIGH) + HEAD + THORAX + PELVIS;
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
}
