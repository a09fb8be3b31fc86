//! The frames of a simulated walk as the camera sees them.

use human_perception::frames::FrameEntry;
use percept_recording::Header;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use simulated_people::{FRAME_RATE, Walker, WalkerSettings};
use vision_models::{
    Action, Body, Camera, Confidence, DepthImage, ImageBody, Keypoint, Percept, RecognisedAction,
    RecognisedSurface,
};

use super::{
    appearance::Appearance,
    image::RenderedImage,
    noise::DepthSensor,
    on_board::OnBoardCamera,
    scene::{Scene, SceneState},
    skeleton::{PoseEstimator, SkeletonSettings},
    view::{self, Viewpoint},
};
use crate::error::Error;

/// Random streams besides those of the walker.
const SENSOR: u64 = 100;
const POSES: u64 = 101;
const LATENCY: u64 = 102;
const ON_BOARD: u64 = 103;
const APPEARANCE: u64 = 104;

/// Delay of a frame \[s\].
const LATE: std::ops::Range<f64> = 0.02..0.09;

/// Image width at which the noise has the given number of pixels.
const WIDTH: f64 = 640.0;

/// A frame with its truth.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Number and times.
    pub entry: FrameEntry,
    /// Colour, and depth without noise.
    pub image: RenderedImage,
    /// Depth as the sensor measures it.
    pub depth: DepthImage,
    /// The on-board camera's image of the object.
    pub surface: RenderedImage,
    /// The result of a pose network; `None` if the person is not in the image.
    pub skeleton: Option<ImageBody>,
    /// The true person with their action, and the surface of the object.
    pub truth: Percept,
}

/// The frames of a walk.
#[derive(Debug)]
pub struct Film {
    walker: Walker,
    camera: Camera,
    on_board: OnBoardCamera,
    appearance: Appearance,
    /// Image of the room, which does not change.
    room: Option<RenderedImage>,
    sensor: DepthSensor,
    poses: PoseEstimator,
    latency: ChaCha8Rng,
    frame: u64,
    arrived: f64,
}

impl Film {
    /// Creates the film of a walk from a viewpoint, with images of this width and height.
    ///
    /// The camera's noise and the share of missing joints are those of `settings.camera`. Joints of the skeletons have
    /// errors of `pixel_sigma` in images 640 pixels wide. The person does not jump or vanish.
    ///
    /// # Errors
    /// [`Error::Value`] names the setting that is wrong.
    pub fn new(
        settings: WalkerSettings,
        viewpoint: Viewpoint,
        size: [usize; 2],
        pixel_sigma: f64,
    ) -> Result<Self, Error> {
        let refuse = |what, got, wanted| Error::Value { what, got, wanted };
        if !(0.0..=100.0).contains(&pixel_sigma) {
            return Err(refuse("pixel-noise", pixel_sigma, "0 to 100 pixels"));
        }
        let camera = view::simulated_camera(viewpoint, size)
            .map_err(|_| refuse("size", size[0] as f64, "sides of 1 to 16384 pixels"))?;
        let (seed, seen) = (settings.seed, settings.camera);
        let walker = Walker::new(settings)?;
        let draw = |stream| simulated_people::generator(seed, stream);
        let pixel_sigma = pixel_sigma * size[0] as f64 / WIDTH;
        let skeletons = SkeletonSettings { pixel_sigma, drop: seen.drop };
        Ok(Self {
            walker,
            sensor: DepthSensor::new(size, *camera.noise(), seen.noise, draw(SENSOR)),
            poses: PoseEstimator::new(skeletons, draw(POSES)),
            latency: draw(LATENCY),
            on_board: OnBoardCamera::new(draw(ON_BOARD)),
            appearance: Appearance::default(),
            room: None,
            camera,
            frame: 0,
            arrived: 0.0,
        })
    }

    /// Varies clothes, room and light by the seed.
    #[must_use]
    pub fn varied(mut self) -> Self {
        let seed = self.walker.settings().seed;
        self.appearance = Appearance::random(&mut simulated_people::generator(seed, APPEARANCE));
        self.room = None;
        self
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The header of a recording of the truth.
    pub fn header(&self) -> Header {
        self.walker.header()
    }

    /// The number of frames.
    pub fn expected_frames(&self) -> u64 {
        self.walker.expected_frames()
    }

    fn shoot(&mut self) -> Option<Result<Shot, Error>> {
        let (truth, _) = self.walker.next_frame()?;
        let time = truth.time;
        let person = self.walker.person();
        let (joints, stature) = (person.joints(), person.stature());
        let surface = self.walker.settings().tool.surface();
        let (action, appearance) = (truth.action, &self.appearance);
        let state = SceneState { joints: &joints, stature, action, surface, appearance };
        let scene = Scene::new(&state, &self.camera);
        let room = self.room.get_or_insert_with(|| view::render_room(&scene, &self.camera));
        let image = view::render_before(room.clone(), &scene, &self.camera);
        let on_board = match self.on_board.next_view() {
            Ok(camera) => camera,
            Err(error) => return Some(Err(error.into())),
        };
        let of_surface = view::render(&Scene::new(&state, &on_board), &on_board);
        let depth = match self.sensor.measure(&image, 1.0 / FRAME_RATE) {
            Ok(depth) => depth,
            Err(error) => return Some(Err(error.into())),
        };
        let skeleton = Some(self.poses.see(&joints, &self.camera, &image))
            .filter(|skeleton| skeleton.iter().next().is_some());
        let confidence = Confidence::ONE;
        let keypoints = joints.map(|position| Some(Keypoint { position, confidence }));
        let action = RecognisedAction { action, confidence };
        // The object does not face the on-board camera while it is carried in the hands.
        let faces = truth.action != Action::WalkingWithObject;
        let surface = faces.then_some(RecognisedSurface { surface, confidence });
        let body = Some(Body::new(keypoints));
        let truth = Percept { time, body, action: Some(action), surface };
        let late = self.latency.random_range(LATE);
        self.arrived = self.arrived.max(time + late);
        let entry = FrameEntry { frame: self.frame, time, arrived: Some(self.arrived) };
        self.frame += 1;
        Some(Ok(Shot { entry, image, depth, surface: of_surface, skeleton, truth }))
    }
}

impl Iterator for Film {
    type Item = Result<Shot, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.shoot()
    }
}
