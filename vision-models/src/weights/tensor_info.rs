//! The position of a tensor's elements in its file.

use std::io::{Read, Seek, SeekFrom};

use super::error::of_tensor;
use super::input::reading;
use super::shape::elements;
use crate::error::Error;
use crate::weights::element::ElementType;

/// Number of bytes that are read at a time. They stay in the cache until they are decoded.
const CHUNK: usize = 128 << 10;

/// A tensor in a checkpoint that is not read yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TensorInfo {
    element: ElementType,
    shape: Vec<usize>,
    /// The step along each axis (elements).
    strides: Vec<usize>,
    /// Position of the first element in the file (bytes).
    position: u64,
    /// Length from the first element to the last, both included (elements).
    span: usize,
    /// CRC-32 of the storage, if the tensor is all of it.
    checksum: Option<u32>,
}

/// A storage in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    /// Position of its start (bytes).
    pub(super) position: u64,
    /// Size (elements).
    pub(super) elements: usize,
    pub(super) checksum: Option<u32>,
}

impl TensorInfo {
    /// Creates a tensor in a storage, or returns `None` if it exceeds the storage.
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

    /// Creates a contiguous tensor in C order.
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

    /// Returns the type of the elements in the file.
    pub fn element(&self) -> ElementType {
        self.element
    }

    /// Returns the length of each axis, or an empty list for a scalar.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the number of elements.
    pub fn elements(&self) -> usize {
        // `new` has checked that the number of elements is valid.
        elements(&self.shape).unwrap_or(0)
    }

    /// Passes the elements' bytes to `sink` in C order, piece by piece. Each piece is a whole
    /// number of elements.
    ///
    /// # Errors
    /// - [`Error::File`] if reading fails.
    /// - [`Error::Checkpoint`] if the checksum is wrong.
    /// - The errors of `sink`.
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

    /// Returns true if the elements are in C order without gaps.
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

    /// Returns the largest memory that [`Self::read`] needs beside its chunks (bytes).
    pub(super) fn scratch(&self) -> usize {
        if self.is_contiguous() || !self.is_dense() { 0 } else { self.span * self.element.size() }
    }

    /// Returns true if a view is dense: reading everything between its first and last element is
    /// faster than one read per piece.
    fn is_dense(&self) -> bool {
        self.span / 4 <= self.elements()
    }

    /// Reads a view with other strides. A dense view is read at once with its gaps, any other piece
    /// by piece. Many views of one large storage therefore read no more than they hold.
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
            // The next index in C order, the last axis fastest.
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
