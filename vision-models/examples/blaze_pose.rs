//! Prints the landmarks of all people in the images of a camera, one line of JSON per image.
//!
//! `blaze_pose pose_solution_packed_assets.data pose_landmark_full.tflite MOST RATE IMAGE...`
//!
//! MOST is the largest number of people. RATE is the number of images per second. If it is 0, the
//! images are independent and people are searched in each of them. Each person is an array of
//! landmarks. Each landmark is x, y, depth (pixels), visibility, presence and the metric position
//! (m).

use std::error::Error;
use std::io::Write;

use vision_models::{BlazePose, BlazePoseSettings, Landmark, Options, TensorFlowLite, read_image};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next =
        || arguments.next().ok_or("give the detector, the landmarks, MOST, RATE and images");
    let (detector, landmarks) = (TensorFlowLite::open(next()?)?, TensorFlowLite::open(next()?)?);
    let (most, rate): (usize, f64) = (next()?.parse()?, next()?.parse()?);
    let settings = BlazePoseSettings { most, ..BlazePoseSettings::default() };
    let mut network = BlazePose::load(detector, landmarks, settings, Options::default())?;
    let mut out = std::io::stdout().lock();
    for (number, image) in arguments.enumerate() {
        if rate == 0.0 {
            network.forget();
        }
        let time = number as f64 / rate.max(1.0);
        let people = network.estimate(time, read_image(image)?.view())?;
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
