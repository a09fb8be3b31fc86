//! Networks on arrays of normalised images or clips.

use std::path::Path;

use ndarray::{Array, Array4, Array5, ArrayD, ArrayViewD, Axis, Dimension};
use vision_models::{
    NetworkKind, Options, Passes, ResNet, Scores, SimpleBaseline, SlowFast, SlowOnly,
    TensorFlowLite, engine::Network,
};

use super::checkpoint::open_weights;
use crate::{error::Error, npy::read_array, watch::Watch};

/// A loaded network with its input: N × 3 × H × W for images, N × 3 × T × H × W for clips.
#[derive(Debug)]
pub enum ArrayNetwork {
    /// A network for classes of images.
    Images(ResNet, Array4<f32>),
    /// A network for classes of clips.
    Clips(SlowOnly, Array5<f32>),
    /// A network for classes of clips, at two speeds.
    TwoSpeeds(SlowFast, Array5<f32>),
    /// A network for maps of joints in images.
    Joints(Box<SimpleBaseline>, Array4<f32>),
    /// Any network on images, with one output.
    Any(Box<Network>, Array4<f32>),
}

impl ArrayNetwork {
    /// Reads the array from a `.npy` file, and loads the network for its size.
    ///
    /// # Errors
    /// Names the file that cannot be used, or reports an array with another number of axes than the
    /// network's input.
    pub fn load(
        kind: NetworkKind,
        weights: &Path,
        input: &Path,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let options = Options { threads, ..Options::default() };
        let array = read_array(input)?;
        let tensors = open_weights(weights, watch)?;
        let refuse = Error::weights(weights);
        let images = |array| of_dimension(array, input, "images are N × 3 × H × W");
        if let NetworkKind::ResNet(form) = kind {
            let images: Array4<f32> = images(array)?;
            let (_, _, height, width) = images.dim();
            let network = ResNet::load(form, tensors, [height, width], options);
            return Ok(Self::Images(network.map_err(refuse)?, images));
        }
        if let NetworkKind::SimpleBaseline(_) = kind {
            let images: Array4<f32> = images(array)?;
            let network = SimpleBaseline::load(tensors, Passes::One, options);
            return Ok(Self::Joints(Box::new(network.map_err(refuse)?), images));
        }
        let clips: Array5<f32> = of_dimension(array, input, "clips are N × 3 × T × H × W")?;
        let (_, _, frames, height, width) = clips.dim();
        let size = [frames, height, width];
        match kind {
            NetworkKind::SlowOnly(form) => {
                let network = SlowOnly::load(form, tensors, size, options);
                Ok(Self::Clips(network.map_err(refuse)?, clips))
            }
            NetworkKind::SlowFast(form) => {
                let network = SlowFast::load(form, tensors, size, options);
                Ok(Self::TwoSpeeds(network.map_err(refuse)?, clips))
            }
            _ => Err(Error::at(weights.display(), format!("{kind} does not run on one array"))),
        }
    }

    /// Reads the array from a `.npy` file and loads a network of TensorFlow Lite. If `output` is
    /// missing, the whole network is computed and its first output is returned. Otherwise only the
    /// layers for this output are computed.
    ///
    /// # Errors
    /// Names the file that cannot be used.
    pub fn load_file(
        weights: &Path,
        output: Option<usize>,
        input: &Path,
        threads: usize,
    ) -> Result<Self, Error> {
        let options = Options { threads, ..Options::default() };
        let images: Array4<f32> =
            of_dimension(read_array(input)?, input, "images are N × 3 × H × W")?;
        let of_file = Error::content(weights);
        let network = TensorFlowLite::open(weights).map_err(&of_file)?;
        let wanted = network.input();
        if images.shape().get(1..) != Some(&wanted) {
            let found = format!("{:?} values, but the network takes {wanted:?}", images.shape());
            return Err(Error::at(input.display(), found));
        }
        let network = match output {
            Some(output) => network.keep(&[output]).map_err(&of_file)?,
            None => network,
        };
        let network = network.load(options).map_err(&of_file)?;
        Ok(Self::Any(Box::new(network), images))
    }

    /// Runs the network. Returns logits, features of the average pool, or maps.
    ///
    /// # Errors
    /// [`Error::Vision`] for errors of the network.
    pub fn run(&mut self, features: bool) -> Result<ArrayViewD<'_, f32>, Error> {
        let Scores { logits, features: pooled } = match self {
            Self::Images(network, images) => network.infer(images.view())?,
            Self::Clips(network, clips) => network.infer(clips.view())?,
            Self::TwoSpeeds(network, clips) => network.infer(clips.view())?,
            Self::Joints(network, images) => {
                return Ok(network.heatmaps(images.view())?.into_dyn());
            }
            Self::Any(network, images) => {
                let inference = network.infer(images.view().insert_axis(Axis(2)))?;
                let map = inference.map(0).map(|map| map.index_axis_move(Axis(2), 0));
                let none = || Error::at("network", "it has no output");
                return Ok(map.ok_or_else(none)?.into_dyn());
            }
        };
        Ok(if features { pooled } else { logits }.into_dyn())
    }

    /// Returns the number of multiplications and additions for the whole batch.
    pub fn operations(&self) -> f64 {
        let (batch, operations) = match self {
            Self::Images(network, images) => (images.dim().0, network.operations()),
            Self::Clips(network, clips) => (clips.dim().0, network.operations()),
            Self::TwoSpeeds(network, clips) => (clips.dim().0, network.operations()),
            Self::Joints(network, images) => (images.dim().0, network.operations()),
            Self::Any(network, images) => (images.dim().0, network.operations()),
        };
        batch as f64 * operations as f64
    }
}

/// Converts the input to the number of axes of the network's input.
fn of_dimension<D: Dimension>(
    array: ArrayD<f32>,
    input: &Path,
    expected: &str,
) -> Result<Array<f32, D>, Error> {
    let found = format!("an array of shape {:?}, but {expected}", array.shape());
    array.into_dimensionality().map_err(|_| Error::at(input.display(), found))
}
