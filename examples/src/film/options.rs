//! Options for films: sources, cameras, and facts about the person.

use std::path::PathBuf;

use anyhow::{Result, bail, ensure};
use clap::Args;
use human_perception::film::{Film, FilmSettings, View};
use vision_models::{
    CalibratedCamera, Camera, DepthNoise, Distortion, Intrinsics, MonocularSettings,
    nalgebra::Point3,
};

use crate::posture::PostureOptions;
use crate::program::Threads;

/// The height of a camera that nobody has measured (m), and how wrong that is.
const HEIGHT: f64 = 1.3;
const HEIGHT_SIGMA: f64 = 0.5;

/// Images of joints without an image: any size will do.
const NO_IMAGE: [usize; 2] = [1000, 1000];

/// A film of a person: images or joints, of one camera without depth or of several that are calibrated.
#[derive(Args, Debug)]
pub struct FilmOptions {
    /// Score a person on film: a video, which ffmpeg takes apart, or a folder of images; of several cameras, which see the
    /// person at the same time, one each.
    #[arg(long, value_name = "FILE", num_args = 1.., group = "source", requires = "pose")]
    video: Vec<PathBuf>,
    /// The same of joints that another program has found: a file of a whole film, or a folder with a file for each image.
    /// OpenPose's, mmpose's, AlphaPose's and MediaPipe's JSON are known; of one camera MediaPipe's metric landmarks are
    /// needed.
    #[arg(long, value_name = "FILE", num_args = 1.., group = "source")]
    joints: Vec<PathBuf>,
    /// BlazePose's landmarks, a .tflite of MediaPipe's package @mediapipe/pose.
    #[arg(long, value_name = "FILE")]
    pose: Option<PathBuf>,
    /// BlazePose's detector; pose_solution_packed_assets.data beside the landmarks without it.
    #[arg(long, value_name = "FILE", requires = "pose")]
    pose_detector: Option<PathBuf>,
    /// The most people whom BlazePose follows in a film.
    #[arg(long, value_name = "COUNT", default_value_t = 1)]
    pose_people: usize,
    /// The cameras in the order of the films: a .qca.txt of Qualisys with all of them, or the YAML of OpenCV or ROS of
    /// each. A camera alone needs none.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    calibration: Vec<PathBuf>,
    /// Field of view of a camera without a calibration (degrees, along the longer side of the image).
    #[arg(long, value_name = "DEGREES", default_value_t = 65.0)]
    field_of_view: f64,
    /// The height of a camera alone above the floor (m): it tells how large the person is.
    #[arg(long, value_name = "METRES")]
    camera_height: Option<f64>,
    /// Downward tilt of a camera alone (degrees). An error of it is one of the trunk.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    camera_tilt: f64,
    /// The person's stature (m), if it is known.
    #[arg(long, value_name = "METRES")]
    stature: Option<f64>,
    /// Images a second: a video is taken apart into so many, and a folder or a file of joints has so many.
    #[arg(long, value_name = "HERTZ", default_value_t = 25.0)]
    rate: f64,
    /// Width and height of the images in which joints were found, such as 1280x720: MediaPipe's are parts of them.
    #[arg(long, value_name = "PIXELS", value_parser = size)]
    size: Option<[usize; 2]>,
    #[command(flatten)]
    posture: PostureOptions,
    #[command(flatten)]
    threads: Threads,
}

/// Two whole numbers with an x between them.
fn size(text: &str) -> Result<[usize; 2], String> {
    let sides = text
        .split_once('x')
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.ok_or_else(|| "give width and height, such as 1280x720".to_owned())
}

impl FilmOptions {
    /// Name of what is filmed, for titles and messages.
    pub fn title(&self) -> String {
        let name = |path: &PathBuf| path.file_name().unwrap_or_default().display().to_string();
        self.video.iter().chain(&self.joints).map(name).collect::<Vec<_>>().join(", ")
    }

    /// Images a second.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Opens films and networks.
    ///
    /// # Errors
    /// Options outside their ranges, and files that cannot be used.
    pub fn open(&self) -> Result<Film> {
        let rate = self.rate;
        ensure!((0.1..=1000.0).contains(&rate), "--rate {rate}: give 0.1 to 1000 images a second");
        let posture = self.posture.settings()?;
        let networks = [self.pose.as_deref(), self.pose_detector.as_deref()];
        let threads = self.threads.count();
        let of_images =
            |film: &PathBuf| View::images(film, rate, networks, self.pose_people, threads);
        let of_joints = |film: &PathBuf| View::joints(film, rate, self.size);
        let views = self.video.iter().map(of_images).chain(self.joints.iter().map(of_joints));
        let views = views.collect::<Result<Vec<_>, _>>()?;
        let size = views.first().and_then(View::size).or(self.size).unwrap_or(NO_IMAGE);
        let height_sigma = match self.camera_height {
            Some(_) => MonocularSettings::default().height_sigma,
            None => HEIGHT_SIGMA,
        };
        let stature = self.stature;
        let monocular = MonocularSettings { stature, height_sigma, ..MonocularSettings::default() };
        monocular.validate()?;
        let settings = FilmSettings { monocular, posture, ..FilmSettings::default() };
        Ok(Film::new(views, self.cameras(size)?, rate, &settings)?)
    }

    /// The cameras: calibrated ones, or the one that stands somewhere before the person.
    fn cameras(&self, size: [usize; 2]) -> Result<Vec<CalibratedCamera>> {
        let films = self.video.len() + self.joints.len();
        let mut cameras = Vec::new();
        for file in &self.calibration {
            cameras.extend(CalibratedCamera::read(file)?);
        }
        if films > 1 {
            ensure!(!cameras.is_empty(), "several films: give --calibration of their cameras");
            return Ok(cameras);
        }
        let mut camera = match cameras.len() {
            0 => self.uncalibrated(size)?,
            1 => cameras.remove(0),
            count => bail!("one film and {count} cameras: give the calibration of the one"),
        };
        let is_placed = self.camera_height.is_some() || self.camera_tilt != 0.0;
        if camera.world_from_camera.is_none() || is_placed {
            let tilt = self.camera_tilt;
            ensure!((-80.0..=80.0).contains(&tilt), "--camera-tilt {tilt}: give -80 to 80 degrees");
            let height = self.camera_height.unwrap_or(HEIGHT);
            ensure!((0.05..=20.0).contains(&height), "--camera-height {height}: give 0.05 to 20 m");
            let (sin, cos) = tilt.to_radians().sin_cos();
            let eye = Point3::new(0.0, 0.0, height);
            let ahead = eye + vision_models::nalgebra::Vector3::new(cos, 0.0, -sin);
            let placed = Camera::looking_at(camera.intrinsics, eye, ahead, DepthNoise::D435I)?;
            camera.world_from_camera = Some(*placed.world_from_camera());
        }
        Ok(vec![camera])
    }

    fn uncalibrated(&self, size: [usize; 2]) -> Result<CalibratedCamera> {
        let wide = self.field_of_view;
        ensure!((10.0..=150.0).contains(&wide), "--field-of-view {wide}: give 10 to 150 degrees");
        let [width, height] = size.map(|side| side as f64);
        let focal = 0.5 * width.max(height) / (0.5 * wide.to_radians()).tan();
        let centre = [0.5 * (width - 1.0), 0.5 * (height - 1.0)];
        Ok(CalibratedCamera {
            name: "camera".to_owned(),
            intrinsics: Intrinsics::new(size, [focal, focal], centre)?,
            distortion: Distortion::None,
            world_from_camera: None,
        })
    }
}
