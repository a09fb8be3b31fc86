//! The person's action, by SlowOnly over the newest frames.

use std::path::{Path, PathBuf};

use vision_models::{Action, ClassNames, Confidence, Intention, RecognisedAction, SlowOnlyForm};

use crate::{
    actions::model::ActionModel,
    error::Error,
    learning::backbone::{ClipBackbone, Weights},
    networks::clip_stream::{ClipStream, preprocessing_of},
    watch::Watch,
};

/// How a network with its own last layer recognises the action.
#[derive(Clone, Copy, Debug)]
pub struct ActionSettings<'a> {
    /// The checkpoint of the network.
    pub weights: &'a Path,
    /// Whose network.
    pub form: SlowOnlyForm,
    /// The names of the classes, one a line; HRI30's where there is none.
    pub names: Option<&'a Path>,
    /// Frames of a clip.
    pub length: usize,
    /// Camera frames from one of a clip to the next.
    pub interval: u64,
}

/// Recognises what the person does over a sliding window of colour images.
#[derive(Debug)]
pub struct ActionNetwork {
    stream: ClipStream,
    /// Of each class.
    actions: Vec<Action>,
    interval: u64,
    /// The number of the newest frame in the window.
    newest: Option<u64>,
}

impl ActionNetwork {
    /// Loads a network with its own last layer.
    ///
    /// # Errors
    /// Names the name of the file that does not fit.
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
        Ok(Self { stream, actions, interval: interval.max(1), newest: None })
    }

    /// Loads what `actions train` has trained, over the network that it was trained with.
    ///
    /// # Errors
    /// Names the file that does not fit; a class that is no action of HRI30.
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
        let interval = (model.window.interval as u64).max(1);
        let stream = model.stream(weights, threads, watch)?;
        Ok(Self { stream, actions, interval, newest: None })
    }

    /// Returns true if the frame of this number belongs into the window.
    pub fn wants(&self, frame: u64) -> bool {
        self.newest.is_none_or(|newest| frame >= newest.saturating_add(self.interval))
    }

    /// Takes a colour image into the window, and says what the person does once it is full. After a gap
    /// of a whole window it begins anew.
    ///
    /// # Errors
    /// If the image cannot be used.
    pub fn push(&mut self, frame: u64, image: &Path) -> Result<Option<RecognisedAction>, Error> {
        let missed = self.newest.is_some_and(|newest| frame - newest > GAPS * self.interval);
        if missed {
            self.stream.clear();
        }
        self.newest = Some(frame);
        let Some(probabilities) = self.stream.push(image)? else { return Ok(None) };
        self.decide(&probabilities)
    }

    /// The most probable action of the most probable intention, with the probability of that intention: a controller
    /// need not be sure which of two tools is in use to know that the person works.
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

/// So many intervals without a frame make a window one of two scenes.
const GAPS: u64 = 3;
