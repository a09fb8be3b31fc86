//! The object that the robot holds for the person to work on, and the place of the person's hand.

use hrsw::Capsule;
use nalgebra::{Isometry3, Matrix3, Point3, Unit, UnitQuaternion, Vector3};
use vision_models::{Surface, Tool};
use whole_body::FrameId;
use whole_body::state::Payload;

use crate::box_side::BoxSide;
use crate::error::{Error, check_not_negative, check_positive, check_settings};

/// A side of the object to work on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WorkFace {
    /// The side.
    pub side: BoxSide,
    /// The surface that it has.
    pub surface: Surface,
}

/// The object that the robot holds: a box of uniform density.
///
/// ```
/// use moca_model::{HandSettings, GraspedObject};
/// use vision_models::Tool;
///
/// let object = GraspedObject::default();
/// let settings = HandSettings::default();
/// let hand = object.tool_from_hand(&settings, Some(Tool::Drill))?;
/// // In front of the object by the length of the drill.
/// assert!((hand.x - (0.06 + 0.2)).abs() < 1e-12);
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GraspedObject {
    /// Lengths of its edges \[m\]. Default 0.12 × 0.2 × 0.15.
    pub size: Vector3<f64>,
    /// Mass \[kg\]. Default 1.
    pub mass: f64,
    /// Pose of its middle and axes in the frame of the robot's tool. Default 0.05 m below the fingertips.
    pub tool_from_object: Isometry3<f64>,
    /// The sides to work on. The robot shows the first one to the person. Default the drilled surface in front and the
    /// smooth one behind.
    pub faces: Vec<WorkFace>,
}

impl Default for GraspedObject {
    fn default() -> Self {
        Self {
            size: Vector3::new(0.12, 0.2, 0.15),
            mass: 1.0,
            tool_from_object: Isometry3::translation(0.0, 0.0, 0.05),
            faces: vec![
                WorkFace { side: BoxSide::Front, surface: Surface::Drilled },
                WorkFace { side: BoxSide::Back, surface: Surface::Smooth },
            ],
        }
    }
}

/// The distance of the hand of a person who works on the object from its surface.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct HandSettings {
    /// Distance with a drill \[m\]. Default 0.2.
    pub drill: f64,
    /// Distance with a polisher \[m\]. Default 0.12.
    pub polisher: f64,
}

impl Default for HandSettings {
    fn default() -> Self {
        Self { drill: 0.2, polisher: 0.12 }
    }
}

impl HandSettings {
    /// The distance with this hand tool \[m\]. A bare hand is at the surface.
    pub fn distance(&self, tool: Option<Tool>) -> f64 {
        match tool {
            None => 0.0,
            Some(Tool::Drill) => self.drill,
            Some(Tool::Polisher) => self.polisher,
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is negative or not finite.
    pub fn validate(&self) -> Result<(), Error> {
        check_not_negative([("hand.drill", self.drill), ("hand.polisher", self.polisher)])
    }
}

impl GraspedObject {
    /// Checks the box.
    ///
    /// # Errors
    /// [`Error::Value`] for edges or a mass that are not positive, or a pose that is not finite;
    /// [`Error::NoFace`] for an object that nobody can work on; [`Error::TwoFacesOnOneSide`].
    pub fn validate(&self) -> Result<(), Error> {
        let edges = self.size.iter().map(|&edge| ("object.size", edge));
        check_positive(edges.chain([("object.mass", self.mass)]))?;
        let pose = &self.tool_from_object;
        let numbers = pose.translation.vector.iter().chain(pose.rotation.coords.iter());
        let numbers = numbers.map(|&value| ("object.tool_from_object", value));
        check_settings(numbers, "finite", f64::is_finite)?;
        if self.faces.is_empty() {
            return Err(Error::NoFace);
        }
        let mut sides = self.faces.iter().map(|face| face.side).enumerate();
        let is_again = |index: usize, side: BoxSide| {
            self.faces.iter().take(index).any(|face| face.side == side)
        };
        match sides.find(|&(index, side)| is_again(index, side)) {
            Some((_, side)) => Err(Error::TwoFacesOnOneSide { side }),
            None => Ok(()),
        }
    }

    /// The place of the hand that works on the side shown, in the frame of the robot's tool \[m\].
    ///
    /// # Errors
    /// [`Error::NoFace`].
    pub fn tool_from_hand(
        &self,
        settings: &HandSettings,
        tool: Option<Tool>,
    ) -> Result<Vector3<f64>, Error> {
        let face = self.faces.first().ok_or(Error::NoFace)?;
        Ok(self.before(face.side, settings.distance(tool)))
    }

    /// The middle of the side shown, in the frame of the robot's tool \[m\].
    ///
    /// # Errors
    /// [`Error::NoFace`].
    pub fn tool_from_face(&self) -> Result<Vector3<f64>, Error> {
        let face = self.faces.first().ok_or(Error::NoFace)?;
        Ok(self.before(face.side, 0.0))
    }

    fn before(&self, side: BoxSide, distance: f64) -> Vector3<f64> {
        self.towards(&self.out_of(side), distance)
    }

    /// The direction out of a side, in the tool's axes.
    pub(crate) fn out_of(&self, side: BoxSide) -> Unit<Vector3<f64>> {
        Unit::new_unchecked(self.tool_from_object.rotation * side.normal())
    }

    /// The point at this distance from the box in a direction of the tool's axes, from its middle, in the tool's frame
    /// \[m\].
    pub(crate) fn towards(&self, direction: &Unit<Vector3<f64>>, distance: f64) -> Vector3<f64> {
        let normal = self.tool_from_object.rotation.inverse() * **direction;
        let half = 0.5 * self.size.dot(&normal.abs());
        (self.tool_from_object * Point3::from(normal * (half + distance))).coords
    }

    /// The rotation of the tool, in its own axes, that brings a side to the place of the first one. It is half a turn
    /// about the tool's z axis, where that suffices.
    pub(crate) fn turn_to_show(&self, side: BoxSide) -> UnitQuaternion<f64> {
        let shown = self.faces.first().map_or(BoxSide::Front, |face| face.side);
        let (from, to) = (self.out_of(side), self.out_of(shown));
        UnitQuaternion::rotation_between_axis(&from, &to).unwrap_or_else(|| {
            let across = Vector3::z() - *from * from.z;
            let axis = Unit::try_new(across, 0.5).unwrap_or_else(Vector3::y_axis);
            UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI)
        })
    }

    /// The surface of a side, if it has one.
    pub(crate) fn surface_of(&self, side: BoxSide) -> Option<Surface> {
        self.faces.iter().find(|face| face.side == side).map(|face| face.surface)
    }

    /// The first side with this surface.
    pub(crate) fn side_with(&self, surface: Surface) -> Option<BoxSide> {
        self.faces.iter().find(|face| face.surface == surface).map(|face| face.side)
    }

    /// Sets the surface of a side. If another side had it, the two exchange their surfaces.
    pub(crate) fn identify(&mut self, side: BoxSide, surface: Surface) {
        let Some(at) = self.faces.iter().position(|face| face.side == side) else { return };
        let other = self.faces.iter().position(|face| face.surface == surface);
        if let (Some(found), Some(face)) = (self.surface_of(side), self.faces.get_mut(at)) {
            face.surface = surface;
            if let Some(other) = other.and_then(|other| self.faces.get_mut(other))
                && other.side != side
            {
                other.surface = found;
            }
        }
    }

    /// A capsule around the box, in the frame of the robot's tool.
    ///
    /// # Errors
    /// [`Error::Workspace`] for sizes that are not finite.
    pub fn capsule(&self) -> Result<Capsule, Error> {
        let half = self.size * 0.5;
        let longest = half.imax();
        let across = (half.norm_squared() - half[longest] * half[longest]).max(0.0).sqrt();
        // The capsule is a little wider than the box, so that its round ends contain the corners without much length.
        let radius = 1.04 * across;
        let reach = (half[longest] - (radius * radius - across * across).sqrt()).max(0.0);
        let mut along = Vector3::zeros();
        along[longest] = reach;
        let end = |offset: Vector3<f64>| (self.tool_from_object * Point3::from(offset)).coords;
        Ok(Capsule::new(end(-along), end(along), radius)?)
    }

    /// The payload of the object, carried by the tool's frame.
    pub fn payload(&self, tool: FrameId) -> Payload {
        let squares = self.size.component_mul(&self.size) * (self.mass / 12.0);
        let moments = Vector3::repeat(squares.sum()) - squares;
        let rotation = self.tool_from_object.rotation.to_rotation_matrix();
        Payload {
            frame: tool,
            mass: self.mass,
            centre: self.tool_from_object.translation.vector.into(),
            inertia: rotation * Matrix3::from_diagonal(&moments) * rotation.transpose(),
        }
    }
}
