//! Prints the landmarks of all people in the images of a camera, one line of JSON per image.
//!
//! `blaze_pose pose_solution_packed_assets.data pose_landmark_full.tflite MOST RATE IMAGE...`
//! `blaze_pose pose_solution_packed_assets.data pose_landmark_full.tflite REGIONS.json IMAGE...`
//!
//! MOST is the largest number of people. RATE is the number of images per second. If it is 0, the
//! images are independent and people are searched in each of them. REGIONS.json has the only region
//! that is searched in each image, or null: centre x, y, side (pixels) and angle (rad). Each person
//! is an array of landmarks. Each landmark is x, y, depth (pixels), visibility, presence and the
//! metric position (m).

use std::error::Error;
use std::io::Write;

use vision_models::nalgebra::Point2;
use vision_models::{
    BlazePose, BlazePoseSettings, Landmark, Options, PoseRegion, TensorFlowLite, read_image,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next =
        || arguments.next().ok_or("give the detector, the landmarks, MOST, RATE and images");
    let (detector, landmarks) = (TensorFlowLite::open(next()?)?, TensorFlowLite::open(next()?)?);
    let third = next()?;
    let regions: Option<Vec<Option<[f64; 4]>>> = match third.strip_suffix(".json") {
        Some(_) => Some(serde_json::from_str(&std::fs::read_to_string(&third)?)?),
        None => None,
    };
    let (most, rate): (usize, f64) =
        if regions.is_some() { (1, 0.0) } else { (third.parse()?, next()?.parse()?) };
    let settings = BlazePoseSettings { most, ..BlazePoseSettings::default() };
    let mut network = BlazePose::load(detector, landmarks, settings, Options::default())?;
    let mut out = std::io::stdout().lock();
    for (number, image) in arguments.enumerate() {
        let image = read_image(image)?;
        let mut people = Vec::new();
        if let Some(regions) = &regions {
            if let Some([x, y, side, angle]) = regions.get(number).copied().flatten() {
                let region = PoseRegion { centre: Point2::new(x, y), side, angle };
                people.push(network.landmarks(image.view(), &region)?);
            }
        } else {
            if rate == 0.0 {
                network.forget();
            }
            people = network.estimate(number as f64 / rate.max(1.0), image.view())?;
        }
        let people: Vec<Vec<_>> =
            people.iter().map(|person| person.points.map(numbers).into()).collect();
        writeln!(out, "{}", serde_json::to_string(&people)?)?;
    }
    Ok(())
}

fn numbers(landmark: Landmark) -> [f64; 8] {
    let Landmark { position, depth, metric, visibility, presence } = landmark;
    let (visibility, presence) = (visibility.value(), presence.value());
    [position.x, position.y, depth, visibility, presence, metric.x, metric.y, metric.z]
}
