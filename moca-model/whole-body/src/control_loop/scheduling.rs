//! Scheduling of a thread that must keep deadlines.

use rustix::mm::{MlockAllFlags, mlockall};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use crate::error::Error;

/// Priority of a thread and memory locking of its process. The default changes neither.
///
/// ```
/// use whole_body::control_loop::Scheduling;
///
/// Scheduling::default().apply()?;
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Scheduling {
    /// Priority of the thread under SCHED_FIFO, 1 to 99, above every thread without one. It needs CAP_SYS_NICE or a
    /// limit `rtprio`. Default `None`, which leaves the scheduling as it is.
    pub priority: Option<u8>,
    /// True if all memory of the process, present and future, stays in memory and is never paged out. It needs
    /// CAP_IPC_LOCK or a limit `memlock`. Default false.
    pub lock_memory: bool,
}

impl Scheduling {
    /// Applies the settings to the calling thread and its process.
    ///
    /// # Errors
    /// [`Error::Refused`] says what the system does not grant; [`Error::Value`] for a priority out of range.
    pub fn apply(&self) -> Result<(), Error> {
        if self.lock_memory {
            mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| {
                Error::Refused {
                    what: "locked memory",
                    reason: error.to_string(),
                    remedy: "raise the limit memlock in /etc/security/limits.conf",
                }
            })?;
        }
        let Some(priority) = self.priority else { return Ok(()) };
        let (what, expected) = ("the real-time priority", "from 1 to 99");
        if !(1..=99).contains(&priority) {
            return Err(Error::value(what, priority.into(), expected));
        }
        let refused = |reason: String| Error::Refused {
            what,
            reason,
            remedy: "raise the limit rtprio in /etc/security/limits.conf",
        };
        let value = ThreadPriorityValue::try_from(priority).map_err(refused)?;
        let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        set_thread_priority_and_policy(
            thread_native_id(),
            ThreadPriority::Crossplatform(value),
            policy,
        )
        .map_err(|error| refused(format!("{error:?}")))
    }
}
