//! Camera that plays a recording.

use moca_model::Scene;

/// Pause between the last frame and the first \[s\].
const PAUSE: f64 = 0.05;

/// Plays camera frames in a loop at their recorded rate, stamped with the time of the control loop.
#[derive(Debug)]
pub struct RecordedCamera {
    frames: Vec<Scene>,
    /// Time at which the recording began \[s\]; `None` before the first call.
    begun: Option<f64>,
    next: usize,
    shown: u64,
}

impl RecordedCamera {
    /// Creates a camera from frames in the order of their times.
    pub fn new(frames: Vec<Scene>) -> Self {
        Self { frames, begun: None, next: 0, shown: 0 }
    }

    /// Shows the frames that are due at `now` \[s\], stamped with the time at which they were. Returns the number of frames
    /// so far and the time at which the next one is due \[s\].
    pub fn show(&mut self, now: f64, mut show: impl FnMut(Scene)) -> (u64, f64) {
        let begun = *self.begun.get_or_insert(now);
        let first = self.frames.first().map_or(0.0, |frame| frame.percept.time);
        while let Some(frame) = self.frames.get(self.next) {
            let due = begun + frame.percept.time - first;
            if due > now {
                return (self.shown, due);
            }
            let mut frame = frame.clone();
            frame.percept.time = due;
            show(frame);
            self.next += 1;
            self.shown += 1;
        }
        (self.begun, self.next) = (Some(now + PAUSE), 0);
        (self.shown, now + PAUSE)
    }
}
