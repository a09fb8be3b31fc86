//! Builds, measures or loads a person's ergonomics map, with its quadratic, report and pictures.

use std::{
    fs::{self, File},
    io::{BufReader, Write},
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};
use ergo_map::{
    ErgonomicsMap, MapOptions, MeasuredOptions, MeasuredSample, Mode, Person, Segments, Side,
    read_samples,
};
use ergo_report::maps::{ACCEPTABLE, Assessment, MapReport, MapStudy, manikin, slices};
use examples::maps::{build_map, read_map};
use examples::program::{
    self, Ending, OutputFile, Printing, Program, Session, check_folder, thread_count,
};
use nalgebra::Vector3;

/// Builds the ergonomics map of a person: how strenuous each place of the hand is, by REBA.
///
/// Fits the convex quadratic that the controller minimises, and reports the quality of the fit. Writes to the folder:
/// person.ergomap (the map), report.txt and report.json, slices.svg (heat maps through the optimum), manikin.svg (the
/// posture there), and manikin-at.svg for --hand-at.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The person's stature (m).
    #[arg(long, value_name = "METRES", required_unless_present_any = ["preset", "load"], conflicts_with = "preset")]
    stature: Option<f64>,
    /// In place of --stature: short 1.58 m, average 1.75 m, tall 1.94 m.
    #[arg(long)]
    preset: Option<Preset>,
    /// Measured lengths (m), such as upper_arm=0.33,forearm=0.27; the others follow from stature.
    #[arg(long, value_name = "NAME=LENGTH,...", value_parser = segments)]
    segments: Option<Segments>,
    /// The working hand.
    #[arg(long, default_value = "right")]
    hand: Hand,
    /// Distance between the map's nodes, as a fraction of stature.
    #[arg(long, value_name = "STATURES", default_value_t = MapOptions::default().spacing)]
    spacing: f64,
    /// Make the map from these recorded postures (CSV) instead of predicted ones.
    #[arg(long, value_name = "FILE")]
    samples: Option<PathBuf>,
    /// Show this map and its person instead of making one.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["stature", "preset", "hand", "spacing", "samples"])]
    load: Option<PathBuf>,
    /// Compare the map with these recorded postures (CSV), other than those that made it.
    #[arg(long, value_name = "FILE")]
    validate: Option<PathBuf>,
    /// Draw the posture for this hand position as well (m; x forward, y left, z up).
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    hand_at: Option<Vector3<f64>>,
    /// Highest score e_s, 0 (good) to 4.25, that counts as acceptable.
    #[arg(long, value_name = "SCORE", default_value_t = ACCEPTABLE)]
    acceptable: f64,
    /// Threads that share the work, 1 to 1024 [default: one for each core].
    #[arg(long, value_name = "COUNT", value_parser = thread_count())]
    threads: Option<u16>,
    /// The output folder, made if it does not exist.
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    printing: Printing,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Preset {
    Short,
    Average,
    Tall,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Hand {
    Left,
    Right,
}

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        check_folder(&self.output)?;
        let started = Instant::now();
        let map = map(&self, session)?;
        let seconds = started.elapsed().as_secs_f64();
        let person = match (&self.load, &self.segments) {
            (Some(_), None) => map.person().clone(),
            _ => person(&self, map.stature())?,
        };
        let study = MapStudy::new(map, person, self.acceptable)?;
        // Check before anything is written, so that a wrong option leaves nothing behind.
        let wanted = match &self.hand_at {
            Some(hand) => {
                Some(Assessment::new(&study.map, &study.person, hand).context("--hand-at")?)
            }
            None => None,
        };
        let validation = match &self.validate {
            Some(path) => {
                let validated = study.map.validate(&samples(path)?);
                let shown = || path.display().to_string();
                Some(validated.map_err(ergo_report::Error::from).with_context(shown)?)
            }
            None => None,
        };
        let report = MapReport::new(&study, validation.as_ref());
        session.interrupt().check()?;

        let side = study.map.side();
        let mut folder = Folder::new(&self.output)?;
        if self.load.is_none() {
            folder.write("person.ergomap", &study.map.to_bytes())?;
        }
        folder.write("report.txt", report.to_string().as_bytes())?;
        folder.write("report.json", report.json()?.as_bytes())?;
        folder.write("slices.svg", slices(&study)?.as_bytes())?;
        folder.write("manikin.svg", manikin(&study.optimum, &study.person, side)?.as_bytes())?;
        if let Some(wanted) = &wanted {
            folder.write("manikin-at.svg", manikin(wanted, &study.person, side)?.as_bytes())?;
        }
        folder.keep()?;
        let output = session.output();
        write!(output, "{report}")?;
        writeln!(output, "{:<34}{seconds:.2}", "the map took [s]")?;
        writeln!(output, "written to {}", self.output.display())?;
        session.conclude(self.printing, &report, Ending::Complete)
    }
}

/// The map of the options.
fn map(options: &Options, session: &Session) -> Result<ErgonomicsMap> {
    if let Some(path) = &options.load {
        return read_map(path);
    }
    let stature = match options.preset {
        Some(Preset::Short) => Person::short().stature(),
        Some(Preset::Average) => Person::average().stature(),
        Some(Preset::Tall) => Person::tall().stature(),
        None => options.stature.unwrap_or_default(),
    };
    let (person, spacing) = (person(options, stature)?, options.spacing);
    let side = match options.hand {
        Hand::Left => Side::Left,
        Hand::Right => Side::Right,
    };
    if let Some(path) = &options.samples {
        let usual = MeasuredOptions::default();
        // The number of neighbours around a node does not depend on the spacing.
        let radius = usual.radius * spacing / usual.spacing;
        let measured = MeasuredOptions { side, spacing, radius, ..usual };
        let made = ErgonomicsMap::from_samples_of(&person, &samples(path)?, &measured);
        return made.map_err(ergo_report::Error::from).with_context(|| path.display().to_string());
    }
    let built = MapOptions { side, spacing, mode: Mode::Graded, ..MapOptions::default() };
    build_map(session, &person, &built, options.threads)
}

fn person(options: &Options, stature: f64) -> Result<Person> {
    let person = Person::new(stature)?;
    Ok(match &options.segments {
        Some(segments) => person.with_segments(segments).context("--segments")?,
        None => person,
    })
}

fn samples(path: &Path) -> Result<Vec<MeasuredSample>> {
    let shown = path.display();
    let file = File::open(path).with_context(|| format!("cannot open {shown}"))?;
    let read = read_samples(BufReader::new(file)).map_err(ergo_report::Error::from);
    read.with_context(|| shown.to_string())
}

fn point(text: &str) -> Result<Vector3<f64>> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|number| number.trim().parse().ok().filter(|x: &f64| x.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Vector3::new(x, y, z)),
        _ => bail!("give three numbers, such as 0.5,-0.2,1.3"),
    }
}

fn segments(text: &str) -> Result<Segments> {
    let mut segments = Segments::default();
    for pair in text.split(',') {
        let (name, length) = pair.split_once('=').context("give NAME=LENGTH,...")?;
        let field = match name.trim() {
            "ankle_height" => &mut segments.ankle_height,
            "knee_height" => &mut segments.knee_height,
            "hip_height" => &mut segments.hip_height,
            "shoulder_height" => &mut segments.shoulder_height,
            "eye_height" => &mut segments.eye_height,
            "upper_arm" => &mut segments.upper_arm,
            "forearm" => &mut segments.forearm,
            "grip" => &mut segments.grip,
            "shoulder_half_width" => &mut segments.shoulder_half_width,
            "foot" => &mut segments.foot,
            other => bail!(
                "there is no segment {other:?}; there are ankle_height, knee_height, hip_height, \
                 shoulder_height, eye_height, upper_arm, forearm, grip, shoulder_half_width, foot"
            ),
        };
        let length = length.trim();
        *field = Some(length.parse().with_context(|| format!("{name}: {length:?} is no number"))?);
    }
    Ok(segments)
}

/// The output folder, and its files before they are put in place together.
struct Folder<'a> {
    path: &'a Path,
    files: Vec<OutputFile>,
}

impl<'a> Folder<'a> {
    fn new(path: &'a Path) -> Result<Self> {
        fs::create_dir_all(path)
            .with_context(|| format!("cannot make the folder {}", path.display()))?;
        Ok(Self { path, files: Vec::new() })
    }

    fn write(&mut self, name: &str, contents: &[u8]) -> Result<()> {
        let mut file = OutputFile::create(self.path.join(name))?;
        file.push(contents)?;
        self.files.push(file);
        Ok(())
    }

    fn keep(self) -> Result<()> {
        Ok(self.files.into_iter().try_for_each(OutputFile::keep)?)
    }
}

fn main() -> ExitCode {
    program::main::<Options>()
}
