//! Recognises the surface of the object by a ResNet.

use std::path::{Path, PathBuf};

use vision_models::{Confidence, RecognisedSurface, ResNet, ResNetDepth, Surface, softmax};

use crate::{
    error::Error,
    frames::Picture,
    learning::backbone::{ImageBackbone, Weights},
    networks::decider::Decider,
    surface::{features::PREPROCESSING, model::SurfaceModel},
    watch::Watch,
};

/// The part of a trained model that decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceDecision {
    /// The support vector machine.
    Svm,
    /// The new last layer.
    Head,
}

/// Recognises the surface in an image of the on-board camera (paper, Experiment 1).
#[derive(Debug)]
pub struct SurfaceNetwork {
    network: ResNet,
    /// The decider that replaces the network's own last layer.
    decider: Option<Decider>,
    /// The surface of each class.
    surfaces: Vec<Surface>,
}

impl SurfaceNetwork {
    /// Loads a network whose last layer has two classes, drilled and smooth in this order.
    ///
    /// # Errors
    /// Names the file that cannot be used.
    pub fn load(
        weights: &Path,
        depth: ResNetDepth,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let network =
            ImageBackbone::new(Weights::File(weights.into()), depth, PREPROCESSING.crop, threads)
                .load(watch)?;
        let classes = network.classes();
        if classes != 2 {
            let found = format!("the network has {classes} classes, not drilled and smooth");
            let wanted = "give one that has, or a trained model";
            return Err(Error::unfit(weights.display(), found, wanted));
        }
        let surfaces = vec![Surface::Drilled, Surface::Smooth];
        Ok(Self { network, decider: None, surfaces })
    }

    /// Loads a model trained by `surface train`, on the network with which it was trained. `depth`
    /// selects the network if there are several.
    ///
    /// # Errors
    /// Names the file that does not fit, or a class that is no surface.
    pub fn of_model(
        folder: &Path,
        (depth, decision): (Option<ResNetDepth>, SurfaceDecision),
        weights: Option<PathBuf>,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let SurfaceModel { classes, networks, .. } = SurfaceModel::read(folder)?;
        let surfaces = classes.iter().map(|class| class.parse());
        let surfaces = surfaces.collect::<Result<_, _>>().map_err(Error::content(folder))?;
        let depths: Vec<_> = networks.iter().map(|own| own.depth.layers().to_string()).collect();
        let mut chosen = networks.into_iter().filter(|own| depth.is_none_or(|d| own.depth == d));
        let (Some(own), None) = (chosen.next(), chosen.next()) else {
            let found = format!("trained over networks of {} layers", depths.join(" and "));
            return Err(Error::unfit(folder.display(), found, "choose one by its depth"));
        };
        let weights = own.weights.weights(weights, watch)?;
        let network =
            ImageBackbone::new(weights, own.depth, PREPROCESSING.crop, threads).load(watch)?;
        let decider = Some(match decision {
            SurfaceDecision::Svm => Decider::Svm(own.svm),
            SurfaceDecision::Head => Decider::Head(own.head),
        });
        Ok(Self { network, decider, surfaces })
    }

    /// Recognises the surface in an image. The confidence of an SVM is the logistic function
    /// of its decision value. It orders images, but is no measured probability.
    ///
    /// # Errors
    /// An error if the image cannot be used.
    pub fn recognise(&mut self, image: &Picture) -> Result<Option<RecognisedSurface>, Error> {
        let image = PREPROCESSING.image(image.read()?.view())?;
        let scores = self.network.infer(image.view())?;
        let features = scores.features.row(0);
        let of = |probabilities: &[f32]| {
            let class = vision_models::top_k(probabilities, 1).first().copied().unwrap_or_default();
            (class, probabilities.get(class).copied().unwrap_or_default().into())
        };
        let (class, probability) = match &self.decider {
            None => of(&softmax(&scores.logits.row(0).to_vec())),
            Some(Decider::Head(head)) => of(&softmax(&head.scores(features)?.to_vec())),
            Some(Decider::Svm(svm)) => {
                let decision = svm.decide(features)?.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
                (svm.classify(features)?, 1.0 / (1.0 + (-decision).exp()))
            }
        };
        let confidence = Confidence::new(f64::clamp(probability, 0.0, 1.0))?;
        Ok(self.surfaces.get(class).map(|&surface| RecognisedSurface { surface, confidence }))
    }
}
