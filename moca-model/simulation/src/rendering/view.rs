//! Rendering of scenes to images.

use nalgebra::{Point2, Point3, Vector3};
use vision_models::{Camera, DepthNoise, Error, Intrinsics};

use super::{
    image::RenderedImage,
    scene::Scene,
    shape::{Capsule, Hit},
};

/// Point that the camera looks at, in the world \[m\].
const TARGET: Point3<f64> = Point3::new(2.0, 0.0, 0.9);

/// Place of the camera, at the height of HRI30's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Viewpoint {
    /// Beside the workplace, where arms and hands hide the hips of the working person.
    Beside,
    /// Behind the robot, where it sees a person who faces the robot from the front.
    Facing,
}

impl Viewpoint {
    /// The place in the world \[m\].
    fn eye(self) -> Point3<f64> {
        match self {
            Self::Beside => Point3::new(0.3, 1.8, 2.3),
            Self::Facing => Point3::new(-0.4, 0.5, 2.3),
        }
    }
}

/// Focal length of a D435i's colour camera over the image's width.
const FOCAL: f64 = 615.0 / 640.0;

/// Creates the camera of the simulation: a RealSense D435i with images of this width and height (pixels).
///
/// # Errors
/// [`Error::Value`] for an invalid size.
pub(crate) fn simulated_camera(viewpoint: Viewpoint, size: [usize; 2]) -> Result<Camera, Error> {
    let [width, height] = size.map(|side| side as f64);
    let focal = FOCAL * width;
    let centre = [0.5 * (width - 1.0), 0.5 * (height - 1.0)];
    let intrinsics = Intrinsics::new(size, [focal, focal], centre)?;
    Camera::looking_at(intrinsics, viewpoint.eye(), TARGET, DepthNoise::D435I)
}

/// Renders what a camera sees, without noise.
pub(crate) fn render(scene: &Scene, camera: &Camera) -> RenderedImage {
    render_before(render_room(scene, camera), scene, camera)
}

/// Renders floor and walls alone.
pub(super) fn render_room(scene: &Scene, camera: &Camera) -> RenderedImage {
    let [width, height] = camera.intrinsics().size();
    let image = RenderedImage {
        size: [width, height],
        colour: vec![0; 3 * width * height],
        depth: vec![f32::INFINITY; width * height],
    };
    let mut view = View::new(image, scene, camera);
    view.draw([0, 0, width, height], |ray| scene.background(ray));
    view.image
}

/// Renders what a camera sees in front of a rendered room.
pub(super) fn render_before(room: RenderedImage, scene: &Scene, camera: &Camera) -> RenderedImage {
    let mut view = View::new(room, scene, camera);
    for textured in &scene.boxes {
        let radius = textured.half.norm();
        let middle = Point3::from(textured.pose.translation.vector);
        if let Some(part) = view.part(&[middle], radius) {
            view.draw(part, |ray| textured.hit(ray));
        }
    }
    for capsule in &scene.capsules {
        let Capsule { ends, radius, .. } = capsule;
        if let Some(part) = view.part(ends, *radius) {
            view.draw(part, |ray| capsule.hit(ray));
        }
    }
    view.image
}

struct View {
    image: RenderedImage,
    rays: Intrinsics,
    light: Vector3<f64>,
}

impl View {
    fn new(image: RenderedImage, scene: &Scene, camera: &Camera) -> Self {
        Self { image, rays: *camera.intrinsics(), light: scene.light }
    }

    /// The first and last column and row of the part of the image with these points and a radius.
    fn part(&self, points: &[Point3<f64>], radius: f64) -> Option<[usize; 4]> {
        let ([width, height], [focal, _]) = (self.rays.size(), self.rays.focal());
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            let near = (point.z - radius).max(0.05);
            let pixel = self.rays.project(&Point3::new(point.x, point.y, point.z.max(0.05)))?;
            let reach = 1.3 * radius * focal / near;
            for axis in 0..2 {
                low[axis] = f64::min(low[axis], pixel[axis] - reach);
                high[axis] = f64::max(high[axis], pixel[axis] + reach);
            }
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let inside = |value: f64, side: usize| value.clamp(0.0, side as f64) as usize;
        let part = [
            inside(low[0], width),
            inside(low[1], height),
            inside(high[0] + 1.0, width),
            inside(high[1] + 1.0, height),
        ];
        (part[0] < part[2] && part[1] < part[3]).then_some(part)
    }

    /// Draws pixels that are nearer than the present ones.
    fn draw(
        &mut self,
        [left, top, right, bottom]: [usize; 4],
        hit: impl Fn(&Vector3<f64>) -> Option<Hit>,
    ) {
        let [width, _] = self.image.size;
        for row in top..bottom {
            for column in left..right {
                let ray = self.rays.ray(&Point2::new(column as f64, row as f64));
                let index = row * width + column;
                let (Some(hit), Some(depth)) = (hit(&ray), self.image.depth.get_mut(index)) else {
                    continue;
                };
                #[expect(clippy::cast_possible_truncation, reason = "a depth needs no more digits")]
                let nearer = hit.depth as f32;
                if nearer >= *depth {
                    continue;
                }
                *depth = nearer;
                let shade = 0.35 + 0.65 * hit.normal.dot(&self.light).abs();
                let pixel = self.image.colour.get_mut(3 * index..3 * index + 3);
                let Some(pixel) = pixel else { continue };
                for (byte, colour) in pixel.iter_mut().zip(&hit.colour) {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "clamped"
                    )]
                    let value = (255.0 * colour * shade).clamp(0.0, 255.0) as u8;
                    *byte = value;
                }
            }
        }
    }
}
