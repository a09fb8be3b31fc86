//! The robot at one configuration, as the stack of tasks sees it.

use hrsw_safety::{Capsule, JointMotion, LinkCapsule, RobotBody};
use nalgebra::{DMatrix, Isometry3, Matrix6xX, Translation3, Vector3};
use whole_body::state::PayloadId;
use whole_body::{Axes, Data, FrameId, Model, Posed};

use super::bodies::RobotBodies;
use super::inertia::InverseInertia;
use crate::error::{Error, check_plain};
use crate::grasped_object::GraspedObject;

/// The robot at one configuration, as the stack of tasks sees it: pose and Jacobian of the tool, bodies, grasped object,
/// and the hand of the person who works on that.
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
    grasped: Option<Grasped>,
    /// Place of the hand in the tool's frame \[m\].
    hand: Vector3<f64>,
    jacobian: Matrix6xX<f64>,
    bodies: RobotBodies,
    inertia: InverseInertia,
}

/// The grasped object.
#[derive(Debug, Clone, Copy)]
struct Grasped {
    payload: PayloadId,
    capsule: Capsule,
    /// Place where the person's hand tool meets it, in the tool's frame \[m\].
    face: Vector3<f64>,
}

/// Radius of the person's hand tool \[m\].
const TOOL_RADIUS: f64 = 0.03;

impl Kinematics {
    /// Creates the robot with the link or frame of its tool, its bodies and its configuration q, n \[m or rad\].
    ///
    /// # Errors
    /// [`Error::FloatingBase`]; [`Error::Robot`] for a tool or link that the robot does not have and for q;
    /// [`Error::BodyBesideTheWay`] for a body whose motion the tool's Jacobian does not give.
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
            grasped: None,
            hand: Vector3::zeros(),
            jacobian: Matrix6xX::zeros(n),
            inertia: InverseInertia::new(n),
            bodies: RobotBodies::new(&model, tool, bodies)?,
            model,
        };
        kinematics.update(configuration)?;
        Ok(kinematics)
    }

    /// Sets the configuration q, n \[m or rad\]. Allocates nothing unless q is refused.
    ///
    /// # Errors
    /// [`Error::Robot`] on q unless [`Model::is_configuration`]; nothing is then changed.
    pub fn update(&mut self, configuration: &[f64]) -> Result<(), Error> {
        let posed = self.data.pose(&self.model, configuration)?;
        self.world_from_tool = posed.world_from(self.tool)?;
        posed.jacobian_into(self.tool, Axes::World, &mut self.jacobian)?;
        self.inertia.forget();
        self.bodies.place(&posed)
    }

    /// Computes M⁻¹ at the present configuration, if it is not known. Allocates nothing.
    ///
    /// # Errors
    /// Never, since there is a configuration from the beginning.
    pub fn update_inertia(&mut self) -> Result<(), Error> {
        if self.inertia.get().is_none() {
            self.inertia.update(&mut self.data.posed(&self.model)?);
        }
        Ok(())
    }

    /// Sets the object that the tool holds. Its mass counts, and it is one of the robot's bodies, unless the robot has
    /// none. Allocates nothing.
    ///
    /// # Errors
    /// Those of [`GraspedObject::validate`]; the robot then keeps what it grasped before.
    pub fn attach(&mut self, object: &GraspedObject) -> Result<(), Error> {
        object.validate()?;
        let (capsule, face) = (object.capsule()?, object.tool_from_face()?);
        self.detach()?;
        let payload = self.data.attach(&self.model, &object.payload(self.tool))?;
        self.grasped = Some(Grasped { payload, capsule, face });
        self.carry()
    }

    /// Releases the grasped object.
    ///
    /// # Errors
    /// Never.
    pub fn detach(&mut self) -> Result<(), Error> {
        if let Some(grasped) = self.grasped.take() {
            self.data.detach(&self.model, grasped.payload)?;
        }
        self.carry()
    }

    /// Sets the place of the person's hand in the tool's frame \[m\]. The person's hand tool is between hand and
    /// object.
    ///
    /// # Errors
    /// [`Error::Value`]; the hand is then unchanged.
    pub(crate) fn set_hand(&mut self, hand: Vector3<f64>) -> Result<(), Error> {
        if let Some(&got) = hand.iter().find(|value| !value.is_finite()) {
            let what = "the place of a hand".to_owned();
            return Err(Error::Value { what, got, wanted: "finite" });
        }
        self.hand = hand;
        self.carry()
    }

    /// Updates the bodies that the tool's frame carries.
    fn carry(&mut self) -> Result<(), Error> {
        let grasped = self.grasped.filter(|_| self.bodies.are_any());
        let tool = grasped.filter(|grasped| (grasped.face - self.hand).norm() > 2.0 * TOOL_RADIUS);
        let tool = match tool {
            Some(grasped) => Some(Capsule::new(grasped.face, self.hand, TOOL_RADIUS)?),
            None => None,
        };
        self.bodies.attach(grasped.map(|grasped| grasped.capsule).into_iter().chain(tool));
        self.bodies.place(&self.data.posed(&self.model)?)
    }

    /// The robot at its configuration, for tasks to read.
    ///
    /// # Errors
    /// Never, since there is a configuration from the beginning.
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

    /// Pose of the tool in the world \[m\].
    pub fn world_from_tool(&self) -> &Isometry3<f64> {
        &self.world_from_tool
    }

    /// The pose in the world of the hand of the person who works with the robot, with the tool's axes. If the robot
    /// holds no object, it is the pose of the tool.
    pub(crate) fn world_from_hand(&self) -> Isometry3<f64> {
        self.world_from_tool * Translation3::from(self.hand)
    }

    /// The place of the hand in the tool's frame \[m\].
    pub fn tool_from_hand(&self) -> &Vector3<f64> {
        &self.hand
    }

    /// The tool's geometric Jacobian, 6 × n, which maps q̇ to its twist at the tool's origin in the world's axes:
    /// linear rows \[m/s\], then angular ones \[rad/s\].
    pub fn jacobian(&self) -> &Matrix6xX<f64> {
        &self.jacobian
    }

    /// M⁻¹, the inverse of the joint-space inertia, n × n \[1/kg, 1/(kg m²)\]. `None` if it has not been
    /// [computed](Self::update_inertia) at this configuration, and for a robot with a joint that moves no mass.
    pub fn inverse_inertia(&self) -> Option<&DMatrix<f64>> {
        self.inertia.get()
    }

    /// The motion of the robot's bodies at these joint velocities, n \[m/s or rad/s\], for
    /// [`Safety`](hrsw_safety::Safety).
    pub fn motion<'a>(&'a self, velocity: &'a [f64]) -> JointMotion<'a> {
        JointMotion {
            jacobian: &self.jacobian,
            origin: self.world_from_tool.translation.vector,
            velocity,
            braking: None,
            change: None,
            inverse_inertia: self.inverse_inertia(),
        }
    }

    /// The robot's bodies in the world.
    pub fn bodies(&self) -> &[RobotBody] {
        self.bodies.placed()
    }
}
