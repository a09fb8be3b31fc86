//! Rows of a workspace: bounds of a pose and their rates.

use nalgebra::{Isometry3, Matrix3, Vector3, Vector6};

use crate::change::{Blend, Change, Stage};
use crate::shape::{HalfSpace, OrientationRow, OrientationShape, PositionShape, RotationPoint};

/// Bound of a pose: the excess over the bound, and the terms of its rate.
///
/// d excess/dt = gradient · ẋ + drift for a pose that moves with the twist ẋ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseRow {
    /// Gradient with respect to the twist of the pose \[1 or m\], linear then angular, in world axes.
    pub gradient: Vector6<f64>,
    /// Direction of the bound in the coordinates of the workspace: linear in its axes, then angular
    /// in those of its reference. The shared slack acts along it.
    pub axes: Vector6<f64>,
    /// Excess of the pose over the bound \[m or rad\], negative inside.
    pub excess: f64,
    /// Rate of the excess for a pose at rest, caused by the motion of frame, reference and bound
    /// \[m/s or rad/s\].
    pub drift: f64,
}

/// A pose relative to the shapes of a workspace, computed once for all rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PosePoint {
    pub(crate) position: Vector3<f64>,
    pub(crate) rotation: RotationPoint,
    pub(crate) world_from_frame: Matrix3<f64>,
    pub(crate) world_from_reference: Matrix3<f64>,
    /// Velocity of a point that moves with the workspace, in world axes.
    pub(crate) linear_drift: Vector3<f64>,
    pub(crate) angular_drift: Vector3<f64>,
}

impl PosePoint {
    /// Returns the row with its excess multiplied by the fade. The bounded set is the same, but a
    /// violation costs less.
    fn position_row(&self, plane: &Plane) -> PoseRow {
        let normal = plane.face.normal();
        let gradient = self.world_from_frame * normal;
        let excess = plane.face.signed_distance(&self.position);
        let rate = -gradient.dot(&self.linear_drift) - plane.offset_rate;
        PoseRow {
            gradient: stack(&(gradient * plane.fade), &Vector3::zeros()),
            axes: stack(normal, &Vector3::zeros()),
            excess: plane.fade * excess,
            drift: plane.fade * rate + plane.fade_rate * excess,
        }
    }

    fn orientation_row(&self, row: &OrientationRow, bound_rate: f64) -> PoseRow {
        let gradient = self.world_from_reference * row.gradient;
        PoseRow {
            gradient: stack(&Vector3::zeros(), &gradient),
            axes: stack(&Vector3::zeros(), &row.axes),
            excess: row.value - row.bound,
            drift: -gradient.dot(&self.angular_drift) - bound_rate,
        }
    }
}

pub(crate) fn stack(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

impl Change<PositionShape> {
    pub(crate) fn row_count(&self) -> usize {
        match self.stage() {
            Stage::Still(shape) => shape.row_count(),
            Stage::Between { from: PositionShape::Box(_), to: PositionShape::Box(_), .. } => 6,
            Stage::Between { from, to, .. } => from.row_count() + to.row_count(),
        }
    }

    /// Returns plane `index`.
    ///
    /// In the blend (1 − λ)A ⊕ λB of two shapes, planes along the normals of both bound the set.
    /// Its support function is (1 − λ)h_A + λh_B. The set is therefore never empty, and equals A
    /// and B at its ends. Planes fade in and out.
    pub(crate) fn plane(&self, index: usize, at: &Vector3<f64>) -> Option<Plane> {
        let (from, to, share, rate) = match self.stage() {
            Stage::Still(shape) => {
                let face = shape.half_space(index, at)?;
                return Some(Plane { face, offset_rate: 0.0, fade: 1.0, fade_rate: 0.0 });
            }
            Stage::Between { from, to, share, rate } => (from, to, share, rate),
        };
        let of_from = index < from.row_count();
        let face = if of_from {
            from.half_space(index, at)?
        } else {
            to.half_space(index - from.row_count(), at)?
        };
        let (begin, end) = (from.support(face.normal()), to.support(face.normal()));
        let offset = begin + share * (end - begin);
        let (fade, fade_rate) = match (of_from, from.blended(to, share).is_some()) {
            (_, true) => (1.0, 0.0),
            (true, false) => faded(1.0 - share, -rate),
            (false, false) => faded(share, rate),
        };
        let face = HalfSpace { offset, ..face };
        Some(Plane { face, offset_rate: rate * (end - begin), fade, fade_rate })
    }

    pub(crate) fn row(&self, index: usize, at: &PosePoint) -> Option<PoseRow> {
        Some(at.position_row(&self.plane(index, &at.position)?))
    }
}

/// A plane of a shape, or of a changing one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) face: HalfSpace,
    offset_rate: f64,
    /// Factor of its excess, from 0 to 1.
    fade: f64,
    fade_rate: f64,
}

/// Returns 3x² − 2x³ for x = 5 · share, and its rate. The value rises from 0 to 1 over the first
/// fifth.
fn faded(share: f64, rate: f64) -> (f64, f64) {
    let x = 5.0 * share;
    if x >= 1.0 { (1.0, 0.0) } else { (x * x * (3.0 - 2.0 * x), 30.0 * x * (1.0 - x) * rate) }
}

impl Change<OrientationShape> {
    pub(crate) fn row_count(&self) -> usize {
        match self.stage() {
            Stage::Still(shape) => shape.row_count(),
            Stage::Between { from, to, share, .. } => {
                if share < 0.5 {
                    from.row_count()
                } else {
                    to.row_count()
                }
            }
        }
    }

    /// Returns row `index`. Between two shapes that do not blend, the first one opens to half a
    /// turn, and then the second one closes.
    pub(crate) fn row(&self, index: usize, at: &PosePoint) -> Option<PoseRow> {
        if index >= self.row_count() {
            return None;
        }
        match self.stage() {
            Stage::Still(shape) => Some(at.orientation_row(&shape.row(index, &at.rotation), 0.0)),
            Stage::Between { from, to, share, rate } => {
                let open = std::f64::consts::PI;
                let (begin, end) = (from.row(index, &at.rotation), to.row(index, &at.rotation));
                let (row, bound, bound_rate) = if from.blended(to, share).is_some() {
                    let span = end.bound - begin.bound;
                    (begin, begin.bound + share * span, rate * span)
                } else if share < 0.5 {
                    let span = 2.0 * (open - begin.bound);
                    (begin, begin.bound + share * span, rate * span)
                } else {
                    let span = 2.0 * (end.bound - open);
                    (end, open + (share - 0.5) * span, rate * span)
                };
                Some(at.orientation_row(&OrientationRow { bound, ..row }, bound_rate))
            }
        }
    }
}

/// Returns `pose` relative to a workspace at rest.
pub(crate) fn pose_point(
    frame: &Isometry3<f64>,
    reference: &nalgebra::UnitQuaternion<f64>,
    pose: &Isometry3<f64>,
) -> PosePoint {
    let relative = frame.inv_mul(pose);
    let world_from_frame = *frame.rotation.to_rotation_matrix().matrix();
    PosePoint {
        position: relative.translation.vector,
        rotation: RotationPoint::new(reference.inverse() * relative.rotation),
        world_from_frame,
        world_from_reference: world_from_frame * reference.to_rotation_matrix().matrix(),
        linear_drift: Vector3::zeros(),
        angular_drift: Vector3::zeros(),
    }
}
