//! Every threshold and gain of the controller, with its default.

use ahqp_core::Budget;
use ergo_map::{Person, Region, Side};
use hrsw::{Bounds, FollowerSettings, HoldSettings};
use hrsw_safety::{ClockSettings, SafetySettings};
use nalgebra::{UnitQuaternion, Vector3, Vector6};
use vision_models::TrackerSettings;

use crate::error::Error;
use crate::held_object::HandSettings;
use crate::intention::IntentionSettings;
use crate::leash::LeashSettings;
use crate::motion_limits::MecanumBase;
use crate::robot::moca::{MOCA_BASE_JOINTS, MOCA_HOME, MOCA_TOOL};
use crate::robot::moca_safety::moca_safety;
use crate::singularity::SingularitySettings;
use crate::stack::PostureSettings;

/// Above it a tracking error of a period is overshot, at any period that a controller is run with \[1/s\].
const HIGHEST_GAIN: f64 = 1e3;
/// Nobody sees farther ahead \[s\].
const LONGEST_HORIZON: f64 = 100.0;
/// More rows of one kind than a hierarchy is solved with in time.
const MOST_ROWS: usize = 1000;

/// Checks a number of rows, before memory is taken for them.
///
/// # Errors
/// [`Error::Setting`].
pub(crate) fn check_count(name: &'static str, count: usize) -> Result<(), Error> {
    if count > MOST_ROWS {
        #[expect(clippy::cast_precision_loss, reason = "it is shown")]
        let value = count as f64;
        return Err(Error::Setting { name, value, expected: "at most 1000" });
    }
    Ok(())
}

/// What the third level of the stack minimises while person and robot work together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Goal {
    /// The person's ergonomics, e_s (the paper's Sec. III-B).
    #[default]
    Ergonomics,
    /// ‖ẋ_d‖², the benchmark of the paper's Experiments 3 and 4.
    LeastMotion,
}

/// The shared workspace in the person's frame H (origin on the floor below the pelvis, x
/// forward, y left, z up).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SpaceSettings {
    /// Least position of the hand \[m\]. Default: that of the work zone of the right hand of a
    /// person of 1.75 m, (0.2, −0.5, 0.7).
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::vector"),
        schemars(with = "[f64; 3]")
    )]
    pub min: Vector3<f64>,
    /// Greatest position of the hand \[m\]. Default (0.75, 0.2, 1.6625).
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::vector"),
        schemars(with = "[f64; 3]")
    )]
    pub max: Vector3<f64>,
    /// The tool's preferred orientation in the person's frame. Default: its x axis towards the
    /// person, its z axis down.
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::rotation"),
        schemars(with = "[f64; 4]")
    )]
    pub tool: UnitQuaternion<f64>,
    /// Half the range of each rotation coordinate about it \[rad\]. Default 0.35.
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::vector"),
        schemars(with = "[f64; 3]")
    )]
    pub turn: Vector3<f64>,
    /// How far the workspace leads the person in the direction in which they walk \[m\].
    /// Default 0.08.
    pub lead: f64,
    /// How far the robot, where it works with somebody who stands, counts as being from the nearest part of them
    /// that it may not touch \[m\]. When they walk away from the robot, and its separation asks for more at their
    /// speed, the workspace falls behind by the difference ([`Headway`](hrsw_safety::Headway)). The larger it is, the
    /// nearer to them the workspace stays, and the farther back in it the robot. Default 0.4, with which the robot
    /// kept its place best in the walks of `experiment following`.
    pub clearance: f64,
    /// How far within the workspace the tool is kept \[m or rad\], so that what is not known of the person's
    /// place does not carry it out; at most half of the narrowest range. Default 0.02.
    pub margin: f64,
    /// Room for rows of the position; a change between two kinds of shape needs as many as both
    /// together. Default 6, a box.
    pub position_rows: usize,
    /// Room for rows of the orientation. Default 6, a box.
    pub orientation_rows: usize,
}

impl SpaceSettings {
    /// The same settings with the work zone of a person who works with the hand of this side.
    #[must_use]
    pub fn for_person(self, person: &Person, side: Side) -> Self {
        let zone = Region::work_zone(person.stature(), side);
        Self { min: *zone.min(), max: *zone.max(), ..self }
    }
}

impl Default for SpaceSettings {
    fn default() -> Self {
        let half_turn = std::f64::consts::PI;
        Self {
            min: Vector3::new(0.2, -0.5, 0.7),
            max: Vector3::new(0.75, 0.2, 1.6625),
            tool: UnitQuaternion::from_axis_angle(&Vector3::y_axis(), half_turn),
            turn: Vector3::repeat(0.35),
            lead: 0.08,
            clearance: 0.4,
            margin: 0.02,
            position_rows: 6,
            orientation_rows: 6,
        }
    }
}

/// What happens when nothing is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct StaleSettings {
    /// Age of the newest body from which on the robot comes to rest \[s\]. Until then, once the
    /// tracker has lost the person, the workspace is frozen. Default 1.5.
    pub rest_after: f64,
    /// How long slowing down, and speeding up again, take \[s\]. Default 0.5.
    pub ramp: f64,
}

impl Default for StaleSettings {
    fn default() -> Self {
        Self { rest_after: 1.5, ramp: 0.5 }
    }
}

/// Limits of the desired pose's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct DesiredMotion {
    /// Speed along each axis \[m/s\]. Default 0.5.
    pub velocity: f64,
    /// Acceleration, ‖ẍ_d‖ \[m/s²\]. Default 4.5.
    pub acceleration: f64,
    /// Angular speed about each axis \[rad/s\]. Default 1.0.
    pub angular_velocity: f64,
    /// Angular acceleration, its norm \[rad/s²\]. Default 9.0.
    pub angular_acceleration: f64,
}

impl Default for DesiredMotion {
    fn default() -> Self {
        Self { velocity: 0.5, acceleration: 4.5, angular_velocity: 1.0, angular_acceleration: 9.0 }
    }
}

impl DesiredMotion {
    /// The accelerations along and about each axis that keep their norms within the limits.
    pub(crate) fn axis_accelerations(&self) -> [f64; 2] {
        [self.acceleration, self.angular_acceleration].map(|limit| limit / 3.0_f64.sqrt())
    }
}

/// The controller's settings.
///
/// ```
/// use moca_model::{ControllerSettings, Goal};
///
/// let benchmark = ControllerSettings { goal: Goal::LeastMotion, ..ControllerSettings::default() };
/// assert!(benchmark.validate().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ControllerSettings {
    /// The link or frame that is the tool. Default MOCA's, [`MOCA_TOOL`].
    pub tool: String,
    /// The control period Δt \[s\]. Default 0.001.
    pub period: f64,
    /// The diagonal of K_p \[1/s\]. Default 30.
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::vector"),
        schemars(with = "[f64; 6]")
    )]
    pub gain: Vector6<f64>,
    /// The horizon τ of workspace and ergonomics \[s\]; at least the velocity limit over the
    /// acceleration limit of the desired pose. Default 0.4.
    pub horizon: f64,
    /// The third level.
    pub goal: Goal,
    /// How long the goal takes to come in and to go \[s\]. Default 0.5.
    pub activation_time: f64,
    /// Limits of ẋ_d and ẍ_d.
    pub desired: DesiredMotion,
    /// The shared workspace.
    pub space: SpaceSettings,
    /// Where the person's hand is when they work on what the robot holds.
    pub hand: HandSettings,
    /// Where the on-board camera is, in the frame of the base on the floor \[m\], to take from the surface that
    /// it recognises which surface is on which side of the object. Default none: the object's own word
    /// is taken.
    pub on_board_camera: Option<[f64; 3]>,
    /// The wheel limit, for robots whose first three joints are a mecanum base. Default MOCA's.
    pub base: Option<MecanumBase>,
    /// How the joints but the base's, all without a [`base`](Self::base), slow down near singular configurations; none
    /// to let them race there. Default that of [`SingularitySettings`].
    pub singularity: Option<SingularitySettings>,
    /// The posture of the fourth level.
    pub posture: PostureSettings,
    /// What solving the stack may cost a tick; where it runs out, [`Fault::IterationLimit`](hrsw_safety::Fault::IterationLimit) says so,
    /// limits hold, and the next tick goes on. Default: the solver's iterations, in any time.
    pub budget: Budget,
    /// When actions become intentions.
    pub intention: IntentionSettings,
    /// The body tracker. Default: that of vision-models with joints that are known to 0.02 m, to which Z_d of
    /// [`SafetySettings`] belongs.
    pub tracker: TrackerSettings,
    /// How the person's frame follows the tracked body.
    pub follower: FollowerSettings,
    /// When it is held, for somebody who stands.
    pub hold: HoldSettings,
    /// What happens when nothing is seen.
    pub stale: StaleSettings,
    /// When the times of ticks and camera frames are faults.
    pub clock: ClockSettings,
    /// How far the commanded state may run ahead of the measured one.
    pub leash: LeashSettings,
    /// Separation from people and from the robot itself.
    pub safety: SafetySettings,
}

impl Default for ControllerSettings {
    fn default() -> Self {
        let base = |base: f64, arm: f64| -> Vec<f64> {
            (0..MOCA_HOME.len()).map(|i| if i < MOCA_BASE_JOINTS { base } else { arm }).collect()
        };
        Self {
            tool: MOCA_TOOL.to_owned(),
            period: 1e-3,
            gain: Vector6::repeat(30.0),
            horizon: 0.4,
            goal: Goal::default(),
            activation_time: 0.5,
            desired: DesiredMotion::default(),
            space: SpaceSettings::default(),
            hand: HandSettings::default(),
            on_board_camera: None,
            base: Some(MecanumBase::default()),
            singularity: Some(SingularitySettings::default()),
            posture: PostureSettings {
                configuration: MOCA_HOME.to_vec(),
                gain: base(0.0, 1.0),
                weight: base(0.5, 1.0),
            },
            budget: Budget::default(),
            intention: IntentionSettings::default(),
            tracker: TrackerSettings { position_sigma: 0.02, ..TrackerSettings::default() },
            follower: FollowerSettings::default(),
            hold: HoldSettings::default(),
            stale: StaleSettings::default(),
            clock: ClockSettings::default(),
            leash: LeashSettings::default(),
            safety: moca_safety(),
        }
    }
}

impl ControllerSettings {
    /// Checks the ranges that no part checks at construction.
    ///
    /// # Errors
    /// [`Error::Setting`] names the first that is out of its range, [`Error::Safety`] one of the
    /// clock's.
    pub fn validate(&self) -> Result<(), Error> {
        let desired = &self.desired;
        for (name, value) in [
            ("period", self.period),
            ("horizon", self.horizon),
            ("activation_time", self.activation_time),
            ("desired.velocity", desired.velocity),
            ("desired.acceleration", desired.acceleration),
            ("desired.angular_velocity", desired.angular_velocity),
            ("desired.angular_acceleration", desired.angular_acceleration),
            ("stale.rest_after", self.stale.rest_after),
            ("stale.ramp", self.stale.ramp),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "positive and finite" });
            }
        }
        for (name, value) in
            [("space.lead", self.space.lead), ("space.clearance", self.space.clearance)]
        {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "finite and not negative" });
            }
        }
        if let Some(&value) = self.gain.iter().find(|gain| !(0.0..=HIGHEST_GAIN).contains(*gain)) {
            return Err(Error::Setting { name: "gain", value, expected: "from 0 to 1000 1/s" });
        }
        if self.horizon > LONGEST_HORIZON {
            let (name, value) = ("horizon", self.horizon);
            return Err(Error::Setting { name, value, expected: "at most 100 s" });
        }
        if let Some(base) = &self.base {
            base.validate()?;
        }
        let space = &self.space;
        for (name, rows) in [
            ("space.position_rows", space.position_rows),
            ("space.orientation_rows", space.orientation_rows),
        ] {
            check_count(name, rows)?;
        }
        Bounds::new(space.min, space.max)?;
        Bounds::symmetric(space.turn)?;
        let narrowest = (0.5 * (space.max - space.min)).min().min(space.turn.min());
        if !(0.0..=narrowest).contains(&space.margin) {
            let expected =
                "from 0 to half of the narrowest range of space.min to space.max and space.turn";
            return Err(Error::Setting { name: "space.margin", value: space.margin, expected });
        }
        self.hand.validate()?;
        if let Some(singularity) = &self.singularity {
            singularity.validate()?;
        }
        let camera = self.on_board_camera.unwrap_or_default();
        if let Some(&value) = camera.iter().find(|value| !value.is_finite()) {
            return Err(Error::Setting { name: "on_board_camera", value, expected: "finite" });
        }
        self.clock.validate(self.period)?;
        self.leash.validate()?;
        let [linear, angular] = desired.axis_accelerations();
        let brake = (desired.velocity / linear).max(desired.angular_velocity / angular);
        if self.horizon != self.period && (self.horizon < self.period || self.horizon < brake) {
            return Err(Error::Setting {
                name: "horizon",
                value: self.horizon,
                expected: "the period (the paper's form), or at least velocity over acceleration \
                           of the desired pose, to leave room to brake",
            });
        }
        Ok(())
    }
}
