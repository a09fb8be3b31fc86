//! Recognises the action in a thread of its own, so that no frame waits for it. On Linux the thread
//! leaves the cores to all others.

use std::{
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread,
    time::{Duration, Instant},
};

use vision_models::RecognisedAction;

use super::action_network::ActionNetwork;
use crate::{error::Error, frames::Picture};

/// Number of frames that may wait for the network.
const WAITING: usize = 4;
/// Nice value of the thread on Linux. Against a thread of nice value 0 it gets a tenth of a core
/// (`sched_prio_to_weight` of the kernel: 110 of 1024).
#[cfg(target_os = "linux")]
const NICE: i32 = 10;

/// A frame of the window.
#[derive(Debug)]
struct Wanted {
    frame: u64,
    captured: f64,
    image: Picture,
}

/// An action, and the time at which the newest image of its window was captured (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) action: RecognisedAction,
    pub(super) captured: f64,
    /// Duration of the recognition.
    pub(super) taken: Duration,
}

/// An [`ActionNetwork`] in its own thread. If frames come faster than it decides, all of them enter
/// the window, and it decides at the newest. The thread ends when this is dropped.
#[derive(Debug)]
pub(super) struct ActionThread {
    frames: SyncSender<Wanted>,
    found: Receiver<Result<Found, Error>>,
    interval: u64,
    /// Number of the newest frame of the window.
    newest: Option<u64>,
}

impl ActionThread {
    pub(super) fn new(network: ActionNetwork) -> Self {
        let interval = network.interval();
        let (frames, wanted) = sync_channel(WAITING);
        let (finds, found) = sync_channel(WAITING);
        thread::spawn(move || recognise(network, &wanted, &finds));
        Self { frames, found, interval, newest: None }
    }

    /// Gives the thread a frame, captured at this time (s), if it belongs to the window. A frame for
    /// which there is no room is left out, and the next one is taken in its place.
    pub(super) fn offer(&mut self, frame: u64, captured: f64, image: &Picture) {
        if self.newest.is_some_and(|newest| frame < newest.saturating_add(self.interval)) {
            return;
        }
        let wanted = Wanted { frame, captured, image: image.clone() };
        if self.frames.try_send(wanted).is_ok() {
            self.newest = Some(frame);
        }
    }

    /// Returns the next result that has come. Never waits.
    ///
    /// # Errors
    /// An image that could not be used.
    pub(super) fn found(&self) -> Result<Option<Found>, Error> {
        self.found.try_recv().map_or(Ok(None), |found| found.map(Some))
    }
}

/// Recognises actions until nobody gives frames, or takes results, any more.
fn recognise(
    mut network: ActionNetwork,
    frames: &Receiver<Wanted>,
    finds: &SyncSender<Result<Found, Error>>,
) {
    // Linux counts nice values by thread. A lower priority is always granted.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, NICE);
    while let Ok(mut newest) = frames.recv() {
        let begun = Instant::now();
        let mut added = Ok(());
        for next in frames.try_iter().take(WAITING) {
            let older = std::mem::replace(&mut newest, next);
            added = added.and_then(|()| network.add(older.frame, &older.image));
        }
        let result = added.and_then(|()| network.push(newest.frame, &newest.image));
        let (captured, taken) = (newest.captured, begun.elapsed());
        let found = result.map(|action| action.map(|action| Found { action, captured, taken }));
        if found.transpose().is_some_and(|found| finds.send(found).is_err()) {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use ndarray::Array3;
    use vision_models::{Action, LinearHead, Preprocessing, SlowOnlyForm};

    use super::*;
    use crate::{
        learning::backbone::{ClipBackbone, Weights},
        networks::clip_stream::ClipStream,
        watch::Event,
    };

    const INTERVAL: u64 = 2;

    fn network() -> ActionNetwork {
        let form = SlowOnlyForm::MmAction2Depth18;
        let preprocessing = Preprocessing { crop: 32, ..Preprocessing::MMACTION2 };
        let backbone = ClipBackbone::new(Weights::Random(3), form, [4, 32, 32], 1);
        let network = backbone.load(&mut |_: Event<'_>| ControlFlow::Continue(())).unwrap();
        let names = Action::ALL.iter().map(|action| action.name().to_owned()).collect();
        let head = LinearHead::random(names, network.features(), 1).unwrap();
        let stream = ClipStream::new(network, 4, preprocessing, Some(head)).unwrap();
        ActionNetwork::new(stream, Action::ALL.to_vec(), INTERVAL)
    }

    fn image(frame: u64) -> Picture {
        let shift = 53 * usize::try_from(frame).unwrap();
        let pixel = |(row, column, colour): (usize, usize, usize)| {
            let [byte, ..] =
                (37 * row + 11 * column + 91 * colour + shift * (row + 1)).to_le_bytes();
            byte
        };
        Picture::Pixels(Array3::from_shape_fn((64, 64, 3), pixel))
    }

    /// However many frames come at once, each decision is that of the network alone at this frame.
    #[test]
    fn decisions_are_those_of_the_network_alone() {
        let mut alone = network();
        let mut beside = ActionThread::new(network());
        let (mut frame, mut decisions) = (0, 0);
        for batch in [1, 1, 1, 1, 3, 1, 2, 4, 1, 3] {
            let mut expected = Vec::new();
            for _ in 0..batch {
                let action = alone.push(frame, &image(frame)).unwrap();
                expected.extend(action.map(|action| (frame as f64, action)));
                beside.offer(frame, frame as f64, &image(frame));
                // A frame between two of the window is none of it.
                beside.offer(frame + 1, frame as f64, &image(frame));
                assert_eq!(beside.newest, Some(frame));
                frame += INTERVAL;
            }
            while let Some((newest, _)) = expected.last() {
                let found = beside.found.recv_timeout(Duration::from_secs(100)).unwrap().unwrap();
                assert!(expected.contains(&(found.captured, found.action)), "{found:?}");
                decisions += 1;
                if found.captured >= *newest {
                    break;
                }
            }
        }
        assert!(decisions >= 7, "{decisions}");
    }

    #[test]
    fn an_unreadable_image_is_an_error() {
        let mut beside = ActionThread::new(network());
        beside.offer(0, 0.0, &Picture::File("nothing.png".into()));
        let error = beside.found.recv().unwrap().unwrap_err();
        assert!(error.to_string().contains("nothing.png"), "{error}");
    }
}
