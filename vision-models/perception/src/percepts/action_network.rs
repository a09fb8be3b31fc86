//! Recognises the person's action by SlowOnly on the newest frames.

use std::path::{Path, PathBuf};

use vision_models::{Action, ClassNames, Confidence, Intention, RecognisedAction, SlowOnlyForm};

use crate::{
    actions::model::ActionModel,
    error::Error,
    frames::Picture,
    learning::backbone::{ClipBackbone, Weights},
    networks::clip_stream::{ClipStream, preprocessing_of},
    watch::Watch,
};

/// Settings for recognising the action with a network's own last layer.
#[derive(Clone, Copy, Debug)]
pub struct ActionSettings<'a> {
    /// The checkpoint of the network.
    pub weights: &'a Path,
    /// The variant of SlowOnly.
    pub form: SlowOnlyForm,
    /// File with the names of the classes, one per line. HRI30's names if missing.
    pub names: Option<&'a Path>,
    /// Number of frames of a clip.
    pub length: usize,
    /// Number of camera frames from one frame of the clip to the next.
    pub interval: u64,
}

/// Recognises the person's action over a sliding window of colour images.
#[derive(Debug)]
pub struct ActionNetwork {
    stream: ClipStream,
    /// The action of each class.
    actions: Vec<Action>,
    interval: u64,
    /// Number of the newest frame in the window.
    newest: Option<u64>,
}

impl ActionNetwork {
    /// Loads a network with its own last layer.
    ///
    /// # Errors
    /// Names the file that does not fit.
    pub fn load(
        settings: &ActionSettings<'_>,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let ActionSettings { weights, form, names, length, interval } = *settings;
        let names_of = |error| match names {
            Some(file) => Error::content(file)(error),
            None => error.into(),
        };
        let actions = names.map_or_else(|| Ok(ClassNames::hri30()), ClassNames::read);
        let actions = actions.and_then(|names| names.actions()).map_err(names_of)?;
        let preprocessing = preprocessing_of(form);
        let size = [length, preprocessing.crop, preprocessing.crop];
        let network =
            ClipBackbone::new(Weights::File(weights.into()), form, size, threads).load(watch)?;
        let (classes, count) = (network.classes(), actions.len());
        if classes != count {
            let found = format!("the network has {classes} classes, and there are {count} names");
            let wanted = "give those names, or a trained model";
            return Err(Error::unfit(weights.display(), found, wanted));
        }
        let stream = ClipStream::new(network, length, preprocessing, None)?;
        Ok(Self::new(stream, actions, interval))
    }

    /// Loads a model trained by `actions train`, on the network with which it was trained.
    ///
    /// # Errors
    /// Names the file that does not fit, or a class that is no action of HRI30.
    pub fn of_model(
        folder: &Path,
        weights: Option<PathBuf>,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let model = ActionModel::read(folder)?;
        let classes = model.head.classes().iter().map(|class| Action::from_label(class));
        let actions = classes.collect::<Result<_, _>>();
        let actions = actions.map_err(Error::content(folder))?;
        let weights = model.weights.weights(weights, watch)?;
        let interval = model.window.interval as u64;
        let stream = model.stream(weights, threads, watch)?;
        Ok(Self::new(stream, actions, interval))
    }

    pub(super) fn new(stream: ClipStream, actions: Vec<Action>, interval: u64) -> Self {
        Self { stream, actions, interval: interval.max(1), newest: None }
    }

    /// Number of camera frames from one frame of the window to the next.
    pub fn interval(&self) -> u64 {
        self.interval
    }

    /// Returns true if the frame of this number belongs to the window.
    pub fn wants(&self, frame: u64) -> bool {
        self.newest.is_none_or(|newest| frame >= newest.saturating_add(self.interval))
    }

    /// Adds a colour image to the window. Returns the person's action if the window is full. After
    /// a gap of several intervals the window is emptied first.
    ///
    /// # Errors
    /// An error if the image cannot be used.
    pub fn push(&mut self, frame: u64, image: &Picture) -> Result<Option<RecognisedAction>, Error> {
        self.follow(frame);
        let Some(probabilities) = self.stream.push(image)? else { return Ok(None) };
        self.decide(&probabilities)
    }

    /// Adds a colour image to the window without recognising the action, which takes less time.
    ///
    /// # Errors
    /// An error if the image cannot be used.
    pub fn add(&mut self, frame: u64, image: &Picture) -> Result<(), Error> {
        self.follow(frame);
        self.stream.add(image)
    }

    /// Empties the window if this frame comes too long after the newest in it.
    fn follow(&mut self, frame: u64) {
        let newest = self.newest.replace(frame);
        if newest.is_some_and(|newest| frame.saturating_sub(newest) > GAPS * self.interval) {
            self.stream.clear();
        }
    }

    /// Returns the most probable action of the most probable intention, with the probability of
    /// that intention. A controller need not know which of two tools is in use to know that the
    /// person works.
    fn decide(&self, probabilities: &[f32]) -> Result<Option<RecognisedAction>, Error> {
        let classes = || probabilities.iter().zip(&self.actions);
        let of_intention = |action: Action| -> f32 {
            let wanted = |action: Action| Intention::from(action).regardless_of_tool();
            let same = classes().filter(|(_, other)| wanted(**other) == wanted(action));
            same.map(|(probability, _)| probability).sum()
        };
        let scored = classes().map(|(own, action)| (of_intention(*action), *own, *action));
        let best =
            scored.max_by(|one, other| one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1)));
        let Some((probability, _, action)) = best else { return Ok(None) };
        let confidence = Confidence::new(f64::from(probability).clamp(0.0, 1.0))?;
        Ok(Some(RecognisedAction { action, confidence }))
    }
}

/// After a gap of more than this many intervals the window would show two scenes.
const GAPS: u64 = 3;
