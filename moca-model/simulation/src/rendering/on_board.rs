//! The robot's own camera, which looks at the object.

use nalgebra::{Point3, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Camera, DepthNoise, Error, Intrinsics};

/// Width and height of its images (pixels).
const SIZE: [usize; 2] = [128, 96];

/// Mean place of the camera, and what it looks at \[m, world\]: the face of the object that the robot holds.
const EYE: Point3<f64> = Point3::new(0.35, 0.0, 1.15);
const TARGET: Point3<f64> = Point3::new(0.75, 0.0, 1.05);

/// Deviation of its mount, and amplitude of the arm's motion \[m\].
const MOUNTED: f64 = 0.05;
const MOVES: f64 = 0.01;

/// A camera on the robot whose mount varies with each draw, and which moves with the arm.
#[derive(Clone, Debug)]
pub(super) struct OnBoardCamera {
    eye: Point3<f64>,
    target: Point3<f64>,
    draw: ChaCha8Rng,
}

impl OnBoardCamera {
    /// Creates a camera. The same draws give the same views.
    pub(super) fn new(mut draw: ChaCha8Rng) -> Self {
        let (eye, target) = (EYE + off(MOUNTED, &mut draw), TARGET + off(MOUNTED, &mut draw));
        Self { eye, target, draw }
    }

    /// The camera in the next frame.
    ///
    /// # Errors
    /// None known.
    pub(super) fn next_view(&mut self) -> Result<Camera, Error> {
        let eye = self.eye + off(MOVES, &mut self.draw);
        let target = self.target + off(MOVES, &mut self.draw);
        let [width, height] = SIZE.map(|side| side as f64);
        let centre = [0.5 * (width - 1.0), 0.5 * (height - 1.0)];
        let intrinsics = Intrinsics::new(SIZE, [width, width], centre)?;
        Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I)
    }
}

fn off(reach: f64, draw: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| draw.random_range(-reach..reach))
}
