//! Finds the place of a camera from points where the robot holds its tool.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;
use examples::program::{self, Ending, OutputFile, Printing, Program, Session, read_text};
use human_perception::frames::CameraToPlace;
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use vision_models::CameraPlacement;

/// Finds where a camera stands, from three or more points where the robot held its tool up to it.
///
/// POINTS is a table in CSV with a line a point. Its columns u and v are a pixel: column and row of the image. There the
/// camera sees the tip of the tool, or the middle of a tag on it. The columns x, y and z are where the robot says that
/// this point is, in the world [m]. A column depth has the depth of the pixel [m]. A column frame has the number of a
/// frame instead, and the depth is looked up in its depth image.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The folder of the camera's frames. Its camera.json has the intrinsics, and a place that does not count.
    #[arg(value_name = "FOLDER")]
    frames: PathBuf,
    /// The table of points.
    #[arg(value_name = "POINTS.csv")]
    points: PathBuf,
    /// The file for the camera.json with the place that was found.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// A line of the table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    u: f64,
    v: f64,
    x: f64,
    y: f64,
    z: f64,
    #[serde(default)]
    depth: Option<f64>,
    #[serde(default)]
    frame: Option<u64>,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Found {
    /// Place, then the unit quaternion x, y, z, w: the setting `camera.pose`.
    pose: [f64; 7],
    /// Distance of each point from where the robot says it is \[m\], and their root mean square.
    residuals: Vec<f64>,
    deviation: f64,
}

/// Largest table (bytes).
const LARGEST: u64 = 1 << 20;
/// Deviation above which the points contradict each other \[m\]: a depth camera is exact to a centimetre at 2 m.
const POOR: f64 = 0.02;

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let file = self.output.as_deref().map(OutputFile::create).transpose()?;
        let mut camera = CameraToPlace::read(&self.frames)?;
        let pairs = pairs(&camera, &self.points)?;
        let placement =
            CameraPlacement::fit(&pairs).with_context(|| self.points.display().to_string())?;
        let text = camera.placed(&placement.world_from_camera)?;
        let found = Found::of(placement);
        found.write(session.output())?;
        if found.deviation > POOR {
            session.warn("the points contradict each other: check the pixels, and that x, y and z are of the same point");
        }
        if let Some(mut file) = file {
            file.write_all(text.as_bytes()).with_context(|| self.frames.display().to_string())?;
            file.keep()?;
        }
        session.conclude(self.printing, &found, Ending::Complete)
    }
}

/// Each point in the optical frame of the camera, then in the world \[m\].
fn pairs(camera: &CameraToPlace, path: &Path) -> Result<Vec<[Point3<f64>; 2]>> {
    let shown = path.display();
    let text = read_text(path, LARGEST).with_context(|| format!("cannot open {shown}"))?;
    let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let pair = |row: Result<Row, csv::Error>| {
        let Row { u, v, x, y, z, depth, frame } = row?;
        let depth = match (depth, frame) {
            (Some(depth), _) => depth,
            (None, Some(frame)) => camera.depth(frame, [u, v])?,
            (None, None) => {
                anyhow::bail!("it has neither a depth nor a frame: give one of these columns")
            }
        };
        Ok([camera.point([u, v], depth)?, Point3::new(x, y, z)])
    };
    let rows = table.deserialize().enumerate();
    rows.map(|(index, row)| pair(row).with_context(|| format!("{shown}: point {}", index + 1)))
        .collect()
}

impl Found {
    fn of(placement: CameraPlacement) -> Self {
        let deviation = placement.deviation();
        let CameraPlacement { world_from_camera, residuals } = placement;
        let ([x, y, z], [i, j, k, w]) =
            (world_from_camera.translation.vector.into(), world_from_camera.rotation.coords.into());
        Self { pose: [x, y, z, i, j, k, w], residuals, deviation }
    }

    fn write(&self, out: &mut impl Write) -> Result<()> {
        writeln!(out, "point  off [mm]")?;
        for (index, residual) in self.residuals.iter().enumerate() {
            writeln!(out, "{:5} {:9.1}", index + 1, residual * 1e3)?;
        }
        writeln!(out, "root mean square {:.1} mm", self.deviation * 1e3)?;
        let pose: Vec<_> = self.pose.iter().map(|value| format!("{value:.6}")).collect();
        writeln!(out, "\n[camera]\npose = [{}]", pose.join(", "))?;
        Ok(())
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
