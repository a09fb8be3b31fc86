//! SlowOnly: scores of clips by the slow path of SlowFast alone.

use ndarray::ArrayView5;

use crate::engine::{Network, Options, Scores, Threads};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::SlowOnlyForm;
use super::kind::NetworkKind;

/// SlowOnly: class scores of a clip. C. Feichtenhofer, H. Fan, J. Malik and K. He, "SlowFast
/// networks for video recognition", ICCV 2019, Table 1, the slow pathway.
#[derive(Debug)]
pub struct SlowOnly(pub(super) Network);

impl SlowOnly {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(form: SlowOnlyForm, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::SlowOnly(form).parameters(classes)
    }

    /// Takes the weights of a checkpoint and packs them for clips of `frames` × `height` × `width`
    /// (other sizes run too, less fast). The checkpoint says how many classes there are; one without a head
    /// gives features alone.
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Value`] for one
    /// that is not finite and for negative variances, [`Error::Overflow`]; [`Error::Size`] for clips that do
    /// not fit the kernels or the head's windows; [`Error::Threads`] for a number of threads that cannot be
    /// started.
    pub fn load(
        form: SlowOnlyForm,
        tensors: impl TensorSource,
        size: [usize; 3],
        options: Options,
    ) -> Result<Self, Error> {
        NetworkKind::SlowOnly(form).load(Box::new(tensors), size, options).map(Self)
    }

    /// Plans for clips of another size and keeps the plan.
    ///
    /// # Errors
    /// As of [`Network::plan`].
    pub fn plan(&mut self, size: [usize; 3]) -> Result<(), Error> {
        self.0.plan(size)
    }

    /// Runs on other threads from now on, which networks may share.
    ///
    /// # Errors
    /// As of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.0.share_threads(threads)
    }

    /// The scores of normalised clips, N × 3 × frames × height × width.
    ///
    /// # Errors
    /// [`Error::Size`] if there are not three channels or no clips, and for a size that does not fit the kernels or
    /// the head's windows; [`Error::Value`] if a value is NaN or
    /// infinite, [`Error::Overflow`] if activations are.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        Ok(self.0.infer(clips)?.scores())
    }

    /// Multiplications and additions for one clip of the size that the network was loaded for.
    pub fn operations(&self) -> u64 {
        self.0.operations()
    }

    /// How many classes there are: the width of the logits. 0 for a checkpoint without a head.
    pub fn classes(&self) -> usize {
        self.0.classes()
    }

    /// How many features the last layer sees: the width of the features.
    pub fn features(&self) -> usize {
        self.0.features()
    }
}
