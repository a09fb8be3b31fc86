//! Torques beside springs and dampers: gravity, Coriolis forces, friction.

use crate::error::{Error, check_size};
use crate::robot::model::Model;
use crate::state::data::Data;

/// The side that adds a part of the torques that a robot needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum CompensatedBy {
    /// The robot adds it to every torque command.
    Robot,
    /// The torque law adds it to every torque that it sends.
    Controller,
    /// No side adds it.
    Nobody,
}

/// The sides that compensate gravity, Coriolis forces and friction. There is no default: gravity that both sides add is
/// as wrong as gravity that neither adds.
///
/// ```
/// use whole_body::torque::{CompensatedBy, Compensation};
///
/// assert_eq!(Compensation::FRANKA.gravity, CompensatedBy::Robot);
/// assert_eq!(Compensation::BARE.gravity, CompensatedBy::Controller);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Compensation {
    /// g(q).
    pub gravity: CompensatedBy,
    /// C(q, q̇) q̇.
    pub coriolis: CompensatedBy,
    /// Friction in the joints. The torque law uses that of the robot's description, at q̇*.
    pub friction: CompensatedBy,
}

impl Compensation {
    /// An interface that adds nothing, such as simulated motors and effort controllers of `ros2_control` on them. The
    /// torque law adds gravity and Coriolis forces.
    pub const BARE: Self = Self {
        gravity: CompensatedBy::Controller,
        coriolis: CompensatedBy::Controller,
        friction: CompensatedBy::Nobody,
    };

    /// Franka robots under libfranka or `franka_ros2`, which add gravity and friction themselves. The torque law
    /// adds Coriolis forces.
    pub const FRANKA: Self = Self {
        gravity: CompensatedBy::Robot,
        coriolis: CompensatedBy::Controller,
        friction: CompensatedBy::Robot,
    };
}

/// The motion of a robot, one element for each entry of q or q̇.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportedMotion<'a> {
    /// q \[rad or m\].
    pub position: &'a [f64],
    /// q̇ \[rad/s or m/s\].
    pub velocity: &'a [f64],
    /// q̈ that the model is to provide \[rad/s² or m/s²\].
    pub acceleration: &'a [f64],
    /// q̇* \[rad/s or m/s\].
    pub commanded: &'a [f64],
    /// Share of C(q, q̇) q̇ that the model is to provide if no side compensates it, 0 to 1.
    pub share: f64,
}

/// The torques of a torque law beside its springs and dampers.
///
/// ```
/// use whole_body::{
///     Data, Description, Model, torque::{Compensation, SupportTorque, SupportedMotion},
/// };
///
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/>
/// #   <link name="tip"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
/// #   <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
/// #   <limit lower="-2" upper="2" velocity="1" effort="50"/></joint></robot>"#, &Description::default())?;
/// let horizontal = [std::f64::consts::FRAC_PI_2];
/// let rest = SupportedMotion {
///     position: &horizontal,
///     velocity: &[0.0],
///     acceleration: &[0.0],
///     commanded: &[0.0],
///     share: 0.0,
/// };
/// let mut data = Data::new(&model);
/// let mut bare = SupportTorque::new(&model, Compensation::BARE, 0.0)?;
/// assert!((bare.update(&mut data, &model, &rest)?[0] + 2.0 * 9.81 * 0.2).abs() < 1e-9);
/// let mut franka = SupportTorque::new(&model, Compensation::FRANKA, 0.0)?;
/// assert_eq!(franka.update(&mut data, &model, &rest)?, [0.0]);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SupportTorque {
    compensation: Compensation,
    rotor_inertia: f64,
    torque: Vec<f64>,
    gravity: Vec<f64>,
    bias: Vec<f64>,
    forces: Vec<f64>,
}

impl SupportTorque {
    /// Creates the torques of the parts that the controller compensates. `rotor_inertia` is the rotors' inertia at the
    /// joints \[kg m²\], which the mass matrix does not contain.
    ///
    /// # Errors
    /// [`Error::Value`] if no side compensates gravity, and for an inertia that is negative or not finite.
    pub fn new(
        model: &Model,
        compensation: Compensation,
        rotor_inertia: f64,
    ) -> Result<Self, Error> {
        if compensation.gravity == CompensatedBy::Nobody {
            let (what, expected) = ("the number of those who compensate gravity", "1");
            return Err(Error::value(what, 0.0, expected));
        }
        if !(rotor_inertia >= 0.0 && rotor_inertia.is_finite()) {
            let (what, expected) = ("the rotors' inertia [kg m²]", "finite and not negative");
            return Err(Error::value(what, rotor_inertia, expected));
        }
        let none = vec![0.0; model.velocity_count()];
        Ok(Self {
            compensation,
            rotor_inertia,
            torque: none.clone(),
            gravity: none.clone(),
            bias: none.clone(),
            forces: none,
        })
    }

    /// Computes the torques for a motion, one for each entry of q̇ \[Nm or N\]. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for the motion. The torques are then unchanged.
    pub fn update(
        &mut self,
        data: &mut Data,
        model: &Model,
        motion: &SupportedMotion<'_>,
    ) -> Result<&[f64], Error> {
        check_size("q̇*", motion.commanded.len(), self.torque.len())?;
        let Compensation { gravity, coriolis, friction } = self.compensation;
        let mut posed = data.pose(model, motion.position)?;
        posed.gravity_into(&mut self.gravity)?;
        let coriolis = match coriolis {
            CompensatedBy::Controller => 1.0,
            CompensatedBy::Robot => 0.0,
            CompensatedBy::Nobody => motion.share,
        };
        let accelerates = motion.acceleration.iter().any(|acceleration| *acceleration != 0.0);
        if coriolis > 0.0 || accelerates {
            let mut moving = posed.moving(motion.velocity)?;
            moving.bias_forces_into(&mut self.bias)?;
            moving.inverse_dynamics_into(motion.acceleration, &[], &mut self.forces)?;
        } else {
            self.bias.copy_from_slice(&self.gravity);
            self.forces.copy_from_slice(&self.gravity);
        }
        let carries = if gravity == CompensatedBy::Controller { 1.0 } else { 0.0 };
        let parts = self.gravity.iter().zip(&self.bias).zip(&self.forces).zip(motion.acceleration);
        for (torque, (((gravity, bias), force), acceleration)) in self.torque.iter_mut().zip(parts)
        {
            let inertia = force - bias + self.rotor_inertia * acceleration;
            *torque = carries * gravity + coriolis * (bias - gravity) + inertia;
        }
        if friction == CompensatedBy::Controller {
            let joints = model.friction.iter().zip(motion.commanded);
            for (torque, (friction, velocity)) in self.torque.iter_mut().zip(joints) {
                *torque += friction.map_or(0.0, |friction| friction.torque(*velocity));
            }
        }
        Ok(&self.torque)
    }

    /// The torques of the last update, one for each entry of q̇ \[Nm or N\].
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }
}
