//! Classification of images.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use human_perception::{
    Event, Watch,
    learning::backbone::{ImageBackbone, Weights},
    networks::{
        classifier::Classifier,
        folders::Unreadable,
        top_k::{ScoredClass, check_names, top_classes, write_top_classes},
    },
    surface::model::SurfaceModel,
};
use ndarray::Array4;
use serde::Serialize;
use vision_models::{
    ClassNames, Orientation, Preprocessing, ResNetDepth, ResNetForm, Resize, softmax, top_k,
};

use super::Results;
use crate::{
    program::{Ending, Session, shown},
    vision::choices::with_option,
};

/// Preparation of images.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Images")]
pub struct ImageOptions {
    /// The size to which images are scaled before the middle 224 × 224 is cut out (pixels). Default 255, as in the
    /// paper. Use 256 for torchvision's weights IMAGENET1K_V1 and 232 for IMAGENET1K_V2.
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u16).range(224..=16_384))]
    resize: Option<u16>,
    /// Scale both sides to that size, as the paper does, instead of the short side.
    #[arg(long)]
    square: bool,
    /// The orientation: `stored` as the pixels are in the file, like torchvision; `exif` as the camera was held, if the
    /// file says so, like OpenCV.
    #[arg(long, default_value = "stored")]
    orientation: OrientationOption,
    /// Stop at the first image that cannot be read.
    #[arg(long)]
    strict: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum OrientationOption {
    Stored,
    Exif,
}

/// A network for images, and the meaning of its scores.
#[derive(Debug)]
pub enum ImageNetwork {
    /// A network with its own last layer.
    Own(Box<Classifier>, Option<ClassNames>),
    /// The networks of a trained model, each with the names of its deciders.
    Model {
        /// The names of the classes.
        classes: Vec<String>,
        /// The networks.
        networks: Vec<(Vec<String>, Classifier)>,
    },
}

/// The JSON object of `--json`.
#[derive(Default, Serialize)]
struct Report {
    /// Classes of a trained model.
    #[serde(skip_serializing_if = "Option::is_none")]
    classes: Option<Vec<String>>,
    images: Vec<ImageReport>,
    /// Number of images that could not be read.
    unreadable: usize,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ImageReport {
    Own {
        image: PathBuf,
        classes: Vec<ScoredClass>,
    },
    /// Scores in the order of the model's classes.
    Model {
        image: PathBuf,
        model: String,
        class: String,
        scores: Vec<f32>,
    },
}

impl ImageOptions {
    /// Loads a network with its own last layer.
    ///
    /// # Errors
    /// The file or the option that is wrong.
    pub fn own(
        self,
        form: ResNetForm,
        weights: &Path,
        names: Option<(&Path, ClassNames)>,
        (threads, watch): (usize, &mut Watch<'_>),
    ) -> Result<ImageNetwork> {
        let side = self.resize.unwrap_or(255).into();
        let resize = if self.square { Resize::Square(side) } else { Resize::ShortSide(side) };
        let preprocessing = Preprocessing { resize, ..Preprocessing::TORCHVISION };
        let weights = Weights::File(weights.into());
        let network = ImageBackbone::new(weights, form, preprocessing.crop, threads)
            .load(watch)
            .map_err(|error| with_option(error, ""))?;
        if let Some((file, names)) = &names {
            check_names(file, names, network.classes())?;
        }
        let classifier = Classifier::new(preprocessing, network, Vec::new());
        Ok(ImageNetwork::Own(Box::new(classifier), names.map(|(_, names)| names)))
    }

    /// Loads the networks of a trained model.
    ///
    /// # Errors
    /// The file or the option that is wrong.
    pub fn model(
        self,
        model: SurfaceModel,
        weights: &[(Option<ResNetDepth>, PathBuf)],
        (threads, watch): (usize, &mut Watch<'_>),
    ) -> Result<ImageNetwork> {
        ensure!(
            self.resize.is_none() && !self.square,
            "--resize and --square: a trained model prepares images as for its training"
        );
        let alone = model.networks.len() == 1;
        let mut networks = Vec::new();
        for network in &model.networks {
            let own = |depth: Option<ResNetDepth>| depth.map_or(alone, |own| own == network.depth);
            let file = weights.iter().find(|(depth, _)| own(*depth)).map(|(_, file)| file.clone());
            let option = format!("--weights {}=FILE", network.depth.layers());
            let classifier = network
                .classifier(file, threads, watch)
                .map_err(|error| with_option(error, &option))?;
            networks.push((network.deciders().map(|(name, _)| name).into(), classifier));
        }
        Ok(ImageNetwork::Model { classes: model.classes, networks })
    }

    /// Classifies images and prints the results.
    ///
    /// # Errors
    /// The image that cannot be used, or an error of the network.
    pub fn run(
        self,
        mut network: ImageNetwork,
        images: Vec<PathBuf>,
        session: &mut Session,
        mut results: Results,
    ) -> Result<Ending> {
        let orientation = match self.orientation {
            OrientationOption::Stored => Orientation::Stored,
            OrientationOption::Exif => Orientation::Exif,
        };
        session.interrupt().check()?;
        let (mut unreadable, mut report) = (Unreadable::new(self.strict), Report::default());
        let progress = session.progress("images", images.len() as u64);
        let mut watch = |event: Event<'_>| {
            if let Event::Warning(text) = event {
                progress.note(text);
            }
            std::ops::ControlFlow::Continue(())
        };
        let mut ending = Ending::Complete;
        for (done, path) in (1..).zip(images) {
            if session.interrupt().requested() {
                ending = Ending::Partial;
                break;
            }
            let read = network.first().read(&path, orientation);
            match read {
                Ok(image) => {
                    for own in network.classify(&path, &image)? {
                        progress.suspend(|| own.write(results.writer(session)))?;
                        report.images.push(own);
                    }
                }
                Err(error) => unreadable.leave_out(error, &mut watch)?,
            }
            progress.set(done);
        }
        progress.finish();
        if let ImageNetwork::Model { classes, .. } = network {
            report.classes = Some(classes);
        }
        report.unreadable = unreadable.count();
        if report.unreadable > 0 {
            session.warn(format_args!("{} images could not be read", report.unreadable));
        }
        if ending == Ending::Partial {
            session.warn("interrupted: the results are of the images up to there");
        } else if report.unreadable > 0 {
            ending = Ending::Failed;
        }
        results.conclude(session, &report, ending)
    }
}

impl ImageNetwork {
    /// The network that reads images; all networks of a model get the same ones.
    fn first(&self) -> &Classifier {
        match self {
            Self::Own(classifier, _) => classifier,
            Self::Model { networks, .. } => &networks[0].1,
        }
    }

    /// The results of every network and every decider for an image.
    fn classify(&mut self, path: &Path, image: &Array4<f32>) -> Result<Vec<ImageReport>> {
        match self {
            Self::Own(classifier, names) => {
                let scores = classifier.scores(image)?;
                let classes = |scores: &Vec<f32>| top_classes(&softmax(scores), names.as_ref());
                let report =
                    |own| ImageReport::Own { image: path.to_owned(), classes: classes(own) };
                Ok(scores.iter().map(report).collect())
            }
            Self::Model { classes, networks } => {
                let mut reports = Vec::new();
                for (names, classifier) in networks {
                    for (model, scores) in names.iter().zip(classifier.scores(image)?) {
                        let best = top_k(&scores, 1).first().copied().unwrap_or_default();
                        let class = classes.get(best).cloned().unwrap_or_default();
                        let (image, model) = (path.to_owned(), model.clone());
                        reports.push(ImageReport::Model { image, model, class, scores });
                    }
                }
                Ok(reports)
            }
        }
    }
}

impl ImageReport {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Own { image, classes } => {
                writeln!(out, "{}", shown(image))?;
                write_top_classes(out, classes)
            }
            Self::Model { image, model, class, scores } => {
                writeln!(out, "{}: {class} ({model}: {scores:.3?})", shown(image))
            }
        }
    }
}
