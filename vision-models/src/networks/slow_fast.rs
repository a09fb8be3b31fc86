//! SlowFast: scores of clips by a slow path that sees few frames, and a thin fast one that sees them all.

use ndarray::ArrayView5;

use crate::engine::{Network, Options, Scores, Threads};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::SlowFastForm;
use super::kind::NetworkKind;

/// SlowFast: class scores of a clip. C. Feichtenhofer, H. Fan, J. Malik and K. He, "SlowFast networks for
/// video recognition", ICCV 2019, Table 1.
#[derive(Debug)]
pub struct SlowFast {
    network: Network,
    form: SlowFastForm,
}

impl SlowFast {
    /// The names and shapes of the tensors that a checkpoint with this many classes must hold.
    pub fn parameters(form: SlowFastForm, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::SlowFast(form).parameters(classes)
    }

    /// Takes the weights of a checkpoint and packs them for clips of `frames` × `height` × `width` (other
    /// sizes run too, less fast). PyTorchVideo's have 32 frames, mmaction2's a multiple of four or eight.
    ///
    /// # Errors
    /// [`Error::Weights`] with every tensor that is missing, surplus or misshapen; [`Error::Value`]
    /// for one that is not finite and for negative variances, [`Error::Overflow`];
    /// [`Error::Size`] for frames that the two paths cannot share, and for clips that do not fit the kernels or the
    /// head's windows; [`Error::Threads`] for a number of threads that cannot be started.
    pub fn load(
        form: SlowFastForm,
        tensors: impl TensorSource,
        size: [usize; 3],
        options: Options,
    ) -> Result<Self, Error> {
        form.check_frames(size[0])?;
        let network = NetworkKind::SlowFast(form).load(Box::new(tensors), size, options)?;
        Ok(Self { network, form })
    }

    /// Plans for clips of another size and keeps the plan.
    ///
    /// # Errors
    /// [`Error::Size`], and as of [`Network::plan`].
    pub fn plan(&mut self, size: [usize; 3]) -> Result<(), Error> {
        self.form.check_frames(size[0])?;
        self.network.plan(size)
    }

    /// Runs on other threads from now on, which networks may share.
    ///
    /// # Errors
    /// As of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.network.share_threads(threads)
    }

    /// The scores of normalised clips, N × 3 × frames × height × width.
    ///
    /// # Errors
    /// [`Error::Size`] if there are not three channels or no clips, for frames that the two paths cannot share, and
    /// for a size that does not fit the kernels or the head's windows; [`Error::Value`] if a value is
    /// NaN or infinite, [`Error::Overflow`] if activations are.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        self.form.check_frames(clips.dim().2)?;
        Ok(self.network.infer(clips)?.scores())
    }

    /// Multiplications and additions for one clip of the size that the network was loaded for.
    pub fn operations(&self) -> u64 {
        self.network.operations()
    }

    /// How many classes there are: the width of the logits. 0 for a checkpoint without a head.
    pub fn classes(&self) -> usize {
        self.network.classes()
    }

    /// How many features the last layer sees: the width of the features.
    pub fn features(&self) -> usize {
        self.network.features()
    }
}
