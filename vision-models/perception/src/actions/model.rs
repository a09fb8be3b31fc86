//! A trained recogniser: a folder with the head and the description of its training.

use std::{collections::BTreeMap, path::Path};

use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};
use vision_models::{Crops, LinearHead, Tensors, softmax};

use super::{
    clips::{ClipSet, LabelledClip},
    window::Window,
};
use crate::{
    error::Error,
    file::{make_folder, write_whole},
    learning::{
        backbone::{Weights, WeightsIdentity},
        description,
        split::Part,
    },
    networks::clip_stream::ClipStream,
    watch::Watch,
};

const FILE: &str = "actions.json";
const HEAD: &str = "head.safetensors";
const VERSION: u32 = 1;
/// Name of the layer, as in mmaction2.
const LAYER: &str = "cls_head.fc_cls";

/// A recogniser of actions, as `actions train` writes it into a folder.
#[derive(Debug)]
pub struct ActionModel {
    /// The new last layer, with the names of the classes.
    pub head: LinearHead,
    /// The frames of a clip that are one input of the network.
    pub window: Window,
    /// Identity of the network's weights.
    pub weights: WeightsIdentity,
    /// The part of each clip in the training's folder, by its name.
    pub parts: BTreeMap<String, Part>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    action_model: u32,
    classes: Vec<String>,
    window: Window,
    weights: WeightsIdentity,
    training: Vec<String>,
    test: Vec<String>,
}

impl ActionModel {
    /// Writes the model into a folder, the description last.
    ///
    /// # Errors
    /// Names the place that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        make_folder(folder)?;
        let mut head = Vec::new();
        self.head.tensors(LAYER)?.write_safetensors(&mut head)?;
        write_whole(&folder.join(HEAD), &head)?;
        let of = |part| {
            let own = self.parts.iter().filter(move |(_, own)| **own == part);
            own.map(|(name, _)| name.clone()).collect()
        };
        let described = Description {
            action_model: VERSION,
            classes: self.head.classes().to_vec(),
            window: self.window.clone(),
            weights: self.weights.clone(),
            training: of(Part::Training),
            test: of(Part::Test),
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
    /// Names the file that is missing, cannot be read, or does not fit the other one.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(FILE);
        let described: Description = description::read(&path)?;
        let Description { action_model, classes, window, weights, training, test } = described;
        description::check_version(&path, action_model, VERSION)?;
        let Window { length, interval, side, .. } = window;
        if !(1..=64).contains(&length)
            || !(1..=64).contains(&interval)
            || !(32..=512).contains(&side)
        {
            let found =
                format!("the window has {length} frames, every {interval}, of {side} pixels");
            return Err(Error::unfit(path.display(), found, "give 1 to 64, 1 to 64 and 32 to 512"));
        }
        let file = folder.join(HEAD);
        let head = Tensors::read(&file)
            .and_then(|mut tensors| LinearHead::read(&mut tensors, LAYER, classes))
            .map_err(Error::content(&file))?;
        let mut parts = BTreeMap::new();
        parts.extend(training.into_iter().map(|name| (name, Part::Training)));
        parts.extend(test.into_iter().map(|name| (name, Part::Test)));
        Ok(Self { head, window, weights, parts })
    }

    /// Returns the clips of a set with the model's class indices. `part` selects a part of the
    /// training's split.
    ///
    /// # Errors
    /// Names a clip whose class the model does not have, or reports that the part has no clips.
    pub fn clips_of(&self, set: ClipSet, part: Option<Part>) -> Result<Vec<LabelledClip>, Error> {
        let ClipSet { classes, mut clips } = set;
        let own = self.head.classes();
        for clip in &mut clips {
            let name = classes.get(clip.label).map_or("", String::as_str);
            clip.label = own.iter().position(|class| class == name).ok_or_else(|| {
                let found = format!("\"{name}\" is no class of the model");
                Error::unfit(
                    clip.folder.display(),
                    found,
                    format!("give one of {}", own.join(", ")),
                )
            })?;
        }
        if let Some(part) = part {
            clips.retain(|clip| self.parts.get(&clip.name) == Some(&part));
        }
        Ok(clips)
    }

    /// Returns the network with its head over a sliding window.
    ///
    /// # Errors
    /// Those of loading the network.
    pub fn stream(
        &self,
        weights: Weights,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<ClipStream, Error> {
        let network = self.window.backbone(weights, threads)?.load(watch)?;
        let preprocessing = self.window.preprocessing(Crops::Centre)?;
        let Window { length, .. } = self.window;
        ClipStream::new(network, length, preprocessing, Some(self.head.clone()))
    }

    /// Returns the mean probability of each class over views, one row of features per view.
    ///
    /// # Errors
    /// An error if the number of features differs from the training's.
    #[allow(clippy::needless_pass_by_value)] // views are passed by value, as usual with ndarray
    pub fn probabilities(&self, views: ArrayView2<'_, f32>) -> Result<Vec<f32>, Error> {
        let mut mean = vec![0.0; self.head.classes().len()];
        for row in views.outer_iter() {
            let probabilities = softmax(&self.head.scores(row)?.to_vec());
            for (mean, probability) in mean.iter_mut().zip(probabilities) {
                *mean += probability / views.nrows() as f32;
            }
        }
        Ok(mean)
    }

    /// Returns the same for each clip.
    ///
    /// # Errors
    /// Those of [`Self::probabilities`].
    pub fn of_clips(&self, clips: &[Array2<f32>]) -> Result<Vec<Vec<f32>>, Error> {
        clips.iter().map(|views| self.probabilities(views.view())).collect()
    }
}
