//! Memory of which the tasks of one loop write disjoint parts.

use std::marker::PhantomData;

/// A borrowed slice whose disjoint parts several threads write at once. It only returns pointers.
/// Code that writes through one must state why no other thread uses that part.
#[derive(Clone, Copy, Debug)]
pub(super) struct SharedSlice<'a> {
    start: *mut f32,
    length: usize,
    borrow: PhantomData<&'a mut [f32]>,
}

// SAFETY: a `SharedSlice` by itself reads and writes nothing.
unsafe impl Send for SharedSlice<'_> {}
// SAFETY: as above.
unsafe impl Sync for SharedSlice<'_> {}

impl<'a> SharedSlice<'a> {
    pub(super) fn new(slice: &'a mut [f32]) -> Self {
        Self { start: slice.as_mut_ptr(), length: slice.len(), borrow: PhantomData }
    }

    pub(super) fn len(&self) -> usize {
        self.length
    }

    /// Returns a pointer to the float at `offset`.
    ///
    /// # Panics
    /// If `offset` is beyond the end.
    pub(super) fn at(&self, offset: usize) -> *mut f32 {
        assert!(offset <= self.length, "offset {offset} in {} floats", self.length);
        // SAFETY: inside the slice, or one past its end.
        unsafe { self.start.add(offset) }
    }
}
