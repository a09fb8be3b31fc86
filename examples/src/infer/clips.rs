//! Recognition of the action in a folder of frames.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use human_perception::{
    actions::{clips::frames_of, model::ActionModel, window::Window},
    frames::Picture,
    learning::backbone::Weights,
    networks::{
        ClipClassifier, ClipScores,
        clip_stream::ClipStream,
        names,
        top_k::{ScoredClass, check_names, top_classes, write_top_classes},
    },
};
use serde::Serialize;
use vision_models::{
    ClassNames, ClipSampling, Crops, LinearHead, NetworkKind, SlowOnly, SlowOnlyForm,
};

use super::Results;
use crate::{
    program::{Ending, Session},
    vision::choices::with_option,
};

/// Selection of frames of a folder.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Folders of frames")]
pub struct ClipOptions {
    /// Frames of a clip. Default 8.
    #[arg(long)]
    length: Option<usize>,
    /// Frames of the video between two of a clip (mmaction2). Default 4.
    #[arg(long)]
    interval: Option<usize>,
    /// Choose the frames like mmaction2 before 1.0 and trained models.
    #[arg(long)]
    before1: bool,
    /// Clips of the video (mmaction2); the probabilities are the mean over all.
    #[arg(long, default_value_t = 1, conflicts_with = "live")]
    clips: usize,
    /// The parts of the frames to use.
    #[arg(long, default_value = "centre", conflicts_with = "live")]
    crops: CropsOption,
    /// Decide while frames come, as from a camera, over the last clip. Print each decision with its latency, from
    /// reading the frame to the probabilities.
    #[arg(long)]
    live: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CropsOption {
    /// The middle part.
    Centre,
    /// Both ends and the middle.
    Three,
    /// Corners and middle, and their mirror images.
    Ten,
}

/// A network for clips that is not loaded yet.
#[derive(Debug)]
pub struct ClipNetwork {
    window: Window,
    weights: Weights,
    head: Option<LinearHead>,
    names: Option<(Option<PathBuf>, ClassNames)>,
    /// Least number of frames.
    least: usize,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Recognised {
    /// Classes of all frames, or of the last decision for live frames.
    classes: Vec<ScoredClass>,
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<Live>,
    #[serde(flatten)]
    whole: Option<Whole>,
}

/// Results for the frames as a whole.
#[derive(Serialize)]
struct Whole {
    /// Number of clips.
    clips: usize,
    /// Number of clips and crops whose probabilities were averaged.
    views: usize,
    /// Time for a window without loading \[s\].
    seconds_per_window: f64,
}

#[derive(Serialize)]
struct Live {
    frames: usize,
    decisions: usize,
    decisions_per_second: Option<f64>,
    latency_median_s: Option<f64>,
    latency_p95_s: Option<f64>,
    /// The most probable class of each decision.
    decided: Vec<Decided>,
}

#[derive(Serialize)]
struct Decided {
    frame: usize,
    class: String,
    probability: f32,
    latency_s: f64,
}

impl ClipOptions {
    /// Creates a network with its own last layer.
    pub fn own(
        self,
        form: SlowOnlyForm,
        weights: PathBuf,
        names: Option<(&Path, ClassNames)>,
    ) -> ClipNetwork {
        let network = names::name_of(NetworkKind::SlowOnly(form)).unwrap_or_default().to_owned();
        let (length, interval) = (self.length.unwrap_or(8), self.interval.unwrap_or(4));
        ClipNetwork {
            window: Window { network, length, interval, side: 256 },
            weights: Weights::File(weights),
            head: None,
            names: names.map(|(file, names)| (Some(file.to_owned()), names)),
            least: 1,
        }
    }

    /// Creates a trained model with the network of these weights.
    ///
    /// # Errors
    /// An option that the model determines itself.
    pub fn model(self, model: ActionModel, weights: Weights) -> Result<ClipNetwork> {
        ensure!(
            self.length.is_none() && self.interval.is_none(),
            "--length and --interval: a trained model sees clips as in its training"
        );
        let names = model.head.classes().join("\n").parse()?;
        let least = model.window.length;
        let (window, head) = (model.window, Some(model.head));
        Ok(ClipNetwork { window, weights, head, names: Some((None, names)), least })
    }

    fn sampling(self, network: &ClipNetwork, form: SlowOnlyForm) -> ClipSampling {
        let (Window { length, interval, .. }, clips) = (network.window.clone(), self.clips);
        match form {
            _ if self.before1 || network.head.is_some() => {
                ClipSampling::Mmaction2Before1 { length, interval, clips }
            }
            SlowOnlyForm::PyTorchVideo => ClipSampling::PyTorchVideo { length },
            _ => ClipSampling::Mmaction2 { length, interval, clips },
        }
    }

    /// Recognises the action in a folder of frames, and prints the most probable classes.
    ///
    /// # Errors
    /// The file or the option that is wrong.
    pub fn run(
        self,
        network: ClipNetwork,
        folder: &Path,
        threads: usize,
        session: &mut Session,
        mut results: Results,
    ) -> Result<Ending> {
        let Window { length, interval, .. } = network.window;
        let least = if self.live { (length.max(1) - 1) * interval + 1 } else { network.least };
        let frames = frames_of(folder, least, &mut session.watch())?;
        let sampling = self.sampling(&network, network.window.form()?);
        let clips =
            sampling.indices(frames.len()).map_err(|error| with_option(error.into(), ""))?;
        let (loaded, names) = network.load(threads, session)?;
        let crops = match self.crops {
            CropsOption::Centre => Crops::Centre,
            CropsOption::Three => Crops::Three,
            CropsOption::Ten => Crops::Ten,
        };
        let preprocessing = network.window.preprocessing(crops)?;
        let (report, ending) = if self.live {
            let stream = ClipStream::new(loaded, length, preprocessing, network.head)?;
            live(stream, interval, &frames, names.as_ref(), (session, &mut results))?
        } else {
            let mut classifier = ClipClassifier::new(loaded, preprocessing, network.head);
            let start = Instant::now();
            let scores = classifier.run(&frames, &clips, &mut session.watch())?;
            let seconds = start.elapsed().as_secs_f64();
            let ClipScores { probabilities, clips: seen, views } = scores;
            if seen == 0 {
                session.interrupt().check()?;
            }
            let whole = Whole { clips: seen, views, seconds_per_window: seconds / seen as f64 };
            let classes = top_classes(&probabilities, names.as_ref());
            let report = Recognised { classes, live: None, whole: Some(whole) };
            (report, ending_of(seen, clips.len(), "clips", session))
        };
        write_top_classes(results.writer(session), &report.classes)?;
        results.conclude(session, &report, ending)
    }
}

impl ClipNetwork {
    /// The network with the names of its classes.
    fn load(&self, threads: usize, session: &Session) -> Result<(SlowOnly, Option<ClassNames>)> {
        let backbone = self.window.backbone(self.weights.clone(), threads)?;
        let network =
            backbone.load(&mut session.watch()).map_err(|error| with_option(error, ""))?;
        let names = match &self.names {
            Some((file, names)) => {
                if let Some(file) = file {
                    check_names(file, names, network.classes())?;
                }
                Some(names.clone())
            }
            None => {
                Some(ClassNames::hri30()).filter(|names| names.names().len() == network.classes())
            }
        };
        Ok((network, names))
    }
}

fn ending_of(seen: usize, all: usize, what: &str, session: &Session) -> Ending {
    if seen == all {
        return Ending::Complete;
    }
    session.warn(format_args!("interrupted after {seen} of {all} {what}"));
    Ending::Partial
}

/// Decides on the frames one after the other, as from a camera.
fn live(
    mut stream: ClipStream,
    interval: usize,
    frames: &[PathBuf],
    names: Option<&ClassNames>,
    (session, results): (&mut Session, &mut Results),
) -> Result<(Recognised, Ending)> {
    let progress = session.progress("frames", frames.len() as u64);
    let (mut decided, mut last) = (Vec::new(), Vec::new());
    let mut seen = 0;
    for (number, frame) in frames.iter().enumerate() {
        if session.interrupt().requested() {
            break;
        }
        let start = Instant::now();
        // One frame of each interval goes into the window.
        let pushed = number
            .is_multiple_of(interval)
            .then(|| stream.push(&Picture::File(frame.clone())))
            .transpose()?;
        if let Some(probabilities) = pushed.flatten() {
            let latency_s = start.elapsed().as_secs_f64();
            let best = vision_models::top_k(&probabilities, 1).first().copied().unwrap_or_default();
            let label = names.and_then(|names| names.label(best));
            let class = label.unwrap_or_else(|| format!("class {best}"));
            let probability = probabilities.get(best).copied().unwrap_or(f32::NAN);
            let out = results.writer(session);
            progress.suspend(|| {
                let (percent, milliseconds) = (100.0 * probability, 1e3 * latency_s);
                writeln!(out, "frame {number}: {class} {percent:.2} %, {milliseconds:.1} ms")
            })?;
            decided.push(Decided { frame: number, class, probability, latency_s });
            last = probabilities;
        }
        seen += 1;
        progress.set(seen as u64);
    }
    progress.finish();
    let ending = ending_of(seen, frames.len(), "frames", session);
    let mut latencies: Vec<f64> = decided.iter().map(|decided| decided.latency_s).collect();
    latencies.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
        let place = (share * latencies.len().saturating_sub(1) as f64).ceil() as usize;
        latencies.get(place).copied()
    };
    let total: f64 = latencies.iter().sum();
    let live = Live {
        frames: frames.len(),
        decisions: decided.len(),
        decisions_per_second: (total > 0.0).then(|| decided.len() as f64 / total),
        latency_median_s: quantile(0.5),
        latency_p95_s: quantile(0.95),
        decided,
    };
    if let (Some(rate), Some(p95)) = (live.decisions_per_second, live.latency_p95_s) {
        let decisions = live.decisions;
        writeln!(
            results.writer(session),
            "{decisions} decisions, {rate:.2} a second, 95 % of them within {:.1} ms\nthe last:",
            1e3 * p95
        )?;
    }
    let classes = top_classes(&last, names);
    Ok((Recognised { classes, live: Some(live), whole: None }, ending))
}
