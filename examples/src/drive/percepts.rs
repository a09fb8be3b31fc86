//! Percepts of another program, as it makes them.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result};
use moca_model::Scene;
use moca_model::whole_body::control_loop::{Clock, MonotonicClock};
use percept_recording::Reader;

use super::attendant::Attendant;

/// Longest time after which the end of the loop is noticed.
const WAKES: Duration = Duration::from_millis(10);
/// Frames that may wait.
const WAITING: usize = 8;

/// Shows a loop the percepts of a recording that another program writes into a pipe, until the loop has ended. Their
/// times are of the system's clock (s since 1970).
///
/// # Errors
/// A pipe that cannot be read, or that holds no recording. The loop is not told: it stops when it sees nothing.
pub fn watch_percepts(
    path: &Path,
    attendant: &mut Attendant<'_>,
    ended: &AtomicBool,
    mut clock: MonotonicClock,
) -> Result<()> {
    let (sender, frames) = sync_channel(WAITING);
    let path = PathBuf::from(path);
    // A pipe without a writer is waited for, even after the loop has ended.
    let reading = thread::spawn(move || {
        let opened = File::open(&path).map_err(anyhow::Error::from);
        opened
            .and_then(|file| read(file, &sender))
            .with_context(|| format!("--percepts {}", path.display()))
    });
    while !ended.load(Ordering::Acquire) {
        attendant.attend();
        match frames.recv_timeout(WAKES) {
            Ok((taken, mut frame)) => {
                // In this order a pause between the two readings makes the frame older, never of the future.
                let now = clock.now();
                let age = SystemTime::now().duration_since(taken).unwrap_or_default();
                frame.percept.time = now - age.as_secs_f64();
                attendant.see(frame);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                let now = clock.now();
                clock.sleep_until(now + WAKES.as_secs_f64());
            }
        }
    }
    if reading.is_finished() { reading.join().unwrap_or(Ok(())) } else { Ok(()) }
}

/// Reads a recording to its end, or until nobody takes its frames any more.
fn read(file: File, to: &SyncSender<(SystemTime, Scene)>) -> Result<()> {
    let mut reader = Reader::new(BufReader::new(file))?;
    while let Some(percept) = reader.next() {
        let percept = percept?;
        let taken = UNIX_EPOCH + Duration::try_from_secs_f64(percept.time)?;
        let frame = Scene::from(percept).with_others(reader.others());
        if to.send((taken, frame)).is_err() {
            break;
        }
    }
    Ok(())
}
