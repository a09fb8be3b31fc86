//! Parallel runs of independent cases.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::error::Error;

/// First random stream, apart from those of people, cameras and robots.
const STREAM: u64 = 1000;

/// Creates the random generator of a case.
pub fn generator(seed: u64, case: u64) -> ChaCha8Rng {
    simulated_people::generator(seed, STREAM + case)
}

/// Runs the cases with `threads` threads. Returns their results in the order of the cases.
///
/// `each` gets the number of finished cases now and then, from several threads. It may end the runs; the results are
/// then those of the finished cases. Each case gets a function that says whether to go on, which a
/// [`Player`](super::Player) calls in every tick.
///
/// # Errors
/// The error of the first case that fails; [`Error::Threads`].
pub fn play_all<C: Sync, R: Send>(
    cases: &[C],
    threads: usize,
    each: impl Fn(u64) -> ControlFlow<()> + Sync,
    play: impl Fn(&C, &(dyn Fn() -> ControlFlow<()> + Sync)) -> Result<R, Error> + Sync,
) -> Result<Vec<R>, Error> {
    let done = AtomicU64::new(0);
    let go_on = || each(done.load(Ordering::Relaxed));
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Error::Threads)?;
    let results: Result<Vec<Option<R>>, Error> = pool.install(|| {
        let played = cases.par_iter().map(|case| {
            if go_on().is_break() {
                return Ok(None);
            }
            let result = play(case, &go_on)?;
            // A case that was ended early has no result.
            if go_on().is_break() {
                return Ok(None);
            }
            done.fetch_add(1, Ordering::Relaxed);
            Ok(Some(result))
        });
        played.collect()
    });
    // Report the last finished case.
    let _ = go_on();
    Ok(results?.into_iter().flatten().collect())
}
