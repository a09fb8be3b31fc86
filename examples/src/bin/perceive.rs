//! Makes a recording of camera frames. It finds joints, lifts them into the world and tracks the person who works with
//! the robot. It measures their posture, and recognises their action and the object's surface.

use std::{
    cell::Cell,
    path::PathBuf,
    process::ExitCode,
    time::{Duration, Instant},
};

#[cfg(feature = "ros2")]
use anyhow::Context;
use anyhow::{Result, ensure};
use clap::{ArgGroup, Args, Parser, ValueEnum};
use examples::posture::PostureOptions;
use examples::program::{self, Ending, OutputFile, Printing, Program, Session, Threads};
#[cfg(feature = "ros2")]
use examples::settings::{RobotSettings, SettingsFile};
#[cfg(feature = "ros2")]
use examples::vision::ros2::Ros2Source;
use examples::vision::{
    action_options::ActionOptions,
    choices::{self, with_option},
    live::LiveWriter,
    report::{Report, peak_memory, print},
    source::Source,
};
use human_perception::{
    Error, Watch,
    frames::truth,
    percepts::{
        AgainstTruth, Perceiver, PerceiverSettings, Pipeline, PoseNetwork, PoseSource,
        SkeletonFolder, SurfaceDecision, SurfaceNetwork, Tally,
    },
};
use moca_model::IntentionFilter;
use percept_recording::{Header, MeasuredSegments, Timing, Writer};
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
    /// The folder of frames. A camera on the ROS 2 graph takes only its place in the world from there, in camera.json.
    frames: PathBuf,
    /// The recording to write (JSON Lines).
    #[cfg_attr(
        feature = "ros2",
        arg(long, short, value_name = "FILE", required_unless_present = "ros2")
    )]
    #[cfg_attr(not(feature = "ros2"), arg(long, short, value_name = "FILE", required = true))]
    output: Option<PathBuf>,
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
    /// Take colour, aligned depth and geometry of a camera on the ROS 2 graph of `ROS_DOMAIN_ID`, and publish people, action
    /// and surface there.
    #[cfg(feature = "ros2")]
    #[arg(long, requires = "live", conflicts_with = "output")]
    ros2: bool,
    /// Take the names of topics, and the place of the camera, from this file of settings.
    #[cfg(feature = "ros2")]
    #[arg(long, value_name = "FILE", requires = "ros2")]
    settings: Option<PathBuf>,
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
    printing: Printing,
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

impl Program for Options {
    fn run(self, session: &mut Session) -> Result<Ending> {
        ensure!((0.0..=86_400.0).contains(&self.wait), "--wait {}: give 0 to 86400 s", self.wait);
        ensure!(
            !self.live || self.wait > 0.0,
            "--live: say with --wait how long the camera may be silent, in seconds"
        );
        let file = match &self.output {
            Some(output) if !self.live => Some(OutputFile::create(output)?),
            _ => None,
        };
        let (source, published) = self.source(session)?;
        let pipeline = self.pipeline(&source, &mut session.watch())?;
        let truth = self.truth.as_deref().map(truth::read).transpose()?;
        let stature = self.stature.or(source.stature());
        let live = match &self.output {
            Some(output) if self.live => Some(LiveWriter::create(output, stature)?),
            _ => published,
        };
        let mut work = Work {
            live,
            has_body: false,
            source,
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
    /// The source of frames, and the publisher of percepts on its ROS 2 graph.
    #[cfg(feature = "ros2")]
    fn source(&self, session: &Session) -> Result<(Source, Option<LiveWriter>)> {
        let wait = Duration::from_secs_f64(self.wait);
        if !self.ros2 {
            return Ok((Source::folder(&self.frames, wait, self.live)?, None));
        }
        let settings = match &self.settings {
            Some(path) => SettingsFile::read(path)
                .and_then(|file| file.over(&RobotSettings::default()))
                .with_context(|| path.display().to_string())?,
            None => RobotSettings::default(),
        };
        let on_board = self.surface.is_given();
        let stop = || session.interrupt().requested();
        let (source, publisher) = Ros2Source::join(&self.frames, &settings, on_board, wait, stop)?;
        let live = LiveWriter::publishing(publisher, settings.camera.frame.name());
        Ok((Source::Ros2(Box::new(source)), Some(live)))
    }

    /// The source of frames.
    #[cfg(not(feature = "ros2"))]
    fn source(&self, _: &Session) -> Result<(Source, Option<LiveWriter>)> {
        let wait = Duration::from_secs_f64(self.wait);
        Ok((Source::folder(&self.frames, wait, self.live)?, None))
    }

    /// Makes the parts that process the frames, loaded before the work.
    fn pipeline(&self, source: &Source, watch: &mut Watch<'_>) -> Result<Pipeline> {
        let pixel_sigma = self.pixel_sigma;
        let lifting = LiftingSettings { pixel_sigma, ..LiftingSettings::default() };
        let settings = PerceiverSettings { lifting, ..PerceiverSettings::default() };
        let perceiver = Perceiver::new(*source.camera(), settings)?;
        let threads = self.threads.count();
        let size = source.camera().intrinsics().size();
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
            source.check_surfaces()?;
            pipeline = pipeline.with_surface(network, self.surface.surface_interval);
        }
        // While the camera goes on the action is recognised beside the joints, which need cores, too.
        let action_threads = if self.live { threads.div_ceil(2) } else { threads };
        if let Some(network) = self.action.network(action_threads, watch)? {
            pipeline = if self.live {
                pipeline.with_action_beside(network)
            } else {
                pipeline.with_action(network)
            };
        }
        Ok(pipeline)
    }
}

impl SurfaceOptions {
    /// True if surfaces are to be recognised.
    #[cfg(feature = "ros2")]
    fn is_given(&self) -> bool {
        self.surface_model.is_some() || self.surface_weights.is_some()
    }

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
    source: Source,
    pipeline: Pipeline,
    percepts: Vec<(Percept, Timing)>,
    /// The other people of each percept.
    others: Vec<Vec<Body>>,
    truth: Option<Vec<Percept>>,
    live: Option<LiveWriter>,
    /// True if somebody was seen.
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
        while let Some((entry, images)) = self.source.next(stop)? {
            self.first.get_or_insert(entry.frame);
            let mut perceived = match images.and_then(|images| self.pipeline.perceive(&images)) {
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
                live.write(&mut perceived, self.pipeline.perceiver())?;
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
                    Ending::Partial => Some(writer.finish_partial()?.keep_partial()?),
                    _ => writer.finish()?.keep().map(|()| self.output)?,
                }
            }
        };
        let late = work.source.late();
        let mut filter = IntentionFilter::new();
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
            lost: work.source.lost(),
            broken: work.broken,
            stature: estimate.map(|estimate| estimate.stature),
            stature_standard_error: estimate.map(|estimate| estimate.standard_error),
            jumps: people.tracks().iter().map(PersonTrack::jumps).sum(),
            rate: work.tally.frames() as f64 / elapsed.max(1e-9),
            summary: work.tally.finish(),
            truth: against_truth,
            live: work.live.map(|live| live.finish(late)).transpose()?,
            #[cfg(feature = "ros2")]
            ros2: match work.source {
                Source::Ros2(source) => Some(source.close()?),
                Source::Folder(_) => None,
            },
            peak_memory_mib: peak_memory(),
        };
        print(&report, session.output())?;
        session.conclude(self.printing, &report, ending)
    }
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

fn main() -> ExitCode {
    program::main::<Options>()
}
