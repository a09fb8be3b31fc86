//! The paper's models on the features of images.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use vision_models::{HeadSettings, LinearHead, LinearSvm, ResNetDepth, SvmSettings, Training};

use super::{
    features::{Features, name_of, path_within},
    model::OverNetwork,
};
use crate::{
    error::Error,
    learning::{
        backbone::WeightsIdentity,
        split::{Part, Shares, split},
        twins::{Twins, twins},
    },
    networks::folders::{LabelledImage, list_classes, list_images},
    watch::{Event, Watch, wait_for},
};

/// The images of a folder with one folder per class, split into the paper's parts.
#[derive(Clone, Debug)]
pub struct ImageParts {
    /// The folder.
    pub folder: PathBuf,
    /// Names of the classes.
    pub classes: Vec<String>,
    /// The training images.
    pub training: Vec<LabelledImage>,
    /// The validation images, for choosing settings.
    pub validation: Vec<LabelledImage>,
    /// The part of each image, by its path in the folder.
    pub of_paths: BTreeMap<String, Part>,
}

/// Settings for training the models on a network.
#[derive(Clone, Debug)]
pub struct TrainingSettings {
    /// Settings of the new last layer.
    pub head: HeadSettings,
    /// Settings of the support vector machine.
    pub svm: SvmSettings,
}

impl ImageParts {
    /// Splits the images of each class at random by the seed: 70 % training, 20 % validation, 10 %
    /// test.
    ///
    /// # Errors
    /// Names the folder or the class that cannot be used.
    pub fn of_folder(folder: &Path, seed: u64, watch: &mut Watch<'_>) -> Result<Self, Error> {
        let classes = list_classes(folder, watch)?;
        let images = list_images(folder, &classes, watch)?;
        let labels: Vec<usize> = images.iter().map(|image| image.label).collect();
        let parts = split(&labels, &classes, Shares::SURFACE, seed)
            .map_err(|error| Error::at(folder.display(), error))?;
        let (mut training, mut validation, mut of_paths) = (vec![], vec![], BTreeMap::new());
        for (image, part) in images.into_iter().zip(parts) {
            of_paths.insert(path_within(folder, &image.path), part);
            match part {
                Part::Training => training.push(image),
                Part::Validation => validation.push(image),
                Part::Test => {}
            }
        }
        Ok(Self { folder: folder.to_owned(), classes, training, validation, of_paths })
    }

    /// Returns the images whose content is also in another part.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the call-back stops the work.
    pub fn twins(&self, watch: &mut Watch<'_>) -> Result<Vec<Twins>, Error> {
        let paths: Vec<_> =
            self.of_paths.iter().map(|(path, part)| (self.folder.join(path), *part)).collect();
        let files: Vec<_> = paths.iter().map(|(path, part)| (path.as_path(), *part)).collect();
        twins(&files, watch)
    }

    /// Trains both models on the features of one network. Also returns the largest relative duality
    /// gap of the machine's planes.
    ///
    /// # Errors
    /// Names a class without a readable image, or a machine that does not converge.
    /// [`Error::Stopped`] if the call-back stops the work.
    pub fn train(
        &self,
        (depth, weights): (ResNetDepth, WeightsIdentity),
        training: &Features,
        settings: &TrainingSettings,
        watch: &mut Watch<'_>,
    ) -> Result<(OverNetwork, f64), Error> {
        for (label, class) in self.classes.iter().enumerate() {
            if !training.labels.contains(&label) {
                let folder = self.folder.join(class);
                return Err(Error::at(folder.display(), "no image to train with can be read"));
            }
        }
        let name = name_of(depth);
        let (what, labels) = (format!("last layer of {name}"), &training.labels);
        let (all, classes) = (settings.head.epochs as u64, self.classes.clone());
        let mut stopped = false;
        let head =
            LinearHead::train(training.rows.view(), labels, classes, &settings.head, |epoch| {
                let done = epoch.number as u64;
                stopped = watch(Event::Progress { what: &what, done, all }).is_break();
                !stopped
            })
            .map_err(|error| Error::at(format_args!("the {what}"), error))?;
        if stopped {
            return Err(Error::Stopped);
        }
        let (samples, labels) = (training.rows.clone(), labels.clone());
        let (classes, own) = (self.classes.clone(), settings.svm.clone());
        let solve = move || LinearSvm::train(samples.view(), &labels, classes, &own);
        let (svm, trainings) = wait_for(solve, watch)??;
        let gap = trainings.iter().map(Training::gap).fold(0.0, f64::max);
        if !trainings.iter().all(|training| training.converged) {
            return Err(Error::unfit(
                format_args!("the support vector machine over {name} did not converge"),
                format_args!("the duality gap is {gap:.1e} of the objective"),
                "try a smaller cost",
            ));
        }
        Ok((OverNetwork { depth, weights, head, svm }, gap))
    }
}
