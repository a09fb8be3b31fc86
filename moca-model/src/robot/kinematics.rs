//! The robot at one configuration, as the stack of tasks sees it.

use hrsw::RobotBody;
use nalgebra::{DMatrix, Isometry3, Matrix6xX};
use whole_body::{Axes, Data, FrameId, Model, Posed};

use super::bodies::{LinkCapsule, RobotBodies};
use super::inertia::InverseInertia;
use crate::error::{Error, check_plain};

/// The robot at one configuration, as the stack of tasks sees it: where the tool is, how the
/// joints move it, where the robot's bodies are.
///
/// ```
/// use moca_model::{Kinematics, MOCA_HOME, MOCA_TOOL, moca};
///
/// let mut robot = Kinematics::new(moca()?, MOCA_TOOL, &[], &MOCA_HOME)?;
/// let mut q = MOCA_HOME;
/// q[0] += 0.5; // the base, 0.5 m forward
/// robot.update(&q)?;
/// assert!((robot.world_from_tool().translation.x - 0.806891).abs() < 1e-6);
/// assert_eq!(robot.jacobian().ncols(), 10);
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Kinematics {
    model: Model,
    data: Data,
    tool: FrameId,
    world_from_tool: Isometry3<f64>,
    jacobian: Matrix6xX<f64>,
    bodies: RobotBodies,
    inertia: InverseInertia,
}

impl Kinematics {
    /// With the link or frame that is the tool, the robot's bodies and its configuration q, n
    /// \[m or rad\].
    ///
    /// # Errors
    /// [`Error::FloatingBase`]; [`Error::Robot`] for a tool or a link that the robot does not have
    /// and for q; [`Error::BodyBesideTheWay`] for a body of which the tool's Jacobian says nothing.
    pub fn new(
        model: Model,
        tool: &str,
        bodies: &[LinkCapsule],
        configuration: &[f64],
    ) -> Result<Self, Error> {
        let n = check_plain(&model)?;
        let tool = model.frame_id(tool)?;
        let mut kinematics = Self {
            data: Data::new(&model),
            tool,
            world_from_tool: Isometry3::identity(),
            jacobian: Matrix6xX::zeros(n),
            inertia: InverseInertia::new(n),
            bodies: RobotBodies::new(&model, tool, bodies)?,
            model,
        };
        kinematics.update(configuration)?;
        Ok(kinematics)
    }

    /// Goes to the configuration q, n \[m or rad\]. Allocates nothing unless q is refused.
    ///
    /// # Errors
    /// [`Error::Robot`] on q unless [`Model::is_configuration`]; all is then as before.
    pub fn update(&mut self, configuration: &[f64]) -> Result<(), Error> {
        let mut posed = self.data.pose(&self.model, configuration)?;
        self.world_from_tool = posed.world_from(self.tool)?;
        posed.jacobian_into(self.tool, Axes::World, &mut self.jacobian)?;
        // Without bodies nothing is touched.
        if !self.bodies.placed().is_empty() {
            self.inertia.update(&mut posed);
        }
        self.bodies.place(&posed)
    }

    /// The robot at its configuration, for tasks to read.
    ///
    /// # Errors
    /// None: there is a configuration from the beginning.
    pub fn posed(&mut self) -> Result<Posed<'_>, Error> {
        Ok(self.data.posed(&self.model)?)
    }

    /// The frame of the tool.
    pub fn tool(&self) -> FrameId {
        self.tool
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Pose of the tool in the world.
    pub fn world_from_tool(&self) -> &Isometry3<f64> {
        &self.world_from_tool
    }

    /// The tool's geometric Jacobian, 6 × n: its twist for q̇, linear rows \[m/s\] then angular
    /// ones \[rad/s\], in the world's axes, at the tool's origin.
    pub fn jacobian(&self) -> &Matrix6xX<f64> {
        &self.jacobian
    }

    /// M⁻¹, the inverse of the joint-space inertia, n × n \[1/kg, 1/(kg m²)\]; none for a robot without
    /// bodies, or with a joint that moves no mass.
    pub fn inverse_inertia(&self) -> Option<&DMatrix<f64>> {
        self.inertia.get()
    }

    /// The robot's bodies in the world.
    pub fn bodies(&self) -> &[RobotBody] {
        self.bodies.placed()
    }
}
