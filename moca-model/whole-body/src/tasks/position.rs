//! A frame's origin at a point.

use nalgebra::{Point3, Vector3};

use super::feedback::Feedback;
use super::input::TaskInput;
use super::mask::{Axis, VectorMask};
use super::rows::TaskRows;
use super::task::Task;
use crate::error::{Error, check_finite};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Brings the origin of a frame to a point of the world: J_v q̇ = ṗ_d + feedback(p_d − p)
/// (Siciliano, Sciavicco, Villani, Oriolo, *Robotics: Modelling, Planning and Control*, 2009,
/// Sec. 3.7). Up to three rows, in world axes \[m/s\].
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use whole_body::{Axis, PositionTask};
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="slide"><link name="base"/><link name="hand"/>
/// #   <joint name="j" type="prismatic"><parent link="base"/><child link="hand"/><axis xyz="1 0 0"/>
/// #   <limit lower="0" upper="1" velocity="1" effort="1"/></joint></robot>"#, &Description::default())?;
/// let hand = model.frame_id("hand")?;
/// let mut task = PositionTask::new(hand).with_gain(50.0).with_axes(&[Axis::X]);
/// task.set_moving_target(Point3::new(0.4, 0.0, 0.0), Vector3::new(0.1, 0.0, 0.0))?;
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct PositionTask {
    frame: FrameId,
    target: Option<(Point3<f64>, Vector3<f64>)>,
    feedback: Feedback,
    mask: VectorMask,
}

impl PositionTask {
    /// Of the origin of `frame`, along all axes; the target is to be set before the first step.
    pub fn new(frame: FrameId) -> Self {
        Self { frame, target: None, feedback: Feedback::LINEAR, mask: VectorMask::default() }
    }

    /// With this gain \[1/s\] instead of that of [`Feedback::LINEAR`].
    #[must_use]
    pub fn with_gain(mut self, gain: f64) -> Self {
        self.feedback.gain = gain;
        self
    }

    /// With this feedback instead of [`Feedback::LINEAR`].
    #[must_use]
    pub fn with_feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = feedback;
        self
    }

    /// Along these axes of the world only.
    #[must_use]
    pub fn with_axes(mut self, axes: &[Axis]) -> Self {
        self.mask.choose(axes);
        self
    }

    /// With weights of the three axes against the other rows of the level.
    #[must_use]
    pub fn with_weights(mut self, weights: Vector3<f64>) -> Self {
        self.mask.weights = weights;
        self
    }

    /// Where the origin is to be, in the world \[m\].
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_target(&mut self, position: Point3<f64>) -> Result<(), Error> {
        self.set_moving_target(position, Vector3::zeros())
    }

    /// Where the origin is to be \[m\], and how fast that place moves \[m/s\].
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the target is then as before.
    pub fn set_moving_target(
        &mut self,
        position: Point3<f64>,
        velocity: Vector3<f64>,
    ) -> Result<(), Error> {
        for value in position.coords.iter().chain(&velocity) {
            check_finite(*value, || "a coordinate of the target".to_owned())?;
        }
        self.target = Some((position, velocity));
        Ok(())
    }
}

impl Task for PositionTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.mask.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.feedback.validate()?;
        self.mask.validate()?;
        model.expect_moving(self.frame)
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let (target, velocity) = self.target.ok_or(Error::TargetMissing)?;
        self.feedback.check_period(input.period())?;
        let actual = input.posed().placement(self.frame)?.translation.vector;
        let error = self.mask.apply(&(target.coords - actual));
        let velocity = velocity + self.feedback.velocity(&error);
        let jacobian = input.jacobian(self.frame, Axes::World)?;
        for (row, axis) in self.mask.iter().enumerate() {
            rows.set_coefficients(row, jacobian.row(axis).iter());
            rows.set_target(row, velocity[axis]);
            rows.set_weight(row, self.mask.weights[axis]);
        }
        Ok(())
    }
}
