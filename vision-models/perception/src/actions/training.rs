//! Trains a new last layer on the features of clips.

use std::{collections::BTreeMap, path::Path};

use ndarray::{Array2, ArrayView2, Axis, concatenate, s};
use vision_models::{Action, ClassNames, HeadSettings, LinearHead};

use super::{
    clips::{ClipSet, LabelledClip},
    features::ClipFeatures,
    model::ActionModel,
    window::Views,
};
use crate::{
    error::Error,
    learning::{
        backbone::WeightsIdentity,
        evaluation::Evaluation,
        split::{Part, Shares, split},
    },
    watch::{Event, Watch},
};

/// Number of clips per class in HRI30, and how many of them each split uses for the test.
const OF_CLASS: f64 = 98.0;
const TESTED: [f64; 3] = [28.0, 21.0, 35.0];

/// The training clips, and the part of each clip of the data set.
#[derive(Clone, Debug)]
pub struct ClipParts {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// The training clips.
    pub training: Vec<LabelledClip>,
    /// The part of each clip, by its name.
    pub of_names: BTreeMap<String, Part>,
}

/// The result of a training.
#[derive(Debug)]
pub struct TrainedActions {
    /// The model.
    pub model: ActionModel,
    /// Share of the training clips that are recognised.
    pub accuracy: Option<f64>,
    /// Mean cross-entropy of the last epoch.
    pub loss: Option<f64>,
}

impl ClipParts {
    /// Splits the clips of FOLDER/CLASS/CLIP/frames at random by the seed. The sizes are those of
    /// HRI30's splits (1 to 3): 28, 21 or 35 of 98 clips per class are for the test.
    ///
    /// # Errors
    /// Names the folder, the class or the split that cannot be used.
    pub fn of_folders(
        folder: &Path,
        number: u8,
        seed: u64,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let ClipSet { classes, mut clips } = ClipSet::of_folders(folder, watch)?;
        let labels: Vec<usize> = clips.iter().map(|clip| clip.label).collect();
        let tested = TESTED.get(usize::from(number.wrapping_sub(1))).ok_or_else(|| {
            Error::unfit(format_args!("split {number}"), "there is none", "give 1, 2 or 3")
        })?;
        let shares = Shares { validation: 0.0, test: tested / OF_CLASS };
        let parts = split(&labels, &classes, shares, seed)
            .map_err(|error| Error::at(folder.display(), error))?;
        let of_names: BTreeMap<String, Part> =
            clips.iter().map(|clip| clip.name.clone()).zip(parts).collect();
        clips.retain(|clip| of_names.get(&clip.name) == Some(&Part::Training));
        Ok(Self { classes, training: clips, of_names })
    }

    /// Uses all clips of a list, in FOLDER/CLIP/frames, for training.
    ///
    /// # Errors
    /// Those of [`ClipSet::of_list`], and an error for a class without a clip.
    pub fn of_list(folder: &Path, list: &Path, names: &ClassNames) -> Result<Self, Error> {
        let ClipSet { classes, clips } = ClipSet::of_list(folder, list, names)?;
        for (label, class) in classes.iter().enumerate() {
            if !clips.iter().any(|clip| clip.label == label) {
                let found = format!("no clip of the class \"{class}\"");
                return Err(Error::at(list.display(), found));
            }
        }
        let of_names = clips.iter().map(|clip| (clip.name.clone(), Part::Training)).collect();
        Ok(Self { classes, training: clips, of_names })
    }

    /// Trains a new last layer on the middle window of each clip and, if requested, on its mirror
    /// image. `None` if the call-back stops the work. The features so far are then in the cache.
    ///
    /// # Errors
    /// Names the clip that cannot be used, or returns an error of the training or
    /// [`Error::Stopped`].
    pub fn train(
        &self,
        source: &mut ClipFeatures,
        weights: WeightsIdentity,
        (mirrored, settings): (bool, &HeadSettings),
        watch: &mut Watch<'_>,
    ) -> Result<Option<TrainedActions>, Error> {
        let features = source.of_clips(&self.training, Views::MIDDLE, mirrored, watch)?;
        if features.len() < self.training.len() {
            return Ok(None);
        }
        let plain = |views: &Array2<f32>| {
            if mirrored { views.nrows() / 2 } else { views.nrows() }
        };
        let (rows, labels) = self.samples(&features, plain)?;
        let (what, all) = ("last layer", settings.epochs as u64);
        let (mut loss, mut stopped) = (None, false);
        let classes = self.classes.clone();
        let head = LinearHead::train(rows.view(), &labels, classes, settings, |epoch| {
            loss = Some(epoch.loss);
            let done = epoch.number as u64;
            stopped = watch(Event::Progress { what, done, all }).is_break();
            !stopped
        })?;
        if stopped {
            return Err(Error::Stopped);
        }
        let (window, parts) = (source.window().clone(), self.of_names.clone());
        let model = ActionModel { head, window, weights, parts };
        let of_clip =
            |views: &Array2<f32>| model.probabilities(views.slice(s![..plain(views), ..]));
        let scores: Vec<Vec<f32>> = features.iter().map(of_clip).collect::<Result<_, _>>()?;
        let scored = scores.iter().map(Vec::as_slice);
        let samples = self.training.iter().map(|clip| clip.label).zip(scored);
        let accuracy = Evaluation::of(self.classes.len(), samples)?.accuracy;
        Ok(Some(TrainedActions { model, accuracy, loss }))
    }

    /// Returns the rows of all views with their classes. A mirrored view has the mirrored class. It
    /// is left out if that is none of the classes.
    fn samples(
        &self,
        features: &[Array2<f32>],
        plain: impl Fn(&Array2<f32>) -> usize,
    ) -> Result<(Array2<f32>, Vec<usize>), Error> {
        let mirrored = |label: usize| {
            let name = self.classes.get(label)?;
            let name = Action::from_label(name).map_or(name.as_str(), |own| own.mirrored().name());
            self.classes.iter().position(|class| class == name)
        };
        let (mut rows, mut labels) = (Vec::<ArrayView2<'_, f32>>::new(), Vec::new());
        for (clip, views) in self.training.iter().zip(features) {
            let (own, of_mirror) = views.view().split_at(Axis(0), plain(views));
            labels.extend(vec![clip.label; own.nrows()]);
            rows.push(own);
            if let Some(label) = mirrored(clip.label) {
                labels.extend(vec![label; of_mirror.nrows()]);
                rows.push(of_mirror);
            }
        }
        let rows = concatenate(Axis(0), &rows);
        Ok((rows.map_err(|error| Error::at("features of clips", error))?, labels))
    }
}
