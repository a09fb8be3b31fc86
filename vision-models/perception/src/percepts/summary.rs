//! Summary of a run over the frames of a camera.

use std::{collections::BTreeMap, time::Duration};

use serde::Serialize;

use super::{pipeline::Perceived, posture::MeasuredAssessment, quantiles::Quantiles};

/// Sums over the frames of a run.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    frames: u64,
    without_skeletons: u64,
    with_body: u64,
    with_action: u64,
    with_surface: u64,
    poses: Vec<Duration>,
    tracking: Vec<Duration>,
    surface: Vec<Duration>,
    action: Vec<Duration>,
    whole: Vec<Duration>,
    /// Sum of the times from capture to arrival (s), and their number.
    latency: (f64, u32),
    postures: u32,
    reba: f64,
    reba_max: Option<u8>,
    rula: f64,
    unseen: BTreeMap<&'static str, f64>,
}

/// Summary of a run, written as one JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Number of frames that were read.
    pub frames: u64,
    /// Number of frames that were not searched for people.
    pub without_skeletons: u64,
    /// Number of frames in which the engaged person was seen.
    pub with_body: u64,
    /// Number of frames with an action.
    pub with_action: u64,
    /// Number of frames with a surface.
    pub with_surface: u64,
    /// Joints in the image, including reading.
    pub poses: Quantiles,
    /// Lifting and tracking.
    pub lifting_and_tracking: Quantiles,
    /// Recognition of the surface, in the frames where it ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<Quantiles>,
    /// Recognition of the action, in the frames where it ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub action: Option<Quantiles>,
    /// Duration from an available frame to its percept, including reading.
    pub whole_frame: Quantiles,
    /// Mean time from the camera to the percept (s), if the frames have their times of arrival.
    pub latency_mean_s: Option<f64>,
    /// Mean REBA score of the measured posture, for the worse arm.
    pub reba_mean: Option<f64>,
    /// Highest REBA score.
    pub reba_max: Option<u8>,
    /// Mean RULA score.
    pub rula_mean: Option<f64>,
    /// Angles of the sheets that were not seen, and the share of the frames.
    pub unseen: BTreeMap<&'static str, f64>,
}

impl Tally {
    /// Returns the number of frames.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds a frame.
    pub fn push(&mut self, perceived: &Perceived) {
        let Perceived { percept, timing, posture, has_skeletons, times, .. } = perceived;
        self.frames += 1;
        self.without_skeletons += u64::from(!has_skeletons);
        self.with_body += u64::from(percept.body.is_some());
        self.with_action += u64::from(percept.action.is_some());
        self.with_surface += u64::from(percept.surface.is_some());
        self.poses.push(times.poses);
        self.tracking.push(times.tracking);
        self.surface.extend(times.surface);
        self.action.extend(times.action);
        self.whole.push(times.whole);
        if let Some(arrived) = timing.arrived {
            let (sum, count) = self.latency;
            self.latency = (sum + arrived - percept.time, count.saturating_add(1));
        }
        if let Some(posture) = posture {
            self.score(posture);
        }
    }

    fn score(&mut self, posture: &MeasuredAssessment) {
        self.postures = self.postures.saturating_add(1);
        self.reba += f64::from(posture.reba.reba);
        self.reba_max = self.reba_max.max(Some(posture.reba.reba));
        self.rula += f64::from(posture.rula.rula);
        for name in posture.measured.unseen() {
            *self.unseen.entry(name).or_default() += 1.0;
        }
    }

    /// Returns the summary.
    pub fn finish(self) -> Summary {
        let mean = |sum: f64, count: u32| (count > 0).then(|| sum / f64::from(count));
        let some = |times: Vec<Duration>| (!times.is_empty()).then(|| Quantiles::of(times));
        let share = |count: f64| count / f64::from(self.postures.max(1));
        Summary {
            frames: self.frames,
            without_skeletons: self.without_skeletons,
            with_body: self.with_body,
            with_action: self.with_action,
            with_surface: self.with_surface,
            poses: Quantiles::of(self.poses),
            lifting_and_tracking: Quantiles::of(self.tracking),
            surface: some(self.surface),
            action: some(self.action),
            whole_frame: Quantiles::of(self.whole),
            latency_mean_s: mean(self.latency.0, self.latency.1),
            reba_mean: mean(self.reba, self.postures),
            reba_max: self.reba_max,
            rula_mean: mean(self.rula, self.postures),
            unseen: self.unseen.into_iter().map(|(name, count)| (name, share(count))).collect(),
        }
    }
}
