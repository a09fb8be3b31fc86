//! Weights of a network for images, in a network for clips.

use std::{collections::BTreeMap, fmt};

use crate::engine::Fitted;
use crate::error::Error;
use crate::weights::{Tensor, TensorSource};

use super::architecture::SlowOnlyForm;
use super::kind::NetworkKind;

/// The weights of a ResNet as a [`SlowOnly`](crate::SlowOnly) takes them: every kernel is repeated
/// over the frames that it covers and divided by their number (J. Carreira and A. Zisserman, "Quo
/// vadis, action recognition?", CVPR 2017). The last layer is left out, so the network returns
/// features alone.
///
/// ```
/// use vision_models::{InflatedResNet, ResNet, ResNetDepth, SlowOnlyForm, Tensor, TensorSource, Tensors};
///
/// let mut images = Tensors::new();
/// for (name, shape) in ResNet::parameters(ResNetDepth::Eighteen, 10) {
///     let elements = vec![0.5; shape.iter().product()];
///     images.insert(name, Tensor::new(shape, elements)?)?;
/// }
/// let mut clips = InflatedResNet::new(SlowOnlyForm::MmAction2Depth18, images)?;
/// let kernel = clips.take("backbone.layer4.0.conv1.conv.weight")?;
/// assert_eq!((kernel.shape(), kernel.data()[0]), ([512, 256, 3, 3, 3].as_slice(), 0.5 / 3.0));
/// # Ok::<(), vision_models::Error>(())
/// ```
pub struct InflatedResNet<'a> {
    images: Fitted<'a>,
    /// Tensors of the network for clips: the name of each in the ResNet, and its shape.
    tensors: BTreeMap<String, (String, Vec<usize>)>,
}

/// Number of the last layer's tensors.
const OF_CLASSIFIER: usize = 2;

impl<'a> InflatedResNet<'a> {
    /// Creates the weights for this form of SlowOnly from those of a ResNet of the same depth.
    ///
    /// # Errors
    /// [`Error::Weights`] if they are those of another network.
    pub fn new(form: SlowOnlyForm, images: impl TensorSource + 'a) -> Result<Self, Error> {
        let kind = NetworkKind::ResNet(form.depth().into());
        let fit = kind.fit(&images)?;
        // Both networks list their tensors in the order of their layers, which are the same.
        let of_layers = |kind: NetworkKind| {
            let mut tensors = kind.parameters(1);
            tensors.truncate(tensors.len().saturating_sub(OF_CLASSIFIER));
            tensors
        };
        let pairs = of_layers(NetworkKind::SlowOnly(form)).into_iter().zip(of_layers(kind));
        let tensors = pairs.map(|((clip, shape), (image, _))| (clip, (image, shape))).collect();
        Ok(Self { images: Fitted::new(Box::new(images), fit), tensors })
    }
}

impl fmt::Debug for InflatedResNet<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("InflatedResNet")
            .field("tensors", &self.tensors)
            .finish_non_exhaustive()
    }
}

impl TensorSource for InflatedResNet<'_> {
    fn names(&self) -> Vec<&str> {
        self.tensors.keys().map(String::as_str).collect()
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        self.tensors.get(name).map(|(_, shape)| shape.as_slice())
    }

    fn take(&mut self, name: &str) -> Result<Tensor, Error> {
        let Some((image, shape)) = self.tensors.get(name) else {
            return Err(Error::unknown("tensor", name, "the name of a tensor of the network"));
        };
        let tensor = self.images.take(image)?;
        let (&[.., frames, rows, columns], 4) = (shape.as_slice(), tensor.shape().len()) else {
            return Ok(tensor);
        };
        let share = |value: &f32| value / frames as f32;
        let kernels = tensor.data().chunks_exact((rows * columns).max(1));
        let repeated =
            kernels.flat_map(|kernel| (0..frames).flat_map(move |_| kernel.iter().map(share)));
        Tensor::new(shape.clone(), repeated.collect())
    }
}
