//! What the system does for a thread that must be in time.

use rustix::mm::{MlockAllFlags, mlockall};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use crate::error::Error;

/// The priority of a thread and the memory of its process. The default leaves both as they are.
///
/// ```
/// use whole_body::control_loop::Scheduling;
///
/// Scheduling::default().apply()?;
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Scheduling {
    /// The thread's priority under SCHED_FIFO, 1 to 99, above every thread without one. Needs the right to it:
    /// CAP_SYS_NICE, or a limit `rtprio`. Default none: as other threads.
    pub priority: Option<u8>,
    /// Whether all memory of the process, present and future, stays in memory and is never paged out. Needs
    /// CAP_IPC_LOCK, or a limit `memlock`. Default false.
    pub lock_memory: bool,
}

impl Scheduling {
    /// Asks the system for it, for the thread that calls.
    ///
    /// # Errors
    /// [`Error::Refused`] says what the system does not grant; [`Error::Value`] for a priority that is none.
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
