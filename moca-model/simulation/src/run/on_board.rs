//! The robot's own camera, which recognises the surface of the grasped object.

use human_perception::random;
use moca_model::GraspedObject;
use nalgebra::Vector3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Confidence, RecognisedSurface, Surface};

use crate::Error;
use crate::plant::Plant;

/// Random stream of the camera.
const STREAM: u64 = 300;

/// Probability that a surface is not seen, and that it is confused with the other.
const MISSED: f64 = 0.02;
const MISTAKEN: f64 = 0.02;

/// Least cosine of the angle between a visible side's normal and the direction to the camera: 60°.
const SEEN: f64 = 0.5;

/// A camera on the base with a network that makes mistakes.
#[derive(Clone, Debug)]
pub(crate) struct OnBoardEye {
    draw: ChaCha8Rng,
}

impl OnBoardEye {
    pub(crate) fn new(seed: u64) -> Self {
        Self { draw: random::generator(seed, STREAM) }
    }

    /// The surface of the true object that faces the camera; none while the robot holds nothing.
    pub(crate) fn look(
        &mut self,
        plant: &Plant,
        object: &GraspedObject,
    ) -> Result<Option<RecognisedSurface>, Error> {
        // The random numbers are always drawn, so that later ones do not depend on what is seen.
        let sure = self.draw.random_range(0.8..0.99);
        let (missed, mistaken) = (self.draw.random_bool(MISSED), self.draw.random_bool(MISTAKEN));
        let Some(camera) = plant.controller().settings().on_board_camera else { return Ok(None) };
        let camera = Vector3::from(camera);
        if plant.controller().object().is_none() || missed {
            return Ok(None);
        }
        let tool = plant.tool();
        let [x, y, yaw] = [0, 1, 2].map(|joint| plant.configuration()[joint]);
        let (sine, cosine) = yaw.sin_cos();
        let eye = Vector3::new(
            x + cosine * camera.x - sine * camera.y,
            y + sine * camera.x + cosine * camera.y,
            camera.z,
        );
        let from_world = (tool * object.tool_from_object).inverse();
        let way = (from_world * nalgebra::Point3::from(eye)).coords.normalize();
        let facing = object.faces.iter().filter(|face| face.side.normal().dot(&way) >= SEEN);
        let surface = facing.map(|face| face.surface).next();
        let other = |surface| match surface {
            Surface::Smooth => Surface::Drilled,
            Surface::Drilled => Surface::Smooth,
        };
        let confidence = Confidence::new(if mistaken { sure - 0.3 } else { sure })?;
        Ok(surface.map(|surface| RecognisedSurface {
            surface: if mistaken { other(surface) } else { surface },
            confidence,
        }))
    }
}
