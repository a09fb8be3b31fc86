//! A simulated pose network.

use nalgebra::Point2;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::json;
use simulated_people::Joints;
use vision_models::{Body25, Camera, Confidence, ImageBody, ImageKeypoint};

use super::image::RenderedImage;

/// Distance in front of a joint beyond which a surface hides it \[m\]: more than flesh and clothes.
const HIDDEN: f64 = 0.17;

/// Probability that a hidden joint is guessed, and the factor of its error.
const GUESSED: f64 = 0.3;
const GUESS: f64 = 3.0;

/// Quality of the network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkeletonSettings {
    /// Standard deviation of a joint, each axis (pixels). Default 3.
    pub pixel_sigma: f64,
    /// Probability that a joint is missing. Default 0.02.
    pub drop: f64,
}

impl Default for SkeletonSettings {
    fn default() -> Self {
        Self { pixel_sigma: 3.0, drop: 0.02 }
    }
}

/// A pose network as a source of errors. Joints are off by some pixels, missing, or guessed where they are hidden.
#[derive(Clone, Debug)]
pub struct PoseEstimator {
    settings: SkeletonSettings,
    draw: ChaCha8Rng,
}

impl PoseEstimator {
    /// Creates a network. The same draws give the same errors.
    pub fn new(settings: SkeletonSettings, draw: ChaCha8Rng) -> Self {
        Self { settings, draw }
    }

    /// The joints \[m, world\] of a person in the image that a camera took of them.
    pub fn see(&mut self, joints: &Joints, camera: &Camera, image: &RenderedImage) -> ImageBody {
        let mut body = ImageBody::default();
        for joint in Body25::ALL {
            // The random numbers are always drawn, so that later ones do not depend on what is seen.
            let mut normal = || -> f64 { StandardNormal.sample(&mut self.draw) };
            let (dx, dy, quality) = (normal(), normal(), normal());
            let missing = self.draw.random_bool(self.settings.drop);
            let guessed = self.draw.random_bool(GUESSED);
            let place = joints[joint.index()];
            let Some(pixel) = camera.project(&place).filter(|_| !missing) else { continue };
            let depth = camera.world_from_camera().inverse_transform_point(&place).z;
            let Some(seen) = depth_at(image, &pixel) else { continue };
            let hidden = seen < depth - HIDDEN;
            if hidden && !guessed {
                continue;
            }
            let (factor, sure) = if hidden { (GUESS, 0.3) } else { (1.0, 0.8) };
            let sigma = self.settings.pixel_sigma * factor;
            let position = Point2::new(pixel.x + sigma * dx, pixel.y + sigma * dy);
            let confidence = (sure + 0.06 * quality).clamp(0.05, 0.98);
            if let Ok(confidence) = Confidence::new(confidence) {
                body.set(joint, Some(ImageKeypoint { position, confidence }));
            }
        }
        body
    }

    /// Writes people as the JSON of OpenPose.
    pub fn json(people: &[ImageBody]) -> String {
        let people: Vec<_> = people
            .iter()
            .map(|body| {
                let joints = body.keypoints().iter().flat_map(|joint| {
                    let round = |value: f64| (1e3 * value).round() / 1e3;
                    joint.map_or([0.0; 3], |joint| {
                        let ImageKeypoint { position, confidence } = joint;
                        [round(position.x), round(position.y), round(confidence.value())]
                    })
                });
                json!({ "person_id": [-1], "pose_keypoints_2d": joints.collect::<Vec<_>>() })
            })
            .collect();
        json!({ "version": 1.3, "people": people }).to_string()
    }
}

/// The depth at a pixel \[m\], if it is in the image.
fn depth_at(image: &RenderedImage, pixel: &Point2<f64>) -> Option<f64> {
    let [width, height] = image.size();
    let (x, y) = (pixel.x.round(), pixel.y.round());
    let inside = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the image")]
    inside.then(|| f64::from(image.depth_at(x as usize, y as usize)))
}
