//! REBA and RULA of a person whose joints were measured.

use ergo_map::{
    Conditions, Error, JointPositions, MeasuredPosture, PostureFilter, Reba, Rula, RulaWorksheet,
    Side, Worksheet,
};
use nalgebra::Matrix3;
use vision_models::{Body, Body25};

/// The standard deviation of a joint, each axis, whose covariance is not known (m): of a depth camera 2 m
/// away.
const SIGMA: f64 = 0.025;

/// The scores of a measured posture, with the arm that is worse off.
///
/// What nobody can see counts as on an easy sheet: no load, a good hold, both feet on the floor, nothing
/// held for long or repeated; [`MeasuredPosture::unseen`] names the angles that are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredAssessment {
    /// Whose arm it is.
    pub side: Side,
    /// The angles.
    pub measured: MeasuredPosture,
    /// The REBA score.
    pub reba: Reba,
    /// The RULA score.
    pub rula: Rula,
}

/// Follows the posture of one person from frame to frame and scores it.
///
/// ```
/// use examples::perception::Assessor;
/// use vision_models::Body;
///
/// let mut assessor = Assessor::default();
/// assert_eq!(assessor.update(0.0, &Body::default())?, None);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessor {
    sides: [PostureFilter; 2],
}

impl Default for Assessor {
    fn default() -> Self {
        Self { sides: [Side::Right, Side::Left].map(PostureFilter::new) }
    }
}

impl Assessor {
    /// Takes a frame in, and gives the scores at its time (s); `None` as long as the trunk was not seen
    /// in the last second.
    ///
    /// # Errors
    /// None for a body whose joints are finite.
    pub fn update(&mut self, time: f64, body: &Body) -> Result<Option<MeasuredAssessment>, Error> {
        let (joints, covariances) = (joint_positions(body), covariances(body));
        let [right, left] = &mut self.sides;
        worse(&[
            (Side::Right, right.update(time, &joints, &covariances)),
            (Side::Left, left.update(time, &joints, &covariances)),
        ])
    }
}

/// The scores of a body by itself, as where its joints are without error; `None` where the trunk was not
/// seen.
///
/// # Errors
/// None for a body whose joints are finite.
pub fn assess(body: &Body) -> Result<Option<MeasuredAssessment>, Error> {
    let joints = joint_positions(body);
    worse(&[Side::Right, Side::Left].map(|side| (side, joints.posture(side))))
}

/// The scores of the side that is worse off.
fn worse(
    postures: &[(Side, Option<MeasuredPosture>); 2],
) -> Result<Option<MeasuredAssessment>, Error> {
    let mut worst: Option<MeasuredAssessment> = None;
    for &(side, measured) in postures {
        let Some(measured) = measured else { continue };
        let posture = &measured.posture;
        let reba = Worksheet::from_posture(posture, Conditions::default()).score()?;
        let rula = RulaWorksheet::from_posture(posture).score()?;
        if worst.is_none_or(|worst| (reba.reba, rula.rula) > (worst.reba.reba, worst.rula.rula)) {
            worst = Some(MeasuredAssessment { side, measured, reba, rula });
        }
    }
    Ok(worst)
}

/// Of the joints of [`joint_positions`], in the order of its array (m²).
fn covariances(body: &Body) -> [Matrix3<f64>; JointPositions::LEN] {
    use Body25::{
        LeftAnkle, LeftEar, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck,
        Nose, RightAnkle, RightEar, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    let joints = [
        Neck,
        MidHip,
        Nose,
        LeftEar,
        RightEar,
        LeftShoulder,
        RightShoulder,
        LeftElbow,
        RightElbow,
        LeftWrist,
        RightWrist,
        LeftHip,
        RightHip,
        LeftKnee,
        RightKnee,
        LeftAnkle,
        RightAnkle,
    ];
    let unknown = Matrix3::identity() * SIGMA.powi(2);
    joints.map(|joint| body.covariance(joint).unwrap_or(unknown))
}

fn joint_positions(body: &Body) -> JointPositions {
    use Body25::{
        LeftAnkle, LeftEar, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck,
        Nose, RightAnkle, RightEar, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    let at = |joint: Body25| body.get(joint).map(|keypoint| keypoint.position.coords);
    JointPositions {
        neck: at(Neck),
        pelvis: at(MidHip),
        nose: at(Nose),
        ears: [LeftEar, RightEar].map(at),
        shoulders: [LeftShoulder, RightShoulder].map(at),
        elbows: [LeftElbow, RightElbow].map(at),
        wrists: [LeftWrist, RightWrist].map(at),
        hips: [LeftHip, RightHip].map(at),
        knees: [LeftKnee, RightKnee].map(at),
        ankles: [LeftAnkle, RightAnkle].map(at),
    }
}
