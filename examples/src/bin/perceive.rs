//! Makes a recording of camera frames: lifts skeletons into the world, follows the person who works
//! with the robot, and measures their posture.

use std::{
    collections::BTreeMap,
    io::Write,
    path::{Path, PathBuf},
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Result, ensure};
use clap::Parser;
use examples::frames::{FrameEntry, FramesReader};
use examples::perception::{
    Perceiver, PerceiverSettings, PoseSource, Quantiles, SkeletonFolder, assess,
};
use examples::program::{self, Ending, Json, OutputFile, Program, Quiet, Session};
use examples::recording::{Header, Writer};
use serde::Serialize;
use vision_models::{Body, LiftingSettings, Percept, PersonTrack, StatureEstimate};

/// Makes a recording, as `follow` plays it, of a folder of camera frames with depth.
///
/// The folder has camera.json, frames.jsonl and depth/, as `record --frames` writes them. Joints in the
/// images come from OpenPose's JSON. Ctrl-C ends early and keeps what there is, in a file named
/// *.partial.*.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    /// The folder of frames.
    frames: PathBuf,
    /// Where the recording goes (JSON Lines).
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// The folder of OpenPose's JSON, a file a frame such as 000012_keypoints.json.
    #[arg(long, value_name = "FOLDER")]
    skeletons: PathBuf,
    /// How long to wait for the next frame of a folder that grows (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    wait: f64,
    /// Standard deviation of the skeletons' joints, each axis (pixels).
    #[arg(long, value_name = "PIXELS", default_value_t = LiftingSettings::default().pixel_sigma)]
    pixel_sigma: f64,
    /// The person's stature (m), in place of the one that is measured.
    #[arg(long, value_name = "METRES")]
    stature: Option<f64>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Perceived {
    output: PathBuf,
    /// Frames that were read, that the camera lost, that nobody looked at for people, and in which the
    /// person who works with the robot was seen.
    frames: u64,
    lost: u64,
    without_skeletons: u64,
    with_body: u64,
    /// As measured (m).
    stature: Option<f64>,
    stature_standard_error: Option<f64>,
    /// Times that the person was somewhere else at once.
    jumps: u64,
    /// Frames a second, all work included.
    rate: f64,
    /// Lifting and tracking.
    lifting_and_tracking: Quantiles,
    /// From a frame that is there to its percept, reading included.
    whole_frame: Quantiles,
    /// From the camera to the percept, where the frames say when they arrived (s).
    latency_mean_s: Option<f64>,
    /// REBA and RULA of the measured posture, of the arm that is worse off.
    reba_mean: Option<f64>,
    reba_max: Option<u8>,
    rula_mean: Option<f64>,
    /// Angles of the sheets that were not seen, and in which share of the frames.
    unseen: BTreeMap<&'static str, f64>,
    /// Most memory of the process (MiB), where the system tells.
    peak_memory_mib: Option<f64>,
}

impl Program for Options {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> Result<Ending> {
        ensure!((0.0..=86_400.0).contains(&self.wait), "--wait {}: give 0 to 86400 s", self.wait);
        let wait = Duration::from_secs_f64(self.wait);
        let file = OutputFile::create(&self.output)?;
        let reader = FramesReader::open(&self.frames, wait)?;
        let mut poses = SkeletonFolder::open(&self.skeletons)?;
        let pixel_sigma = self.pixel_sigma;
        let lifting = LiftingSettings { pixel_sigma, ..LiftingSettings::default() };
        let settings = PerceiverSettings { lifting, ..PerceiverSettings::default() };
        let perceiver = Perceiver::new(*reader.camera(), settings)?;
        let mut work = Work::new(reader, perceiver);
        let ending = work.run(&mut poses, session)?;
        self.finish(work, file, ending, session)
    }
}

/// A run through the frames.
struct Work {
    reader: FramesReader,
    perceiver: Perceiver,
    percepts: Vec<Percept>,
    /// Of who was engaged last.
    stature: Option<StatureEstimate>,
    without_skeletons: u64,
    tracking: Vec<Duration>,
    whole: Vec<Duration>,
    latency: Option<(f64, u32)>,
    scores: Scores,
    started: Instant,
}

/// Sums of the scores of measured postures.
#[derive(Default)]
struct Scores {
    frames: u32,
    reba: f64,
    reba_max: Option<u8>,
    rula: f64,
    unseen: BTreeMap<&'static str, f64>,
}

impl Scores {
    fn push(&mut self, body: &Body) -> Result<()> {
        let Some(assessed) = assess(body)? else { return Ok(()) };
        self.frames = self.frames.saturating_add(1);
        self.reba += f64::from(assessed.reba.reba);
        self.reba_max = self.reba_max.max(Some(assessed.reba.reba));
        self.rula += f64::from(assessed.rula.rula);
        for name in assessed.measured.unseen() {
            *self.unseen.entry(name).or_default() += 1.0;
        }
        Ok(())
    }

    fn mean(&self, sum: f64) -> Option<f64> {
        (self.frames > 0).then(|| sum / f64::from(self.frames))
    }
}

impl Work {
    fn new(reader: FramesReader, perceiver: Perceiver) -> Self {
        Self {
            reader,
            perceiver,
            percepts: Vec::new(),
            stature: None,
            without_skeletons: 0,
            tracking: Vec::new(),
            whole: Vec::new(),
            latency: None,
            scores: Scores::default(),
            started: Instant::now(),
        }
    }

    fn run(&mut self, poses: &mut impl PoseSource, session: &Session) -> Result<Ending> {
        let interrupt = session.interrupt().clone();
        let progress = session.open_progress("frames");
        while let Some(entry) = self.reader.next_entry(|| interrupt.requested())? {
            self.frame(&entry, poses)?;
            progress.set(self.percepts.len() as u64);
            if interrupt.requested() {
                break;
            }
        }
        progress.finish();
        Ok(if interrupt.requested() { Ending::Partial } else { Ending::Complete })
    }

    fn frame(&mut self, entry: &FrameEntry, poses: &mut impl PoseSource) -> Result<()> {
        let started = Instant::now();
        let people = poses.people(entry)?;
        self.without_skeletons += u64::from(people.is_none());
        let depth = self.reader.depth(entry)?;
        self.perceiver.see(entry.time, &people.unwrap_or_default(), &depth)?;
        let body = self.perceiver.body().cloned();
        if let Some(body) = &body {
            self.scores.push(body)?;
        }
        let stature = self.perceiver.engaged().and_then(PersonTrack::stature);
        self.stature = stature.or(self.stature);
        self.percepts.push(Percept { time: entry.time, body, action: None, surface: None });
        self.tracking.push(self.perceiver.time_taken());
        let taken = started.elapsed();
        self.whole.push(taken);
        if let Some(arrived) = entry.arrived {
            let (sum, count) = self.latency.unwrap_or_default();
            let latency = arrived - entry.time + taken.as_secs_f64();
            self.latency = Some((sum + latency, count.saturating_add(1)));
        }
        Ok(())
    }
}

impl Options {
    fn finish(
        self,
        work: Work,
        file: OutputFile,
        ending: Ending,
        session: &mut Session,
    ) -> Result<Ending> {
        let elapsed = work.started.elapsed().as_secs_f64();
        let estimate = work.stature;
        // To the millimetre: its error is larger.
        let measured = estimate.map(|estimate| (estimate.stature * 1e3).round() / 1e3);
        let stature = self.stature.or(measured);
        let header = Header { rate: rate(&work.percepts), stature, ..Header::default() };
        let mut writer = Writer::new(file, &header)?;
        for percept in &work.percepts {
            writer.write(percept)?;
        }
        let output = match ending {
            Ending::Partial => writer.finish_partial()?.keep_partial()?,
            _ => writer.finish()?.keep().map(|()| self.output)?,
        };
        let frames = work.percepts.len() as u64;
        let perceived = Perceived {
            frames,
            lost: work.reader.lost(),
            without_skeletons: work.without_skeletons,
            with_body: work.percepts.iter().filter(|percept| percept.body.is_some()).count() as u64,
            stature: estimate.map(|estimate| estimate.stature),
            stature_standard_error: estimate.map(|estimate| estimate.standard_error),
            jumps: work.perceiver.people().tracks().iter().map(PersonTrack::jumps).sum(),
            rate: frames as f64 / elapsed.max(1e-9),
            lifting_and_tracking: Quantiles::of(work.tracking),
            whole_frame: Quantiles::of(work.whole),
            latency_mean_s: work.latency.map(|(sum, count)| sum / f64::from(count)),
            reba_mean: work.scores.mean(work.scores.reba),
            reba_max: work.scores.reba_max,
            rula_mean: work.scores.mean(work.scores.rula),
            unseen: work
                .scores
                .unseen
                .iter()
                .map(|(name, count)| (*name, count / f64::from(work.scores.frames)))
                .collect(),
            peak_memory_mib: peak_memory(),
            output,
        };
        print(&perceived, session)?;
        session.print_json(self.json, &perceived, ending)?;
        Ok(ending)
    }
}

fn print(perceived: &Perceived, session: &mut Session) -> Result<()> {
    let Perceived { output, frames, lost, without_skeletons, with_body, .. } = perceived;
    let out = session.output();
    writeln!(out, "{}: {frames} camera frames, the person in {with_body}", shown(output))?;
    writeln!(out, "lost by the camera {lost}, without skeletons {without_skeletons}")?;
    if let (Some(stature), Some(error)) = (perceived.stature, perceived.stature_standard_error) {
        writeln!(out, "stature {stature:.3} m, standard error {error:.3} m")?;
    }
    if let (Some(mean), Some(max), Some(rula)) =
        (perceived.reba_mean, perceived.reba_max, perceived.rula_mean)
    {
        writeln!(out, "measured posture: REBA {mean:.1}, {max} at most; RULA {rula:.1}")?;
        let never = perceived.unseen.iter().filter(|(_, share)| **share == 1.0);
        let never: Vec<_> = never.map(|(name, _)| *name).collect();
        writeln!(out, "  never seen: {}, loads, holds, support, how long", never.join(", "))?;
    }
    let times = &perceived.lifting_and_tracking;
    writeln!(
        out,
        "lifting and tracking {:.0} µs a frame, {:.0} µs at most; {:.0} frames a second in all",
        times.median_us, times.max_us, perceived.rate
    )?;
    Ok(())
}

fn shown(path: &Path) -> impl std::fmt::Display + '_ {
    path.display()
}

/// Frames a second, from the time stamps.
fn rate(percepts: &[Percept]) -> f64 {
    match (percepts.first(), percepts.last()) {
        (Some(first), Some(last)) if last.time > first.time => {
            ((percepts.len() - 1) as f64 / (last.time - first.time)).clamp(1e-3, 1000.0)
        }
        _ => Header::default().rate,
    }
}

/// What Linux says in /proc.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes / 1024.0)
}

fn main() -> ExitCode {
    program::main::<Options>()
}
