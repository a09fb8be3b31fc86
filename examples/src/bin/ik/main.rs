//! Moves any robot along a path: a frame's position before its orientation before the posture.

mod figure;
mod path;
mod record;
mod robot;
mod run;
mod table;

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;
use examples::program::{
    self, Ending, OutputFile, Printing, Program, Session, check_folder, read_text,
};

use figure::figure;
use path::{Path, Shape};
use robot::RobotOptions;
use run::Run;
use table::table;

/// Largest file of a path (bytes).
const LARGEST_PATH: u64 = 256 << 20;

/// Moves a frame of any robot along a path, within the limits of all joints: the position first,
/// then the orientation, then the posture.
///
/// Writes a table of every control period and a picture into the report's folder, and prints a summary. The picture
/// shows joints within their ranges, errors, and the motion from the front and from the side.
///
/// Each period is checked against the robot's limits, independently of the library. The exit status is 1 if a limit was
/// exceeded or a period had no solution. It is also 1 if the frame ends more than 1 mm off its path. Ctrl-C ends early
/// and keeps the results so far.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    #[command(flatten)]
    robot: RobotOptions,
    /// The link that moves along the path.
    #[arg(long, value_name = "NAME")]
    frame: String,
    /// A link that stays in place with the highest priority, such as a foot; may be given several times.
    #[arg(long, value_name = "NAME")]
    hold: Vec<String>,
    /// `circle` or `line` from where the robot starts, or a file of lines time,x,y,z (s, m) in the
    /// frame of the robot's root.
    #[arg(long, value_name = "PATH", default_value = "circle")]
    path: String,
    /// Radius of the circle in metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.1)]
    radius: f64,
    /// Length of the line in metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.2)]
    length: f64,
    /// Time for a round in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 4.0, value_parser = positive)]
    duration: f64,
    /// Number of rounds.
    #[arg(long, value_name = "COUNT", default_value_t = 2.0, value_parser = positive)]
    rounds: f64,
    /// The control period in seconds, 0.00001 to 1.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.001, value_parser = period)]
    period: f64,
    /// The report's folder, made if it does not exist: ik.csv and ik.svg.
    #[arg(long, short, value_name = "FOLDER", default_value = "report")]
    output: PathBuf,
    /// Write no report.
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    printing: Printing,
}

fn period(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (1e-5..=1.0).contains(&number) => Ok(number),
        _ => Err("a number from 0.00001 to 1 is needed".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number <= 1e5 => Ok(number),
        _ => Err("a number above 0 and at most 100000 is needed".to_owned()),
    }
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        let folder = (!self.no_report).then_some(self.output.as_path());
        if let Some(folder) = folder {
            check_folder(folder)?;
        }
        let model = self.robot.model()?;
        for warning in model.warnings() {
            session.note(format_args!("{}: {warning}", self.robot.urdf.display()));
        }
        let joints = model.default_accelerations().iter().filter_map(|id| model.joint(*id).ok());
        let names: Vec<_> = joints.map(|joint| joint.name.as_str()).collect();
        if !names.is_empty() {
            session.note(format_args!(
                "no acceleration limits: these joints reach full speed within 0.25 s: {}",
                names.join(", ")
            ));
        }
        let start = self.robot.start(&model)?;
        let path = self.path()?;
        let run = Run::new(&model, &self.frame, &self.hold, &start, path, self.period)?;
        let ticks = run.ticks();
        let progress = session.progress("move", ticks as u64);
        let interrupt = session.interrupt().clone();
        let (record, summary) = run.play(|tick| {
            if tick % 1000 == 0 {
                progress.set(tick as u64);
            }
            interrupt.flow()
        })?;
        progress.finish();
        let shortfall = record.shortfall();
        let ending = if summary.ticks + summary.infeasible < ticks {
            Ending::Partial
        } else if summary.limit_violations + summary.infeasible > 0 || shortfall.is_some() {
            Ending::Failed
        } else {
            Ending::Complete
        };
        if let Some(folder) = folder
            && summary.ticks > 0
        {
            fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
            for (name, content) in
                [("ik.csv", table(&record)?), ("ik.svg", figure(&record)?.into_bytes())]
            {
                let mut file = OutputFile::create(folder.join(name))?;
                file.push(&content)?;
                if ending == Ending::Partial {
                    file.keep_partial()?;
                } else {
                    file.keep()?;
                }
            }
        }
        if ending == Ending::Partial {
            session.warn("interrupted: what follows is of the time up to there");
        }
        if let Some(shortfall) = shortfall.filter(|_| ending != Ending::Partial) {
            session.warn(shortfall);
        }
        writeln!(session.output(), "{summary}")?;
        if let Some(folder) = folder {
            writeln!(session.output(), "report: {}", folder.display())?;
        }
        session.conclude(self.printing, &summary, ending)
    }
}

impl Options {
    fn path(&self) -> Result<Path> {
        let shape = match self.path.as_str() {
            "circle" => Shape::Circle(self.radius),
            "line" => Shape::Line(self.length),
            file => {
                let text = read_text(file, LARGEST_PATH).with_context(|| {
                    format!("--path is `circle`, `line` or a file, but {file} cannot be read")
                })?;
                text.trim_start_matches('\u{feff}').parse().with_context(|| file.to_owned())?
            }
        };
        Ok(Path { shape, duration: self.duration, rounds: self.rounds })
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
