//! The way of a frame from the camera to the controller.

use std::collections::VecDeque;
use std::ops::Range;

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::Percept;

/// How late a frame arrives (s).
const LATENCY: Range<f64> = 0.02..0.09;

/// Frames on their way: each is late by 20 to 90 ms, and none overtakes another.
#[derive(Clone, Debug)]
pub struct Transport {
    draw: ChaCha8Rng,
    /// When each arrives (s).
    frames: VecDeque<(f64, Percept)>,
}

impl Transport {
    /// Without a frame yet.
    pub fn new(draw: ChaCha8Rng) -> Self {
        Self { draw, frames: VecDeque::new() }
    }

    /// Sends a frame at the time that it bears, to arrive `delay` \[s\] later than usual; `None` stands for one
    /// that the camera lost.
    pub fn send(&mut self, percept: Option<Percept>, delay: f64) {
        // Drawn in any case, so that what follows does not depend on what is lost.
        let late = self.draw.random_range(LATENCY);
        let Some(percept) = percept else { return };
        let last = self.frames.back().map_or(percept.time, |(arrives, _)| *arrives);
        self.frames.push_back((last.max(percept.time + late + delay), percept));
    }

    /// The next frame that has arrived by `time` (s).
    pub fn arrived(&mut self, time: f64) -> Option<Percept> {
        let (arrives, _) = self.frames.front()?;
        if *arrives > time {
            return None;
        }
        self.next().map(|(_, percept)| percept)
    }
}

/// The frames on their way, each with when it arrives (s).
impl Iterator for Transport {
    type Item = (f64, Percept);

    fn next(&mut self) -> Option<Self::Item> {
        self.frames.pop_front()
    }
}
