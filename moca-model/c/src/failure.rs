//! Results of calls.

use std::cell::RefCell;
use std::ffi::c_char;
use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Result of a call. If it is negative, nothing was done, and `ahqp_last_error` says why.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AhqpStatus {
    /// The call succeeded. A solve is at the optimum of every level.
    Ok = 0,
    /// The iterations ran out. Hard constraints and limits hold.
    IterationLimit = 1,
    /// The time ran out. Hard constraints and limits hold.
    TimeLimit = 2,
    /// A pointer is null.
    NullPointer = -1,
    /// A matrix, vector or buffer has the wrong size, or a number is not an allowed value.
    BadArgument = -2,
    /// The data make no valid problem, or the robot cannot do what is asked.
    BadData = -3,
    /// Hard constraints contradict each other.
    Infeasible = -4,
    /// The library has failed; please report this defect. The handles of the call may only be freed.
    Panic = -5,
}

/// Size of the buffer for the text of an error, with the zero byte at its end.
const ROOM: usize = 1024;

/// Text in an existing buffer.
struct Message {
    bytes: [u8; ROOM],
    length: usize,
}

impl Write for Message {
    /// Writes as many whole characters as fit.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars() {
            let end = self.length + character.len_utf8();
            let Some(room) = self.bytes.get_mut(self.length..end).filter(|_| end < ROOM) else {
                return Err(fmt::Error);
            };
            character.encode_utf8(room);
            self.length = end;
        }
        Ok(())
    }
}

thread_local! {
    static LAST: RefCell<Message> = const { RefCell::new(Message { bytes: [0; ROOM], length: 0 }) };
}

/// A call that did nothing.
#[derive(Debug)]
pub(crate) struct Failure(AhqpStatus);

pub(crate) type Result<T> = std::result::Result<T, Failure>;

impl Failure {
    /// Stores the text for the caller.
    pub(crate) fn new(status: AhqpStatus, text: &dyn fmt::Display) -> Self {
        LAST.with_borrow_mut(|last| {
            last.length = 0;
            // Text that does not fit is cut.
            let _ = write!(last, "{text}");
            last.bytes[last.length] = 0;
        });
        Self(status)
    }

    pub(crate) fn null(what: &str) -> Self {
        Self::new(AhqpStatus::NullPointer, &format_args!("{what} is null"))
    }

    pub(crate) fn size(what: &str, found: usize, expected: usize) -> Self {
        let text = format_args!("{what} has size {found}; it must have {expected}");
        Self::new(AhqpStatus::BadArgument, &text)
    }
}

impl From<ahqp_core::Error> for Failure {
    fn from(error: ahqp_core::Error) -> Self {
        let status = match error {
            ahqp_core::Error::Infeasible { .. } => AhqpStatus::Infeasible,
            ahqp_core::Error::Size { .. } => AhqpStatus::BadArgument,
            _ => AhqpStatus::BadData,
        };
        Self::new(status, &error)
    }
}

impl From<whole_body::Error> for Failure {
    fn from(error: whole_body::Error) -> Self {
        match error {
            whole_body::Error::Hierarchy(error) => error.into(),
            whole_body::Error::Size { .. } => Self::new(AhqpStatus::BadArgument, &error),
            error => Self::new(AhqpStatus::BadData, &error),
        }
    }
}

/// Runs a call. Neither errors nor panics leave it.
pub(crate) fn call(run: impl FnOnce() -> Result<AhqpStatus>) -> AhqpStatus {
    // A handle that a panic leaves half-written may only be freed: `AhqpStatus::Panic` says so.
    if let Ok(Ok(status) | Err(Failure(status))) = catch_unwind(AssertUnwindSafe(run)) {
        return status;
    }
    let text = "the library has failed; please report what led to it, and free the handle";
    Failure::new(AhqpStatus::Panic, &text).0
}

/// Returns the status for the result of a solve.
pub(crate) fn status(status: ahqp_core::Status) -> AhqpStatus {
    match status {
        ahqp_core::Status::Solved => AhqpStatus::Ok,
        ahqp_core::Status::TimeLimit { .. } => AhqpStatus::TimeLimit,
        _ => AhqpStatus::IterationLimit,
    }
}

/// Returns the error text of this thread's last call with a negative status: what was wrong, where, and what would
/// be right. It is UTF-8, at most 1023 bytes, and valid until the next such call of this thread. It is never null.
#[unsafe(no_mangle)]
pub extern "C" fn ahqp_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.bytes.as_ptr().cast())
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    fn last() -> String {
        // SAFETY: never null, and ends with a zero byte.
        unsafe { CStr::from_ptr(ahqp_last_error()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn panics_become_a_status() {
        assert_eq!(call(|| panic!("a defect")), AhqpStatus::Panic);
        assert!(last().contains("the library has failed"));
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        for shift in 0..3 {
            let text = "x".repeat(shift) + &"é".repeat(2000);
            Failure::new(AhqpStatus::BadData, &text);
            let kept = last();
            assert!(text.starts_with(&kept) && (ROOM - 3..ROOM).contains(&kept.len()));
        }
        Failure::new(AhqpStatus::BadData, &"short");
        assert_eq!(last(), "short");
    }
}
