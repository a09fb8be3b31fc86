//! Transport of frames from the camera to the controller.

use std::collections::VecDeque;
use std::ops::Range;

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Body, Percept};

/// Delay of a frame \[s\].
const LATENCY: Range<f64> = 0.02..0.09;

/// A percept, and the other people in its frame.
type Frame = (Percept, Vec<Body>);

/// Frames in transit: each is late by 20 to 90 ms, and none overtakes another.
#[derive(Clone, Debug)]
pub struct Transport {
    draw: ChaCha8Rng,
    /// Arrival time of each frame \[s\].
    frames: VecDeque<(f64, Frame)>,
}

impl Transport {
    /// Creates a transport without frames.
    pub fn new(draw: ChaCha8Rng) -> Self {
        Self { draw, frames: VecDeque::new() }
    }

    /// Sends a frame at its own time, to arrive `delay` \[s\] later than usual. `None` stands for a frame that the
    /// camera lost.
    pub fn send(&mut self, frame: Option<Frame>, delay: f64) {
        // The random number is always drawn, so that later ones do not depend on lost frames.
        let late = self.draw.random_range(LATENCY);
        let Some(frame) = frame else { return };
        let time = frame.0.time;
        let last = self.frames.back().map_or(time, |(arrives, _)| *arrives);
        self.frames.push_back((last.max(time + late + delay), frame));
    }

    /// The next frame that has arrived by `time` \[s\].
    pub fn arrived(&mut self, time: f64) -> Option<Frame> {
        let (arrives, _) = self.frames.front()?;
        if *arrives > time {
            return None;
        }
        self.next().map(|(_, frame)| frame)
    }
}

/// Iterates over the frames in transit, each with its arrival time \[s\].
impl Iterator for Transport {
    type Item = (f64, Frame);

    fn next(&mut self) -> Option<Self::Item> {
        self.frames.pop_front()
    }
}
