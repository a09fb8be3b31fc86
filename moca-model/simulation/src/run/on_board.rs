//! The robot's own camera, which recognises the surface of the grasped object.

use moca_model::GraspedObject;
use nalgebra::{Isometry3, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Confidence, RecognisedSurface, Surface};

use crate::error::Error;
use crate::plant::Plant;

/// Random stream of the camera.
const STREAM: u64 = 300;

/// Probability that a surface is not seen, and that it is confused with the other.
const MISSED: f64 = 0.02;
const MISTAKEN: f64 = 0.02;

/// Least cosine of the angle between a visible side's normal and the direction to the camera: 60°.
const SEEN: f64 = 0.5;

/// State of the robot that the on-board camera is told.
#[derive(Clone, Copy, Debug)]
pub struct RobotView {
    /// Place of the camera in the frame of the base on the floor \[m\]; `None` without a camera.
    pub camera: Option<[f64; 3]>,
    /// Pose of the base on the floor: x, y \[m\] and yaw \[rad\].
    pub base: [f64; 3],
    /// Pose of the tool in the world.
    pub tool: Isometry3<f64>,
    /// True if the robot holds the object.
    pub holds: bool,
}

impl RobotView {
    pub(crate) fn of(plant: &Plant) -> Self {
        let controller = plant.controller();
        Self {
            camera: controller.settings().on_board_camera,
            base: [0, 1, 2].map(|joint| plant.configuration()[joint]),
            tool: *plant.tool(),
            holds: controller.object().is_some(),
        }
    }
}

/// A camera on the base with a network that makes mistakes.
#[derive(Clone, Debug)]
pub(crate) struct OnBoardEye {
    draw: ChaCha8Rng,
}

impl OnBoardEye {
    pub(crate) fn new(seed: u64) -> Self {
        Self { draw: simulated_people::generator(seed, STREAM) }
    }

    /// The surface of the true object that faces the camera; none while the robot holds nothing.
    pub(crate) fn look(
        &mut self,
        robot: &RobotView,
        object: &GraspedObject,
    ) -> Result<Option<RecognisedSurface>, Error> {
        // The random numbers are always drawn, so that later ones do not depend on what is seen.
        let sure = self.draw.random_range(0.8..0.99);
        let (missed, mistaken) = (self.draw.random_bool(MISSED), self.draw.random_bool(MISTAKEN));
        let Some(camera) = robot.camera.map(Vector3::from) else { return Ok(None) };
        if !robot.holds || missed {
            return Ok(None);
        }
        let [x, y, yaw] = robot.base;
        let (sine, cosine) = yaw.sin_cos();
        let eye = Vector3::new(
            x + cosine * camera.x - sine * camera.y,
            y + sine * camera.x + cosine * camera.y,
            camera.z,
        );
        let from_world = (robot.tool * object.tool_from_object).inverse();
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
