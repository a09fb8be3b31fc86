//! REBA and RULA of a person whose joints were measured.

use ergo_map::{
    Conditions, Error, JointPositions, LegSupport, MeasuredPosture, NeutralEstimate, PostureFilter,
    Reba, Rula, RulaWorksheet, Side, Worksheet,
};
use nalgebra::Matrix3;
use vision_models::{Body, Body25};

/// Standard deviation on each axis of a joint with unknown covariance (m), as for a depth camera 2
/// m away.
const SIGMA: f64 = 0.025;

/// The scores of a measured posture, for the worse arm.
///
/// Facts that a camera cannot see count as favourable: no load, a good grip, and nothing held for
/// long or repeated. [`MeasuredPosture::unseen`] names the missing angles. Walking and sitting are
/// measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredAssessment {
    /// The side of the arm.
    pub side: Side,
    /// The angles.
    pub measured: MeasuredPosture,
    /// The REBA score.
    pub reba: Reba,
    /// The RULA score.
    pub rula: Rula,
}

/// Known facts about a person other than their joints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PostureSettings {
    /// True to score the person as seated. Otherwise sitting is detected by balance.
    pub sitting: bool,
    /// True to score the person's arm as supported.
    pub arm_supported: bool,
    /// Time for which the person stands upright and looks ahead after being seen first (s). Their
    /// angles are measured from this posture. If it is 0, an average neutral posture is used.
    pub upright: f64,
}

/// Longest time for measuring a neutral posture (s).
const LONGEST_UPRIGHT: f64 = 600.0;

impl PostureSettings {
    /// Checks the time and returns the settings.
    ///
    /// # Errors
    /// [`Error`] if the time is negative, above ten minutes or not finite.
    pub fn checked(self) -> Result<Self, Error> {
        let Self { upright: value, .. } = self;
        if (0.0..=LONGEST_UPRIGHT).contains(&value) {
            return Ok(self);
        }
        let wanted = format!("lie in [0, {LONGEST_UPRIGHT}] s");
        Err(Error::Value { what: "upright", got: value, unit: "s", wanted })
    }

    fn conditions(&self, measured: &MeasuredPosture) -> Conditions {
        let support = if self.sitting { LegSupport::Sitting } else { measured.support };
        Conditions { support, arm_supported: self.arm_supported, ..Conditions::default() }
    }
}

/// Filters the posture of one person from frame to frame and scores it.
///
/// ```
/// use human_perception::percepts::Assessor;
/// use vision_models::Body;
///
/// let mut assessor = Assessor::default();
/// assert_eq!(assessor.update(0.0, &Body::default())?, None);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessor {
    settings: PostureSettings,
    sides: [PostureFilter; 2],
    /// The estimate of the person's own neutral posture while it is measured.
    neutral: Option<NeutralEstimate>,
    /// Time when the trunk was first seen (s).
    since: Option<f64>,
}

impl Default for Assessor {
    fn default() -> Self {
        Self::new(PostureSettings::default())
    }
}

impl Assessor {
    /// Creates an assessor for a person who has not been seen yet.
    pub fn new(settings: PostureSettings) -> Self {
        let sides = [Side::Right, Side::Left].map(PostureFilter::new);
        let neutral = (settings.upright > 0.0).then(NeutralEstimate::default);
        Self { settings, sides, neutral, since: None }
    }

    /// Updates the filter with a frame and returns the scores at its time (s). `None` if the trunk
    /// was not seen in the last second.
    ///
    /// # Errors
    /// None if the body's joints are finite.
    pub fn update(&mut self, time: f64, body: &Body) -> Result<Option<MeasuredAssessment>, Error> {
        let (joints, covariances) = (joint_positions(body), covariances(body));
        self.stand_upright(time, &joints);
        let [right, left] = &mut self.sides;
        let postures = [
            (Side::Right, right.update(time, &joints, &covariances)),
            (Side::Left, left.update(time, &joints, &covariances)),
        ];
        worse(&postures, &self.settings)
    }

    /// The sheet that gives the REBA score of an assessment.
    pub fn sheet(&self, assessment: &MeasuredAssessment) -> Worksheet {
        let MeasuredAssessment { measured, .. } = assessment;
        Worksheet::from_posture(&measured.posture, self.settings.conditions(measured))
    }

    /// Measures the person's own neutral posture while it lasts.
    fn stand_upright(&mut self, time: f64, joints: &JointPositions) {
        let Some(estimate) = &mut self.neutral else { return };
        if joints.posture(Side::Right).is_none() {
            return;
        }
        estimate.push(joints);
        if time - *self.since.get_or_insert(time) >= self.settings.upright {
            let own = estimate.neutral();
            self.sides = self.sides.map(|filter| filter.with_neutral(own));
            self.neutral = None;
        }
    }
}

/// Returns the scores of a single body whose joints have no errors. `None` if the trunk was not
/// seen.
///
/// # Errors
/// None if the body's joints are finite.
pub fn assess(body: &Body) -> Result<Option<MeasuredAssessment>, Error> {
    let joints = joint_positions(body);
    let postures = [Side::Right, Side::Left].map(|side| (side, joints.posture(side)));
    worse(&postures, &PostureSettings::default())
}

/// Returns the scores of the worse side.
fn worse(
    postures: &[(Side, Option<MeasuredPosture>); 2],
    settings: &PostureSettings,
) -> Result<Option<MeasuredAssessment>, Error> {
    let mut worst: Option<MeasuredAssessment> = None;
    for &(side, measured) in postures {
        let Some(measured) = measured else { continue };
        let posture = &measured.posture;
        let reba = Worksheet::from_posture(posture, settings.conditions(&measured)).score()?;
        let sheet = RulaWorksheet::from_posture(posture);
        let rula = RulaWorksheet { arm_supported: settings.arm_supported, ..sheet }.score()?;
        if worst.is_none_or(|worst| (reba.reba, rula.rula) > (worst.reba.reba, worst.rula.rula)) {
            worst = Some(MeasuredAssessment { side, measured, reba, rula });
        }
    }
    Ok(worst)
}

/// The joints of [`JointPositions`], in the order of its array.
const JOINTS: [Body25; JointPositions::LEN] = {
    use Body25::{
        LeftAnkle, LeftEar, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck,
        Nose, RightAnkle, RightEar, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    [
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
    ]
};

/// Returns the covariances of the joints (m²).
fn covariances(body: &Body) -> [Matrix3<f64>; JointPositions::LEN] {
    let unknown = Matrix3::identity() * SIGMA.powi(2);
    JOINTS.map(|joint| body.covariance(joint).unwrap_or(unknown))
}

fn joint_positions(body: &Body) -> JointPositions {
    let position = |joint| body.get(joint).map(|keypoint| keypoint.position.coords);
    JointPositions::from_array(JOINTS.map(position))
}
