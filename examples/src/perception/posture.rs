//! REBA and RULA of a person whose joints were measured.

use ergo_map::{
    Conditions, Error, JointPositions, MeasuredPosture, Reba, Rula, RulaWorksheet, Side, Worksheet,
};
use vision_models::{Body, Body25};

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

/// The scores of a body; `None` where the trunk was not seen.
///
/// # Errors
/// None for a body whose joints are finite.
pub fn assess(body: &Body) -> Result<Option<MeasuredAssessment>, Error> {
    let joints = joint_positions(body);
    let mut worst: Option<MeasuredAssessment> = None;
    for side in [Side::Right, Side::Left] {
        let Some(measured) = joints.posture(side) else { continue };
        let posture = &measured.posture;
        let reba = Worksheet::from_posture(posture, Conditions::default()).score()?;
        let rula = RulaWorksheet::from_posture(posture).score()?;
        if worst.is_none_or(|worst| (reba.reba, rula.rula) > (worst.reba.reba, worst.rula.rula)) {
            worst = Some(MeasuredAssessment { side, measured, reba, rula });
        }
    }
    Ok(worst)
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
