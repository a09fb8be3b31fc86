//! The person's action, by SlowOnly over the newest frames.

use std::path::Path;

use anyhow::{Result, ensure};
use ndarray::Axis;
use vision_models::{
    Action, ClassNames, Confidence, Error, LinearHead, Options, Preprocessing, RecognisedAction,
    SlowOnly, SlowOnlyForm, SlowOnlyStream, read_image, softmax,
};

use crate::vision::{
    choices::Accepted,
    errors::{in_file, of_weights, open_checkpoint},
};

/// How the action is recognised.
#[derive(Clone, Copy, Debug)]
pub struct ActionSettings<'a> {
    /// The checkpoint of the network.
    pub weights: &'a Path,
    /// Whose network.
    pub form: SlowOnlyForm,
    /// A head over the network's features in place of its own, with `fc.weight` and `fc.bias`.
    pub head: Option<&'a Path>,
    /// The names of the classes, one a line; HRI30's where there is none.
    pub names: Option<&'a Path>,
    /// Frames of a clip.
    pub length: usize,
    /// Camera frames from one of a clip to the next.
    pub interval: u64,
    /// Threads that share the work.
    pub threads: usize,
}

/// Recognises what the person does over a sliding window of colour images.
#[derive(Debug)]
pub struct ActionNetwork {
    stream: SlowOnlyStream,
    preprocessing: Preprocessing,
    head: Option<LinearHead>,
    /// Of each class.
    actions: Vec<Action>,
    interval: u64,
    /// The number of the newest frame in the window.
    newest: Option<u64>,
}

impl ActionNetwork {
    /// Loads the network.
    ///
    /// # Errors
    /// With the name of the file that does not fit.
    pub fn load(settings: &ActionSettings<'_>) -> Result<Self> {
        let ActionSettings { weights, form, length, interval, threads, .. } = *settings;
        let names = match settings.names {
            Some(file) => ClassNames::read(file).map_err(|error| in_file(file, error))?,
            None => ClassNames::hri30(),
        };
        let names_of = |error: Error| match settings.names {
            Some(file) => in_file(file, error),
            None => error.into(),
        };
        let actions = names.actions().map_err(names_of)?;
        let preprocessing = match form {
            SlowOnlyForm::PyTorchVideo => Preprocessing::PYTORCHVIDEO,
            _ => Preprocessing::MMACTION2,
        };
        let size = [length, preprocessing.crop, preprocessing.crop];
        let options = Options { threads, ..Options::default() };
        let of_network = |error| of_weights(weights, Accepted::SlowOnlys, error);
        let network =
            SlowOnly::load(form, open_checkpoint(weights)?, size, options).map_err(of_network)?;
        let (features, classes) = (network.features(), network.classes());
        let read_head = |file: &Path| {
            let classes = names.names().to_vec();
            let head = LinearHead::read(&mut open_checkpoint(file)?, "fc", classes);
            let head = head.map_err(|error| in_file(file, error))?;
            let taken = head.weights().ncols();
            ensure!(
                taken == features,
                "{}: it takes {taken} features, but the network has {features}: give the network that \
                 it was trained with",
                file.display()
            );
            Ok(head)
        };
        let head = settings.head.map(read_head).transpose()?;
        let count = actions.len();
        ensure!(
            head.is_some() || classes == count,
            "{}: the network has {classes} classes, and there are {count} names: give those names, or \
             a head",
            weights.display()
        );
        let stream = SlowOnlyStream::new(network, size).map_err(of_network)?;
        let newest = None;
        Ok(Self { stream, preprocessing, head, actions, interval: interval.max(1), newest })
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
    pub fn push(&mut self, frame: u64, image: &Path) -> Result<Option<RecognisedAction>> {
        let missed = self.newest.is_some_and(|newest| frame - newest > GAPS * self.interval);
        if missed {
            self.stream.clear();
        }
        self.newest = Some(frame);
        let image = self.preprocessing.image(read_image(image)?.view())?;
        let Some(scores) = self.stream.push(image.index_axis(Axis(0), 0))? else { return Ok(None) };
        let logits = match &self.head {
            Some(head) => head.scores(scores.features.row(0))?.to_vec(),
            None => scores.logits.row(0).to_vec(),
        };
        let probabilities = softmax(&logits);
        let best =
            probabilities.iter().zip(&self.actions).max_by(|one, other| one.0.total_cmp(other.0));
        let Some((&probability, &action)) = best else { return Ok(None) };
        let confidence = Confidence::new(f64::from(probability).clamp(0.0, 1.0))?;
        Ok(Some(RecognisedAction { action, confidence }))
    }
}

/// So many intervals without a frame make a window one of two scenes.
const GAPS: u64 = 3;
