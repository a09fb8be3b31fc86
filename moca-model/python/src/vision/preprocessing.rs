//! Conversion of camera frames to the input of networks.

use numpy::{PyArray4, PyArray5};
use pyo3::prelude::*;
use vision_models::{Crops, Library, Resize};

use super::arrays::image;
use crate::ergo::keywords::word;
use crate::failure::{Failure, Result};

/// Resizing, cropping and normalising of frames, as a network's training did it.
///
/// `Preprocessing(library="torchvision", *, short_side=None, square=None, crop=224, crops="centre")`
///
/// Parameters
/// ----------
/// library : str
///     The library whose arithmetic is used: "torchvision", "mmaction2" or "pytorchvideo".
/// short_side, square : int, optional
///     Length of the short side after resizing, or that of both sides [pixels]. Exactly one is given.
/// crop : int
///     Side of the crop [pixels].
/// crops : str
///     "centre"; "three" along the long side; "ten", at the corners and in the middle, each mirrored too.
///
/// Ready ones are `Preprocessing.TORCHVISION` (255, 224), `SURFACE` (255 × 255, 224), `MMACTION2` and `PYTORCHVIDEO` (256,
/// 256). Frames are arrays of uint8, (height, width, 3): red, green, blue. OpenCV has blue first.
///
/// >>> import numpy as np
/// >>> from ahqp.vision import Preprocessing
/// >>> Preprocessing.TORCHVISION.image(np.zeros((480, 640, 3), np.uint8)).shape
/// (1, 3, 224, 224)
#[pyclass(frozen, eq, module = "ahqp.vision")]
#[derive(PartialEq)]
pub(crate) struct Preprocessing(vision_models::Preprocessing);

const LIBRARIES: [(&str, Library); 3] = [
    ("torchvision", Library::Torchvision),
    ("mmaction2", Library::Mmaction2),
    ("pytorchvideo", Library::PyTorchVideo),
];
const CROPS: [(&str, Crops); 3] =
    [("centre", Crops::Centre), ("three", Crops::Three), ("ten", Crops::Ten)];

#[pymethods]
impl Preprocessing {
    #[new]
    #[pyo3(signature = (library="torchvision", *, short_side=None, square=None, crop=224, crops="centre"))]
    fn new(
        library: &str,
        short_side: Option<usize>,
        square: Option<usize>,
        crop: usize,
        crops: &str,
    ) -> Result<Self> {
        let resize = match (short_side, square) {
            (Some(side), None) => Resize::ShortSide(side),
            (None, Some(side)) => Resize::Square(side),
            _ => return Err(Failure::value("give one of short_side and square [pixels]")),
        };
        let library = word("library", library, &LIBRARIES)?;
        let crops = word("crops", crops, &CROPS)?;
        Ok(Self(vision_models::Preprocessing { library, resize, crop, crops }))
    }

    /// ImageNet's, with the paper's short side of 255.
    #[classattr]
    #[pyo3(name = "TORCHVISION")]
    fn torchvision() -> Self {
        Self(vision_models::Preprocessing::TORCHVISION)
    }

    /// Surfaces, as the paper takes them.
    #[classattr]
    #[pyo3(name = "SURFACE")]
    fn surface() -> Self {
        Self(vision_models::Preprocessing::SURFACE)
    }

    /// SlowOnly of mmaction2.
    #[classattr]
    #[pyo3(name = "MMACTION2")]
    fn mmaction2() -> Self {
        Self(vision_models::Preprocessing::MMACTION2)
    }

    /// SlowOnly of PyTorchVideo.
    #[classattr]
    #[pyo3(name = "PYTORCHVIDEO")]
    fn pytorchvideo() -> Self {
        Self(vision_models::Preprocessing::PYTORCHVIDEO)
    }

    /// Crops of a frame: (height, width, 3) gives (crops, 3, side, side), float32.
    fn image<'py>(
        &self,
        py: Python<'py>,
        frame: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray4<f32>>> {
        let frame = image("frame", frame)?;
        let images = py.detach(|| self.0.image(frame.view()))?;
        Ok(PyArray4::from_owned_array(py, images))
    }

    /// Crops of the frames of a clip: (frames, height, width, 3), or a sequence of frames, gives (crops, 3, frames, side,
    /// side), float32.
    fn clip<'py>(
        &self,
        py: Python<'py>,
        frames: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray5<f32>>> {
        let frames = frames.try_iter()?.map(|frame| image("a frame", &frame?));
        let frames = frames.collect::<Result<Vec<_>>>()?;
        let views: Vec<_> = frames.iter().map(|frame| frame.view()).collect();
        let clips = py.detach(|| self.0.clip(&views))?;
        Ok(PyArray5::from_owned_array(py, clips))
    }

    fn __repr__(&self) -> String {
        let vision_models::Preprocessing { library, resize, crop, crops } = self.0;
        let library = LIBRARIES.iter().find(|(_, known)| *known == library);
        let crops = CROPS.iter().find(|(_, known)| *known == crops);
        let (name, side) = match resize {
            Resize::ShortSide(side) => ("short_side", side),
            Resize::Square(side) => ("square", side),
        };
        let [library, crops] =
            [library.map_or("", |known| known.0), crops.map_or("", |known| known.0)];
        format!("Preprocessing(\"{library}\", {name}={side}, crop={crop}, crops=\"{crops}\")")
    }
}
