//! Settings of robots other than MOCA.

use hrsw_safety::{BaseBraking, SafetySettings, SeparationSettings};
use whole_body::torque::Compensation;
use whole_body::{Base, Model};

use super::{ControllerSettings, PostureSettings};
use crate::robot::moca::MOCA_BASE_JOINTS;
use crate::torque::TorqueLoopSettings;

/// Deceleration of a planar base that safety relies on \[m/s²\].
const BASE_DECELERATION: f64 = 0.5;

impl ControllerSettings {
    /// Creates the settings of a robot with this tool. Its configuration `start`, n \[m, rad\], is its posture.
    ///
    /// The robot has no capsules, and so keeps no distance from people until it gets some. A planar base has no limit of
    /// its wheels.
    ///
    /// ```
    /// use moca_model::whole_body::{Description, Model};
    /// use moca_model::{ControllerSettings, MOCA_URDF};
    ///
    /// let arm = Description { root: Some("panda_link0".into()), ..Description::default() };
    /// let model = Model::from_urdf(MOCA_URDF, &arm)?;
    /// let settings = ControllerSettings::of_robot(&model, "panda_tcp", &model.neutral());
    /// assert!(settings.base.is_none() && settings.validate().is_ok());
    /// # Ok::<(), moca_model::whole_body::Error>(())
    /// ```
    pub fn of_robot(model: &Model, tool: &str, start: &[f64]) -> Self {
        let base = base_joints(model);
        let each = |of_base: f64, other: f64| -> Vec<f64> {
            (0..start.len()).map(|joint| if joint < base { of_base } else { other }).collect()
        };
        let braking = BaseBraking { joints: base, deceleration: BASE_DECELERATION };
        let safety = SafetySettings::default();
        let separation =
            SeparationSettings { base: (base > 0).then_some(braking), ..safety.separation };
        Self {
            tool: tool.to_owned(),
            base: None,
            posture: PostureSettings {
                configuration: start.to_vec(),
                gain: each(0.0, 1.0),
                weight: each(0.5, 1.0),
            },
            safety: SafetySettings { separation, ..safety },
            ..Self::default()
        }
    }
}

impl TorqueLoopSettings {
    /// Creates the settings of a robot whose joints take torques, except those of a planar base. The gains are a
    /// Panda's, and so need seven joints.
    pub fn of_robot(model: &Model, compensation: Compensation) -> Self {
        let joints = model.joints().iter().skip(base_joints(model));
        let joints: Vec<_> = joints.map(|joint| joint.name.clone()).collect();
        Self { joints, ..Self::new(compensation) }
    }
}

/// The number of joints of a planar base.
fn base_joints(model: &Model) -> usize {
    if model.base() == Base::Planar { MOCA_BASE_JOINTS } else { 0 }
}
