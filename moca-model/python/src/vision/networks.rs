//! Networks that classify images and clips.

use numpy::PyArray2;
use numpy::ndarray::{Array2, Ix3, Ix4, Ix5};
use pyo3::prelude::*;
use vision_models::NetworkKind;

use super::arrays::floats;
use super::weights::{Weights, options};
use crate::failure::Result;
use crate::shared::Shared;

type Matrix<'py> = Bound<'py, PyArray2<f32>>;

/// What a network says of each image or clip of a batch.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct Scores {
    logits: Array2<f32>,
    features: Array2<f32>,
}

impl Scores {
    fn of(scores: &vision_models::Scores<'_>) -> Self {
        Self { logits: scores.logits.to_owned(), features: scores.features.to_owned() }
    }
}

#[pymethods]
impl Scores {
    /// Scores of the classes before any softmax, (N, classes). Empty for weights without a last layer.
    #[getter]
    fn logits<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        PyArray2::from_array(py, &self.logits)
    }

    /// Features that the last layer reads, (N, width).
    #[getter]
    fn features<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        PyArray2::from_array(py, &self.features)
    }

    /// Softmax of the scores, (N, classes).
    #[getter]
    fn probabilities<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        let mut all = self.logits.clone();
        for mut row in all.rows_mut() {
            let shares = vision_models::softmax(&row.to_vec());
            row.iter_mut().zip(shares).for_each(|(to, share)| *to = share);
        }
        PyArray2::from_owned_array(py, all)
    }

    fn __repr__(&self) -> String {
        let (count, classes) = self.logits.dim();
        format!("<ahqp.vision.Scores: {count} × {classes} classes>")
    }
}

/// A residual network for images: ResNet, ResNeXt or Wide ResNet, as torchvision has them.
///
/// `ResNet(weights, *, height=224, width=224, threads=1)`
///
/// Parameters
/// ----------
/// weights : path or dict of str to array_like
///     A file of `torch.save` or a `.safetensors`, or a state dict. Names and shapes say which network it is.
/// height, width : int
///     The size of images that is planned [pixels]. Other sizes run too, but slower.
/// threads : int
///     Threads that share the work. Results are the same for any number.
///
/// Nothing in a file is executed. Inference releases the interpreter's lock.
///
/// >>> from ahqp.vision import ResNet
/// >>> ResNet({"fc.bias": [0.5]})
/// Traceback (most recent call last):
///     ...
/// ahqp.Error: weights: no network that is known has these tensors; give those of a ResNet
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct ResNet(Shared<vision_models::ResNet>);

#[pymethods]
impl ResNet {
    #[new]
    #[pyo3(signature = (weights, *, height=224, width=224, threads=1))]
    fn new(
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        height: usize,
        width: usize,
        threads: usize,
    ) -> Result<Self> {
        let weights = Weights::read(weights)?;
        let form = weights.kind("a ResNet", |kind| match kind {
            NetworkKind::ResNet(form) => Some(form),
            _ => None,
        })?;
        let network = py.detach(|| {
            vision_models::ResNet::load(form, weights, [height, width], options(threads))
        })?;
        Ok(Self(Shared::new("ResNet", network)))
    }

    /// Scores of normalised images, (N, 3, height, width), as `Preprocessing.image` gives them.
    fn infer(&self, py: Python<'_>, images: &Bound<'_, PyAny>) -> Result<Scores> {
        let images = floats::<Ix4>("images", images, "(N, 3, height, width)")?;
        let mut network = self.0.lock()?;
        let network = &mut *network;
        Ok(py.detach(|| network.infer(images.view()).map(|scores| Scores::of(&scores)))?)
    }

    /// The number of classes, 0 for weights without a last layer.
    #[getter]
    fn classes(&self) -> Result<usize> {
        Ok(self.0.lock()?.classes())
    }

    /// Multiplications and additions for one image of the planned size.
    #[getter]
    fn operations(&self) -> Result<u64> {
        Ok(self.0.lock()?.operations())
    }
}

/// Reads the weights of SlowOnly.
fn slow_only(
    py: Python<'_>,
    weights: &Bound<'_, PyAny>,
    size: [usize; 3],
    threads: usize,
) -> Result<vision_models::SlowOnly> {
    let weights = Weights::read(weights)?;
    let form = weights.kind("SlowOnly", |kind| match kind {
        NetworkKind::SlowOnly(form) => Some(form),
        _ => None,
    })?;
    Ok(py.detach(|| vision_models::SlowOnly::load(form, weights, size, options(threads)))?)
}

/// SlowOnly, which says what a person does in a clip: mmaction2's or PyTorchVideo's.
///
/// `SlowOnly(weights, *, frames=8, height=256, width=256, threads=1)`
///
/// Parameters
/// ----------
/// weights : path or dict of str to array_like
///     A file of `torch.save` or a `.safetensors`, or a state dict. Names and shapes say which network it is.
/// frames, height, width : int
///     The size of clips that is planned [frames, pixels]. Other sizes run too, but slower.
/// threads : int
///     Threads that share the work.
///
/// `SlowOnlyStream` gives a camera's frames the same scores in less time.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct SlowOnly(Shared<vision_models::SlowOnly>);

#[pymethods]
impl SlowOnly {
    #[new]
    #[pyo3(signature = (weights, *, frames=8, height=256, width=256, threads=1))]
    fn new(
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        frames: usize,
        height: usize,
        width: usize,
        threads: usize,
    ) -> Result<Self> {
        let network = slow_only(py, weights, [frames, height, width], threads)?;
        Ok(Self(Shared::new("SlowOnly", network)))
    }

    /// Scores of normalised clips, (N, 3, frames, height, width), as `Preprocessing.clip` gives them.
    fn infer(&self, py: Python<'_>, clips: &Bound<'_, PyAny>) -> Result<Scores> {
        let clips = floats::<Ix5>("clips", clips, "(N, 3, frames, height, width)")?;
        let mut network = self.0.lock()?;
        let network = &mut *network;
        Ok(py.detach(|| network.infer(clips.view()).map(|scores| Scores::of(&scores)))?)
    }

    /// The number of classes, 0 for weights without a last layer.
    #[getter]
    fn classes(&self) -> Result<usize> {
        Ok(self.0.lock()?.classes())
    }

    /// Multiplications and additions for one clip of the planned size.
    #[getter]
    fn operations(&self) -> Result<u64> {
        Ok(self.0.lock()?.operations())
    }
}

/// SlowOnly over the last frames of a camera. What it has computed of a frame is used again.
///
/// `SlowOnlyStream(weights, *, frames=8, height=256, width=256, threads=1)`
///
/// Parameters
/// ----------
/// weights : path or dict of str to array_like
///     As those of `SlowOnly`.
/// frames, height, width : int
///     Length of the window, and size of the frames [frames, pixels].
/// threads : int
///     Threads that share the work.
#[pyclass(frozen, module = "ahqp.vision")]
pub(crate) struct SlowOnlyStream(Shared<vision_models::SlowOnlyStream>);

#[pymethods]
impl SlowOnlyStream {
    #[new]
    #[pyo3(signature = (weights, *, frames=8, height=256, width=256, threads=1))]
    fn new(
        py: Python<'_>,
        weights: &Bound<'_, PyAny>,
        frames: usize,
        height: usize,
        width: usize,
        threads: usize,
    ) -> Result<Self> {
        let size = [frames, height, width];
        let network = slow_only(py, weights, size, threads)?;
        let stream = py.detach(|| vision_models::SlowOnlyStream::new(network, size))?;
        Ok(Self(Shared::new("SlowOnlyStream", stream)))
    }

    /// Adds the next normalised frame, (3, height, width). Returns the scores of the window, None until it is full.
    fn push(&self, py: Python<'_>, frame: &Bound<'_, PyAny>) -> Result<Option<Scores>> {
        let frame = floats::<Ix3>("frame", frame, "(3, height, width)")?;
        let mut stream = self.0.lock()?;
        let stream = &mut *stream;
        let push = || stream.push(frame.view()).map(|full| full.map(|scores| Scores::of(&scores)));
        Ok(py.detach(push)?)
    }

    /// Adds a frame without scoring the window, for frames that come faster than scores are needed.
    fn add(&self, py: Python<'_>, frame: &Bound<'_, PyAny>) -> Result<()> {
        let frame = floats::<Ix3>("frame", frame, "(3, height, width)")?;
        let mut stream = self.0.lock()?;
        let stream = &mut *stream;
        Ok(py.detach(|| stream.add(frame.view()))?)
    }

    /// Forgets all frames, to begin another recording.
    fn clear(&self) -> Result<()> {
        self.0.lock()?.clear();
        Ok(())
    }
}
