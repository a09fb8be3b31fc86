//! Scores of an array, and their time.

use std::{
    io::Write,
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Context, Result};
use clap::Args;
use human_perception::{networks::ArrayNetwork, npy::write_array};
use ndarray::ArrayD;
use serde::Serialize;
use vision_models::NetworkKind;

use super::Results;
use crate::{
    program::{Ending, ProgramError, Session},
    vision::choices::with_option,
};

/// Options for arrays.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Arrays")]
pub struct ArrayOptions {
    /// Write the features of the average pool instead of the logits.
    #[arg(long)]
    features: bool,
    /// The output of a network of TensorFlow Lite to compute and write, counted from 0. Default: all are computed, and
    /// the first is written.
    #[arg(long, value_name = "INDEX")]
    map: Option<usize>,
    /// Number of runs; the first one is not counted if there are more.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Timed {
    network: String,
    output: Option<PathBuf>,
    /// Inputs, and classes or features; joints, rows and columns of a pose network.
    shape: Vec<usize>,
    load_s: f64,
    #[serde(flatten)]
    times: Times,
    gflop_per_s: f64,
}

/// The times of the runs, without the first if there are more.
#[derive(Clone, Copy, Serialize)]
struct Times {
    /// Number of counted runs.
    runs: usize,
    median_s: f64,
    minimum_s: f64,
}

impl Times {
    fn of(times: &mut [f64]) -> Self {
        let counted = if times.len() > 1 { &mut times[1..] } else { times };
        counted.sort_by(f64::total_cmp);
        let runs = counted.len();
        let median_s = 0.5 * (counted[(runs - 1) / 2] + counted[runs / 2]);
        Self { runs, median_s, minimum_s: counted[0] }
    }
}

impl ArrayOptions {
    /// Runs the network on an array, writes its scores and prints the time.
    ///
    /// # Errors
    /// The file that is wrong.
    pub fn run(
        self,
        (kind, weights): (Option<NetworkKind>, &Path),
        input: &Path,
        threads: usize,
        session: &mut Session,
        mut results: Results,
    ) -> Result<Ending> {
        let start = Instant::now();
        let network = match kind {
            Some(kind) => ArrayNetwork::load(kind, weights, input, threads, &mut session.watch()),
            None => ArrayNetwork::load_file(weights, self.map, input, threads),
        };
        let mut network = network.map_err(|error| with_option(error, ""))?;
        let load_s = start.elapsed().as_secs_f64();
        writeln!(session.output(), "loaded in {load_s:.3} s")?;
        let operations = network.operations();

        let progress = session.progress("runs", u64::from(self.repeat));
        let repeat = self.repeat as usize;
        let mut times = Vec::new();
        let mut result = ArrayD::default(vec![0]);
        while times.len() < repeat && !session.interrupt().requested() {
            let start = Instant::now();
            let scores = network.run(self.features)?;
            times.push(start.elapsed().as_secs_f64());
            result = scores.as_standard_layout().into_owned();
            progress.set(times.len() as u64);
        }
        progress.finish();
        if times.is_empty() {
            return Err(ProgramError::Interrupted.into());
        }
        let mut output = None;
        if let Some(file) = results.file() {
            let path = file.path().to_owned();
            write_array(file, &result)
                .with_context(|| format!("cannot write {}", path.display()))?;
            output = Some(path);
        }
        // The scores of all runs are the same, so that they are complete after the first.
        results.keep_whole()?;
        let ending = if times.len() < repeat { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {} of {repeat} runs", times.len()));
        }
        let times = Times::of(&mut times);
        let Times { median_s, minimum_s, .. } = times;
        let gflop_per_s = 1e-9 * operations / median_s;
        writeln!(
            session.output(),
            "median {:.3} ms, minimum {:.3} ms, {gflop_per_s:.1} GFLOP/s",
            1e3 * median_s,
            1e3 * minimum_s
        )?;
        let network = kind.map_or_else(|| "TensorFlow Lite".into(), |kind| kind.to_string());
        let shape = result.shape().to_vec();
        let timed = Timed { network, output, shape, load_s, times, gflop_per_s };
        results.conclude(session, &timed, ending)
    }
}
