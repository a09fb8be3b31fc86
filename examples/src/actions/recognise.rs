//! Recognises the action in a folder of frames.

use std::{path::PathBuf, time::Instant};

use anyhow::Result;
use clap::Args;
use serde::Serialize;
use vision_models::{ClassNames, Crops};

use human_perception::{
    actions::{
        clips::frames_of, features::ClipFeatures, live::LiveRecogniser, model::ActionModel,
        window::Views,
    },
    networks::top_k::{ScoredClass, top_classes, write_top_classes},
};

use super::options::ModelWeights;
use crate::{
    program::{Ending, Json, ProgramError, Quiet, ResultFile, Session, Threads},
    vision::{choices::with_option, results::Results},
};

/// Recognises the action in a folder of frames by a trained model, and prints the five most probable classes.
///
/// With --live the frames come one after the other, as from a camera, and each decision is printed with its latency:
/// from reading the frame to the probabilities. Dwell time and hysteresis belong to what acts on the decisions.
#[derive(Args, Debug)]
pub struct Recognise {
    /// A folder of JPEG or PNG files, one a frame, in the order of their names.
    folder: PathBuf,
    /// The folder of the trained model.
    #[arg(long, value_name = "FOLDER")]
    model: PathBuf,
    #[command(flatten)]
    weights: ModelWeights,
    /// Decide as the frames come, over the last window.
    #[arg(long)]
    live: bool,
    /// Windows along the clip, 1 to 64; the probabilities are the mean over all.
    #[arg(
        long,
        default_value_t = 1,
        value_parser = clap::value_parser!(u16).range(1..=64),
        conflicts_with = "live"
    )]
    clips: u16,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    result: ResultFile,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Recognised {
    /// Of a clip as a whole: its classes; of live frames those of the last decision.
    classes: Vec<ScoredClass>,
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<Live>,
    /// Of a clip as a whole: for each window, the loading left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds_per_window: Option<f64>,
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

impl Recognise {
    /// The option `--quiet`.
    pub fn quiet(&self) -> Quiet {
        self.quiet
    }

    /// Recognises it.
    ///
    /// # Errors
    /// With the file or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        let mut results = Results::begin(&self.result)?;
        let model = ActionModel::read(&self.model)?;
        let names: ClassNames = model.head.classes().join("\n").parse()?;
        let (report, ending) = if self.live {
            self.live(&model, &names, session, &mut results)?
        } else {
            self.whole(&model, &names, session)?
        };
        write_top_classes(results.writer(session), &report.classes)?;
        results.keep(ending)?;
        session.conclude(self.json, &report, ending)
    }

    fn whole(
        &self,
        model: &ActionModel,
        names: &ClassNames,
        session: &Session,
    ) -> Result<(Recognised, Ending)> {
        let watch = &mut session.watch();
        let weights = model.weights.weights(self.weights.weights.clone(), watch);
        let weights = weights.map_err(|error| with_option(error, ModelWeights::OPTION))?;
        let source = (weights, &model.weights);
        let mut source =
            ClipFeatures::new(model.window.clone(), source, None, self.threads.count())?;
        let views = Views { clips: self.clips.into(), crops: Crops::Centre };
        // The first loads the network.
        let once = Views { clips: 1, ..views };
        source.of_clip(&self.folder, once, false, watch)?;
        let start = Instant::now();
        let views = source.of_clip(&self.folder, views, false, watch)?;
        let seconds = start.elapsed().as_secs_f64() / f64::from(self.clips);
        let Some(views) = views else { return Err(ProgramError::Interrupted.into()) };
        let classes = top_classes(&model.probabilities(views.view())?, Some(names));
        let report = Recognised { classes, live: None, seconds_per_window: Some(seconds) };
        Ok((report, Ending::Complete))
    }

    fn live(
        &self,
        model: &ActionModel,
        names: &ClassNames,
        session: &mut Session,
        results: &mut Results,
    ) -> Result<(Recognised, Ending)> {
        let window = &model.window;
        let least = (window.length - 1) * window.interval + 1;
        let frames = frames_of(&self.folder, least, &mut session.watch())?;
        let watch = &mut session.watch();
        let weights = model.weights.weights(self.weights.weights.clone(), watch);
        let weights = weights.map_err(|error| with_option(error, ModelWeights::OPTION))?;
        let mut recogniser = LiveRecogniser::new(model, weights, self.threads.count(), watch)?;
        let progress = session.progress("frames", frames.len() as u64);
        let (mut decided, mut last) = (Vec::new(), Vec::new());
        let mut seen = 0;
        for frame in &frames {
            if session.interrupt().requested() {
                break;
            }
            if let Some(decision) = recogniser.push(frame)? {
                let best = vision_models::top_k(&decision.probabilities, 1);
                let best = best.first().copied().unwrap_or_default();
                let class = model.head.classes().get(best).cloned().unwrap_or_default();
                let probability = decision.probabilities.get(best).copied().unwrap_or(f32::NAN);
                let (number, latency_s) = (decision.frame, decision.latency);
                let out = results.writer(session);
                progress.suspend(|| {
                    let (percent, milliseconds) = (100.0 * probability, 1e3 * latency_s);
                    writeln!(out, "frame {number}: {class} {percent:.2} %, {milliseconds:.1} ms")
                })?;
                decided.push(Decided { frame: number, class, probability, latency_s });
                last = decision.probabilities;
            }
            seen += 1;
            progress.set(seen);
        }
        progress.finish();
        let ending = if seen < frames.len() as u64 { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {seen} of {} frames", frames.len()));
        }
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
        let classes = top_classes(&last, Some(names));
        Ok((Recognised { classes, live: Some(live), seconds_per_window: None }, ending))
    }
}
