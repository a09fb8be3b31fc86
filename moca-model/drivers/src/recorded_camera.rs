//! A camera that shows what was recorded.

use std::sync::mpsc::SyncSender;

use moca_model::CameraFrame;

/// Between the last frame and the first \[s\].
const PAUSE: f64 = 0.05;

/// Plays camera frames again and again at their pace, stamped with the time of the loop.
#[derive(Debug)]
pub struct RecordedCamera {
    frames: Vec<CameraFrame>,
    to: SyncSender<CameraFrame>,
    /// When the recording began \[s\]; none before the first look.
    begun: Option<f64>,
    next: usize,
    shown: u64,
}

impl RecordedCamera {
    /// Makes one from frames in the order of their times, and where they go.
    pub fn new(frames: Vec<CameraFrame>, to: SyncSender<CameraFrame>) -> Self {
        Self { frames, to, begun: None, next: 0, shown: 0 }
    }

    /// Shows the frames that are due at `now` \[s\]; how many were shown so far, and when the next is due \[s\]. A loop that
    /// takes none for a while misses these, as it would miss a camera's.
    pub fn show(&mut self, now: f64) -> (u64, f64) {
        let begun = *self.begun.get_or_insert(now);
        let first = self.frames.first().map_or(0.0, |frame| frame.percept.time);
        while let Some(frame) = self.frames.get(self.next) {
            let due = begun + frame.percept.time - first;
            if due > now {
                return (self.shown, due);
            }
            let mut frame = frame.clone();
            frame.percept.time = now;
            // The loop may have ended.
            let _ = self.to.try_send(frame);
            self.next += 1;
            self.shown += 1;
        }
        (self.begun, self.next) = (Some(now + PAUSE), 0);
        (self.shown, now + PAUSE)
    }
}
