//! SlowOnly: scores of clips by the slow path of SlowFast alone.

use ndarray::ArrayView5;

use crate::engine::{Network, Options, Scores, Threads};
use crate::error::Error;
use crate::weights::TensorSource;

use super::architecture::SlowOnlyForm;
use super::kind::NetworkKind;

/// SlowOnly, which returns class scores of a clip. C. Feichtenhofer, H. Fan, J. Malik and K. He,
/// "SlowFast networks for video recognition", ICCV 2019, Table 1, the slow pathway.
#[derive(Debug)]
pub struct SlowOnly(pub(super) Network);

impl SlowOnly {
    /// Returns the names and shapes of the tensors that a checkpoint with this many classes must
    /// hold.
    pub fn parameters(form: SlowOnlyForm, classes: usize) -> Vec<(String, Vec<usize>)> {
        NetworkKind::SlowOnly(form).parameters(classes)
    }

    /// Loads a checkpoint and packs its weights for clips of `frames` × `height` × `width`. Other
    /// sizes run too, but slower. The checkpoint determines the number of classes. If it has no
    /// head, the network returns features only.
    ///
    /// # Errors
    /// - [`Error::Weights`] with every tensor that is missing, surplus or of the wrong shape.
    /// - [`Error::Value`] if a weight is not finite or a variance is negative.
    /// - [`Error::Overflow`] if a weight is too large for f32.
    /// - [`Error::Size`] if clips do not fit the kernels or the head's windows.
    /// - [`Error::Threads`] if this number of threads cannot be started.
    pub fn load(
        form: SlowOnlyForm,
        tensors: impl TensorSource,
        size: [usize; 3],
        options: Options,
    ) -> Result<Self, Error> {
        NetworkKind::SlowOnly(form).load(Box::new(tensors), size, options).map(Self)
    }

    /// Plans the pass for clips of another size and keeps the plan.
    ///
    /// # Errors
    /// Those of [`Network::plan`].
    pub fn plan(&mut self, size: [usize; 3]) -> Result<(), Error> {
        self.0.plan(size)
    }

    /// Makes the network run on other threads, which networks may share.
    ///
    /// # Errors
    /// Those of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.0.share_threads(threads)
    }

    /// Returns the scores of normalised clips, N × 3 × frames × height × width.
    ///
    /// # Errors
    /// - [`Error::Size`] if there are not three channels, there are no clips, or the size does not
    ///   fit the kernels or the head's windows.
    /// - [`Error::Value`] if a value is NaN or infinite.
    /// - [`Error::Overflow`] if an output is NaN or infinite.
    pub fn infer(&mut self, clips: ArrayView5<'_, f32>) -> Result<Scores<'_>, Error> {
        Ok(self.0.infer(clips)?.scores())
    }

    /// Returns the number of multiplications and additions for one clip of the size given at
    /// loading.
    pub fn operations(&self) -> u64 {
        self.0.operations()
    }

    /// Returns the number of classes, which is the width of the logits. 0 for a checkpoint without
    /// a head.
    pub fn classes(&self) -> usize {
        self.0.classes()
    }

    /// Returns the width of the features, which the last layer reads.
    pub fn features(&self) -> usize {
        self.0.features()
    }
}
