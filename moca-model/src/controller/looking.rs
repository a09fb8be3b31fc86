//! Which surface of the object is on which side: what the on-board camera tells.

use nalgebra::Vector3;
use vision_models::{Percept, Surface};

use super::Controller;
use crate::held_object::BoxSide;
use crate::interaction::Phase;

/// A side faces the camera if the cosine of the angle between its normal and the way to the camera is at
/// least this: within 60°.
const FACES: f64 = 0.5;

/// A surface that is seen where another was taken to be, and since when \[s\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SeenSurface {
    since: Option<(f64, BoxSide, Surface)>,
}

impl Controller {
    /// Takes the surface that faces the on-board camera. One that differs from what was taken to be there
    /// is believed when it has been seen for as long as a new intention must be.
    pub(super) fn look(&mut self, percept: &Percept) {
        let settings = &self.settings.intention;
        let seen = percept.surface.filter(|seen| seen.confidence.value() >= settings.enter);
        // What turns is seen late.
        let still = !matches!(self.interaction.phase(), Phase::Turning { .. });
        let (Some(seen), Some(side), true) = (seen, self.side_that_faces_camera(), still) else {
            self.seen_surface.since = None;
            return;
        };
        let Some(object) = &mut self.object else { return };
        if object.surface_of(side).is_none_or(|known| known == seen.surface) {
            self.seen_surface.since = None;
            return;
        }
        let since = match self.seen_surface.since {
            Some((since, at, surface)) if (at, surface) == (side, seen.surface) => since,
            _ => percept.time,
        };
        self.seen_surface.since = Some((since, side, seen.surface));
        if percept.time - since >= settings.dwell {
            object.identify(side, seen.surface);
            self.seen_surface.since = None;
        }
    }

    /// The worked side of the object that faces the on-board camera, if there is a camera and one does.
    fn side_that_faces_camera(&self) -> Option<BoxSide> {
        let (object, camera) = (self.object.as_ref()?, self.settings.on_board_camera?);
        let camera = Vector3::from(camera);
        let [x, y, yaw, ..] = self.reference[..] else { return None };
        let (sine, cosine) = yaw.sin_cos();
        let camera = Vector3::new(
            x + cosine * camera.x - sine * camera.y,
            y + sine * camera.x + cosine * camera.y,
            camera.z,
        );
        let tool = self.robot.world_from_tool();
        let middle = (tool * object.tool_from_object).translation.vector;
        let way = (camera - middle).try_normalize(0.0)?;
        let cosine = |side: BoxSide| (tool.rotation * *object.out_of(side)).dot(&way);
        let sides = object.faces.iter().map(|face| (face.side, cosine(face.side)));
        let best = sides.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (best.1 >= FACES).then_some(best.0)
    }
}
