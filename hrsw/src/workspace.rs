//! The shared workspace: bounds of position and orientation in a moving frame.

use ahqp_core::{left_jacobian_inverse, rotation_log};
use nalgebra::{Isometry3, Matrix6, UnitQuaternion, Vector3, Vector6};

use crate::error::Error;

/// Rotation vectors are continuous below half a turn; bounds keep this distance from it \[rad\].
const ANGLE_MARGIN: f64 = 0.1;

/// Bounds along three axes, `min ≤ v ≤ max`.
///
/// ```
/// use hrsw::Bounds;
/// use nalgebra::Vector3;
///
/// let bounds = Bounds::new(Vector3::new(0.2, -0.5, 0.7), Vector3::new(0.75, 0.2, 1.6))?;
/// assert_eq!(bounds.nearest(&Vector3::new(0.0, 0.0, 1.0)), Vector3::new(0.2, 0.0, 1.0));
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    min: Vector3<f64>,
    max: Vector3<f64>,
}

impl Bounds {
    /// # Errors
    /// [`Error::NotFinite`] for NaN or infinite bounds, [`Error::Empty`] where the minimum lies
    /// above the maximum.
    pub fn new(min: Vector3<f64>, max: Vector3<f64>) -> Result<Self, Error> {
        for value in min.iter().chain(max.iter()) {
            if !value.is_finite() {
                return Err(Error::NotFinite { what: "a bound", value: *value });
            }
        }
        if let Some(axis) = (0..3).find(|&axis| min[axis] > max[axis]) {
            let (min, max) = (min[axis], max[axis]);
            return Err(Error::Empty { what: "the bounds", axis, min, max });
        }
        Ok(Self { min, max })
    }

    /// The same distance `half` to both sides of zero.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn symmetric(half: Vector3<f64>) -> Result<Self, Error> {
        Self::new(-half, half)
    }

    /// The lower bounds.
    pub fn min(&self) -> &Vector3<f64> {
        &self.min
    }

    /// The upper bounds.
    pub fn max(&self) -> &Vector3<f64> {
        &self.max
    }

    /// The point within that lies nearest to `v`.
    pub fn nearest(&self, v: &Vector3<f64>) -> Vector3<f64> {
        v.sup(&self.min).inf(&self.max)
    }

    /// The same bounds moved by `offset`.
    #[must_use]
    pub fn shifted(&self, offset: &Vector3<f64>) -> Self {
        Self { min: self.min + offset, max: self.max + offset }
    }
}

/// A human-robot shared workspace: bounds of position in the axes of its frame, and bounds of
/// orientation as rotation vectors about a reference in that frame.
///
/// The coordinates of a pose (p, R) in a workspace with the frame (p_S, R_S) and the reference
/// R_0 are z = [R_Sᵀ(p − p_S); log((R_S R_0)ᵀR)] \[m, rad\]; the workspace is the set of poses whose z lies
/// within the bounds (the paper's x_min ≤ x_d ≤ x_max, in axes that may turn).
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workspace {
    frame: Isometry3<f64>,
    twist: Vector6<f64>,
    reference: UnitQuaternion<f64>,
    position: Bounds,
    orientation: Bounds,
}

impl Workspace {
    /// A workspace at rest.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a frame that is not finite, [`Error::AngleTooLarge`] for
    /// orientation bounds that come near half a turn.
    pub fn new(
        world_from_workspace: Isometry3<f64>,
        position: Bounds,
        orientation: Bounds,
    ) -> Result<Self, Error> {
        check_pose(&world_from_workspace)?;
        let farthest = orientation.min.abs().sup(&orientation.max.abs()).norm();
        let limit = std::f64::consts::PI - ANGLE_MARGIN;
        if farthest > limit {
            return Err(Error::AngleTooLarge { angle: farthest, limit });
        }
        Ok(Self {
            frame: world_from_workspace,
            twist: Vector6::zeros(),
            reference: UnitQuaternion::identity(),
            position,
            orientation,
        })
    }

    /// The same workspace with its orientation bounds about `reference`, an orientation given
    /// in the axes of the frame, instead of about the frame itself.
    #[must_use]
    pub fn with_reference(mut self, reference: UnitQuaternion<f64>) -> Self {
        self.reference = reference;
        self
    }

    /// The orientation about which orientations are bounded, in the axes of the frame.
    pub fn reference(&self) -> &UnitQuaternion<f64> {
        &self.reference
    }

    /// The frame.
    pub fn world_from_workspace(&self) -> &Isometry3<f64> {
        &self.frame
    }

    /// The bounds of position, in the axes of the frame \[m\].
    pub fn position(&self) -> &Bounds {
        &self.position
    }

    /// The bounds of orientation, as rotation vectors from the frame \[rad\].
    pub fn orientation(&self) -> &Bounds {
        &self.orientation
    }

    /// The velocity of the frame: linear at its origin, then angular, in world axes.
    pub fn twist(&self) -> &Vector6<f64> {
        &self.twist
    }

    /// Moves the frame; `twist` is its velocity, linear at its origin, then angular, in world
    /// axes \[m/s, rad/s\].
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the workspace then stays as it was.
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

    /// Replaces the bounds of position.
    pub fn set_position(&mut self, position: Bounds) {
        self.position = position;
    }

    /// z, the coordinates of a pose \[m, rad\].
    pub fn coordinates(&self, pose: &Isometry3<f64>) -> Vector6<f64> {
        let relative = self.frame.inv_mul(pose);
        let turn = rotation_log(&(self.reference.inverse() * relative.rotation));
        let (p, v) = (relative.translation.vector, turn);
        Vector6::new(p.x, p.y, p.z, v.x, v.y, v.z)
    }

    /// How z changes: ż = M (ẋ − drift), with the matrix M and the drift of the frame at the
    /// pose, both for twists in world axes.
    pub fn rates(&self, pose: &Isometry3<f64>) -> (Matrix6<f64>, Vector6<f64>) {
        let to_frame = self.frame.rotation.inverse().to_rotation_matrix();
        let to_reference = self.reference.inverse().to_rotation_matrix() * to_frame;
        let z = self.coordinates(pose);
        let angular =
            left_jacobian_inverse(&z.fixed_rows::<3>(3).into_owned()) * to_reference.matrix();
        let mut matrix = Matrix6::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(to_frame.matrix());
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&angular);
        let arm = pose.translation.vector - self.frame.translation.vector;
        let turning = self.twist.fixed_rows::<3>(3).into_owned();
        let linear = self.twist.fixed_rows::<3>(0) + turning.cross(&arm);
        let drift = Vector6::new(linear.x, linear.y, linear.z, turning.x, turning.y, turning.z);
        (matrix, drift)
    }

    /// By how much z leaves the bounds, zero within \[m, rad\].
    pub fn violation(&self, pose: &Isometry3<f64>) -> Vector6<f64> {
        let z = self.coordinates(pose);
        let (p, v) = (z.fixed_rows::<3>(0).into_owned(), z.fixed_rows::<3>(3).into_owned());
        let (dp, dv) = (p - self.position.nearest(&p), v - self.orientation.nearest(&v));
        Vector6::new(dp.x, dp.y, dp.z, dv.x, dv.y, dv.z)
    }

    /// Whether the pose lies within.
    pub fn contains(&self, pose: &Isometry3<f64>) -> bool {
        self.violation(pose) == Vector6::zeros()
    }

    /// Lower and upper bounds of z.
    pub(crate) fn coordinate_bounds(&self) -> (Vector6<f64>, Vector6<f64>) {
        let stack = |p: &Vector3<f64>, v: &Vector3<f64>| Vector6::new(p.x, p.y, p.z, v.x, v.y, v.z);
        (
            stack(&self.position.min, &self.orientation.min),
            stack(&self.position.max, &self.orientation.max),
        )
    }
}

pub(crate) fn check_pose(pose: &Isometry3<f64>) -> Result<(), Error> {
    check_all("the translation of a frame", pose.translation.vector.iter())?;
    check_all("the rotation of a frame", pose.rotation.coords.iter())
}

pub(crate) fn check_all<'a>(
    what: &'static str,
    mut values: impl Iterator<Item = &'a f64>,
) -> Result<(), Error> {
    match values.find(|value| !value.is_finite()) {
        Some(&value) => Err(Error::NotFinite { what, value }),
        None => Ok(()),
    }
}
