//! Simulates a walking person and writes what the camera reports as a recording.

use std::{io::Write, path::PathBuf, process::ExitCode};

use clap::Parser;
use examples::program::{self, Ending, Json, OutputFile, Program, Quiet, Seed, Session};
use examples::recording::Writer;
use examples::simulation::{CameraSettings, Walker, WalkerSettings, WalkingPath};
use serde::Serialize;
use vision_models::Tool;

/// Simulates a person who works with the robot, and records what perception reports.
///
/// Without options but --output it makes the recording that `follow` plays by default.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// Where the recording goes (JSON Lines).
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// The person's stature (m).
    #[arg(long, value_name = "METRES", default_value_t = WalkerSettings::default().stature, allow_negative_numbers = true)]
    stature: f64,
    /// Where the person leads the robot: stations, straight, square, circle, figure-eight, random,
    /// points on the floor (m) such as "1.4,0 2.4,0 2.4,-1", or a file with one point a line.
    #[arg(long, default_value = "stations", value_parser = WalkingPath::from_argument)]
    path: WalkingPath,
    /// How long to record (s).
    #[arg(long, value_name = "SECONDS", default_value_t = WalkerSettings::default().duration, allow_negative_numbers = true)]
    duration: f64,
    /// Factor on the camera's noise: 0 is none, 1 that of a RealSense D435i.
    #[arg(long, value_name = "FACTOR", default_value_t = CameraSettings::default().noise)]
    noise: f64,
    /// Probability that a joint is missing in a frame; frames are missing in proportion.
    #[arg(long, value_name = "PROBABILITY", default_value_t = CameraSettings::default().drop)]
    drop: f64,
    /// How many times the person seems to jump by two metres, for a moment.
    #[arg(long, value_name = "TIMES", default_value_t = CameraSettings::default().jumps)]
    jump: u32,
    /// How many times the person is not seen, for up to three seconds.
    #[arg(long, value_name = "TIMES", default_value_t = CameraSettings::default().vanishings)]
    vanish: u32,
    /// What the person works with: drill or polisher.
    #[arg(long, default_value = "drill", value_parser = tool)]
    tool: Tool,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

fn tool(name: &str) -> Result<Tool, &'static str> {
    match name {
        "drill" => Ok(Tool::Drill),
        "polisher" => Ok(Tool::Polisher),
        _ => Err("give drill or polisher"),
    }
}

/// The line of `--json`.
#[derive(Serialize)]
struct Recorded {
    output: PathBuf,
    frames: u64,
}

impl Program for Options {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> anyhow::Result<Ending> {
        let Self { json, .. } = self;
        let walker = Walker::new(WalkerSettings {
            stature: self.stature,
            path: self.path,
            tool: self.tool,
            duration: self.duration,
            seed: self.seed.seed,
            camera: CameraSettings {
                noise: self.noise,
                drop: self.drop,
                jumps: self.jump,
                vanishings: self.vanish,
                ..CameraSettings::default()
            },
        })?;
        let file = OutputFile::create(&self.output)?;
        let mut writer = Writer::new(file, &walker.header())?;
        let progress = session.progress("recording", walker.expected_frames());
        let mut frames = 0;
        let mut ending = Ending::Complete;
        for percept in walker {
            writer.write(&percept)?;
            frames += 1;
            progress.set(frames);
            if session.interrupt().requested() {
                ending = Ending::Partial;
                break;
            }
        }
        progress.finish();
        let output = match ending {
            Ending::Partial => writer.finish_partial()?.keep_partial()?,
            _ => writer.finish()?.keep().map(|()| self.output)?,
        };
        let partial = if ending == Ending::Partial { ", interrupted" } else { "" };
        writeln!(session.output(), "{}: {frames} camera frames{partial}", output.display())?;
        session.print_json(json, &Recorded { output, frames }, ending)?;
        Ok(ending)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
