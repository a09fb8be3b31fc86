//! Percepts that others read while the camera goes on.

use std::fs::File;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result};
use human_perception::percepts::{Perceived, Perceiver, Quantiles};
#[cfg(feature = "ros2")]
use moca_drivers::ros2::PeoplePublisher;
use percept_recording::{Header, Writer};
use serde::Serialize;

/// Passes each percept on at once, and measures how old its image is then.
#[derive(Debug)]
pub struct LiveWriter {
    sink: Sink,
    latencies: Vec<Duration>,
}

/// Destination of percepts.
#[derive(Debug)]
enum Sink {
    /// A file, a pipe or a device.
    File(Writer<File>),
    /// The ROS 2 graph, with people in this frame.
    #[cfg(feature = "ros2")]
    Ros2(Box<PeoplePublisher>, &'static str),
}

/// Latency from image to percept, and frames that were left out.
#[derive(Debug, Serialize)]
pub struct LiveReport {
    /// Number of frames that were left out because a newer one was there.
    pub late: u64,
    /// Time from the image to its percept.
    pub latency: Quantiles,
    /// 95th percentile of the latency \[ms\].
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
        Ok(Self { sink: Sink::File(Writer::new(file, &header)?), latencies: Vec::new() })
    }

    /// Publishes percepts on the ROS 2 graph, with people in this frame.
    #[cfg(feature = "ros2")]
    pub fn publishing(to: PeoplePublisher, frame: &'static str) -> Self {
        Self { sink: Sink::Ros2(Box::new(to), frame), latencies: Vec::new() }
    }

    /// Passes on a percept of an image that was taken at its time by the system's clock, with the time at which it is
    /// written. The people are those of the perceiver.
    ///
    /// # Errors
    /// A place where nothing can be written any more.
    pub fn write(&mut self, perceived: &mut Perceived, people: &Perceiver) -> Result<()> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64();
        let taken = perceived.percept.time;
        // The camera's clock may be a little ahead.
        self.latencies.push(Duration::try_from_secs_f64(now - taken).unwrap_or_default());
        perceived.timing.arrived = Some(now.max(taken));
        #[cfg(not(feature = "ros2"))]
        let _ = people;
        match &mut self.sink {
            Sink::File(writer) => {
                let Perceived { percept, others, timing, .. } = &*perceived;
                Ok(writer.write_people(percept, others, timing)?)
            }
            #[cfg(feature = "ros2")]
            Sink::Ros2(publisher, frame) => {
                super::ros2::publish(publisher, frame, perceived, people)
            }
        }
    }

    /// Writes the end of the percepts. Returns the report of a run that left out so many frames.
    ///
    /// # Errors
    /// A place where nothing can be written any more.
    pub fn finish(self, late: u64) -> Result<LiveReport> {
        let Self { sink, mut latencies } = self;
        match sink {
            Sink::File(writer) => {
                writer.finish()?;
            }
            #[cfg(feature = "ros2")]
            Sink::Ros2(..) => {}
        }
        latencies.sort_unstable();
        let p95 = latencies.get(latencies.len() * 95 / 100).copied().unwrap_or_default();
        let latency_p95_ms = 1e3 * p95.as_secs_f64();
        Ok(LiveReport { late, latency: Quantiles::of(latencies), latency_p95_ms })
    }
}
