//! The surface of the object, by a ResNet's features.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use vision_models::{
    Confidence, LinearHead, LinearSvm, NetworkKind, RecognisedSurface, ResNet, ResNetDepth,
    Surface, read_image, softmax,
};

use crate::surface::features::PREPROCESSING;
use crate::vision::{
    classifier::load_resnet,
    errors::{in_file, open_checkpoint},
};

/// The classes of a head whose names are not given: folders of images in their order.
const CLASSES: [&str; 2] = ["drilled", "smooth"];

/// What makes a surface of features.
#[derive(Clone, Debug)]
enum Decision {
    Svm(LinearSvm),
    Head(LinearHead),
}

/// Recognises the surface in an image of the on-board camera, by an SVM or a head over the features of a
/// ResNet (paper, Experiment 1).
#[derive(Debug)]
pub struct SurfaceNetwork {
    network: ResNet,
    decision: Decision,
    /// Of each class.
    surfaces: Vec<Surface>,
}

impl SurfaceNetwork {
    /// Loads the network, and an SVM as `surface train` writes it, or else a head with the tensors
    /// `fc.weight` and `fc.bias` for drilled and smooth.
    ///
    /// # Errors
    /// With the file's name.
    pub fn load(
        weights: &Path,
        depth: ResNetDepth,
        decision: SurfaceDecision<'_>,
        threads: usize,
    ) -> Result<Self> {
        let network = load_resnet(weights, depth, PREPROCESSING.crop, threads)?;
        let (decision, file) = match decision {
            SurfaceDecision::Svm(file) => {
                let svm = LinearSvm::read(file).map_err(|error| in_file(file, error))?;
                (Decision::Svm(svm), file)
            }
            SurfaceDecision::Head(file) => {
                let classes = CLASSES.map(str::to_owned).into();
                let head = LinearHead::read(&mut open_checkpoint(file)?, "fc", classes);
                (Decision::Head(head.map_err(|error| in_file(file, error))?), file)
            }
        };
        let (classes, taken) = match &decision {
            Decision::Svm(svm) => (svm.classes(), svm.weights().ncols()),
            Decision::Head(head) => (head.classes(), head.weights().ncols()),
        };
        let shown = file.display();
        let given = network.features();
        ensure!(
            taken == given,
            "{shown}: it takes {taken} features, but the {} of {} has {given}: give the network that \
             it was trained with",
            NetworkKind::ResNet(depth.into()),
            weights.display()
        );
        let surfaces = classes.iter().map(|class| class.parse());
        let surfaces = surfaces.collect::<Result<_, _>>().with_context(|| shown.to_string())?;
        Ok(Self { network, decision, surfaces })
    }

    /// The surface in an image file. The confidence of an SVM is the logistic function of its decision,
    /// which orders images but is no measured probability.
    ///
    /// # Errors
    /// If the image cannot be used.
    pub fn recognise(&mut self, image: &Path) -> Result<Option<RecognisedSurface>> {
        let image = PREPROCESSING.image(read_image(image)?.view())?;
        let scores = self.network.infer(image.view())?;
        let features = scores.features.row(0);
        let (class, probability) = match &self.decision {
            Decision::Svm(svm) => {
                let decision = svm.decide(features)?.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
                (svm.classify(features)?, 1.0 / (1.0 + (-decision).exp()))
            }
            Decision::Head(head) => {
                let class = head.classify(features)?;
                let scores = head.scores(features)?.to_vec();
                (class, softmax(&scores).get(class).copied().unwrap_or_default().into())
            }
        };
        let confidence = Confidence::new(probability.clamp(0.0, 1.0))?;
        Ok(self.surfaces.get(class).map(|&surface| RecognisedSurface { surface, confidence }))
    }
}

/// The file of what decides.
#[derive(Clone, Copy, Debug)]
pub enum SurfaceDecision<'a> {
    /// An SVM.
    Svm(&'a Path),
    /// A head.
    Head(&'a Path),
}
