//! What a run over the frames of a camera came to.

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
    /// From capture to arrival (s), and how many are known.
    latency: (f64, u32),
    postures: u32,
    reba: f64,
    reba_max: Option<u8>,
    rula: f64,
    unseen: BTreeMap<&'static str, f64>,
}

/// What a run came to, for `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Frames that were read.
    pub frames: u64,
    /// Of these, in which nobody looked for people.
    pub without_skeletons: u64,
    /// Of these, in which the person who works with the robot was seen.
    pub with_body: u64,
    /// With an action, and with a surface.
    pub with_action: u64,
    /// With a surface.
    pub with_surface: u64,
    /// Joints in the image, reading included.
    pub poses: Quantiles,
    /// Lifting and tracking.
    pub lifting_and_tracking: Quantiles,
    /// The surface and the action, where they were looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<Quantiles>,
    /// The action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub action: Option<Quantiles>,
    /// From a frame that is there to its percept, reading included.
    pub whole_frame: Quantiles,
    /// From the camera to the percept, where the frames say when they arrived (s).
    pub latency_mean_s: Option<f64>,
    /// REBA and RULA of the measured posture, of the arm that is worse off.
    pub reba_mean: Option<f64>,
    /// The highest REBA.
    pub reba_max: Option<u8>,
    /// Mean of RULA.
    pub rula_mean: Option<f64>,
    /// Angles of the sheets that were not seen, and in which share of the frames.
    pub unseen: BTreeMap<&'static str, f64>,
}

impl Tally {
    /// How many frames there were.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Takes a frame in.
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

    /// What it came to.
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
