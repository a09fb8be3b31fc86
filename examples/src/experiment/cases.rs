//! Independent cases, some at a time.

use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::{Context, Result};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::program::{Ending, Interrupt, Session, Threads};
use moca_simulation::random;

/// Apart from the streams of people, cameras and robots.
const STREAM: u64 = 1000;

/// What the random numbers of a case come from.
pub fn generator(seed: u64, case: u64) -> ChaCha8Rng {
    random::generator(seed, STREAM + case)
}

/// Plays cases with so many threads; what they came to, in the order of the cases. An interrupt ends it
/// with those that were played to their end.
///
/// # Errors
/// The error of the first case that fails.
pub(super) fn play_all<C: Sync, R: Send>(
    session: &Session,
    what: &str,
    threads: Threads,
    cases: &[C],
    play: impl Fn(&C, &Interrupt) -> Result<R> + Sync,
) -> Result<(Vec<R>, Ending)> {
    let progress = session.progress(what, cases.len() as u64);
    let interrupt = session.interrupt();
    let done = AtomicU64::new(0);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.count())
        .build()
        .context("cannot start the threads that play the cases")?;
    let results: Result<Vec<Option<R>>> = pool.install(|| {
        cases
            .par_iter()
            .map(|case| {
                if interrupt.requested() {
                    return Ok(None);
                }
                let result = play(case, interrupt)?;
                progress.set(done.fetch_add(1, Ordering::Relaxed) + 1);
                // A case that an interrupt has cut says nothing.
                Ok((!interrupt.requested()).then_some(result))
            })
            .collect()
    });
    progress.finish();
    let results: Vec<R> = results?.into_iter().flatten().collect();
    let ending = if results.len() < cases.len() { Ending::Partial } else { Ending::Complete };
    Ok((results, ending))
}
