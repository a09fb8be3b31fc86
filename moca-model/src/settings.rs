//! Thresholds and gains of the controller, with their defaults.

mod mecanum_base;
mod other_robot;
mod stack;

use ahqp_core::{Budget, Stacking};
use ergo_map::{Person, Region, Side};
use hrsw::Bounds;
use hrsw_safety::SafetySettings;
use nalgebra::{UnitQuaternion, Vector3, Vector6};
use vision_models::TrackerSettings;
use whole_body::robot::JointLimits;
use whole_body::torque::FollowingErrorSettings;

use crate::error::{Error, check_not_negative, check_positive, check_settings};
use crate::grasped_object::HandSettings;
use crate::robot::moca::{MOCA_BASE_JOINTS, MOCA_HOME, MOCA_TOOL};
use crate::robot::moca_safety::moca_safety;
pub use mecanum_base::MecanumBase;
pub use stack::{Levels, PostureSettings};

/// Largest gain \[1/s\]. Above it a tracking error would overshoot within a period, at any usual period.
const HIGHEST_GAIN: f64 = 1e3;
/// Longest horizon \[s\].
const LONGEST_HORIZON: f64 = 100.0;
/// The objective of the third level while person and robot work together.
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
    /// Lower corner of the hand's positions \[m\]. The default is the work zone of the right hand of a person of 1.75
    /// m, (0.2, −0.5, 0.7).
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::vector"),
        schemars(with = "[f64; 3]")
    )]
    pub min: Vector3<f64>,
    /// Upper corner of the hand's positions \[m\]. Default (0.75, 0.2, 1.6625).
    #[cfg_attr(
        feature = "serde",
        serde(with = "crate::serial::vector"),
        schemars(with = "[f64; 3]")
    )]
    pub max: Vector3<f64>,
    /// Preferred orientation of the tool in the person's frame. Default: its x axis towards the person, its z axis
    /// down.
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
    /// Distance by which the workspace leads the person in their walking direction \[m\]. Default 0.08.
    pub lead: f64,
    /// Distance by which the tool is kept within the workspace \[m or rad\]. It covers the uncertainty of the person's
    /// place, and is at most half of the narrowest range. Default 0.02.
    pub margin: f64,
}

impl SpaceSettings {
    /// Sets the work zone of a person who works with the hand of this side.
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
            margin: 0.02,
        }
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
    /// The limits along and about each axis.
    pub(crate) fn limits(&self) -> [JointLimits; 6] {
        let [linear, angular] = self.axis_accelerations();
        let limits = |velocity: f64, acceleration: f64| JointLimits {
            velocity,
            acceleration,
            ..JointLimits::UNLIMITED
        };
        let linear = limits(self.velocity, linear);
        let angular = limits(self.angular_velocity, angular);
        [linear, linear, linear, angular, angular, angular]
    }

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
    /// Link or frame of the tool. Default MOCA's, [`MOCA_TOOL`].
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
    /// Objective of the third level.
    pub goal: Goal,
    /// Limits of ẋ_d and ẍ_d.
    pub desired: DesiredMotion,
    /// The shared workspace.
    pub space: SpaceSettings,
    /// Place of the hand of a person who works on the grasped object.
    pub hand: HandSettings,
    /// Place of the on-board camera in the frame of the base on the floor \[m\]. The camera identifies which surface is
    /// on which side of the object. Default `None`, which trusts the object's description.
    pub on_board_camera: Option<[f64; 3]>,
    /// The wheel limit, for robots whose first three joints are a mecanum base. Default MOCA's.
    pub base: Option<MecanumBase>,
    /// Posture of the last level.
    pub posture: PostureSettings,
    /// Levels of the stack besides those of safety. Default all.
    pub levels: Levels,
    /// Method by which later levels keep the optimum of a level. Default elimination.
    pub stacking: Stacking,
    /// Budget of the stack's solution in a tick. If it runs out,
    /// [`Fault::IterationLimit`](hrsw_safety::Fault::IterationLimit) reports it, limits hold, and the next tick
    /// continues. The default limits the solver's iterations but not its time.
    pub budget: Budget,
    /// Limits on the distance between commanded and measured state.
    pub following_error: FollowingErrorSettings,
    /// Separation from people and from the robot itself. Its standard deviation of joints also counts for the person's
    /// frame.
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
            desired: DesiredMotion::default(),
            space: SpaceSettings::default(),
            hand: HandSettings::default(),
            on_board_camera: None,
            base: Some(MecanumBase::default()),
            posture: PostureSettings {
                configuration: MOCA_HOME.to_vec(),
                gain: base(0.0, 1.0),
                weight: base(0.5, 1.0),
            },
            levels: Levels::default(),
            stacking: Stacking::default(),
            budget: Budget::default(),
            following_error: FollowingErrorSettings::default(),
            safety: moca_safety(),
        }
    }
}

impl ControllerSettings {
    /// Returns the settings with the paper's own controller: three levels, the period as the horizon, and ergonomics
    /// that begin at once.
    ///
    /// There is no posture, margin, lead, following distance, and no separation from people or the robot itself. The
    /// person's hand is at the side of the object that they work on, whatever tool they hold. Limits of joints and wheels remain, as does the limit of the following error.
    ///
    /// ```
    /// use moca_model::{ControllerSettings, Levels};
    ///
    /// let settings = ControllerSettings::default().as_in_paper();
    /// assert_eq!((settings.levels, settings.horizon), (Levels::Paper, settings.period));
    /// assert!(settings.validate().is_ok());
    /// ```
    #[must_use]
    pub fn as_in_paper(self) -> Self {
        Self {
            levels: Levels::Paper,
            horizon: self.period,
            space: SpaceSettings { lead: 0.0, margin: 0.0, ..self.space },
            hand: HandSettings { drill: 0.0, polisher: 0.0 },
            safety: self.safety.off(),
            ..self
        }
    }

    /// Parameters by which people are tracked. The tracker sees what counts for safety, and keypoints of less
    /// confidence.
    pub(crate) fn tracker(&self) -> TrackerSettings {
        let position_sigma = self.safety.position_sigma;
        TrackerSettings { position_sigma, ..TrackerSettings::default() }
    }

    /// Checks the ranges that no other part checks at construction.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        let desired = &self.desired;
        check_positive([
            ("period", self.period),
            ("horizon", self.horizon),
            ("desired.velocity", desired.velocity),
            ("desired.acceleration", desired.acceleration),
            ("desired.angular_velocity", desired.angular_velocity),
            ("desired.angular_acceleration", desired.angular_acceleration),
        ])?;
        check_not_negative([("space.lead", self.space.lead)])?;
        let gains = self.gain.iter().map(|&gain| ("gain", gain));
        check_settings(gains, "from 0 to 1000 1/s", |gain| (0.0..=HIGHEST_GAIN).contains(&gain))?;
        let horizon = self.horizon;
        check_settings([("horizon", horizon)], "at most 100 s", |time| time <= LONGEST_HORIZON)?;
        if let Some(base) = &self.base {
            base.validate()?;
        }
        let space = &self.space;
        Bounds::new(space.min, space.max)?;
        Bounds::symmetric(space.turn)?;
        let narrowest = (0.5 * (space.max - space.min)).min().min(space.turn.min());
        check_settings(
            [("space.margin", space.margin)],
            "from 0 to half of the narrowest range of space.min to space.max and space.turn",
            |margin| (0.0..=narrowest).contains(&margin),
        )?;
        self.hand.validate()?;
        let camera = self.on_board_camera.unwrap_or_default().map(|at| ("on_board_camera", at));
        check_settings(camera, "finite", f64::is_finite)?;
        self.following_error.validate()?;
        let [linear, angular] = desired.axis_accelerations();
        let brake = (desired.velocity / linear).max(desired.angular_velocity / angular);
        check_settings(
            [("horizon", horizon)],
            "the period (the paper's form), or at least velocity over acceleration of the desired pose, to leave room \
             to brake",
            |horizon| horizon == self.period || horizon >= self.period.max(brake),
        )
    }
}
