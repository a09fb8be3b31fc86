//! The posture of a person whose joints were measured.

mod filter;

use nalgebra::Vector3;

use crate::posture::Posture;
use crate::side::Side;

pub use filter::PostureFilter;

/// The elbow has to be bent by so much for the forearm to tell how the upper arm is turned \[rad\].
const BENT: f64 = 0.4;

/// Where the joints of a person were seen \[m\], in any frame with z up; `None` where they were not.
/// Pairs are left before right.
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
    /// Between the shoulders.
    pub neck: Option<Vector3<f64>>,
    /// Between the hips.
    pub pelvis: Option<Vector3<f64>>,
    /// Tip of the nose.
    pub nose: Option<Vector3<f64>>,
    /// Ears.
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

/// A posture as far as it was seen. Angles that were not are zero, the neutral posture.
///
/// The wrist's angles and the forearm's twist never are, nor what the sheets ask beside the posture:
/// loads, holds, supported arms, raised shoulders, how long and how often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPosture {
    /// The angles.
    pub posture: Posture,
    seen: [bool; Posture::LEN],
}

impl MeasuredPosture {
    /// The names of the angles that were not seen.
    pub fn unseen(&self) -> impl Iterator<Item = &'static str> + '_ {
        Posture::NAMES.into_iter().zip(self.seen).filter(|(_, seen)| !seen).map(|(name, _)| name)
    }
}

impl JointPositions {
    /// Number of joints.
    pub const LEN: usize = 17;

    /// The positions in the order in which the fields are declared.
    pub fn to_array(&self) -> [Option<Vector3<f64>>; Self::LEN] {
        let Self { neck, pelvis, nose, ears, shoulders, elbows, wrists, hips, knees, ankles } =
            *self;
        let [[a, b], [c, d], [e, f], [g, h], [i, j], [k, l], [m, n]] =
            [ears, shoulders, elbows, wrists, hips, knees, ankles];
        [neck, pelvis, nose, a, b, c, d, e, f, g, h, i, j, k, l, m, n]
    }

    /// The inverse of [`JointPositions::to_array`].
    pub fn from_array(positions: [Option<Vector3<f64>>; Self::LEN]) -> Self {
        let [neck, pelvis, nose, a, b, c, d, e, f, g, h, i, j, k, l, m, n] = positions;
        let [ears, shoulders, elbows, wrists, hips, knees, ankles] =
            [[a, b], [c, d], [e, f], [g, h], [i, j], [k, l], [m, n]];
        Self { neck, pelvis, nose, ears, shoulders, elbows, wrists, hips, knees, ankles }
    }

    /// The posture, with the arm of one side; `None` where neck, pelvis or both pairs of shoulders and
    /// hips were not seen, or for positions that are not finite. The middle of a pair stands in for the
    /// neck and the pelvis.
    ///
    /// The trunk's axis is from pelvis to neck, its left from the right to the left shoulder, or hip;
    /// the upper arm's flexion and abduction are those of [`crate::Skeleton`]; the neck's flexion is
    /// the inclination of the line from neck to the middle of the ears against the trunk's; of the
    /// knees the more bent one counts.
    pub fn posture(&self, side: Side) -> Option<MeasuredPosture> {
        let trunk = Trunk::of(self)?;
        let side_index = usize::from(side == Side::Right);
        let pick = |pair: &[Option<Vector3<f64>>; 2]| pair.get(side_index).copied().flatten();
        let between = |from: Option<Vector3<f64>>, to: Option<Vector3<f64>>| Some(to? - from?);
        let upper = between(pick(&self.shoulders), pick(&self.elbows));
        let fore = between(pick(&self.elbows), pick(&self.wrists));
        let arm = upper.and_then(|upper| Arm::of(&trunk, &upper, side));
        let head = middle(&self.ears).or(self.nose);
        let neck = between(self.neck, head).and_then(|line| trunk.local(&line));
        let face = between(middle(&self.ears), self.nose).and_then(|line| trunk.local(&line));
        let hips = between(self.hips[1], self.hips[0]);
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
            Some(trunk.flexion),
            Some(trunk.side),
            hips.map(|hips| trunk.twist(&hips)),
            neck.map(|neck| neck.x.atan2(neck.z)),
            neck.map(|neck| neck.y.atan2(neck.z)),
            face.map(|face| face.y.atan2(face.x)),
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
            seen: angles.map(|angle| angle.is_some()),
        })
    }
}

/// The trunk: its axes and how it is inclined.
struct Trunk {
    forward: Vector3<f64>,
    left: Vector3<f64>,
    up: Vector3<f64>,
    /// Horizontal, from the right to the left shoulder.
    shoulders: Vector3<f64>,
    flexion: f64,
    side: f64,
}

impl Trunk {
    fn of(joints: &JointPositions) -> Option<Self> {
        let pelvis = joints.pelvis.or_else(|| between(&joints.hips))?;
        let neck = joints.neck.or_else(|| between(&joints.shoulders))?;
        let up = unit(&(neck - pelvis))?;
        let pair = |[left, right]: [Option<Vector3<f64>>; 2]| Some(left? - right?);
        let across = pair(joints.shoulders).or_else(|| pair(joints.hips))?;
        let level = unit(&Vector3::new(across.x, across.y, 0.0))?;
        let ahead = level.cross(&Vector3::z());
        let forward = unit(&level.cross(&up))?;
        let flexion = up.dot(&ahead).atan2(up.z);
        let side = up.dot(&level).clamp(-1.0, 1.0).asin();
        Some(Self { forward, left: up.cross(&forward), up, shoulders: level, flexion, side })
    }

    /// A direction in the trunk's axes: x forward, y left, z along the trunk.
    fn local(&self, line: &Vector3<f64>) -> Option<Vector3<f64>> {
        let line = unit(line)?;
        Some(Vector3::new(line.dot(&self.forward), line.dot(&self.left), line.dot(&self.up)))
    }

    /// From the line of the hips to that of the shoulders about the vertical, to the left positive.
    fn twist(&self, hips: &Vector3<f64>) -> f64 {
        let cross = hips.x * self.shoulders.y - hips.y * self.shoulders.x;
        cross.atan2(hips.x * self.shoulders.x + hips.y * self.shoulders.y)
    }
}

/// The upper arm against the trunk.
struct Arm {
    flexion: f64,
    abduction: f64,
    /// Where the forearm goes from an elbow bent by a right angle, with the arm not turned, and the
    /// inside of it.
    ahead: Vector3<f64>,
    inside: Vector3<f64>,
}

impl Arm {
    fn of(trunk: &Trunk, upper: &Vector3<f64>, side: Side) -> Option<Self> {
        let outward = trunk.left * side.sign();
        let along = unit(upper)?;
        let flexion = along.dot(&trunk.forward).atan2(-along.dot(&trunk.up));
        let abduction = along.dot(&outward).clamp(-1.0, 1.0).asin();
        // Flexion turns about the trunk's left, abduction about the axis that it leaves forward.
        let ahead = trunk.forward * flexion.cos() + trunk.up * flexion.sin();
        let inside = along.cross(&ahead) * side.sign();
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
