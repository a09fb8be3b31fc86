//! The shared workspace: a shape of positions and a shape of orientations in a moving frame.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, Vector6};

use crate::change::{Blend, Change, Stage};
use crate::error::{Error, check_all, check_pose, check_rotation};
use crate::rows::{PosePoint, PoseRow, pose_point, stack};
use crate::shape::{Bounds, OrientationShape, PositionShape};

/// A human-robot shared workspace: a shape of positions in the axes of its frame, and a shape of
/// orientations about a reference in that frame.
///
/// A pose (p, R) in a workspace with the frame (p_S, R_S) and the reference R_0 has the coordinates
/// z = [R_Sᵀ(p − p_S); log((R_S R_0)ᵀR)] \[m, rad\]. If both shapes are boxes, the workspace is the
/// set of poses whose z lies within bounds. This is the paper's x_min ≤ x_d ≤ x_max, in axes that
/// may turn.
///
/// ```
/// use hrsw::{Bounds, Workspace};
/// use nalgebra::{Isometry3, Vector3};
///
/// let position = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.75, 0.2, 1.6))?;
/// let orientation = Bounds::symmetric(Vector3::repeat(0.3))?;
/// let workspace = Workspace::new(Isometry3::identity(), position, orientation)?;
/// assert!(workspace.contains(&Isometry3::translation(0.5, 0.0, 1.0)));
/// assert!(!workspace.contains(&Isometry3::translation(0.0, 0.0, 1.0)));
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace {
    frame: Isometry3<f64>,
    twist: Vector6<f64>,
    reference: UnitQuaternion<f64>,
    reference_rate: Vector3<f64>,
    position: Change<PositionShape>,
    orientation: Change<OrientationShape>,
}

impl Workspace {
    /// Creates a workspace at rest.
    ///
    /// # Errors
    /// [`Error::Value`] if the frame is invalid, or the orientation bounds come near half a turn.
    pub fn new(
        world_from_workspace: Isometry3<f64>,
        position: impl Into<PositionShape>,
        orientation: impl Into<OrientationShape>,
    ) -> Result<Self, Error> {
        check_pose(&world_from_workspace)?;
        let orientation = orientation.into();
        orientation.validate()?;
        Ok(Self {
            frame: world_from_workspace,
            twist: Vector6::zeros(),
            reference: UnitQuaternion::identity(),
            reference_rate: Vector3::zeros(),
            position: Change::still(position.into()),
            orientation: Change::still(orientation),
        })
    }

    /// Sets the reference of orientations, in the axes of the frame. The default is the frame
    /// itself.
    #[must_use]
    pub fn with_reference(mut self, reference: UnitQuaternion<f64>) -> Self {
        self.reference = reference;
        self
    }

    /// Reference about which orientations are bounded, in the axes of the frame.
    pub fn reference(&self) -> &UnitQuaternion<f64> {
        &self.reference
    }

    /// Angular velocity of the reference, in the axes of the frame \[rad/s\].
    pub fn reference_rate(&self) -> &Vector3<f64> {
        &self.reference_rate
    }

    /// Pose of the workspace's frame in the world.
    pub fn world_from_workspace(&self) -> &Isometry3<f64> {
        &self.frame
    }

    /// Returns the smallest bounds around the current positions, in the axes of the frame \[m\].
    pub fn position(&self) -> Bounds {
        self.position.extent()
    }

    /// Returns the shape of positions. During a change it is the final one.
    pub fn position_shape(&self) -> &PositionShape {
        self.position.goal()
    }

    /// Returns the shape of orientations. During a change it is the final one.
    pub fn orientation_shape(&self) -> &OrientationShape {
        self.orientation.goal()
    }

    /// Velocity of the frame: linear at its origin, then angular, in world axes \[m/s, rad/s\].
    pub fn twist(&self) -> &Vector6<f64> {
        &self.twist
    }

    /// Moves the frame to a pose in the world. `twist` is its velocity, linear at its origin, then angular, in world axes
    /// \[m/s, rad/s\].
    ///
    /// # Errors
    /// [`Error::Value`] if a number is invalid. The workspace is then unchanged.
    pub fn place(
        &mut self,
        world_from_workspace: Isometry3<f64>,
        twist: Vector6<f64>,
    ) -> Result<(), Error> {
        check_pose(&world_from_workspace)?;
        check_all("the twist of the workspace", twist.iter())?;
        self.frame = world_from_workspace;
        self.twist = twist;
        Ok(())
    }

    /// Turns the reference of orientations, in the axes of the frame. `rate` is its angular velocity in the axes of the frame \[rad/s\].
    ///
    /// # Errors
    /// [`Error::Value`] if a number is invalid. The workspace is then unchanged.
    pub fn set_reference(
        &mut self,
        reference: UnitQuaternion<f64>,
        rate: Vector3<f64>,
    ) -> Result<(), Error> {
        check_rotation("the reference of a workspace", &reference)?;
        check_all("the rate of the reference", rate.iter())?;
        self.reference = reference;
        self.reference_rate = rate;
        Ok(())
    }

    /// Starts a continuous change of the shape of positions over `duration` \[s\].
    ///
    /// In between, the shape is the blend (1 − λ)A ⊕ λB of the old and the new one, bounded along
    /// the normals of both. Rows that come with the new shape or go with the old one fade in and
    /// out, so that the slack is continuous too. A change between boxes may be replaced while it is
    /// in progress. A change to another kind of shape starts when the current one has ended.
    ///
    /// # Errors
    /// [`Error::Value`] if the duration is not positive. The workspace is then unchanged.
    pub fn reshape_position(
        &mut self,
        position: impl Into<PositionShape>,
        duration: f64,
    ) -> Result<(), Error> {
        self.position.begin(position.into(), duration)
    }

    /// Starts a continuous change of the shape of orientations over `duration` \[s\]. Between a box
    /// and a cone, the first one opens to half a turn, and then the second one closes.
    ///
    /// # Errors
    /// [`Error::Value`] if an argument is invalid. The workspace is then unchanged.
    pub fn reshape_orientation(
        &mut self,
        orientation: impl Into<OrientationShape>,
        duration: f64,
    ) -> Result<(), Error> {
        let orientation = orientation.into();
        orientation.validate()?;
        self.orientation.begin(orientation, duration)
    }

    /// Advances changes of shape by `period` \[s\].
    pub fn advance(&mut self, period: f64) {
        self.position.advance(period);
        self.orientation.advance(period);
    }

    /// Returns true if a change of shape is in progress.
    pub fn is_changing(&self) -> bool {
        !(self.position.is_still() && self.orientation.is_still())
    }

    /// Returns the coordinates z of a pose \[m, rad\].
    pub fn coordinates(&self, pose: &Isometry3<f64>) -> Vector6<f64> {
        let at = self.point(pose);
        stack(&at.position, at.rotation.vector())
    }

    /// Returns the bounds of a pose: those of the position, then those of the orientation.
    pub fn rows(&self, pose: &Isometry3<f64>) -> impl Iterator<Item = PoseRow> + '_ {
        let at = self.point(pose);
        let (positions, orientations) = self.row_counts();
        let position = (0..positions).filter_map(move |i| self.position.row(i, &at));
        let orientation = (0..orientations).filter_map(move |i| self.orientation.row(i, &at));
        position.chain(orientation)
    }

    /// Returns the numbers of rows that currently bound the position and the orientation.
    pub fn row_counts(&self) -> (usize, usize) {
        (self.position.row_count(), self.orientation.row_count())
    }

    /// Returns the shortest displacement by which the pose is outside the shapes, zero inside \[m,
    /// rad\]. It is in the axes of the frame and of the reference. If the shapes are boxes, it is z
    /// minus the nearest z inside.
    pub fn violation(&self, pose: &Isometry3<f64>) -> Vector6<f64> {
        let at = self.point(pose);
        let linear = match self.position.stage() {
            Stage::Still(shape) => at.position - shape.nearest(&at.position),
            Stage::Between { from, to, share, .. } => match from.blended(to, share) {
                Some(shape) => at.position - shape.nearest(&at.position),
                None => worst((0..self.position.row_count()).filter_map(|i| {
                    let face = self.position.plane(i, &at.position)?.face;
                    Some((face.signed_distance(&at.position), *face.normal()))
                })),
            },
        };
        let angular = match self.orientation.stage() {
            Stage::Still(shape) => shape.violation(&at.rotation),
            Stage::Between { from, to, share, .. } => match from.blended(to, share) {
                Some(shape) => shape.violation(&at.rotation),
                None => worst((0..self.orientation.row_count()).filter_map(|i| {
                    let row = self.orientation.row(i, &at)?;
                    Some((row.excess, row.axes.fixed_rows::<3>(3).into_owned()))
                })),
            },
        };
        stack(&linear, &angular)
    }

    /// Returns true if the pose is inside.
    pub fn contains(&self, pose: &Isometry3<f64>) -> bool {
        self.violation(pose) == Vector6::zeros()
    }

    fn point(&self, pose: &Isometry3<f64>) -> PosePoint {
        let at = pose_point(&self.frame, &self.reference, pose);
        let turning = self.twist.fixed_rows::<3>(3).into_owned();
        let arm = (pose * Point3::origin()).coords - self.frame.translation.vector;
        PosePoint {
            linear_drift: self.twist.fixed_rows::<3>(0) + turning.cross(&arm),
            angular_drift: turning + at.world_from_frame * self.reference_rate,
            ..at
        }
    }
}

/// Returns the largest positive excess, along its direction.
fn worst(rows: impl Iterator<Item = (f64, Vector3<f64>)>) -> Vector3<f64> {
    let worst = rows.max_by(|(a, _), (b, _)| a.total_cmp(b));
    worst.map_or(Vector3::zeros(), |(excess, direction)| direction * excess.max(0.0))
}
