//! Handles: pointers that the caller holds.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::failure::{AhqpStatus, Failure, Result};

/// Passes a new handle to the caller.
///
/// # Safety
/// `out`, if not null, points to room for a pointer.
pub(crate) unsafe fn give<T>(
    out: *mut *mut T,
    make: impl FnOnce() -> Result<T>,
) -> Result<AhqpStatus> {
    if out.is_null() {
        return Err(Failure::null("where to put the new handle"));
    }
    // SAFETY: not null; the caller promises room.
    unsafe { *out = std::ptr::null_mut() };
    let made = Box::into_raw(Box::new(make()?));
    // SAFETY: as above.
    unsafe { *out = made };
    Ok(AhqpStatus::Ok)
}

/// Returns the contents of a handle.
///
/// # Safety
/// `handle`, if not null, came from [`give`], was not freed, and nobody changes it meanwhile.
pub(crate) unsafe fn read<'a, T>(what: &str, handle: *const T) -> Result<&'a T> {
    // SAFETY: the caller promises that it is null or valid.
    unsafe { handle.as_ref() }.ok_or_else(|| Failure::null(what))
}

/// Returns the contents of a handle for changes.
///
/// # Safety
/// `handle`, if not null, came from [`give`], was not freed, and nobody else uses it meanwhile.
pub(crate) unsafe fn write<'a, T>(what: &str, handle: *mut T) -> Result<&'a mut T> {
    // SAFETY: the caller promises that it is null or valid, and used by nobody else.
    unsafe { handle.as_mut() }.ok_or_else(|| Failure::null(what))
}

/// Frees the contents of a handle. Does nothing for a null pointer.
///
/// # Safety
/// `handle`, if not null, came from [`give`] and is not used again.
pub(crate) unsafe fn free<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: the caller promises that it came from a box and is not used again.
        let value = unsafe { Box::from_raw(handle) };
        // Freeing runs no code that could fail, but a panic must not leave in any case.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(value)));
    }
}
