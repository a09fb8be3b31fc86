//! Postures of people whose joints were measured.

mod direction;
mod filter;
mod neutral;
mod support;
mod trunk;

use nalgebra::Vector3;

use crate::posture::Posture;
use crate::reba::LegSupport;
use crate::side::Side;
use crate::upper_arm::UpperArm;
use neutral::Landmark;
use support::is_sitting;
use trunk::Trunk;

pub use filter::PostureFilter;
pub use neutral::{NeutralEstimate, NeutralPosture};

/// Smallest elbow flexion at which the forearm shows the rotation of the upper arm \[rad\].
const BENT: f64 = 0.4;

/// Measured positions of a person's joints \[m\], in any frame with z up. `None` stands for a joint
/// that was not seen. In pairs, left comes before right.
///
/// ```
/// use ergo_map::{JointPositions, Side};
/// use nalgebra::Vector3;
///
/// let joints = JointPositions {
///     neck: Some(Vector3::new(0.25, 0.0, 1.33)),
///     pelvis: Some(Vector3::new(0.0, 0.0, 0.9)),
///     shoulders: [Some(Vector3::new(0.25, 0.2, 1.33)), Some(Vector3::new(0.25, -0.2, 1.33))],
///     ..JointPositions::default()
/// };
/// let measured = joints.posture(Side::Right).expect("the trunk is seen");
/// assert!((measured.posture.trunk_flexion - (0.25_f64 / 0.43).atan()).abs() < 1e-9);
/// // Nobody saw the arm, and nobody ever sees a wrist's flexion in these joints.
/// assert!(measured.unseen().any(|name| name == "elbow_flexion"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointPositions {
    /// The middle between the shoulders.
    pub neck: Option<Vector3<f64>>,
    /// The middle between the hips.
    pub pelvis: Option<Vector3<f64>>,
    /// Tip of the nose.
    pub nose: Option<Vector3<f64>>,
    /// Ears, left before right.
    pub ears: [Option<Vector3<f64>>; 2],
    /// Shoulders.
    pub shoulders: [Option<Vector3<f64>>; 2],
    /// Elbows.
    pub elbows: [Option<Vector3<f64>>; 2],
    /// Wrists.
    pub wrists: [Option<Vector3<f64>>; 2],
    /// Hips.
    pub hips: [Option<Vector3<f64>>; 2],
    /// Knees.
    pub knees: [Option<Vector3<f64>>; 2],
    /// Ankles.
    pub ankles: [Option<Vector3<f64>>; 2],
}

/// A posture as far as it was seen. Angles that were not seen are zero, the neutral posture.
///
/// The wrist's angles and the forearm's twist are never seen. Nor are the other inputs of the
/// sheets: loads, coupling, supported arms, raised shoulders, durations and repetitions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPosture {
    /// The angles.
    pub posture: Posture,
    /// Support of the body. It is [`LegSupport::Sitting`] if the body could not balance over its
    /// feet, otherwise [`LegSupport::Bilateral`]. A [`PostureFilter`] also detects
    /// [`LegSupport::Walking`].
    pub support: LegSupport,
    seen: [bool; Posture::LEN],
}

impl MeasuredPosture {
    /// Names of the angles that were not seen.
    pub fn unseen(&self) -> impl Iterator<Item = &'static str> + '_ {
        Posture::NAMES.into_iter().zip(self.seen).filter(|(_, seen)| !seen).map(|(name, _)| name)
    }
}

impl JointPositions {
    /// Number of joints.
    pub const LEN: usize = 17;

    /// Returns the positions \[m\] in the order of the fields.
    pub fn to_array(&self) -> [Option<Vector3<f64>>; Self::LEN] {
        let Self { neck, pelvis, nose, ears, shoulders, elbows, wrists, hips, knees, ankles } =
            *self;
        let [[a, b], [c, d], [e, f], [g, h], [i, j], [k, l], [m, n]] =
            [ears, shoulders, elbows, wrists, hips, knees, ankles];
        [neck, pelvis, nose, a, b, c, d, e, f, g, h, i, j, k, l, m, n]
    }

    /// Creates the positions \[m\] from an array. This is the inverse of
    /// [`JointPositions::to_array`].
    pub fn from_array(positions: [Option<Vector3<f64>>; Self::LEN]) -> Self {
        let [neck, pelvis, nose, a, b, c, d, e, f, g, h, i, j, k, l, m, n] = positions;
        let [ears, shoulders, elbows, wrists, hips, knees, ankles] =
            [[a, b], [c, d], [e, f], [g, h], [i, j], [k, l], [m, n]];
        Self { neck, pelvis, nose, ears, shoulders, elbows, wrists, hips, knees, ankles }
    }

    /// Returns the posture relative to an average neutral one: [`JointPositions::posture_from`]
    /// with [`NeutralPosture::default`].
    pub fn posture(&self, side: Side) -> Option<MeasuredPosture> {
        self.posture_from(side, &NeutralPosture::default())
    }

    /// Returns the posture, with the arm of one side, relative to the person's neutral posture.
    ///
    /// `None` if neck, pelvis, or both pairs of shoulders and hips were not seen, or if a position
    /// is not finite. The midpoint of a pair replaces the neck or the pelvis.
    ///
    /// - The trunk's axis is from pelvis to neck. Its inclination is forward in the common
    ///   direction of hips and shoulders. Its twist is from the hips to the shoulders about that
    ///   axis. Its left is from the right to the left shoulder, or hip.
    /// - The upper arm's flexion and abduction are those of [`crate::Skeleton`], with flexion from
    ///   -π/2 to 3π/2.
    /// - The neck's flexion is the inclination of a line relative to the trunk, less the neutral
    ///   inclination. The line is from neck to the midpoint of the ears, or to the nose. One ear
    ///   alone does not show bending or turning of the head.
    /// - Extension of trunk and neck counts from the end of the neutral posture's dead bands.
    /// - The knee with the larger flexion counts.
    pub fn posture_from(&self, side: Side, neutral: &NeutralPosture) -> Option<MeasuredPosture> {
        let trunk = Trunk::of(self)?;
        let side_index = usize::from(side == Side::Right);
        let pick = |pair: &[Option<Vector3<f64>>; 2]| pair.get(side_index).copied().flatten();
        let between = |from: Option<Vector3<f64>>, to: Option<Vector3<f64>>| Some(to? - from?);
        let upper = between(pick(&self.shoulders), pick(&self.elbows));
        let fore = between(pick(&self.elbows), pick(&self.wrists));
        let arm = upper.and_then(|upper| Arm::of(&trunk, &upper, side));
        let head = Head::of(self, &trunk);
        let bend = head.neck.filter(|_| head.tells_bend);
        let knee = [0, 1].map(|leg| {
            let thigh = between(self.hips[leg], self.knees[leg])?;
            let shank = between(self.knees[leg], self.ankles[leg])?;
            angle(&thigh, &shank)
        });
        let elbow = upper.zip(fore).and_then(|(upper, fore)| angle(&upper, &fore));
        let rotation = arm
            .as_ref()
            .zip(fore)
            .zip(elbow)
            .and_then(|((arm, fore), elbow)| (elbow > BENT).then(|| arm.rotation(&fore)));
        let angles = [
            Some(neutral.trunk_flexion(trunk.flexion)),
            Some(trunk.side),
            trunk.twist,
            head.neck.map(|neck| neutral.neck_flexion(neck.x.atan2(neck.z), head.by)),
            bend.map(|neck| neck.y.atan2(neck.z)),
            head.face.map(|face| face.y.atan2(face.x)),
            knee.into_iter().flatten().reduce(f64::max),
            arm.as_ref().map(|arm| arm.flexion),
            arm.as_ref().map(|arm| arm.abduction),
            rotation,
            elbow,
            None,
            None,
            None,
        ];
        let angles = angles.map(|angle: Option<f64>| angle.filter(|angle| angle.is_finite()));
        Some(MeasuredPosture {
            posture: Posture::from_array(angles.map(Option::unwrap_or_default)),
            support: if is_sitting(self) { LegSupport::Sitting } else { LegSupport::Bilateral },
            seen: angles.map(|angle| angle.is_some()),
        })
    }
}

/// The head relative to the trunk.
struct Head {
    /// Direction from the neck to the landmark `by`, in the trunk's axes.
    neck: Option<Vector3<f64>>,
    by: Landmark,
    /// True if that landmark is in the midplane of the head.
    tells_bend: bool,
    /// Direction from the midpoint of both ears to the nose, in the trunk's axes.
    face: Option<Vector3<f64>>,
}

impl Head {
    fn of(joints: &JointPositions, trunk: &Trunk) -> Self {
        let ears = between(&joints.ears);
        let (head, by) = match middle(&joints.ears) {
            Some(ears) => (Some(ears), Landmark::Ears),
            None => (joints.nose, Landmark::Nose),
        };
        let neck = joints.neck.or_else(|| between(&joints.shoulders));
        let line =
            |from: Option<Vector3<f64>>, to: Option<Vector3<f64>>| trunk.local(&(to? - from?));
        Self {
            neck: line(neck, head),
            by,
            tells_bend: ears.is_some() || by == Landmark::Nose,
            face: line(ears, joints.nose),
        }
    }
}

/// The upper arm relative to the trunk.
struct Arm {
    flexion: f64,
    abduction: f64,
    /// Direction of the forearm for a right-angled elbow without rotation of the upper arm, and the
    /// inner direction.
    ahead: Vector3<f64>,
    inside: Vector3<f64>,
}

impl Arm {
    fn of(trunk: &Trunk, upper: &Vector3<f64>, side: Side) -> Option<Self> {
        let along = trunk.local(upper)?;
        let direction = Vector3::new(along.x, along.y * side.sign(), -along.z);
        let [flexion, abduction] = UpperArm::of_vector(&direction)?.angles();
        // Flexion turns about the trunk's left axis, abduction about the axis that is then forward.
        let ahead = trunk.forward * flexion.cos() + trunk.up * flexion.sin();
        let inside = unit(upper)?.cross(&ahead) * side.sign();
        Some(Self { flexion, abduction, ahead, inside })
    }

    fn rotation(&self, fore: &Vector3<f64>) -> f64 {
        fore.dot(&self.inside).atan2(fore.dot(&self.ahead))
    }
}

fn unit(line: &Vector3<f64>) -> Option<Vector3<f64>> {
    line.try_normalize(1e-6).filter(|unit| unit.iter().all(|value| value.is_finite()))
}

fn between([left, right]: &[Option<Vector3<f64>>; 2]) -> Option<Vector3<f64>> {
    Some((left.as_ref()? + right.as_ref()?) * 0.5)
}

fn middle([left, right]: &[Option<Vector3<f64>>; 2]) -> Option<Vector3<f64>> {
    match (left, right) {
        (Some(left), Some(right)) => Some((left + right) * 0.5),
        (one, other) => one.or(*other),
    }
}

fn angle(one: &Vector3<f64>, other: &Vector3<f64>) -> Option<f64> {
    Some(unit(one)?.dot(&unit(other)?).clamp(-1.0, 1.0).acos())
}
