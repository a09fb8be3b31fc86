//! Where a tensor's elements lie in its file.

use std::io::{Read, Seek, SeekFrom};

use super::error::of_tensor;
use super::input::reading;
use super::shape::elements;
use crate::error::Error;
use crate::weights::element::ElementType;

/// Bytes that are read at a time: they stay in the cache until they are decoded.
const CHUNK: usize = 128 << 10;

/// A tensor in a checkpoint, not yet read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TensorInfo {
    element: ElementType,
    shape: Vec<usize>,
    /// The step along each axis (elements).
    strides: Vec<usize>,
    /// Where the first element is in the file (bytes).
    position: u64,
    /// From the first element to the last, both included (elements).
    span: usize,
    /// The CRC-32 of the storage, if the tensor is all of it.
    checksum: Option<u32>,
}

/// A storage in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    /// Where it starts (bytes).
    pub(super) position: u64,
    /// How large it is (elements).
    pub(super) elements: usize,
    pub(super) checksum: Option<u32>,
}

impl TensorInfo {
    /// A tensor in a storage; `None` if it reaches beyond it.
    pub(super) fn new(
        element: ElementType,
        shape: Vec<usize>,
        strides: Vec<usize>,
        offset: usize,
        region: Region,
    ) -> Option<Self> {
        let size = elements(&shape)?;
        let last = shape.iter().zip(&strides).try_fold(0_usize, |last, (&axis, &stride)| {
            last.checked_add(axis.saturating_sub(1).checked_mul(stride)?)
        })?;
        let span = if size == 0 { 0 } else { last.checked_add(1)? };
        if offset.checked_add(span)? > region.elements {
            return None;
        }
        let start = offset.checked_mul(element.size())?;
        let position = region.position.checked_add(u64::try_from(start).ok()?)?;
        let mut info = Self { element, shape, strides, position, span, checksum: None };
        if info.is_contiguous() && span == region.elements {
            info.checksum = region.checksum;
        }
        Some(info)
    }

    /// A tensor that fills its place, in C order.
    pub(super) fn contiguous(
        element: ElementType,
        shape: Vec<usize>,
        position: u64,
    ) -> Option<Self> {
        let size = elements(&shape)?;
        let mut strides = vec![0; shape.len()];
        let mut step = 1;
        for (stride, &axis) in strides.iter_mut().zip(&shape).rev() {
            *stride = step;
            step *= axis.max(1);
        }
        let region = Region { position, elements: size, checksum: None };
        Self::new(element, shape, strides, 0, region)
    }

    /// The type of the elements in the file.
    pub fn element(&self) -> ElementType {
        self.element
    }

    /// The length of each axis; empty for a scalar.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The number of elements.
    pub fn elements(&self) -> usize {
        // `new` has seen that the shape has a number of elements.
        elements(&self.shape).unwrap_or(0)
    }

    /// Hands the elements' bytes out in C order, piece by piece, each a whole number of elements.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::Checkpoint`] for another checksum; what `sink` gives.
    pub(super) fn read<R: Read + Seek>(
        &self,
        name: &str,
        source: &mut R,
        mut sink: impl FnMut(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        if !self.is_contiguous() {
            return self.read_strided(source, sink);
        }
        source.seek(SeekFrom::Start(self.position)).map_err(|error| reading(&error))?;
        let bytes = self.span * self.element.size();
        let mut chunk = vec![0; bytes.min(CHUNK)];
        let mut checksum = self.checksum.map(|expected| (crc32fast::Hasher::new(), expected));
        let mut left = bytes;
        while left > 0 {
            let size = left.min(CHUNK);
            let piece = chunk.get_mut(..size).unwrap_or_default();
            source.read_exact(piece).map_err(|error| reading(&error))?;
            if let Some((hasher, _)) = &mut checksum {
                hasher.update(piece);
            }
            sink(piece)?;
            left -= size;
        }
        if checksum.is_none_or(|(hasher, expected)| hasher.finalize() == expected) {
            Ok(())
        } else {
            Err(of_tensor(name, "its bytes have another checksum than the archive says"))
        }
    }

    /// Whether the elements lie in C order without gaps.
    fn is_contiguous(&self) -> bool {
        let mut size = 1;
        self.span == 0
            || self.elements() == self.span
                && self.shape.iter().zip(&self.strides).rev().all(|(&axis, &stride)| {
                    let in_order = axis == 1 || stride == size;
                    size *= axis;
                    in_order
                })
    }

    /// The most memory that [`Self::read`] takes beside its chunks (bytes).
    pub(super) fn scratch(&self) -> usize {
        if self.is_contiguous() || !self.is_dense() { 0 } else { self.span * self.element.size() }
    }

    /// Whether a view has so many of the elements between its first and last that reading all of
    /// them costs less than one read for each piece.
    fn is_dense(&self) -> bool {
        self.span / 4 <= self.elements()
    }

    /// Reads a view with other strides: all that it spans at once where it is dense, and else only
    /// its own elements, so that many views of one large storage read no more than they hold.
    fn read_strided<R: Read + Seek>(
        &self,
        source: &mut R,
        mut sink: impl FnMut(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let size = self.element.size();
        let mut storage = vec![0; self.scratch()];
        source.seek(SeekFrom::Start(self.position)).map_err(|error| reading(&error))?;
        source.read_exact(&mut storage).map_err(|error| reading(&error))?;
        // Pieces without gaps: rows, or single elements.
        let (axes, piece) = match (self.shape.split_last(), self.strides.split_last()) {
            (Some((&last, axes)), Some((&1, _))) => (axes, last),
            _ => (self.shape.as_slice(), 1),
        };
        let strides = self.strides.get(..axes.len()).unwrap_or_default();
        let mut index = vec![0_usize; axes.len()];
        let mut offset = 0_usize;
        let mut chunk = Vec::with_capacity(CHUNK);
        for _ in 0..self.elements() / piece.max(1) {
            let (mut start, end) = (offset * size, (offset + piece) * size);
            while start < end {
                let part = (end - start).min(CHUNK - chunk.len());
                if self.is_dense() {
                    chunk.extend(storage.get(start..start + part).unwrap_or_default());
                } else {
                    let place = SeekFrom::Start(self.position + start as u64);
                    source.seek(place).map_err(|error| reading(&error))?;
                    source
                        .by_ref()
                        .take(part as u64)
                        .read_to_end(&mut chunk)
                        .map_err(|error| reading(&error))?;
                }
                start += part;
                if chunk.len() == CHUNK {
                    sink(&chunk)?;
                    chunk.clear();
                }
            }
            // The next place in C order: the last axis fastest.
            for ((place, &axis), &stride) in index.iter_mut().zip(axes).zip(strides).rev() {
                *place += 1;
                offset += stride;
                if *place < axis {
                    break;
                }
                offset -= stride * axis;
                *place = 0;
            }
        }
        sink(&chunk)
    }
}
