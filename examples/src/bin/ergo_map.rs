//! A person's ergonomics map: built, measured or loaded; with its quadratic, report and pictures.

use std::{
    fs::{self, File},
    io::BufReader,
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};
use ergo_map::{
    ErgonomicsMap, MapOptions, MeasuredOptions, MeasuredSample, Mode, Person, Segments, Side,
    read_samples,
};
use examples::ergonomics::{ACCEPTABLE, Assessment, MapReport, MapStudy, manikin, slices};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use nalgebra::Vector3;

/// Builds the ergonomics map of a person, fits its quadratic, and shows both.
///
/// Writes to the folder: person.ergomap (the map), report.txt and report.json, slices.svg (heat maps
/// through the optimum), manikin.svg (the posture there), and manikin-at.svg with --hand-at.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The person's stature (m).
    #[arg(long, required_unless_present_any = ["preset", "load"], conflicts_with = "preset")]
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
    #[arg(long, default_value_t = MapOptions::default().spacing)]
    spacing: f64,
    /// Make the map from these recorded postures (CSV) instead of predicted ones.
    #[arg(long, value_name = "FILE")]
    samples: Option<PathBuf>,
    /// Show this map instead of making one. Give --segments as when it was made.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["stature", "preset", "hand", "spacing", "samples"])]
    load: Option<PathBuf>,
    /// Compare the map with these recorded postures (CSV), others than those that made it.
    #[arg(long, value_name = "FILE")]
    validate: Option<PathBuf>,
    /// Draw the posture for this hand position as well (m; x forward, y left, z up).
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    hand_at: Option<Vector3<f64>>,
    /// Highest e_s that counts as acceptable.
    #[arg(long, default_value_t = ACCEPTABLE)]
    acceptable: f64,
    /// The folder for what is written.
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
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

fn main() -> Result<()> {
    let options = Options::parse();
    let started = Instant::now();
    let map = map(&options)?;
    let seconds = started.elapsed().as_secs_f64();
    let person = person(&options, map.stature())?;
    let study = MapStudy::new(map, person, options.acceptable)?;
    // Before anything is written, so that nothing is left behind by a wrong option.
    let wanted = match &options.hand_at {
        Some(hand) => Some(Assessment::new(&study.map, &study.person, hand).context("--hand-at")?),
        None => None,
    };
    let validation = match &options.validate {
        Some(path) => {
            let recorded = samples(path)?;
            Some(study.map.validate(&recorded).with_context(|| path.display().to_string())?)
        }
        None => None,
    };
    let report = MapReport::new(&study, validation.as_ref());

    let folder = Folder::new(&options.output)?;
    if options.load.is_none() {
        study.map.save(folder.path("person.ergomap"))?;
    }
    folder.write("report.txt", &report.to_string())?;
    folder.write("report.json", &report.json()?)?;
    folder.write("slices.svg", &slices(&study)?)?;
    let side = study.map.side();
    folder.write("manikin.svg", &manikin(&study.optimum, &study.person, side)?)?;
    if let Some(wanted) = &wanted {
        folder.write("manikin-at.svg", &manikin(wanted, &study.person, side)?)?;
    }
    print!("{report}");
    println!("{:<34}{seconds:.2}", "the map took [s]");
    println!("written to {}", options.output.display());
    Ok(())
}

/// The map that the options ask for.
fn map(options: &Options) -> Result<ErgonomicsMap> {
    if let Some(path) = &options.load {
        return Ok(ErgonomicsMap::load(path)?);
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
        // As many neighbours around a node whatever the spacing.
        let radius = usual.radius * spacing / usual.spacing;
        let measured = MeasuredOptions { side, spacing, radius, ..usual };
        return ErgonomicsMap::from_samples(stature, &samples(path)?, &measured)
            .with_context(|| path.display().to_string());
    }
    let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %  {elapsed}")?;
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
        .with_style(style)
        .with_message("map of the person");
    let progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let built = MapOptions { side, spacing, mode: Mode::Graded, ..MapOptions::default() };
    let map = ErgonomicsMap::build(&person, &built, Some(&progress))?;
    bar.finish_and_clear();
    Ok(map)
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
    read_samples(BufReader::new(file)).with_context(|| shown.to_string())
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

/// The folder for what is written.
struct Folder<'a>(&'a Path);

impl<'a> Folder<'a> {
    fn new(path: &'a Path) -> Result<Self> {
        fs::create_dir_all(path)
            .with_context(|| format!("cannot make the folder {}", path.display()))?;
        Ok(Self(path))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, text: &str) -> Result<()> {
        let path = self.path(name);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    }
}
