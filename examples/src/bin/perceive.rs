//! Makes a recording of camera frames: finds joints, lifts them into the world, follows the person who
//! works with the robot, measures their posture, and recognises what they do and the object's surface.

use std::{
    cell::Cell,
    io::Write,
    path::{Path, PathBuf},
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Result, ensure};
use clap::{ArgGroup, Args, Parser};
use examples::frames::FramesReader;
use examples::perception::{
    ActionNetwork, ActionSettings, Perceiver, PerceiverSettings, Pipeline, PoseNetwork, PoseSource,
    SkeletonFolder, Summary, SurfaceDecision, SurfaceNetwork, Tally,
};
use examples::program::{self, Ending, Json, OutputFile, Program, Quiet, Session, Threads};
use examples::recording::{Header, MeasuredSegments, Timing, Writer};
use examples::vision::choices;
use serde::Serialize;
use vision_models::{
    LiftingSettings, Passes, Percept, PersonTrack, ResNetDepth, SlowOnlyForm, StatureEstimate,
};

/// Makes a recording, as `follow` plays it, of a folder of camera frames with depth.
///
/// The folder has camera.json, frames.jsonl and depth/, as `record --frames` writes them, and colour/ and
/// surface/ for networks. Joints come from a pose network or from OpenPose's JSON. Ctrl-C ends early and
/// keeps what there is, in a file named *.partial.*.
#[derive(Debug, Parser)]
#[command(version, group(ArgGroup::new("joints").required(true)))]
struct Options {
    /// The folder of frames.
    frames: PathBuf,
    /// Where the recording goes (JSON Lines).
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// The folder of OpenPose's JSON, a file a frame such as 000012_keypoints.json.
    #[arg(long, value_name = "FOLDER", group = "joints")]
    skeletons: Option<PathBuf>,
    /// The weights of a pose network: a simple baseline or OpenPose, as their tensors say.
    #[arg(long, value_name = "FILE", group = "joints")]
    pose_weights: Option<PathBuf>,
    /// Let the simple baseline look at the mirrored image, too: better joints for twice the time.
    #[arg(long, requires = "pose_weights")]
    mirrored: bool,
    #[command(flatten)]
    surface: SurfaceOptions,
    #[command(flatten)]
    action: ActionOptions,
    #[command(flatten)]
    threads: Threads,
    /// How long to wait for the next frame of a folder that grows (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    wait: f64,
    /// Standard deviation of the joints in the image, each axis (pixels).
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

/// How the surface is recognised in the images of the on-board camera.
#[derive(Args, Debug)]
#[command(group(ArgGroup::new("decision")))]
#[expect(clippy::struct_field_names, reason = "they are the options' names")]
struct SurfaceOptions {
    /// The weights of a ResNet, whose features tell the surface.
    #[arg(long, value_name = "FILE", requires = "decision")]
    surface_weights: Option<PathBuf>,
    /// How many layers it has.
    #[arg(long, default_value = "50", value_parser = choices::depth(), requires = "surface_weights")]
    surface_depth: ResNetDepth,
    /// A linear SVM over the features, as `surface train` writes it.
    #[arg(long, value_name = "FILE", group = "decision", requires = "surface_weights")]
    surface_svm: Option<PathBuf>,
    /// Or a linear layer: fc.weight and fc.bias for drilled and smooth.
    #[arg(long, value_name = "FILE", group = "decision", requires = "surface_weights")]
    surface_head: Option<PathBuf>,
    /// Camera frames from one look at the surface to the next.
    #[arg(long, value_name = "FRAMES", default_value_t = 10, requires = "surface_weights")]
    surface_interval: u64,
}

/// How the action is recognised in the colour images.
#[derive(Args, Debug)]
#[expect(clippy::struct_field_names, reason = "they are the options' names")]
struct ActionOptions {
    /// The weights of a SlowOnly.
    #[arg(long, value_name = "FILE")]
    action_weights: Option<PathBuf>,
    /// Whose network.
    #[arg(long, default_value = "slowonly_mm", value_parser = choices::slow_only(), requires = "action_weights")]
    action_model: SlowOnlyForm,
    /// A linear layer over its features in place of its own: fc.weight and fc.bias.
    #[arg(long, value_name = "FILE", requires = "action_weights")]
    action_head: Option<PathBuf>,
    /// The names of the classes, actions of HRI30, one a line; all thirty if left out.
    #[arg(long, value_name = "FILE", requires = "action_weights")]
    action_names: Option<PathBuf>,
    /// Frames of a clip.
    #[arg(long, value_name = "FRAMES", default_value_t = 8, requires = "action_weights")]
    action_length: usize,
    /// Camera frames from one of a clip to the next.
    #[arg(long, value_name = "FRAMES", default_value_t = 4, requires = "action_weights")]
    action_interval: u64,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Report {
    output: PathBuf,
    /// Frames that the camera lost.
    lost: u64,
    /// As measured (m).
    stature: Option<f64>,
    stature_standard_error: Option<f64>,
    /// Times that the person was somewhere else at once.
    jumps: u64,
    /// Frames a second, all work included.
    rate: f64,
    #[serde(flatten)]
    summary: Summary,
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
        let pipeline = self.pipeline(&reader)?;
        let mut work = Work {
            reader,
            pipeline,
            percepts: Vec::new(),
            tally: Tally::default(),
            started: Instant::now(),
        };
        let ending = work.run(session)?;
        self.finish(work, file, ending, session)
    }
}

impl Options {
    /// Everything that looks at the frames, loaded before the work.
    fn pipeline(&self, reader: &FramesReader) -> Result<Pipeline> {
        let pixel_sigma = self.pixel_sigma;
        let lifting = LiftingSettings { pixel_sigma, ..LiftingSettings::default() };
        let settings = PerceiverSettings { lifting, ..PerceiverSettings::default() };
        let perceiver = Perceiver::new(*reader.camera(), settings)?;
        let threads = self.threads.count();
        let size = reader.camera().intrinsics().size();
        let passes = if self.mirrored { Passes::Mirrored } else { Passes::One };
        let poses: Box<dyn PoseSource> = match (&self.skeletons, &self.pose_weights) {
            (Some(folder), _) => Box::new(SkeletonFolder::open(folder)?),
            (_, Some(weights)) => Box::new(PoseNetwork::load(weights, size, passes, threads)?),
            (None, None) => anyhow::bail!("give --skeletons or --pose-weights"),
        };
        let mut pipeline = Pipeline::new(perceiver, poses);
        let of = &self.surface;
        let decision = of.surface_svm.as_deref().map(SurfaceDecision::Svm);
        let decision = decision.or(of.surface_head.as_deref().map(SurfaceDecision::Head));
        if let (Some(weights), Some(decision)) = (&of.surface_weights, decision) {
            let images = reader.surfaces();
            ensure!(images.is_dir(), "{}: there are no images of a surface", images.display());
            let network = SurfaceNetwork::load(weights, of.surface_depth, decision, threads)?;
            pipeline = pipeline.with_surface(network, of.surface_interval);
        }
        let of = &self.action;
        if let Some(weights) = &of.action_weights {
            let network = ActionNetwork::load(&ActionSettings {
                weights,
                form: of.action_model,
                head: of.action_head.as_deref(),
                names: of.action_names.as_deref(),
                length: of.action_length,
                interval: of.action_interval,
                threads,
            })?;
            pipeline = pipeline.with_action(network);
        }
        Ok(pipeline)
    }
}

/// A run through the frames.
struct Work {
    reader: FramesReader,
    pipeline: Pipeline,
    percepts: Vec<(Percept, Timing)>,
    tally: Tally,
    started: Instant,
}

impl Work {
    fn run(&mut self, session: &Session) -> Result<Ending> {
        let interrupt = session.interrupt().clone();
        let progress = session.open_progress("frames");
        let waiting = Cell::new(false);
        let stop = || {
            // Asked only where the index has no further line yet.
            if !waiting.replace(true) {
                session.note("waiting for further frames");
            }
            interrupt.requested()
        };
        while let Some(entry) = self.reader.next_entry(stop)? {
            let perceived = self.pipeline.perceive(&self.reader, &entry)?;
            self.tally.push(&perceived);
            self.percepts.push((perceived.percept, perceived.timing));
            progress.set(self.tally.frames());
            if interrupt.requested() {
                break;
            }
        }
        progress.finish();
        Ok(if interrupt.requested() { Ending::Partial } else { Ending::Complete })
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
        let estimate = work.pipeline.stature();
        // To the millimetre: its error is larger.
        let rounded = |estimate: StatureEstimate| (estimate.stature * 1e3).round() / 1e3;
        let stature = self.stature.or(estimate.map(rounded));
        // Another stature than the measured one says that the lengths are not to be relied on.
        let segments = match self.stature {
            None => work.pipeline.segments(),
            Some(_) => MeasuredSegments::default(),
        };
        let rate_of_camera = rate(&work.percepts);
        let header = Header { rate: rate_of_camera, stature, segments, ..Header::default() };
        let mut writer = Writer::new(file, &header)?;
        for (percept, timing) in &work.percepts {
            writer.write_timed(percept, timing)?;
        }
        let output = match ending {
            Ending::Partial => writer.finish_partial()?.keep_partial()?,
            _ => writer.finish()?.keep().map(|()| self.output)?,
        };
        let people = work.pipeline.perceiver().people();
        let report = Report {
            output,
            lost: work.reader.lost(),
            stature: estimate.map(|estimate| estimate.stature),
            stature_standard_error: estimate.map(|estimate| estimate.standard_error),
            jumps: people.tracks().iter().map(PersonTrack::jumps).sum(),
            rate: work.tally.frames() as f64 / elapsed.max(1e-9),
            summary: work.tally.finish(),
            peak_memory_mib: peak_memory(),
        };
        print(&report, session)?;
        session.print_json(self.json, &report, ending)?;
        Ok(ending)
    }
}

fn print(report: &Report, session: &mut Session) -> Result<()> {
    let Report { output, lost, summary, .. } = report;
    let Summary { frames, without_skeletons, with_body, with_action, with_surface, .. } = summary;
    let out = session.output();
    writeln!(out, "{}: {frames} camera frames, the person in {with_body}", shown(output))?;
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
        writeln!(out, "  never seen: {}, loads, holds, support, how long", never.join(", "))?;
    }
    let times = &summary.lifting_and_tracking;
    writeln!(
        out,
        "lifting and tracking {:.0} µs a frame, {:.0} µs at most; {:.0} frames a second in all",
        times.median_us, times.max_us, report.rate
    )?;
    Ok(())
}

fn shown(path: &Path) -> impl std::fmt::Display + '_ {
    path.display()
}

/// Frames a second, from the time stamps.
fn rate(percepts: &[(Percept, Timing)]) -> f64 {
    match (percepts.first(), percepts.last()) {
        (Some((first, _)), Some((last, _))) if last.time > first.time => {
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
