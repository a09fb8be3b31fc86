//! Simulates a walking person and writes their percepts as a recording, or the camera's images as frames.

use std::{
    io::Write,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::Arc,
};

use anyhow::{Result, bail};
use clap::Parser;
use examples::program::{self, Ending, OutputFile, Printing, Program, Seed, Session, check_folder};
use human_perception::frames::{FramesWriter, truth};
use moca_simulation::people::{
    CameraSettings, CapturedMotion, Movement, Occupation, Walker, WalkerSettings, WalkingPath,
};
use moca_simulation::rendering::{Film, PoseEstimator, Shot, SkeletonSettings, Viewpoint};
use percept_recording::Writer;
use serde::Serialize;
use vision_models::{Body, Confidence, Keypoint, Percept, Tool};

/// Simulates a person who works with the robot, and records what perception reports, or what a camera sees.
///
/// If only --output is given, it makes the recording that `follow` plays by default. --frames renders colour and depth
/// images, skeletons and the truth, for `perceive`.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The recording to write (JSON Lines).
    #[arg(long, short, value_name = "FILE", required_unless_present = "frames")]
    output: Option<PathBuf>,
    /// Render the camera's images into this folder: colour and depth images, skeletons in OpenPose's JSON, and the
    /// truth as a recording.
    #[arg(long, value_name = "FOLDER", conflicts_with = "output")]
    frames: Option<PathBuf>,
    /// The place of the camera: facing the person from behind the robot, or beside the workplace.
    #[arg(long, default_value = "facing", value_parser = viewpoint, requires = "frames")]
    view: Viewpoint,
    /// Width and height of the rendered images (pixels).
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = size, requires = "frames")]
    size: [usize; 2],
    /// Vary clothes, skin, room and light by the seed.
    #[arg(long, requires = "frames")]
    varied: bool,
    /// Standard deviation of the skeletons' joints, each axis, in images 640 pixels wide (pixels).
    #[arg(long, value_name = "PIXELS", default_value_t = SkeletonSettings::default().pixel_sigma, requires = "frames")]
    pixel_noise: f64,
    /// The person's stature (m).
    #[arg(long, value_name = "METRES", default_value_t = WalkerSettings::default().stature, allow_negative_numbers = true)]
    stature: f64,
    /// The path along which the person leads the robot: stations, straight, square, circle, figure-eight, random or
    /// directions (each time along one of HRI30's eight). Also points on the floor (m) such as "1.4,0 2.4,0 2.4,-1", or
    /// a file with one point a line.
    #[arg(long, default_value = "stations", value_parser = WalkingPath::from_argument)]
    path: WalkingPath,
    /// The person only walks along the path, with empty hands.
    #[arg(long)]
    walk: bool,
    /// A movement on the spot that the person repeats where they stand and work. One of bow, kneel, sit-down, get-up,
    /// lean-sideways, reach-overhead, turn, squat, pick-up, step-sideways and swing-arms.
    #[arg(long, value_parser = movement)]
    movement: Option<Movement>,
    /// Repeat the motion of a real person to and fro, where it is: walk, balance, punch, dance, get-up, or a recording of
    /// somebody, best one without noise. Actions are those of somebody who works, or walks.
    #[arg(long, value_name = "NAME|FILE", value_parser = CapturedMotion::from_argument, conflicts_with_all = ["stature", "path", "movement", "speed", "sway"])]
    motion: Option<CapturedMotion>,
    /// Also write the true joints at 100 Hz, for `follow --truth` (JSON Lines).
    #[arg(long, value_name = "FILE", conflicts_with = "frames")]
    truth: Option<PathBuf>,
    /// Time for which the person offers the object (s).
    #[arg(long, value_name = "SECONDS", default_value_t = WalkerSettings::default().offer, allow_negative_numbers = true)]
    offer: f64,
    /// Walking speed (m/s), in place of 0.8 to come and go and 0.3 to lead the robot.
    #[arg(long, value_name = "M/S", allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Duration of the recording (s).
    #[arg(long, value_name = "SECONDS", default_value_t = WalkerSettings::default().duration, allow_negative_numbers = true)]
    duration: f64,
    /// Factor on the camera's noise: 0 is none, 1 that of a RealSense D435i.
    #[arg(long, value_name = "FACTOR", default_value_t = CameraSettings::default().noise)]
    noise: f64,

    /// Share of the variance of the noise that lasts from frame to frame; 0.9 for real detectors.
    #[arg(long, value_name = "SHARE", default_value_t = CameraSettings::default().lasting)]
    lasting: f64,

    /// Factor on the motion of the pelvis about its mean place in walking and standing; 1 for real people.
    #[arg(long, value_name = "FACTOR", default_value_t = WalkerSettings::default().sway)]
    sway: f64,
    /// Probability that a joint is missing in a frame; frames are missing in proportion.
    #[arg(long, value_name = "PROBABILITY", default_value_t = CameraSettings::default().drop)]
    drop: f64,
    /// Number of times that the person seems to jump by two metres for a moment.
    #[arg(long, value_name = "TIMES", default_value_t = CameraSettings::default().jumps)]
    jump: u32,
    /// Number of times that the person is not seen, for up to three seconds.
    #[arg(long, value_name = "TIMES", default_value_t = CameraSettings::default().vanishings)]
    vanish: u32,
    /// The person's tool: drill or polisher.
    #[arg(long, default_value = "drill", value_parser = tool)]
    tool: Tool,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    printing: Printing,
}

fn tool(name: &str) -> std::result::Result<Tool, &'static str> {
    match name {
        "drill" => Ok(Tool::Drill),
        "polisher" => Ok(Tool::Polisher),
        _ => Err("give drill or polisher"),
    }
}

fn movement(name: &str) -> std::result::Result<Movement, String> {
    Movement::from_name(name)
        .ok_or_else(|| format!("give {}", Movement::ALL.map(Movement::name).join(", ")))
}

fn viewpoint(name: &str) -> std::result::Result<Viewpoint, &'static str> {
    match name {
        "facing" => Ok(Viewpoint::Facing),
        "beside" => Ok(Viewpoint::Beside),
        _ => Err("give facing or beside"),
    }
}

fn size(text: &str) -> std::result::Result<[usize; 2], &'static str> {
    let sides = text
        .split_once('x')
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides: &[usize; 2]| sides.iter().all(|side| (32..=4096).contains(side)))
        .ok_or("give a width and a height of 32 to 4096 pixels, such as 640x480")
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Recorded {
    output: PathBuf,
    frames: u64,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let printing = self.printing;
        let settings = WalkerSettings {
            stature: self.stature,
            path: self.path,
            tool: self.tool,
            occupation: if self.walk { Occupation::Walking } else { Occupation::Working },
            offer: self.offer,
            speed: self.speed,
            arm_speed: None,
            movement: self.movement,
            motion: self.motion.map(Arc::new),
            sway: self.sway,
            duration: self.duration,
            seed: self.seed.seed,
            camera: CameraSettings {
                noise: self.noise,
                lasting: self.lasting,
                drop: self.drop,
                jumps: self.jump,
                vanishings: self.vanish,
                ..CameraSettings::default()
            },
        };
        let recorded = match (self.frames, self.output) {
            (Some(folder), _) => {
                let film = Film::new(settings, self.view, self.size, self.pixel_noise)?;
                let film = if self.varied { film.varied() } else { film };
                film_frames(film, &folder, session)?
            }
            (None, Some(output)) => {
                record(Walker::new(settings)?, output, self.truth.as_deref(), session)?
            }
            (None, None) => bail!("give --output or --frames"),
        };
        let (recorded, ending) = recorded;
        let partial = if ending == Ending::Partial { ", interrupted" } else { "" };
        let Recorded { output, frames } = &recorded;
        writeln!(session.output(), "{}: {frames} camera frames{partial}", output.display())?;
        session.conclude(printing, &recorded, ending)
    }
}

/// Writes the percepts as a recording, and the true joints as another.
fn record(
    mut walker: Walker,
    output: PathBuf,
    truth: Option<&Path>,
    session: &Session,
) -> Result<(Recorded, Ending)> {
    let file = OutputFile::create(&output)?;
    let mut writer = Writer::new(file, &walker.header())?;
    let mut truth = match truth {
        Some(path) => Some(Writer::new(OutputFile::create(path)?, &walker.true_header())?),
        None => None,
    };
    let progress = session.progress("recording", walker.expected_frames());
    let mut frames = 0;
    let mut ending = Ending::Complete;
    while let Some((_, percept)) = walker.next_frame() {
        if let Some(truth) = &mut truth {
            for (time, joints) in walker.motion() {
                let seen = |position| Some(Keypoint { position, confidence: Confidence::ONE });
                let body = Some(Body::new(joints.map(seen)));
                truth.write(&Percept { time: *time, body, action: None, surface: None })?;
            }
        }
        let Some(percept) = percept else { continue };
        writer.write(&percept)?;
        frames += 1;
        progress.set(frames);
        if session.interrupt().requested() {
            ending = Ending::Partial;
            break;
        }
    }
    progress.finish();
    let output = if ending == Ending::Partial {
        truth
            .map(|truth| truth.finish_partial()?.keep_partial().map_err(anyhow::Error::from))
            .transpose()?;
        writer.finish_partial()?.keep_partial()?
    } else {
        truth.map(|truth| truth.finish()?.keep().map_err(anyhow::Error::from)).transpose()?;
        writer.finish()?.keep().map(|()| output)?
    };
    Ok((Recorded { output, frames }, ending))
}

/// Writes the camera's images as a folder of frames with the truth.
fn film_frames(film: Film, folder: &Path, session: &Session) -> Result<(Recorded, Ending)> {
    check_folder(folder)?;
    let mut writer = FramesWriter::create(folder, film.camera())?;
    let file = OutputFile::create(folder.join(truth::TRUTH))?;
    let mut truth = Writer::new(file, &film.header())?;
    let progress = session.progress("frames", film.expected_frames());
    let mut frames = 0;
    let mut ending = Ending::Complete;
    for shot in film {
        let Shot { entry, image, depth, surface, skeleton, truth: percept } = shot?;
        let people: Vec<_> = skeleton.into_iter().collect();
        let skeletons = PoseEstimator::json(&people);
        writer.write(&entry, image.colours(), &depth, surface.colours(), &skeletons)?;
        truth.write(&percept)?;
        frames += 1;
        progress.set(frames);
        if session.interrupt().requested() {
            ending = Ending::Partial;
            break;
        }
    }
    progress.finish();
    if ending == Ending::Partial {
        truth.finish_partial()?.keep_partial()?;
    } else {
        writer.finish()?;
        truth.finish()?.keep()?;
    }
    Ok((Recorded { output: folder.to_owned(), frames }, ending))
}

fn main() -> ExitCode {
    program::main::<Options>()
}
