//! SlowFast: scores of clips by a slow path that sees few frames, and a thin fast path that sees
//! all of them.

use ndarray::ArrayView5;

use crate::engine::{Network, Options, Scores, Threads};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::SlowFastForm;
use super::kind::NetworkKind;

/// SlowFast, which returns class scores of a clip. C. Feichtenhofer, H. Fan, J. Malik and K. He,
/// "SlowFast networks for video recognition", ICCV 2019, Table 1.
#[derive(Debug)]
pub struct SlowFast {
    network: Network,
    form: SlowFastForm,
}

impl SlowFast {
    /// Returns the names and shapes of the tensors that a checkpoint with this many classes must
    /// hold.
    pub fn parameters(form: SlowFastForm, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::SlowFast(form).parameters(classes)
    }

    /// Loads a checkpoint and packs its weights for clips of `frames` × `height` × `width`. Other
    /// sizes run too, but slower. Clips for PyTorchVideo's network have 32 frames, those for
    /// mmaction2's a multiple of four or eight.
    ///
    /// # Errors
    /// - [`Error::Weights`] with every tensor that is missing, surplus or of the wrong shape.
    /// - [`Error::Value`] if a weight is not finite or a variance is negative.
    /// - [`Error::Overflow`] if a weight is too large for f32.
    /// - [`Error::Size`] if the two paths cannot share the frames, or clips do not fit the kernels
    ///   or the head's windows.
    /// - [`Error::Threads`] if this number of threads cannot be started.
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

    /// Plans the pass for clips of another size and keeps the plan.
    ///
    /// # Errors
    /// [`Error::Size`] if the two paths cannot share the frames, and those of [`Network::plan`].
    pub fn plan(&mut self, size: [usize; 3]) -> Result<(), Error> {
        self.form.check_frames(size[0])?;
        self.network.plan(size)
    }

    /// Makes the network run on other threads, which networks may share.
    ///
    /// # Errors
    /// Those of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.network.share_threads(threads)
    }

    /// Returns the scores of normalised clips, N × 3 × frames × height × width.
    ///
    /// # Errors
    /// - [`Error::Size`] if there are not three channels, there are no clips, or the two paths
    ///   cannot share the frames.
    /// - [`Error::Size`] if the clips do not fit the kernels or the head's windows.
    /// - [`Error::Value`] if a value is NaN or infinite.
    /// - [`Error::Overflow`] if an output is NaN or infinite.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        self.form.check_frames(clips.dim().2)?;
        Ok(self.network.infer(clips)?.scores())
    }

    /// Returns the number of multiplications and additions for one clip of the size given at
    /// loading.
    pub fn operations(&self) -> u64 {
        self.network.operations()
    }

    /// Returns the number of classes, which is the width of the logits. 0 for a checkpoint without
    /// a head.
    pub fn classes(&self) -> usize {
        self.network.classes()
    }

    /// Returns the width of the features, which the last layer reads.
    pub fn features(&self) -> usize {
        self.network.features()
    }
}
