//! Classifies images with a ResNet, or with a linear SVM over its features.

use std::{
    io::{self, Write},
    path::PathBuf,
    process::ExitCode,
};

use anyhow::{Result, ensure};
use clap::Parser;
use examples::program::{
    self, Ending, Json, OutputFile, Program, Quiet, ResultFile, Session, Threads,
};
use examples::vision::{
    choices,
    classifier::{Classifier, Scored},
    confusion::{TestReport, test},
    errors::{in_file, of_option},
    folders::{LabelledImage, Unreadable, list_images},
    results::Results,
    top_k::{ScoredClass, check_names, top_classes, write_top_classes},
    training::{TrainingReport, TrainingSet},
};
use ndarray::aview1;
use serde::Serialize;
use vision_models::{
    ClassNames, LinearSvm, Loss, Preprocessing, ResNetDepth, SvmSettings, softmax,
};

/// Classifies images: the five most probable classes of each, by a ResNet; or, as the paper
/// classifies surfaces, the class by a linear SVM over the features of its average pool, which this
/// program can train and test, too.
///
/// An image that cannot be read is named on standard error and left out. Where one of IMAGES is, the
/// exit status is 1. Ctrl-C ends early: the images so far are printed, a training is not kept.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// JPEG or PNG files.
    #[arg(required_unless_present_any = ["train", "test"])]
    images: Vec<PathBuf>,
    /// The ResNet's checkpoint, with torchvision's names.
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// How many layers the ResNet has.
    #[arg(long, default_value = "50", value_parser = choices::depth())]
    depth: ResNetDepth,
    /// The names of the network's classes, one a line.
    #[arg(long, value_name = "FILE", conflicts_with = "svm")]
    names: Option<PathBuf>,
    /// A linear SVM over the features, instead of the network's last layer.
    #[arg(long, value_name = "FILE")]
    svm: Option<PathBuf>,
    /// Train the SVM first, with the images of this folder, which has a folder for each class, and
    /// write it to the file of --svm.
    #[arg(long, value_name = "FOLDER", requires = "svm")]
    train: Option<PathBuf>,
    /// Classify the images of this folder, which has a folder for each class of the SVM, and print
    /// the confusion matrix in percent.
    #[arg(long, value_name = "FOLDER", requires = "svm")]
    test: Option<PathBuf>,
    /// Train with the hinge instead of the squared hinge.
    #[arg(long, requires = "train")]
    hinge: bool,
    /// The weight of the penalty against the margin.
    #[arg(long, default_value_t = 1.0, requires = "train", allow_negative_numbers = true)]
    cost: f64,
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
    #[serde(skip_serializing_if = "Option::is_none")]
    training: Option<TrainingReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    test: Option<TestReport>,
    images: Vec<ImageReport>,
    /// Images that could not be read, those of the training and the test, too.
    unreadable: usize,
}

#[derive(Serialize)]
struct ImageReport {
    image: PathBuf,
    #[serde(flatten)]
    result: ImageResult,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ImageResult {
    Network {
        classes: Vec<ScoredClass>,
    },
    Svm {
        class: String,
        /// f(x) of each plane.
        decisions: Vec<f64>,
    },
}

/// What the scores of an image are made classes by.
enum Decision {
    Network(Option<ClassNames>),
    Svm(LinearSvm),
}

impl Decision {
    fn decide(&self, scored: &Scored) -> Result<ImageResult> {
        Ok(match self {
            Self::Network(names) => {
                let classes = top_classes(&softmax(&scored.logits), names.as_ref());
                ImageResult::Network { classes }
            }
            Self::Svm(svm) => {
                let features = aview1(&scored.features);
                let class = svm.classify(features)?;
                let class = svm.classes().get(class).cloned().unwrap_or_default();
                ImageResult::Svm { class, decisions: svm.decide(features)?.to_vec() }
            }
        })
    }
}

/// What there is to do, checked before any of it is done.
struct Work {
    names: Option<ClassNames>,
    training: Option<(TrainingSet, SvmSettings, OutputFile)>,
    svm: Option<LinearSvm>,
    test: Option<Vec<LabelledImage>>,
}

impl Arguments {
    fn check(&self) -> Result<Work> {
        let names = self
            .names
            .as_ref()
            .map(|file| ClassNames::read(file).map_err(|error| in_file(file, error)));
        let mut training = None;
        let mut svm = None;
        match (&self.train, &self.svm) {
            (Some(folder), Some(file)) => {
                let settings = self.settings()?;
                let file = OutputFile::create(file)?;
                training = Some((TrainingSet::list(folder)?, settings, file));
            }
            (None, Some(file)) => {
                svm = Some(LinearSvm::read(file).map_err(|error| in_file(file, error))?);
            }
            (_, None) => {}
        }
        let classes = match (&training, &svm) {
            (Some((set, ..)), _) => set.classes(),
            (None, Some(svm)) => svm.classes(),
            (None, None) => &[],
        };
        let test = self.test.as_ref().map(|folder| list_images(folder, classes)).transpose()?;
        Ok(Work { names: names.transpose()?, training, svm, test })
    }

    fn settings(&self) -> Result<SvmSettings> {
        let loss = if self.hinge { Loss::Hinge } else { Loss::SquaredHinge };
        let settings = SvmSettings { loss, cost: self.cost, ..SvmSettings::default() };
        settings.validate().map_err(of_option)?;
        Ok(settings)
    }

    fn load(&self, work: &Work) -> Result<Classifier> {
        let preprocessing =
            if self.square { Preprocessing::SURFACE } else { Preprocessing::TORCHVISION };
        let classifier =
            Classifier::load(&self.weights, self.depth, preprocessing, self.threads.count())?;
        if let (Some(names), Some(file)) = (&work.names, &self.names) {
            check_names(file, names, classifier.classes())?;
        }
        if let (Some(svm), Some(file)) = (&work.svm, &self.svm) {
            let (taken, given) = (svm.weights().ncols(), classifier.features());
            ensure!(
                taken == given,
                "{}: this SVM takes {taken} features, but {} has {given}: give the network that it \
                 was trained with",
                file.display(),
                classifier.describe()
            );
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
        let work = self.check()?;
        let mut classifier = self.load(&work)?;
        session.interrupt().check()?;

        let mut report = Report::default();
        let mut unreadable = Unreadable::new(self.strict);
        let mut ending = Ending::Complete;
        let svm = match work.training {
            Some((set, settings, mut file)) => {
                let (svm, training) =
                    set.train(&mut classifier, settings, session, &mut unreadable)?;
                file.push(svm.to_string().as_bytes())?;
                file.keep()?;
                training.write(results.writer(session))?;
                report.training = Some(training);
                Some(svm)
            }
            None => work.svm,
        };
        if let (Some(images), Some(svm)) = (&work.test, &svm) {
            let (test, ended) = test(&mut classifier, svm, images, session, &mut unreadable)?;
            test.write(results.writer(session), svm.classes())?;
            (report.test, ending) = (Some(test), ended);
        }
        if ending == Ending::Complete {
            let decision = svm.map_or(Decision::Network(work.names), Decision::Svm);
            (report.images, ending) =
                self.classify(&mut classifier, &decision, session, &mut results, &mut unreadable)?;
        }
        report.unreadable = unreadable.count();
        if report.unreadable > 0 {
            session.warn(format_args!("{} images could not be read", report.unreadable));
        }
        if ending == Ending::Partial {
            session.warn("interrupted: the results are of the images up to there");
        }
        results.keep(ending)?;
        session.print_json(self.json, &report, ending)?;
        Ok(ending)
    }
}

impl Arguments {
    /// Classifies the images that are named on the command line.
    fn classify(
        &self,
        classifier: &mut Classifier,
        decision: &Decision,
        session: &mut Session,
        results: &mut Results,
        unreadable: &mut Unreadable,
    ) -> Result<(Vec<ImageReport>, Ending)> {
        let before = unreadable.count();
        let progress = session.progress("images", self.images.len() as u64);
        let mut reports = Vec::new();
        for (done, path) in (1..).zip(&self.images) {
            if session.interrupt().requested() {
                return Ok((reports, Ending::Partial));
            }
            match classifier.read(path) {
                Ok(image) => {
                    let result = decision.decide(&classifier.infer(&image)?)?;
                    let report = ImageReport { image: path.clone(), result };
                    progress.suspend(|| report.write(results.writer(session)))?;
                    reports.push(report);
                }
                Err(error) => unreadable.leave_out(&progress, path, error)?,
            }
            progress.set(done);
        }
        let whole = unreadable.count() == before;
        Ok((reports, if whole { Ending::Complete } else { Ending::Failed }))
    }
}

impl ImageReport {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let shown = self.image.display();
        match &self.result {
            ImageResult::Network { classes } => {
                writeln!(out, "{shown}")?;
                write_top_classes(out, classes)
            }
            ImageResult::Svm { class, decisions } => {
                let decisions = aview1(decisions);
                writeln!(out, "{shown}: {class} (f = {decisions:.3})")
            }
        }
    }
}

fn main() -> ExitCode {
    program::main::<Arguments>()
}
