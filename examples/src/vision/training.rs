//! Training a linear SVM on the features of images in folders.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use anyhow::{Result, ensure};
use ndarray::Array2;
use serde::Serialize;
use vision_models::{LinearSvm, SvmSettings, Training};

use super::{
    classifier::Classifier,
    folders::{LabelledImage, Unreadable, list_classes, list_images},
};
use crate::program::{Ending, ProgramError, Session};

/// The images to train with.
#[derive(Clone, Debug)]
pub struct TrainingSet {
    folder: PathBuf,
    classes: Vec<String>,
    images: Vec<LabelledImage>,
}

/// How a training went.
#[derive(Clone, Debug, Serialize)]
pub struct TrainingReport {
    /// Images that were trained with.
    pub images: usize,
    /// Images that could not be read.
    pub unreadable: usize,
    /// One for each plane.
    pub planes: Vec<PlaneReport>,
}

/// How the training of a plane ended.
#[derive(Clone, Debug, Serialize)]
pub struct PlaneReport {
    /// Steps of the solver.
    pub steps: usize,
    /// ½ wᵀw + C Σ ξ, or with ξ².
    pub objective: f64,
    /// The duality gap as a part of it.
    pub gap: f64,
}

impl TrainingSet {
    /// Lists the images of a folder that has a folder for each class.
    ///
    /// # Errors
    /// If there are fewer than two classes, one without images, or too many images.
    pub fn list(folder: &Path) -> Result<Self> {
        let classes = list_classes(folder)?;
        let images = list_images(folder, &classes)?;
        let (count, most) = (images.len(), LinearSvm::MAX_SAMPLES);
        ensure!(count <= most, "{}: {count} images, give at most {most}", folder.display());
        Ok(Self { folder: folder.to_owned(), classes, images })
    }

    /// The names of the classes.
    pub fn classes(&self) -> &[String] {
        &self.classes
    }

    /// Trains on the features of all images that can be read. Nothing is kept of an interrupted
    /// training: it would lack whole classes.
    ///
    /// # Errors
    /// If a class is left without images, the solver does not converge, or there is an interrupt.
    pub fn train(
        self,
        classifier: &mut Classifier,
        settings: SvmSettings,
        session: &Session,
        unreadable: &mut Unreadable,
    ) -> Result<(LinearSvm, TrainingReport)> {
        let before = unreadable.count();
        let (mut features, mut labels) = (Vec::new(), Vec::new());
        let ending = classifier.score_each(
            session,
            "training images",
            &self.images,
            unreadable,
            |label, scored| {
                features.extend(scored.features);
                labels.push(label);
                Ok(())
            },
        )?;
        ensure!(ending == Ending::Complete, ProgramError::Interrupted);
        for (label, class) in self.classes.iter().enumerate() {
            let folder = self.folder.join(class);
            ensure!(labels.contains(&label), "{}: no image can be read", folder.display());
        }
        let features = Array2::from_shape_vec((labels.len(), classifier.features()), features)?;
        let images = labels.len();
        let solved = session.interrupt().wait_for(move || {
            LinearSvm::train(features.view(), &labels, self.classes, &settings)
        })?;
        let (svm, trainings) = solved?;
        let planes = trainings.iter().map(report).collect::<Result<_>>()?;
        let unreadable = unreadable.count() - before;
        Ok((svm, TrainingReport { images, unreadable, planes }))
    }
}

impl TrainingReport {
    /// Writes a line for each plane.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        for PlaneReport { steps, objective, gap } in &self.planes {
            let images = self.images;
            writeln!(
                out,
                "trained with {images} images in {steps} steps: objective {objective:.6}, gap {gap:.1e}"
            )?;
        }
        Ok(())
    }
}

fn report(training: &Training) -> Result<PlaneReport> {
    ensure!(
        training.converged,
        "the training did not converge in {} steps: the objective is {}, at best {}; try a smaller \
         --cost",
        training.iterations,
        training.objective,
        training.bound
    );
    let gap = training.gap();
    Ok(PlaneReport { steps: training.iterations, objective: training.objective, gap })
}
