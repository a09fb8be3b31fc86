//! Results of a run of perception.

use std::io::{self, Write};
use std::path::PathBuf;

use human_perception::percepts::{AgainstTruth, Summary};
#[cfg(feature = "ros2")]
use moca_drivers::ros2::CameraReport;
use serde::Serialize;

use super::live::LiveReport;

/// The JSON object of `--json`.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The file of percepts; `None` on the ROS 2 graph.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<PathBuf>,
    /// Number of frames that the camera lost.
    pub lost: u64,
    /// Number of frames that are left out because of an unusable file.
    pub broken: u64,
    /// Measured stature \[m\].
    pub stature: Option<f64>,
    /// Standard error of the stature \[m\].
    pub stature_standard_error: Option<f64>,
    /// Number of times that the person was suddenly at another place.
    pub jumps: u64,
    /// Frames a second, with all work.
    pub rate: f64,
    /// Counts and times of the frames.
    #[serde(flatten)]
    pub summary: Summary,
    /// Shares of time with the right results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<AgainstTruth>,
    /// Latencies of live percepts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub live: Option<LiveReport>,
    /// Messages of the camera on the ROS 2 graph.
    #[cfg(feature = "ros2")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ros2: Option<CameraReport>,
    /// Peak memory of the process (MiB), if the system reports it.
    pub peak_memory_mib: Option<f64>,
}

/// Writes a report for people.
///
/// # Errors
/// Those of `out`.
pub fn print(report: &Report, out: &mut impl Write) -> io::Result<()> {
    let Report { output, lost, summary, .. } = report;
    let Summary { frames, without_skeletons, with_body, with_action, with_surface, .. } = summary;
    let place = output.as_ref().map_or("ROS 2".to_owned(), |path| path.display().to_string());
    writeln!(out, "{place}: {frames} camera frames, the person in {with_body}")?;
    writeln!(out, "lost by the camera {lost}, without skeletons {without_skeletons}")?;
    writeln!(out, "with an action {with_action}, with a surface {with_surface}")?;
    if let (Some(stature), Some(error)) = (report.stature, report.stature_standard_error) {
        writeln!(out, "stature {stature:.3} m, standard error {error:.3} m")?;
    }
    if let (Some(mean), Some(max), Some(rula)) =
        (summary.reba_mean, summary.reba_max, summary.rula_mean)
    {
        writeln!(out, "measured posture: REBA {mean:.1}, {max} at most; RULA {rula:.1}")?;
        let never = summary.unseen.iter().filter(|(_, share)| **share == 1.0);
        let never: Vec<_> = never.map(|(name, _)| *name).collect();
        writeln!(out, "  never seen: {}, loads, coupling, support, how long", never.join(", "))?;
    }
    if let Some(LiveReport { late, latency, latency_p95_ms }) = &report.live {
        let (p50, max) = (1e-3 * latency.median_us, 1e-3 * latency.max_us);
        writeln!(out, "overtaken by a newer frame {late}")?;
        writeln!(
            out,
            "from image to percept [ms] p50 p95 max {p50:.0}, {latency_p95_ms:.0}, {max:.0}"
        )?;
    }
    #[cfg(feature = "ros2")]
    if let Some(CameraReport { unpaired, topics, .. }) = &report.ros2 {
        writeln!(out, "colour without depth, or depth without colour {unpaired}")?;
        topics.iter().try_for_each(|topic| writeln!(out, "{topic}"))?;
    }
    if let Some(truth) = &report.truth {
        let percent = |share: Option<f64>| 100.0 * share.unwrap_or(f64::NAN);
        let AgainstTruth { surface_right, action_right, intention_right, delay } = truth;
        writeln!(
            out,
            "against the truth: surface {:.1} %, action {:.1} %, intention {:.1} % of the time ({delay} s late allowed)",
            percent(*surface_right),
            percent(*action_right),
            percent(*intention_right)
        )?;
    }
    let times = &summary.lifting_and_tracking;
    writeln!(
        out,
        "lifting and tracking {:.0} µs a frame, {:.0} µs at most; {:.0} frames a second in all",
        times.median_us, times.max_us, report.rate
    )?;
    Ok(())
}

/// The peak memory that Linux reports in /proc (MiB).
pub fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes / 1024.0)
}
