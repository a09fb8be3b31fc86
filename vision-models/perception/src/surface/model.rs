//! A trained model: a folder with the classifiers on each network.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use vision_models::{LinearHead, LinearSvm, ResNetDepth, Tensors};

use super::features::{FeatureSource, Features, PREPROCESSING, name_of, path_within};
use crate::{
    error::Error,
    file::{make_folder, write_whole},
    learning::{
        backbone::{ImageBackbone, WeightsIdentity},
        description,
        evaluation::Evaluation,
        split::Part,
    },
    networks::{
        classifier::Classifier,
        decider::Decider,
        folders::{LabelledImage, list_classes, list_images},
        names::depth_of,
    },
    watch::Watch,
};

/// Name of the file that describes the model.
const FILE: &str = "surface.json";
const VERSION: u32 = 1;
/// Name of the layer in the files of heads, as in torchvision.
const LAYER: &str = "fc";

/// The classifiers on one network.
#[derive(Debug)]
pub struct OverNetwork {
    /// Number of layers of the network.
    pub depth: ResNetDepth,
    /// The network's weights.
    pub weights: WeightsIdentity,
    /// The new last layer.
    pub head: LinearHead,
    /// The support vector machine.
    pub svm: LinearSvm,
}

/// A recogniser of surfaces, as `surface train` writes it into a folder.
#[derive(Debug)]
pub struct SurfaceModel {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// The part of each image in the training's folder, by its path there.
    pub parts: BTreeMap<String, Part>,
    /// The classifiers on each network.
    pub networks: Vec<OverNetwork>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    surface_model: u32,
    classes: Vec<String>,
    networks: Vec<NetworkDescription>,
    validation: Vec<String>,
    test: Vec<String>,
    training: Vec<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NetworkDescription {
    depth: usize,
    weights: WeightsIdentity,
}

impl SurfaceModel {
    /// Writes the model into a folder, the description last.
    ///
    /// # Errors
    /// Names the place that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        make_folder(folder)?;
        for network in &self.networks {
            let name = name_of(network.depth);
            let mut head = Vec::new();
            network.head.tensors(LAYER)?.write_safetensors(&mut head)?;
            write_whole(&folder.join(format!("{name}-head.safetensors")), &head)?;
            let svm = network.svm.to_string();
            write_whole(&folder.join(format!("{name}.svm")), svm.as_bytes())?;
        }
        let of = |part| {
            let own = self.parts.iter().filter(move |(_, own)| **own == part);
            own.map(|(path, _)| path.clone()).collect()
        };
        let describe = |network: &OverNetwork| NetworkDescription {
            depth: network.depth.layers(),
            weights: network.weights.clone(),
        };
        let described = Description {
            surface_model: VERSION,
            classes: self.classes.clone(),
            networks: self.networks.iter().map(describe).collect(),
            validation: of(Part::Validation),
            test: of(Part::Test),
            training: of(Part::Training),
        };
        description::write(&folder.join(FILE), &described)
    }

    /// Returns true if there is a model in a folder.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(FILE).exists()
    }

    /// Reads a model.
    ///
    /// # Errors
    /// Names the file that is missing, cannot be read, or does not fit the others.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(FILE);
        let described: Description = description::read(&path)?;
        let Description { surface_model, classes, networks, .. } = described;
        description::check_version(&path, surface_model, VERSION)?;
        let mut parts = BTreeMap::new();
        for (part, paths) in [
            (Part::Training, described.training),
            (Part::Validation, described.validation),
            (Part::Test, described.test),
        ] {
            parts.extend(paths.into_iter().map(|path| (path, part)));
        }
        let networks = networks
            .into_iter()
            .map(|NetworkDescription { depth, weights }| {
                let Some(depth) = depth_of(&depth.to_string()) else {
                    let found = format!("no ResNet has {depth} layers");
                    return Err(Error::at(path.display(), found));
                };
                let name = name_of(depth);
                let file = folder.join(format!("{name}-head.safetensors"));
                let head = Tensors::read(&file)
                    .and_then(|mut tensors| LinearHead::read(&mut tensors, LAYER, classes.clone()))
                    .map_err(Error::content(&file))?;
                let file = folder.join(format!("{name}.svm"));
                let svm = LinearSvm::read(&file).map_err(Error::content(&file))?;
                if svm.classes() != classes {
                    let found = format!("its classes are not those of {}", path.display());
                    return Err(Error::at(file.display(), found));
                }
                Ok(OverNetwork { depth, weights, head, svm })
            })
            .collect::<Result<_, Error>>()?;
        Ok(Self { classes, parts, networks })
    }

    /// Returns the images of a folder that has a folder for each of the model's classes. `part`
    /// selects a part of the training's split.
    ///
    /// # Errors
    /// Names the folder or the class that does not fit, or reports that the part has no images.
    pub fn images_of(
        &self,
        folder: &Path,
        part: Option<Part>,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<LabelledImage>, Error> {
        let refuse = |found: String| Error::at(folder.display(), found);
        let (classes, own) = (list_classes(folder, watch)?, self.classes.join(", "));
        if let Some(class) = classes.iter().find(|class| !self.classes.contains(class)) {
            let found =
                format!("the folder \"{class}\" is no class of the model, whose classes are {own}");
            return Err(refuse(found));
        }
        if let Some(class) = self.classes.iter().find(|class| !classes.contains(class)) {
            return Err(refuse(format!(
                "there is no folder for the class \"{class}\" of the model"
            )));
        }
        let mut images = list_images(folder, &self.classes, watch)?;
        if let Some(part) = part {
            images.retain(|image| self.parts.get(&path_within(folder, &image.path)) == Some(&part));
        }
        Ok(images)
    }

    /// Returns the networks for the features, with the weights of the model's training. `weights`
    /// has the checkpoint of each depth.
    ///
    /// # Errors
    /// An error if a checkpoint is missing or another one, or an error of the cache.
    pub fn sources(
        &self,
        weights: &[(ResNetDepth, PathBuf)],
        cache: Option<&PathBuf>,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<FeatureSource>, Error> {
        let source = |network: &OverNetwork| {
            let given = weights.iter().find(|(depth, _)| *depth == network.depth);
            let file = given.map(|(_, file)| file.clone());
            let own = network.weights.weights(file, watch)?;
            FeatureSource::new(network.depth, (own, &network.weights), cache, threads)
        };
        self.networks.iter().map(source).collect()
    }
}

impl OverNetwork {
    /// Returns the paper's two classifiers, by name.
    pub fn deciders(&self) -> [(String, Decider); 2] {
        let name = name_of(self.depth);
        let svm = format!("{name}+svm");
        [(name, Decider::Head(self.head.clone())), (svm, Decider::Svm(self.svm.clone()))]
    }

    /// Returns the network with both classifiers, for image files.
    ///
    /// # Errors
    /// An error if the checkpoint is missing, another one, or cannot be read.
    pub fn classifier(
        &self,
        weights: Option<PathBuf>,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Classifier, Error> {
        let weights = self.weights.weights(weights, watch)?;
        let network = ImageBackbone::new(weights, self.depth, PREPROCESSING.crop, threads);
        let deciders = self.deciders().map(|(_, decider)| decider).into();
        Ok(Classifier::new(PREPROCESSING, network.load(watch)?, deciders))
    }
}

impl Features {
    /// Returns the scores of each sample.
    ///
    /// # Errors
    /// Those of [`Decider::scores`].
    pub fn scores(&self, decider: &Decider) -> Result<Vec<Vec<f32>>, Error> {
        self.rows.outer_iter().map(|row| decider.scores(row)).collect()
    }

    /// Evaluates these scores.
    ///
    /// # Errors
    /// None if all classes are below `classes`.
    pub fn evaluate(&self, classes: usize, scores: &[Vec<f32>]) -> Result<Evaluation, Error> {
        let scores = scores.iter().map(Vec::as_slice);
        Evaluation::of(classes, self.labels.iter().copied().zip(scores))
    }
}
