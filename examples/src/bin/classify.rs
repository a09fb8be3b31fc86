//! Classifies images with a ResNet.

use std::{
    io::{self, Write},
    path::PathBuf,
    process::ExitCode,
};

use anyhow::{Context, Result};
use clap::{Parser, ValueEnum};
use examples::program::{self, Ending, Json, Program, Quiet, ResultFile, Session, Threads, shown};
use examples::vision::{
    choices::{self, with_option},
    results::Results,
};
use human_perception::{
    Watch,
    networks::{
        classifier::Classifier,
        folders::Unreadable,
        top_k::{ScoredClass, check_names, top_classes, write_top_classes},
    },
};
use serde::Serialize;
use vision_models::{ClassNames, Orientation, Preprocessing, ResNetDepth, Resize, softmax};

/// Classifies images by a ResNet: the five most probable classes of each. `surface` trains on classes of your own.
///
/// An image that cannot be read is named on standard error and left out; the exit status is then 1. Ctrl-C ends early: the
/// images so far are printed.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// JPEG or PNG files.
    #[arg(required = true)]
    images: Vec<PathBuf>,
    /// The ResNet's checkpoint, with torchvision's names.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// How many layers the ResNet has.
    #[arg(long, default_value = "50", value_parser = choices::depth())]
    depth: ResNetDepth,
    /// The names of the network's classes, one a line.
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// The size that images are brought to before the middle 224 × 224 is cut out (pixels): the paper's 255, 256 for
    /// torchvision's weights IMAGENET1K_V1, 232 for IMAGENET1K_V2.
    #[arg(long, value_name = "PIXELS", default_value_t = 255, value_parser = clap::value_parser!(u16).range(224..=16_384))]
    resize: u16,
    /// Bring both sides to that size, as the paper does, instead of the short side.
    #[arg(long)]
    square: bool,
    /// Which way up: `stored`, as the pixels stand in the file, which is what torchvision does; `exif`, as the camera was
    /// held, where the file says so, which is what OpenCV does.
    #[arg(long, default_value = "stored")]
    orientation: OrientationOption,
    /// Stop at the first image that cannot be read.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum OrientationOption {
    Stored,
    Exif,
}

impl From<OrientationOption> for Orientation {
    fn from(option: OrientationOption) -> Self {
        match option {
            OrientationOption::Stored => Self::Stored,
            OrientationOption::Exif => Self::Exif,
        }
    }
}

/// The line of `--json`.
#[derive(Default, Serialize)]
struct Report {
    images: Vec<ImageReport>,
    /// Images that could not be read.
    unreadable: usize,
}

#[derive(Serialize)]
struct ImageReport {
    image: PathBuf,
    classes: Vec<ScoredClass>,
}

impl Arguments {
    fn load(&self, names: Option<&ClassNames>, watch: &mut Watch<'_>) -> Result<Classifier> {
        let side = self.resize.into();
        let resize = if self.square { Resize::Square(side) } else { Resize::ShortSide(side) };
        let preprocessing = Preprocessing { resize, ..Preprocessing::TORCHVISION };
        let classifier =
            Classifier::load(&self.weights, self.depth, preprocessing, self.threads.count(), watch)
                .map_err(|error| with_option(error, ""))?;
        if let (Some(names), Some(file)) = (names, &self.names) {
            check_names(file, names, classifier.classes())?;
        }
        Ok(classifier)
    }
}

impl Program for Arguments {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> Result<Ending> {
        let mut results = Results::begin(&self.result)?;
        let names = self
            .names
            .as_ref()
            .map(|file| ClassNames::read(file).with_context(|| file.display().to_string()))
            .transpose()?;
        let mut classifier = self.load(names.as_ref(), &mut session.watch())?;
        session.interrupt().check()?;
        let mut unreadable = Unreadable::new(self.strict);
        let (images, ending) =
            self.classify(&mut classifier, names.as_ref(), session, &mut results, &mut unreadable)?;
        let report = Report { images, unreadable: unreadable.count() };
        if report.unreadable > 0 {
            session.warn(format_args!("{} images could not be read", report.unreadable));
        }
        if ending == Ending::Partial {
            session.warn("interrupted: the results are of the images up to there");
        }
        results.keep(ending)?;
        session.conclude(self.json, &report, ending)
    }
}

impl Arguments {
    /// Classifies the images that are named on the command line.
    fn classify(
        &self,
        classifier: &mut Classifier,
        names: Option<&ClassNames>,
        session: &mut Session,
        results: &mut Results,
        unreadable: &mut Unreadable,
    ) -> Result<(Vec<ImageReport>, Ending)> {
        let progress = session.progress("images", self.images.len() as u64);
        let mut reports = Vec::new();
        for (done, path) in (1..).zip(&self.images) {
            if session.interrupt().requested() {
                return Ok((reports, Ending::Partial));
            }
            match classifier.read(path, self.orientation.into()) {
                Ok(image) => {
                    let classes = top_classes(&softmax(&classifier.infer(&image)?), names);
                    let report = ImageReport { image: path.clone(), classes };
                    progress.suspend(|| report.write(results.writer(session)))?;
                    reports.push(report);
                }
                Err(error) => unreadable.leave_out(error, &mut session.watch())?,
            }
            progress.set(done);
        }
        let whole = unreadable.count() == 0;
        Ok((reports, if whole { Ending::Complete } else { Ending::Failed }))
    }
}

impl ImageReport {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", shown(&self.image))?;
        write_top_classes(out, &self.classes)
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
