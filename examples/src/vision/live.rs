//! Percepts that others read while the camera goes on.

use std::fs::File;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result};
use human_perception::percepts::{Perceived, Quantiles};
use percept_recording::{Header, Writer};
use serde::Serialize;

/// Writes each percept at once, and measures how old its image is then.
#[derive(Debug)]
pub struct LiveWriter {
    writer: Writer<File>,
    latencies: Vec<Duration>,
}

/// How old the images were when their percepts were there, and the frames that were left out.
#[derive(Debug, Serialize)]
pub struct LiveReport {
    /// Number of frames that were left out because a newer one was there.
    pub late: u64,
    /// Time from the image to its percept.
    pub latency: Quantiles,
    /// Its 95th percentile \[ms\].
    pub latency_p95_ms: f64,
}

impl LiveWriter {
    /// Opens a file, a pipe or a device, for percepts of a person of this stature \[m\] if it is known.
    ///
    /// # Errors
    /// A place where nothing can be written.
    pub fn create(path: &Path, stature: Option<f64>) -> Result<Self> {
        let file =
            File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
        let header = Header { stature, ..Header::default() };
        Ok(Self { writer: Writer::new(file, &header)?, latencies: Vec::new() })
    }

    /// Writes a percept of an image that was taken at its time by the system's clock, with the time at which it is
    /// written.
    ///
    /// # Errors
    /// A place where nothing can be written any more.
    pub fn write(&mut self, perceived: &mut Perceived) -> Result<()> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64();
        let taken = perceived.percept.time;
        // The camera's clock may be a little ahead.
        self.latencies.push(Duration::try_from_secs_f64(now - taken).unwrap_or_default());
        perceived.timing.arrived = Some(now.max(taken));
        let Perceived { percept, others, timing, .. } = &*perceived;
        Ok(self.writer.write_people(percept, others, timing)?)
    }

    /// Writes the end of the percepts. Returns the report of a run that left out so many frames.
    ///
    /// # Errors
    /// A place where nothing can be written any more.
    pub fn finish(self, late: u64) -> Result<LiveReport> {
        let Self { writer, mut latencies } = self;
        writer.finish()?;
        latencies.sort_unstable();
        let p95 = latencies.get(latencies.len() * 95 / 100).copied().unwrap_or_default();
        let latency_p95_ms = 1e3 * p95.as_secs_f64();
        Ok(LiveReport { late, latency: Quantiles::of(latencies), latency_p95_ms })
    }
}
