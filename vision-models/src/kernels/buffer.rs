//! Memory for weights and activations, aligned to cache lines.

use std::ops::{Deref, DerefMut};

/// A cache line of floats.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Line([f32; Self::FLOATS]);

impl Line {
    const FLOATS: usize = 16;
}

/// Floats that start on a cache line.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffer {
    lines: Vec<Line>,
    length: usize,
}

impl Buffer {
    /// Creates a buffer of `length` zeros.
    pub(crate) fn zeroed(length: usize) -> Self {
        let count = length.div_ceil(Line::FLOATS);
        let mut lines = Vec::with_capacity(count);
        advise_huge_pages(&mut lines);
        lines.resize(count, Line([0.0; Line::FLOATS]));
        Self { lines, length }
    }

    /// Creates a buffer of `length` zeros, or returns `None` if there is not enough memory.
    pub(crate) fn try_zeroed(length: usize) -> Option<Self> {
        Vec::<Line>::new().try_reserve_exact(length.div_ceil(Line::FLOATS)).ok()?;
        Some(Self::zeroed(length))
    }
}

/// Asks for huge pages before the memory is first used. A network's weights would cover thousands
/// of small pages, too many for the processor's address translation cache.
#[cfg(target_os = "linux")]
fn advise_huge_pages(lines: &mut Vec<Line>) {
    const HUGE_PAGE: usize = 2 << 20;
    let spare = lines.spare_capacity_mut();
    let start = spare.as_mut_ptr().addr();
    let first = start.next_multiple_of(HUGE_PAGE);
    let end = start + size_of_val(spare);
    if end >= first + HUGE_PAGE {
        let address = spare.as_mut_ptr().wrapping_byte_add(first - start);
        // SAFETY: the range lies inside the vector's memory, and the advice changes no contents.
        // Ignored advice only costs speed.
        unsafe { libc::madvise(address.cast(), end - first, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise_huge_pages(_: &mut Vec<Line>) {}

impl Deref for Buffer {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        // SAFETY: `lines` holds at least `length` initialised floats without gaps between them.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().cast(), self.length) }
    }
}

impl DerefMut for Buffer {
    fn deref_mut(&mut self) -> &mut [f32] {
        // SAFETY: as above, and the borrow is exclusive.
        unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), self.length) }
    }
}
