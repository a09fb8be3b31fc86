//! Identification of the object's surfaces by the on-board camera.

use nalgebra::{UnitQuaternion, Vector3};
use vision_models::{Percept, Surface};

use super::Controller;
use crate::box_side::BoxSide;
use crate::error::Error;
use crate::intention::{DWELL, ENTER};
use crate::interaction::{Phase, Sight};

/// Least cosine of the angle between a side's normal and the direction to the camera at which the side faces the
/// camera: 60°.
const FACES: f64 = 0.5;

/// The camera's knowledge of the object.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SeenSurface {
    /// A surface that is seen in place of the expected one, and since when \[s\].
    since: Option<(f64, BoxSide, Surface)>,
    /// Whether the camera has confirmed or corrected the places of the surfaces.
    known: bool,
}

/// The side to work on that faces the camera most.
struct NearestSide {
    side: BoxSide,
    /// Normal of the side in the world, outwards.
    normal: Vector3<f64>,
    /// Unit vector from the middle of the object to the camera, in the world.
    way: Vector3<f64>,
}

impl Controller {
    /// Takes the surface that faces the on-board camera. A surface other than the expected one is accepted once it has
    /// been seen for the dwell time of intentions.
    pub(super) fn look(&mut self, percept: &Percept) {
        let seen = percept.surface.filter(|seen| seen.confidence.value() >= ENTER);
        // The surface of a turning object is seen late.
        let still = !matches!(self.command.phase, Phase::Turning { .. });
        let (Some(seen), Some(side), true) = (seen, self.side_that_faces_camera(), still) else {
            self.workpiece.seen_surface.since = None;
            return;
        };
        let Some(object) = &mut self.workpiece.object else { return };
        let known = object.surface_of(side);
        if known.is_none_or(|known| known == seen.surface) {
            self.workpiece.seen_surface.since = None;
            self.workpiece.seen_surface.known |= known.is_some();
            return;
        }
        let since = match self.workpiece.seen_surface.since {
            Some((since, at, surface)) if (at, surface) == (side, seen.surface) => since,
            _ => percept.time,
        };
        self.workpiece.seen_surface.since = Some((since, side, seen.surface));
        if percept.time - since >= DWELL {
            object.identify(side, seen.surface);
            self.workpiece.seen_surface = SeenSurface { since: None, known: true };
        }
    }

    /// The camera's knowledge of the object.
    pub(super) fn sight(&self) -> Sight {
        let wants = self.settings.on_board_camera.is_some() && self.workpiece.object.is_some();
        if !wants || self.workpiece.seen_surface.known {
            Sight::Known
        } else if self.side_that_faces_camera().is_some() {
            Sight::Facing
        } else {
            Sight::Hidden
        }
    }

    /// Turns the object about the vertical until the side nearest to the camera faces it, in the phase for that. The
    /// base, which carries the camera, turns along. So the goal moves from frame to frame.
    pub(super) fn turn_to_camera(&mut self) -> Result<(), Error> {
        if self.command.phase != Phase::Looking || self.sight() != Sight::Hidden {
            return Ok(());
        }
        let Some(NearestSide { normal, way, .. }) = self.side_nearest_to_camera() else {
            return Ok(());
        };
        let angle = normal.xy().perp(&way.xy()).atan2(normal.xy().dot(&way.xy()));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let workspace = self.space.workspace();
        let world = workspace.world_from_workspace().rotation;
        let goal = world.inverse() * turn * world * workspace.reference();
        Ok(self.space.moving_mut().reorient(goal, &Vector3::z_axis())?)
    }

    /// The side to work on that faces the on-board camera, if there is a camera and such a side.
    fn side_that_faces_camera(&self) -> Option<BoxSide> {
        let nearest = self.side_nearest_to_camera()?;
        (nearest.normal.dot(&nearest.way) >= FACES).then_some(nearest.side)
    }

    fn side_nearest_to_camera(&self) -> Option<NearestSide> {
        let (object, camera) = (self.workpiece.object.as_ref()?, self.settings.on_board_camera?);
        let camera = Vector3::from(camera);
        let [x, y, yaw, ..] = self.motion.reference[..] else { return None };
        let (sine, cosine) = yaw.sin_cos();
        let camera = Vector3::new(
            x + cosine * camera.x - sine * camera.y,
            y + sine * camera.x + cosine * camera.y,
            camera.z,
        );
        let tool = self.robot.world_from_tool();
        let middle = (tool * object.tool_from_object).translation.vector;
        let way = (camera - middle).try_normalize(0.0)?;
        let sides = object.faces.iter().map(|face| {
            let normal = tool.rotation * *object.out_of(face.side);
            NearestSide { side: face.side, normal, way }
        });
        sides.max_by(|one, other| one.normal.dot(&way).total_cmp(&other.normal.dot(&way)))
    }
}
