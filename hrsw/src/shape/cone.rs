//! Orientations that point an axis of the tool approximately in one direction.

use nalgebra::{Unit, UnitQuaternion, Vector3};

use crate::error::{Error, check_all};

/// Largest angle of bounds \[rad\]. Rotation vectors are continuous below half a turn.
const LARGEST_ANGLE: f64 = std::f64::consts::PI - 0.1;

/// Checks the angle of the farthest rotation inside the bounds (rad).
pub(super) fn check_angle(angle: f64) -> Result<(), Error> {
    if angle <= LARGEST_ANGLE {
        return Ok(());
    }
    let what = "the angle that the orientation bounds reach";
    let wanted = "at most 3.04 rad; turn the reference frame instead";
    Err(Error::Value { what, got: angle, wanted })
}

/// The orientations that turn `axis` of the tool to within `half_angle` of `direction`. The roll
/// about the axis is free.
///
/// ```
/// use hrsw::Cone;
/// use nalgebra::{UnitQuaternion, Vector3};
///
/// // The tool's z axis points down, to 10 degrees.
/// let down = Cone::new(Vector3::z(), -Vector3::z(), 10_f64.to_radians())?;
/// let rolled = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.0)
///     * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
/// assert!(down.contains(&rolled));
/// assert!(!down.contains(&UnitQuaternion::identity()));
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    axis: Unit<Vector3<f64>>,
    direction: Unit<Vector3<f64>>,
    half_angle: f64,
}

impl Cone {
    /// Creates a cone with `axis` in the axes of the tool, `direction` in those of the reference,
    /// and the half angle \[rad\]. The lengths of the vectors do not matter.
    ///
    /// # Errors
    /// [`Error::Value`] if a vector is not finite or has length zero, or if the angle is negative
    /// or near half a turn.
    pub fn new(
        axis: Vector3<f64>,
        direction: Vector3<f64>,
        half_angle: f64,
    ) -> Result<Self, Error> {
        check_all("a cone of orientations", axis.iter().chain(&direction).chain([&half_angle]))?;
        let unit = |name, v: Vector3<f64>| {
            let (value, expected) = (v.norm(), "above zero");
            Unit::try_new(v, 1e-12).ok_or(Error::Value { what: name, got: value, wanted: expected })
        };
        let (axis, direction) = (
            unit("the length of a cone's axis", axis)?,
            unit("the length of a cone's direction", direction)?,
        );
        if half_angle < 0.0 {
            let (name, expected) = ("the half angle of a cone", "not negative");
            return Err(Error::Value { what: name, got: half_angle, wanted: expected });
        }
        check_angle(half_angle)?;
        Ok(Self { axis, direction, half_angle })
    }

    /// The axis, in the axes of the tool.
    pub fn axis(&self) -> &Unit<Vector3<f64>> {
        &self.axis
    }

    /// The direction, in the axes of the reference.
    pub fn direction(&self) -> &Unit<Vector3<f64>> {
        &self.direction
    }

    /// The half angle \[rad\].
    pub(crate) fn half_angle(&self) -> f64 {
        self.half_angle
    }

    /// The angle between the turned axis and the direction \[rad\].
    pub fn angle(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        let turned = rotation * self.axis.into_inner();
        self.direction.cross(&turned).norm().atan2(self.direction.dot(&turned))
    }

    /// Returns true if the orientation is inside.
    pub fn contains(&self, rotation: &UnitQuaternion<f64>) -> bool {
        self.angle(rotation) <= self.half_angle
    }

    /// Returns the angle by which the axis is outside the cone \[rad\], negative inside.
    pub fn signed_distance(&self, rotation: &UnitQuaternion<f64>) -> f64 {
        self.angle(rotation) - self.half_angle
    }

    /// Returns the nearest orientation in the cone, by the shortest turn. One inside is its own
    /// nearest orientation.
    pub fn nearest(&self, rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let excess = self.signed_distance(rotation);
        if excess <= 0.0 {
            return *rotation;
        }
        UnitQuaternion::from_scaled_axis(self.turn(rotation) * -excess) * rotation
    }

    /// Returns the cone with a blended half angle, if the cones differ in nothing else.
    pub(crate) fn blended(&self, other: &Self, share: f64) -> Option<Self> {
        let half_angle = self.half_angle + share * (other.half_angle - self.half_angle);
        let same = self.axis == other.axis && self.direction == other.direction;
        same.then_some(Self { half_angle, ..*self })
    }

    /// Returns the gradient of the angle with respect to the angular velocity, in the axes of the
    /// reference. A turn along it increases the angle.
    pub(crate) fn turn(&self, rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
        let turned = rotation * self.axis.into_inner();
        let across = self.direction.cross(&turned);
        across.try_normalize(1e-12).unwrap_or_else(|| {
            // If axis and direction are aligned, all turns across the direction are equivalent.
            let other = if self.direction.x.abs() > 0.5 { Vector3::y() } else { Vector3::x() };
            self.direction.cross(&other).normalize()
        })
    }
}
