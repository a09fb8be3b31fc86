//! Speed and separation monitoring, following ISO/TS 15066 as described in Marvel and Norcross,
//! "Implementing speed and separation monitoring in collaborative robot workcells" (2017).

use crate::error::{Error, not_negative, positive};

/// Braking of the mobile base under an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BaseBraking {
    /// Number of the base's joints, counted from the first.
    pub joints: usize,
    /// Deceleration of the base's joints \[m/s²\].
    pub deceleration: f64,
}

/// Below this speed of approach the base counts as moving, since it is not known which joints move
/// next \[m/s\].
const CREEP: f64 = 0.02;

/// Terms of the protective separation distance.
///
/// ```
/// use hrsw_safety::SeparationSettings;
///
/// let settings = SeparationSettings::default();
/// let speed = settings.approach_limit(1.0, 1.6);
/// // At the largest speed allowed the distance is just the protective one.
/// assert!((settings.protective_distance(1.6, speed) - 1.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SeparationSettings {
    /// Speed v_h of a person's body towards the robot if it is not measured \[m/s\]. Default 1.6,
    /// the speed of walking of ISO 13855.
    pub human_speed: f64,
    /// Speed of hands and arms towards the robot if it is not measured \[m/s\]. Default 2.0, the
    /// speed of reaching of ISO 13855.
    pub arm_speed: f64,
    /// Reaction time T_r from the person's motion to the robot's first reaction, including the
    /// latency of perception \[s\]. Default 0.15: a frame at 20 Hz and 0.1 s of recognition.
    pub reaction_time: f64,
    /// Deceleration a of the robot along the line between the two bodies \[m/s²\]. Default 2.0.
    pub deceleration: f64,
    /// Braking of the first joints, if it differs from that of the others. Default none.
    pub base: Option<BaseBraking>,
    /// Intrusion distance C that a part of the body may reach in before it is seen \[m\]. Default
    /// 0.1.
    pub intrusion: f64,
    /// Uncertainty Z_d of the person's position \[m\]. Default 0.05.
    pub human_uncertainty: f64,
    /// Uncertainty Z_r of the robot's position \[m\]. Default 0.01.
    pub robot_uncertainty: f64,
}

impl Default for SeparationSettings {
    fn default() -> Self {
        Self {
            human_speed: 1.6,
            arm_speed: 2.0,
            reaction_time: 0.15,
            deceleration: 2.0,
            base: None,
            intrusion: 0.1,
            human_uncertainty: 0.05,
            robot_uncertainty: 0.01,
        }
    }
}

impl SeparationSettings {
    /// Creates terms for two bodies of one robot. Nobody moves unseen, and the reaction takes one
    /// `period` \[s\]. `margin` \[m\] remains between the bodies, which brake at `deceleration`
    /// \[m/s²\].
    pub fn between_own_bodies(period: f64, deceleration: f64, margin: f64) -> Self {
        Self {
            human_speed: 0.0,
            arm_speed: 0.0,
            reaction_time: period,
            deceleration,
            base: None,
            intrusion: margin,
            human_uncertainty: 0.0,
            robot_uncertainty: 0.0,
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first term that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        not_negative("the human speed", self.human_speed)?;
        not_negative("the speed of an arm", self.arm_speed)?;
        positive("the reaction time", self.reaction_time)?;
        positive("the deceleration of the robot", self.deceleration)?;
        if let Some(base) = &self.base {
            positive("the deceleration of the base", base.deceleration)?;
        }
        not_negative("the intrusion distance", self.intrusion)?;
        not_negative("the uncertainty of the person's position", self.human_uncertainty)?;
        not_negative("the uncertainty of the robot's position", self.robot_uncertainty)?;
        Ok(())
    }

    /// Returns the settings for a pair that approaches at `base_speed` by the base and `arm_speed`
    /// by the other joints \[m/s\].
    ///
    /// 1/a is the mean of the reciprocal decelerations, weighted by the speeds. The stopping
    /// distance is then no less than v_b²/(2a_b) + v_a²/(2a_a). The stopping time is no less than
    /// that of either part.
    #[must_use]
    pub fn braking_by_parts(&self, base_speed: f64, arm_speed: f64) -> Self {
        let Some(base) = &self.base else { return *self };
        let (base_speed, arm_speed) = (base_speed.max(0.0) + CREEP, arm_speed.max(0.0));
        let time = base_speed / base.deceleration + arm_speed / self.deceleration;
        Self { deceleration: (base_speed + arm_speed) / time, ..*self }
    }

    /// Returns the settings with the smallest deceleration of all joints.
    pub(crate) fn braking_worst(&self) -> Self {
        let worst = self.base.map_or(f64::INFINITY, |base| base.deceleration);
        Self { deceleration: self.deceleration.min(worst), ..*self }
    }

    /// Returns S_p = v_h(T_r + T_s) + v_r T_r + v_r²/(2a) + C + Z_d + Z_r with T_s = v_r/a \[m\].
    ///
    /// At this distance a person at `human_speed` towards the robot and a robot at `robot_speed`
    /// towards the person \[m/s\] still end apart. Receding counts as standing.
    pub fn protective_distance(&self, human_speed: f64, robot_speed: f64) -> f64 {
        let (human, robot) = (human_speed.max(0.0), robot_speed.max(0.0));
        let stopping = robot / self.deceleration;
        human * (self.reaction_time + stopping)
            + robot * self.reaction_time
            + 0.5 * robot * stopping
            + self.margin()
    }

    /// Returns the largest speed v_r of the robot towards the person at `distance` \[m\] from them
    /// \[m/s\].
    ///
    /// v_r = −(aT_r + v_h) + √((aT_r + v_h)² + 2aK) with K = d − C − Z_d − Z_r − v_h T_r. The speed
    /// is zero where even a robot at rest is too near.
    pub fn approach_limit(&self, distance: f64, human_speed: f64) -> f64 {
        let human = human_speed.max(0.0);
        let room = distance - self.margin() - human * self.reaction_time;
        if room > 0.0 {
            let slope = self.deceleration * self.reaction_time + human;
            let reach = 2.0 * self.deceleration * room;
            // The root in a form that does not subtract nearly equal numbers.
            reach / (slope + (slope * slope + reach).sqrt())
        } else {
            0.0
        }
    }

    /// Returns C + Z_d + Z_r \[m\].
    fn margin(&self) -> f64 {
        self.intrusion + self.human_uncertainty + self.robot_uncertainty
    }
}
