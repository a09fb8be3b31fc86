//! Classifies images with a ResNet.

use std::{
    io::{self, Write},
    path::PathBuf,
    process::ExitCode,
};

use anyhow::Result;
use clap::Parser;
use examples::program::{self, Ending, Json, Program, Quiet, ResultFile, Session, Threads};
use examples::vision::{
    choices,
    classifier::Classifier,
    errors::in_file,
    folders::Unreadable,
    results::Results,
    top_k::{ScoredClass, check_names, top_classes, write_top_classes},
};
use serde::Serialize;
use vision_models::{ClassNames, Preprocessing, ResNetDepth, softmax};

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
    /// Resize to 255 × 255, as the paper says, instead of the short side to 255.
    #[arg(long)]
    square: bool,
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
    fn load(&self, names: Option<&ClassNames>) -> Result<Classifier> {
        let preprocessing =
            if self.square { Preprocessing::SURFACE } else { Preprocessing::TORCHVISION };
        let classifier =
            Classifier::load(&self.weights, self.depth, preprocessing, self.threads.count())?;
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
            .map(|file| ClassNames::read(file).map_err(|error| in_file(file, error)))
            .transpose()?;
        let mut classifier = self.load(names.as_ref())?;
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
            match classifier.read(path) {
                Ok(image) => {
                    let classes = top_classes(&softmax(&classifier.infer(&image)?), names);
                    let report = ImageReport { image: path.clone(), classes };
                    progress.suspend(|| report.write(results.writer(session)))?;
                    reports.push(report);
                }
                Err(error) => unreadable.leave_out(&progress, path, error)?,
            }
            progress.set(done);
        }
        let whole = unreadable.count() == 0;
        Ok((reports, if whole { Ending::Complete } else { Ending::Failed }))
    }
}

impl ImageReport {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.image.display())?;
        write_top_classes(out, &self.classes)
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
