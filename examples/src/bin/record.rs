//! Simulates a walking person and writes what the camera reports as a recording.

use std::{fs::File, io::BufWriter, path::PathBuf};

use anyhow::{Context, Result};
use clap::Parser;
use examples::walker::{CameraSettings, Walker, WalkerSettings, WalkingPath};
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
    #[arg(long, default_value_t = WalkerSettings::default().stature)]
    stature: f64,
    /// Where the person leads the robot: stations, straight, square, circle, figure-eight, random,
    /// points on the floor (m) such as "1.4,0 2.4,0 2.4,-1", or a file with one point a line.
    #[arg(long, default_value = "stations", value_parser = WalkingPath::from_argument)]
    path: WalkingPath,
    /// How long to record (s).
    #[arg(long, default_value_t = WalkerSettings::default().duration)]
    duration: f64,
    /// Of everything random.
    #[arg(long, default_value_t = WalkerSettings::default().seed)]
    seed: u64,
    /// Factor on the camera's noise: 0 is none, 1 that of a RealSense D435i.
    #[arg(long, default_value_t = CameraSettings::default().noise)]
    noise: f64,
    /// Probability that a joint is missing in a frame; frames are missing in proportion.
    #[arg(long, default_value_t = CameraSettings::default().drop)]
    drop: f64,
    /// How many times the person seems to jump by two metres, for a moment.
    #[arg(long, default_value_t = CameraSettings::default().jumps)]
    jump: u32,
    /// How many times the person is not seen, for up to three seconds.
    #[arg(long, default_value_t = CameraSettings::default().vanishings)]
    vanish: u32,
    /// What the person works with: drill or polisher.
    #[arg(long, default_value = "drill", value_parser = tool)]
    tool: Tool,
}

fn tool(name: &str) -> Result<Tool, &'static str> {
    match name {
        "drill" => Ok(Tool::Drill),
        "polisher" => Ok(Tool::Polisher),
        _ => Err("give drill or polisher"),
    }
}

fn main() -> Result<()> {
    let options = Options::parse();
    let walker = Walker::new(WalkerSettings {
        stature: options.stature,
        path: options.path,
        tool: options.tool,
        duration: options.duration,
        seed: options.seed,
        camera: CameraSettings {
            noise: options.noise,
            drop: options.drop,
            jumps: options.jump,
            vanishings: options.vanish,
        },
    })?;
    let output = &options.output;
    let file = File::create(output)
        .with_context(|| format!("cannot create the recording {}", output.display()))?;
    let frames = walker.record(BufWriter::new(file))?;
    println!("{}: {frames} camera frames", output.display());
    Ok(())
}
