//! The memory that a checkpoint file may take.

use super::error::beyond;
use super::shape::elements;
use crate::error::Error;
use crate::weights::tensors::Tensor;

/// What remains of the memory that opening and reading a file may take: four times its size and
/// [`Budget::BESIDE`]. Whatever is kept because of something in the file is taken off before it is
/// allocated and never given back, so that the sum bounds the peak.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: u64,
    taken: u64,
}

impl Budget {
    /// Bytes beside four times the file's size: enough for the names of any small checkpoint.
    pub(super) const BESIDE: u64 = 16 << 20;
    /// Bytes of the readers' own buffers.
    const BUFFERS: u64 = 1 << 20;

    /// For a file of `length` bytes.
    pub(crate) fn of_file(length: u64) -> Self {
        let limit = length.saturating_mul(4).saturating_add(Self::BESIDE);
        Self { limit, taken: Self::BUFFERS }
    }

    /// Takes `bytes` off.
    ///
    /// # Errors
    /// [`Error::Checkpoint`].
    pub(crate) fn take(&mut self, bytes: usize) -> Result<(), Error> {
        self.taken = self.taken.saturating_add(bytes as u64);
        if self.taken <= self.limit {
            return Ok(());
        }
        Err(beyond("bytes of memory for the file", self.taken, self.limit))
    }

    /// Takes an entry of a `BTreeMap` off: its nodes may be half empty.
    pub(super) fn take_entry<K, V>(&mut self, heap: usize) -> Result<(), Error> {
        self.take(heap.saturating_add(2 * (size_of::<K>() + size_of::<V>())))
    }

    /// Takes a tensor off that will be read as f32.
    pub(super) fn take_tensor(&mut self, name: &str, shape: &[usize]) -> Result<(), Error> {
        let values = elements(shape).unwrap_or(usize::MAX).saturating_mul(size_of::<f32>());
        let heap = values.saturating_add(name.len() + size_of_val(shape));
        self.take_entry::<String, Tensor>(heap)
    }

    /// Appends to a list that doubles when it is full, and is in memory twice meanwhile.
    pub(super) fn push<T>(&mut self, list: &mut Vec<T>, item: T) -> Result<(), Error> {
        if list.len() == list.capacity() {
            self.take(size_of::<T>() * (2 * list.capacity()).max(4))?;
        }
        list.push(item);
        Ok(())
    }
}
