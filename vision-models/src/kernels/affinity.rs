//! The cores on which a thread runs.

use std::{io, thread::JoinHandle};

/// Restricts a thread to these cores.
///
/// # Errors
/// The operating system's error, or an error if a core does not exist.
#[cfg(target_os = "linux")]
pub(super) fn restrict<T>(thread: &JoinHandle<T>, cores: &[usize]) -> io::Result<()> {
    use std::os::unix::thread::JoinHandleExt;

    // SAFETY: a set of cores is plain bits, and zeros are the empty set.
    let mut set: libc::cpu_set_t = unsafe { std::mem::zeroed() };
    let bits = 8 * size_of_val(&set);
    for &core in cores {
        if core >= bits {
            return Err(io::Error::other(format!("there is no core {core}")));
        }
        // SAFETY: the core is a bit of the set.
        unsafe { libc::CPU_SET(core, &mut set) };
    }
    // SAFETY: the handle keeps the thread's identity valid, and the given size is the set's.
    let code = unsafe {
        libc::pthread_setaffinity_np(thread.as_pthread_t(), size_of_val(&set), &raw const set)
    };
    if code == 0 { Ok(()) } else { Err(io::Error::from_raw_os_error(code)) }
}

/// Fails, because other systems are not supported.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub(super) fn restrict<T>(_: &JoinHandle<T>, _: &[usize]) -> io::Result<()> {
    Err(io::Error::new(io::ErrorKind::Unsupported, "threads are bound to cores on Linux only"))
}
