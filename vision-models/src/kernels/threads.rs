//! A pool of threads that share the tasks of each layer.
//!
//! A network is about a hundred short parallel loops. Between two of them the workers spin, because
//! a wake-up takes as long as a small layer. After a while without work they sleep. If other
//! threads need the cores, they can sleep at once.

use std::{
    cell::UnsafeCell,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread::{self, JoinHandle, Thread},
};

/// Number of checks for work before a worker sleeps: some tenths of a millisecond.
const SPINS: usize = 20_000;
/// Number of checks before a thread yields the core.
const SPINS_BEFORE_YIELD: usize = 2_000;

/// Behaviour of threads while there is no work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Waiting {
    /// Threads check for work for some tenths of a millisecond, which occupies their cores, and then
    /// sleep. This is fastest.
    #[default]
    Spinning,
    /// Threads sleep at once. Their cores are free, but every layer costs a wake-up.
    Parking,
}

/// The body of a loop. Its arguments are the lane (which thread) and the task's number.
type Body<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// The current loop.
struct Job {
    body: Body<'static>,
    tasks: usize,
    /// The thread that the last worker wakes, if it sleeps.
    caller: Option<Thread>,
}

/// The state that the caller and the workers share.
struct PoolState {
    /// Counts the loops. A worker that sees it change has work.
    epoch: AtomicUsize,
    /// Written by the owner while no worker works, and read by the workers while they work.
    job: UnsafeCell<Option<Job>>,
    /// The next task.
    next: AtomicUsize,
    /// Number of workers that have not finished this loop.
    pending: AtomicUsize,
    /// True if a task of this loop panicked.
    panicked: AtomicBool,
    /// True if the workers must end.
    stop: AtomicBool,
    /// True for each worker that sleeps or is about to sleep.
    asleep: Vec<AtomicBool>,
    waiting: Waiting,
}

// SAFETY: all fields but `job` are atomic. `job` is written only between loops, when `pending` is
// zero. It is read only after the `epoch` that follows the write was seen (release and acquire).
unsafe impl Sync for PoolState {}
// SAFETY: the body in `job` is `Sync`, and everything else is plain data.
unsafe impl Send for PoolState {}

/// The threads that run a network: the caller's own and some workers.
pub(crate) struct Pool {
    state: Arc<PoolState>,
    workers: Vec<JoinHandle<()>>,
}

impl std::fmt::Debug for Pool {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Pool").field("lanes", &self.lanes()).finish()
    }
}

impl Pool {
    /// Creates a pool of this many threads, the caller's included. The others run on these cores,
    /// or on any if the list is empty.
    ///
    /// # Errors
    /// The operating system's error, if a thread cannot be started or a core does not exist.
    pub(crate) fn new(lanes: usize, cores: &[usize], waiting: Waiting) -> std::io::Result<Self> {
        let workers = lanes.saturating_sub(1);
        let state = Arc::new(PoolState {
            epoch: AtomicUsize::new(0),
            job: UnsafeCell::new(None),
            next: AtomicUsize::new(0),
            pending: AtomicUsize::new(0),
            panicked: AtomicBool::new(false),
            stop: AtomicBool::new(false),
            asleep: (0..workers).map(|_| AtomicBool::new(false)).collect(),
            waiting,
        });
        let mut pool = Self { state, workers: Vec::with_capacity(workers) };
        for worker in 0..workers {
            let state = Arc::clone(&pool.state);
            let handle = thread::Builder::new()
                .name(format!("vision-models {}", worker + 1))
                .spawn(move || work(&state, worker))?;
            pool.workers.push(handle);
        }
        if !cores.is_empty() {
            for worker in &pool.workers {
                super::affinity::restrict(worker, cores)?;
            }
        }
        Ok(pool)
    }

    /// Returns the number of threads, the caller's included.
    pub(crate) fn lanes(&self) -> usize {
        self.workers.len() + 1
    }

    /// Calls `body(lane, task)` for every task below `tasks`, in any order, and returns when all
    /// are done. A lane runs at most one task at a time.
    pub(crate) fn run(&mut self, tasks: usize, body: Body) {
        if self.workers.is_empty() || tasks <= 1 {
            for task in 0..tasks {
                body(0, task);
            }
            return;
        }
        let state = &*self.state;
        // A worker that panicked has ended.
        assert!(!state.panicked.load(Ordering::Relaxed), "a task of the network panicked");
        // SAFETY: only the lifetime changes, and the body is called only before this function
        // returns: the workers are waited for below, even if a task panics.
        let body: Body<'static> = unsafe { std::mem::transmute::<Body<'_>, Body<'static>>(body) };
        let caller = (state.waiting == Waiting::Parking).then(thread::current);
        // SAFETY: `pending` is zero, so no worker reads the job.
        unsafe { *state.job.get() = Some(Job { body, tasks, caller }) };
        state.next.store(0, Ordering::Relaxed);
        state.pending.store(self.workers.len(), Ordering::Relaxed);
        state.epoch.fetch_add(1, Ordering::SeqCst);
        for (worker, asleep) in self.workers.iter().zip(&state.asleep) {
            if asleep.load(Ordering::SeqCst) {
                worker.thread().unpark();
            }
        }
        let waiting = WaitForWorkers(state);
        take_tasks(state, 0, body, tasks);
        drop(waiting);
        // A task that panicked left its layer unfinished.
        assert!(!state.panicked.load(Ordering::Relaxed), "a task of the network panicked");
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        self.state.stop.store(true, Ordering::Relaxed);
        self.state.epoch.fetch_add(1, Ordering::SeqCst);
        for worker in self.workers.drain(..) {
            worker.thread().unpark();
            // A worker ends without a result, or with a panic that `run` has reported.
            let _ = worker.join();
        }
    }
}

/// Waits for all workers when dropped, so that a panic cannot leave them with a dangling body.
struct WaitForWorkers<'a>(&'a PoolState);

impl Drop for WaitForWorkers<'_> {
    fn drop(&mut self) {
        let mut spins = 0;
        while self.0.pending.load(Ordering::Acquire) > 0 {
            match self.0.waiting {
                Waiting::Spinning => pause(&mut spins),
                Waiting::Parking => thread::park(),
            }
        }
    }
}

/// Reports that a worker has finished the loop, even if a task panicked.
struct Finish<'a> {
    state: &'a PoolState,
    /// A separate handle, because the job may be gone as soon as this worker is done.
    caller: Option<Thread>,
}

impl Drop for Finish<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.state.panicked.store(true, Ordering::Relaxed);
        }
        let left = self.state.pending.fetch_sub(1, Ordering::Release);
        if left == 1
            && let Some(caller) = &self.caller
        {
            caller.unpark();
        }
    }
}

fn take_tasks(state: &PoolState, lane: usize, body: Body, tasks: usize) {
    loop {
        let task = state.next.fetch_add(1, Ordering::Relaxed);
        if task >= tasks {
            return;
        }
        body(lane, task);
    }
}

fn work(state: &PoolState, worker: usize) {
    let mut seen = 0;
    loop {
        wait_for_work(state, worker, seen);
        seen += 1;
        if state.stop.load(Ordering::Relaxed) {
            return;
        }
        // SAFETY: the epoch was seen to change, so the job is written, and stays until this
        // worker's `Finish`.
        let job = unsafe { &*state.job.get() };
        let caller = job.as_ref().and_then(|job| job.caller.clone());
        let _finish = Finish { state, caller };
        if let Some(job) = job {
            take_tasks(state, worker + 1, job.body, job.tasks);
        }
    }
}

/// Returns when the epoch differs from `seen`.
fn wait_for_work(state: &PoolState, worker: usize, seen: usize) {
    let mut spins = 0;
    while state.epoch.load(Ordering::SeqCst) == seen {
        if spins < SPINS && state.waiting == Waiting::Spinning {
            pause(&mut spins);
            continue;
        }
        if let Some(asleep) = state.asleep.get(worker) {
            asleep.store(true, Ordering::SeqCst);
            if state.epoch.load(Ordering::SeqCst) == seen {
                thread::park();
            }
            asleep.store(false, Ordering::SeqCst);
        }
    }
}

fn pause(spins: &mut usize) {
    *spins += 1;
    if spins.is_multiple_of(SPINS_BEFORE_YIELD) {
        thread::yield_now();
    } else {
        std::hint::spin_loop();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn every_task_runs_once(lanes in 1..5_usize, loops in prop::collection::vec(0..40_usize, 1..9)) {
            let mut pool = Pool::new(lanes, &[], Waiting::Spinning).expect("threads");
            for tasks in loops {
                prop_assert!(runs(&mut pool, lanes, tasks).iter().all(|&count| count == 1));
            }
        }
    }

    /// Threads that sleep between loops and are bound to one core work too.
    #[test]
    fn parked_threads_on_one_core_run_all_tasks() {
        let cores: &[usize] = if cfg!(target_os = "linux") { &[0] } else { &[] };
        let mut pool = Pool::new(3, cores, Waiting::Parking).expect("core 0");
        for _ in 0..20 {
            assert!(runs(&mut pool, 3, 50).iter().all(|&count| count == 1));
        }
        if cfg!(target_os = "linux") {
            let error = Pool::new(2, &[1 << 20], Waiting::Spinning).unwrap_err();
            assert_eq!(error.to_string(), "there is no core 1048576");
        }
    }

    /// The largest number of threads can start, work and end.
    #[test]
    fn the_most_threads_run_every_task_once() {
        let lanes = crate::engine::Options::MAX_THREADS;
        let mut pool = Pool::new(lanes, &[], Waiting::Spinning).expect("so many threads");
        assert_eq!(pool.lanes(), lanes);
        assert!(runs(&mut pool, lanes, 5000).iter().all(|&count| count == 1));
    }

    /// Returns how often each task of a loop runs.
    fn runs(pool: &mut Pool, lanes: usize, tasks: usize) -> Vec<usize> {
        let counts: Vec<AtomicUsize> = (0..tasks).map(|_| AtomicUsize::new(0)).collect();
        pool.run(tasks, &|lane, task| {
            assert!(lane < lanes);
            counts[task].fetch_add(1, Ordering::Relaxed);
        });
        counts.into_iter().map(AtomicUsize::into_inner).collect()
    }
}
