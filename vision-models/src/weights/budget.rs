//! The memory budget of a checkpoint file.

use super::error::beyond;
use super::shape::elements;
use crate::error::Error;
use crate::weights::tensors::Tensor;

/// Memory that remains for opening and reading a file: a multiple of its size, and a constant.
/// Memory whose size depends on the file is charged before it is allocated, and never returned. The
/// sum therefore bounds the peak.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: u64,
    taken: u64,
}

impl Budget {
    /// Bytes in addition to four times the file's size: enough for the names of any small
    /// checkpoint.
    pub(super) const BESIDE: u64 = 16 << 20;
    /// Bytes of the readers' own buffers.
    const BUFFERS: u64 = 1 << 20;

    /// Bytes in addition to a multiple of the size of a graph's file: enough for any small network.
    const GRAPH: u64 = 256 << 10;
    /// Multiple of the file's size for the weights, which sparse float16 needs to become dense float32:
    /// MediaPipe's detector of people 5.4 times its size.
    const DENSE: u64 = 6;

    /// Creates the budget for a file of `length` bytes.
    pub(crate) fn of_file(length: u64) -> Self {
        let limit = length.saturating_mul(4).saturating_add(Self::BESIDE);
        Self { limit, taken: Self::BUFFERS }
    }

    /// Creates the budget for reading the graph of a file of `length` bytes in memory.
    pub(crate) fn of_graph(length: u64) -> Self {
        Self { limit: length.saturating_mul(4).saturating_add(Self::GRAPH), taken: 0 }
    }

    /// Creates the budget for the weights of such a graph, which are read after it.
    pub(crate) fn of_weights(length: u64) -> Self {
        Self { limit: length.saturating_mul(Self::DENSE).saturating_add(Self::GRAPH), taken: 0 }
    }

    /// Charges `bytes`.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the budget is exceeded.
    pub(crate) fn take(&mut self, bytes: usize) -> Result<(), Error> {
        self.taken = self.taken.saturating_add(bytes as u64);
        if self.taken <= self.limit {
            return Ok(());
        }
        Err(beyond("bytes of memory for the file", self.taken, self.limit))
    }

    /// Charges an entry of a `BTreeMap`, whose nodes may be half empty.
    pub(super) fn take_entry<K, V>(&mut self, heap: usize) -> Result<(), Error> {
        self.take(heap.saturating_add(2 * (size_of::<K>() + size_of::<V>())))
    }

    /// Charges a tensor that will be read as f32.
    pub(super) fn take_tensor(&mut self, name: &str, shape: &[usize]) -> Result<(), Error> {
        let values = elements(shape).unwrap_or(usize::MAX).saturating_mul(size_of::<f32>());
        let heap = values.saturating_add(name.len() + size_of_val(shape));
        self.take_entry::<String, Tensor>(heap)
    }

    /// Appends to a list. A full list doubles, and is then in memory twice.
    pub(super) fn push<T>(&mut self, list: &mut Vec<T>, item: T) -> Result<(), Error> {
        if list.len() == list.capacity() {
            self.take(size_of::<T>() * (2 * list.capacity()).max(4))?;
        }
        list.push(item);
        Ok(())
    }
}
