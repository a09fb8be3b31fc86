//! Makes a recording of camera frames. It finds joints, lifts them into the world and tracks the person who works with
//! the robot. It measures their posture, and recognises their action and the object's surface.

use std::{
    cell::Cell,
    io::Write,
    path::{Path, PathBuf},
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Result, ensure};
use clap::{ArgGroup, Args, Parser, ValueEnum};
use examples::posture::PostureOptions;
use examples::program::{self, Ending, Json, OutputFile, Program, Quiet, Session, Threads};
use examples::vision::{
    action_options::ActionOptions,
    choices::{self, with_option},
    live::{LiveReport, LiveWriter},
};
use human_perception::{
    Error, Watch,
    frames::{FrameEntry, FramesReader, truth},
    percepts::{
        AgainstTruth, Perceiver, PerceiverSettings, Pipeline, PoseNetwork, PoseSource,
        SkeletonFolder, Summary, SurfaceDecision, SurfaceNetwork, Tally,
    },
};
use moca_model::{IntentionFilter, IntentionSettings};
use percept_recording::{Header, MeasuredSegments, Timing, Writer};
use serde::Serialize;
use vision_models::{
    Body, LiftingSettings, Passes, Percept, PersonTrack, ResNetDepth, StatureEstimate,
};

/// Makes a recording, as `follow` plays it, of a folder of camera frames with depth.
///
/// The folder has camera.json, frames.jsonl and depth/, as `record --frames` writes them, and colour/ and surface/ for
/// networks. Joints come from a pose network or from OpenPose's JSON.
///
/// A frame with an unusable file is named and left out; the exit status is then 1. Ctrl-C ends early and keeps the
/// results so far in a file named *.partial.*.
#[derive(Debug, Parser)]
#[command(version, group(ArgGroup::new("joints").required(true)))]
struct Options {
    /// The folder of frames.
    frames: PathBuf,
    /// The recording to write (JSON Lines).
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// The folder of joints, a file a frame such as 000012_keypoints.json or 000000000012_keypoints.json: JSON of OpenPose,
    /// mmpose, AlphaPose, COCO or MediaPipe.
    #[arg(long, value_name = "FOLDER", group = "joints")]
    skeletons: Option<PathBuf>,
    /// The weights of a pose network. Their tensors identify a simple baseline or OpenPose. A .tflite of MediaPipe's
    /// package @mediapipe/pose is BlazePose's landmark network.
    #[arg(long, visible_alias = "pose", value_name = "FILE", group = "joints")]
    pose_weights: Option<PathBuf>,
    /// BlazePose's detector. Default pose_solution_packed_assets.data beside the landmarks.
    #[arg(long, value_name = "FILE", requires = "pose_weights")]
    pose_detector: Option<PathBuf>,
    /// The largest number of people whom BlazePose tracks.
    #[arg(long, value_name = "COUNT", default_value_t = 1, requires = "pose_weights")]
    pose_people: usize,
    /// Let the simple baseline also use the mirrored image: better joints for twice the time.
    #[arg(long, requires = "pose_weights")]
    mirrored: bool,
    #[command(flatten)]
    surface: SurfaceOptions,
    #[command(flatten)]
    action: ActionOptions,
    #[command(flatten)]
    threads: Threads,
    /// Time to wait for the next frame of a growing folder (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    wait: f64,
    /// Process only the newest frame of a growing folder, and write each percept at once, into a file or a pipe. Times
    /// of frames must be of the system's clock (s since 1970). Frames that a newer one overtakes are counted.
    #[arg(long, conflicts_with = "truth")]
    live: bool,
    /// Standard deviation of the joints in the image, each axis (pixels).
    #[arg(long, value_name = "PIXELS", default_value_t = LiftingSettings::default().pixel_sigma)]
    pixel_sigma: f64,
    /// Compare with this recording of the truth, as `record --frames` writes it. Prints shares of time with the right
    /// surface, action and intention.
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// The person's stature (m), in place of the measured one.
    #[arg(long, value_name = "METRES")]
    stature: Option<f64>,
    #[command(flatten)]
    posture: PostureOptions,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// Recognition of the surface in the images of the on-board camera.
#[derive(Args, Debug)]
#[command(group(ArgGroup::new("surface_network").multiple(true)))]
#[expect(clippy::struct_field_names, reason = "they are the options' names")]
struct SurfaceOptions {
    /// The folder that `surface train` has made, whose model recognises the surface.
    #[arg(long, value_name = "FOLDER", group = "surface_network")]
    surface_model: Option<PathBuf>,
    /// The weights of the ResNet that the model was trained with, unless they are random. If there is no model, the
    /// weights of a ResNet whose own last layer has the classes drilled and smooth.
    #[arg(long, value_name = "FILE", group = "surface_network")]
    surface_weights: Option<PathBuf>,
    /// The number of its layers: 50 if there is no model; needed for a model with several networks.
    #[arg(long, value_parser = choices::depth(), requires = "surface_network")]
    surface_depth: Option<ResNetDepth>,
    /// The part of the model that decides.
    #[arg(long, default_value = "svm", requires = "surface_model")]
    surface_decision: DecisionOption,
    /// Number of camera frames between two recognitions of the surface.
    #[arg(long, value_name = "FRAMES", default_value_t = 10, requires = "surface_network")]
    surface_interval: u64,
}

/// The part of a trained model that decides.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum DecisionOption {
    /// The support vector machine.
    Svm,
    /// The new last layer.
    Head,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Report {
    output: PathBuf,
    /// Number of frames that the camera lost.
    lost: u64,
    /// Number of frames that are left out because of an unusable file.
    broken: u64,
    /// Measured stature \[m\].
    stature: Option<f64>,
    stature_standard_error: Option<f64>,
    /// Number of times that the person was suddenly at another place.
    jumps: u64,
    /// Frames a second, with all work.
    rate: f64,
    #[serde(flatten)]
    summary: Summary,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<AgainstTruth>,
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<LiveReport>,
    /// Peak memory of the process (MiB), if the system reports it.
    peak_memory_mib: Option<f64>,
}

impl Program for Options {
    fn quiet(&self) -> Quiet {
        self.quiet
    }

    fn run(self, session: &mut Session) -> Result<Ending> {
        ensure!((0.0..=86_400.0).contains(&self.wait), "--wait {}: give 0 to 86400 s", self.wait);
        ensure!(
            !self.live || self.wait > 0.0,
            "--live: say with --wait how long the camera may be silent, in seconds"
        );
        let wait = Duration::from_secs_f64(self.wait);
        let file = if self.live { None } else { Some(OutputFile::create(&self.output)?) };
        let reader = FramesReader::open(&self.frames, wait)?;
        let pipeline = self.pipeline(&reader, &mut session.watch())?;
        let truth = self.truth.as_deref().map(truth::read).transpose()?;
        let live = if self.live {
            Some(LiveWriter::create(&self.output, self.stature.or(reader.stature()))?)
        } else {
            None
        };
        let mut work = Work {
            live,
            late: 0,
            has_body: false,
            reader,
            pipeline,
            percepts: Vec::new(),
            others: Vec::new(),
            truth,
            tally: Tally::default(),
            started: Instant::now(),
            first: None,
            broken: 0,
            last_broken: None,
        };
        let ending = work.run(session)?;
        self.finish(work, file, ending, session)
    }
}

impl Options {
    /// All parts that process the frames, loaded before the work.
    fn pipeline(&self, reader: &FramesReader, watch: &mut Watch<'_>) -> Result<Pipeline> {
        let pixel_sigma = self.pixel_sigma;
        let lifting = LiftingSettings { pixel_sigma, ..LiftingSettings::default() };
        let settings = PerceiverSettings { lifting, ..PerceiverSettings::default() };
        let perceiver = Perceiver::new(*reader.camera(), settings)?;
        let threads = self.threads.count();
        let size = reader.camera().intrinsics().size();
        let passes = if self.mirrored { Passes::Mirrored } else { Passes::One };
        let poses: Box<dyn PoseSource> = match (&self.skeletons, &self.pose_weights) {
            (Some(folder), _) => Box::new(SkeletonFolder::open(folder)?),
            (_, Some(weights)) => {
                let people = (self.pose_detector.as_deref(), self.pose_people);
                Box::new(PoseNetwork::load(weights, people, size, passes, threads, watch)?)
            }
            (None, None) => anyhow::bail!("give --skeletons or --pose-weights"),
        };
        let mut pipeline = Pipeline::new(perceiver, poses).with_posture(self.posture.settings()?);
        if let Some(network) = self.surface.network(threads, watch)? {
            let images = reader.surfaces();
            ensure!(images.is_dir(), "{}: there are no images of a surface", images.display());
            pipeline = pipeline.with_surface(network, self.surface.surface_interval);
        }
        if let Some(network) = self.action.network(threads, watch)? {
            pipeline = pipeline.with_action(network);
        }
        Ok(pipeline)
    }
}

impl SurfaceOptions {
    /// The network of the options.
    fn network(&self, threads: usize, watch: &mut Watch<'_>) -> Result<Option<SurfaceNetwork>> {
        let depth = self.surface_depth;
        let decision = match self.surface_decision {
            DecisionOption::Svm => SurfaceDecision::Svm,
            DecisionOption::Head => SurfaceDecision::Head,
        };
        let with_option = |error| with_option(error, "--surface-weights FILE");
        Ok(match (&self.surface_model, &self.surface_weights) {
            (Some(folder), weights) => {
                let weights = weights.clone();
                let own = (depth, decision);
                let network = SurfaceNetwork::of_model(folder, own, weights, threads, watch);
                Some(network.map_err(with_option)?)
            }
            (None, Some(weights)) => {
                let depth = depth.unwrap_or(ResNetDepth::Fifty);
                Some(SurfaceNetwork::load(weights, depth, threads, watch).map_err(with_option)?)
            }
            (None, None) => None,
        })
    }
}

/// A run over the frames.
struct Work {
    reader: FramesReader,
    pipeline: Pipeline,
    percepts: Vec<(Percept, Timing)>,
    /// The other people of each percept.
    others: Vec<Vec<Body>>,
    truth: Option<Vec<Percept>>,
    live: Option<LiveWriter>,
    /// Number of frames that a newer one overtook.
    late: u64,
    /// Whether somebody was seen.
    has_body: bool,
    tally: Tally,
    started: Instant,
    /// Number of the first frame.
    first: Option<u64>,
    /// Number of frames with an unusable file.
    broken: u64,
    last_broken: Option<Error>,
}

/// Largest number of left-out frames that are named.
const MOST_NAMED: u64 = 5;

impl Work {
    /// The next frame, or the newest one if others wait for it.
    fn next_entry(&mut self, stop: impl Fn() -> bool) -> Result<Option<FrameEntry>> {
        if self.live.is_none() {
            return Ok(self.reader.next_entry(stop)?);
        }
        let newest = self.reader.newest_entry(stop)?;
        Ok(newest.map(|(entry, left_out)| {
            self.late += left_out;
            entry
        }))
    }

    fn run(&mut self, session: &Session) -> Result<Ending> {
        let interrupt = session.interrupt().clone();
        let progress = session.open_progress("frames");
        let waiting = Cell::new(false);
        let stop = || {
            // The interrupt is only checked while the index has no further line.
            if !waiting.replace(true) {
                session.note("waiting for further frames");
            }
            interrupt.requested()
        };
        while let Some(entry) = self.next_entry(stop)? {
            self.first.get_or_insert(entry.frame);
            let mut perceived = match self.pipeline.perceive(&self.reader, &entry) {
                Ok(perceived) => perceived,
                Err(broken @ Error::Frame(_)) => {
                    self.broken += 1;
                    if self.broken <= MOST_NAMED {
                        progress.note(format_args!("frame {} left out: {broken}", entry.frame));
                    }
                    self.last_broken = Some(broken);
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            self.tally.push(&perceived);
            self.has_body |= perceived.percept.body.is_some();
            if let Some(live) = &mut self.live {
                live.write(&mut perceived)?;
            } else {
                self.percepts.push((perceived.percept, perceived.timing));
                self.others.push(perceived.others);
            }
            progress.set(self.tally.frames());
            if interrupt.requested() {
                break;
            }
        }
        progress.finish();
        if self.broken > MOST_NAMED {
            session.warn(format_args!("{} frames were left out", self.broken));
        }
        let nobody = !self.has_body;
        if nobody && let Some(broken) = self.last_broken.take() {
            let text = format!("nobody was found, and {} frames cannot be used", self.broken);
            return Err(anyhow::Error::new(broken).context(text));
        }
        if interrupt.requested() {
            return Ok(Ending::Partial);
        }
        if nobody {
            self.pipeline.check_sightings(self.first.unwrap_or_default())?;
            session.warn("nobody was seen long enough to be followed: the recording is of nobody");
        }
        Ok(if self.broken > 0 { Ending::Failed } else { Ending::Complete })
    }
}

impl Options {
    fn finish(
        self,
        work: Work,
        file: Option<OutputFile>,
        ending: Ending,
        session: &mut Session,
    ) -> Result<Ending> {
        let elapsed = work.started.elapsed().as_secs_f64();
        let estimate = work.pipeline.stature();
        // Statures are rounded to the millimetre, which is less than their error.
        let rounded = |estimate: StatureEstimate| (estimate.stature * 1e3).round() / 1e3;
        let stature = self.stature.or(estimate.map(rounded));
        // A given stature other than the measured one means that the lengths are not reliable.
        let segments = match self.stature {
            None => work.pipeline.segments(),
            Some(_) => MeasuredSegments::default(),
        };
        let rate_of_camera = rate(&work.percepts);
        let header = Header { rate: rate_of_camera, stature, segments, ..Header::default() };
        let output = match file {
            None => self.output,
            Some(file) => {
                let mut writer = Writer::new(file, &header)?;
                for ((percept, timing), others) in work.percepts.iter().zip(&work.others) {
                    writer.write_people(percept, others, timing)?;
                }
                match ending {
                    Ending::Partial => writer.finish_partial()?.keep_partial()?,
                    _ => writer.finish()?.keep().map(|()| self.output)?,
                }
            }
        };
        let late = work.late;
        let mut filter = IntentionFilter::new(IntentionSettings::default())?;
        let compare = |truth: &Vec<Percept>| {
            AgainstTruth::of(&work.percepts, truth, |percept| {
                filter.update(percept.time, percept.action.as_ref());
                filter.intention()
            })
        };
        let against_truth = work.truth.as_ref().map(compare);
        let people = work.pipeline.perceiver().people();
        let report = Report {
            output,
            lost: work.reader.lost(),
            broken: work.broken,
            stature: estimate.map(|estimate| estimate.stature),
            stature_standard_error: estimate.map(|estimate| estimate.standard_error),
            jumps: people.tracks().iter().map(PersonTrack::jumps).sum(),
            rate: work.tally.frames() as f64 / elapsed.max(1e-9),
            summary: work.tally.finish(),
            truth: against_truth,
            live: work.live.map(|live| live.finish(late)).transpose()?,
            peak_memory_mib: peak_memory(),
        };
        print(&report, session)?;
        session.conclude(self.json, &report, ending)
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

fn shown(path: &Path) -> impl std::fmt::Display + '_ {
    path.display()
}

/// Frames a second from the time stamps.
fn rate(percepts: &[(Percept, Timing)]) -> f64 {
    match (percepts.first(), percepts.last()) {
        (Some((first, _)), Some((last, _))) if last.time > first.time => {
            ((percepts.len() - 1) as f64 / (last.time - first.time)).clamp(1e-3, 1000.0)
        }
        _ => Header::default().rate,
    }
}

/// The peak memory that Linux reports in /proc.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes / 1024.0)
}

fn main() -> ExitCode {
    program::main::<Options>()
}
