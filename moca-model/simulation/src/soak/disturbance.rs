//! Disturbances around the controller, one at a time, and the state that each must lead to.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::Range;

use hrsw_safety::SafetyState;
use moca_model::DynamicRobotSettings;
use nalgebra::{Isometry3, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use vision_models::Percept;

use crate::plant::{Drive, Heard};

/// Something that goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Disturbance {
    /// No frame comes.
    FramesLost,
    /// The same frame comes again and again.
    FramesFrozen,
    /// Every frame comes more than half a second late.
    FramesLate,
    /// Every frame comes twice.
    FramesRepeated,
    /// After every frame comes the one before.
    FramesOutOfOrder,
    /// In every frame the person is somewhere else.
    FramesAbsurd,
    /// The camera's clock is ahead by 20 s.
    CameraAhead,
    /// The camera's clock is behind by 20 s.
    CameraBehind,
    /// The camera counts from another origin.
    CameraEpoch,
    /// The camera's clock stands still.
    CameraStands,
    /// The camera is not where its calibration has it: everybody is seen elsewhere.
    CameraMoved,
    /// A joint's measured position is NaN.
    MeasurementNan,
    /// The robot measures nothing.
    MeasurementMissing,
    /// The robot measures the same again and again.
    MeasurementFrozen,
    /// Every tenth tick comes some milliseconds late.
    TicksLate,
    /// The loop's time is NaN.
    TimeNan,
    /// The loop's time stands still.
    TimeStands,
    /// The loop's clock is set back by a second.
    TimeBack,
    /// The loop's clock is set ahead by an hour.
    TimeAhead,
    /// The tool is pushed hard for a moment.
    ArmPushed,
    /// A third of the commands does not arrive, at random.
    CommandsThinned,
    /// No command arrives.
    CommandsLost,
}

/// Displacement of a moved camera: along the floor \[m\], and the largest turn about the world's origin \[rad\].
const CAMERA_SHIFT: f64 = 0.3;
const CAMERA_TURN: f64 = 0.1;
/// Duration of each \[s\].
const LENGTH: Range<f64> = 0.3..1.6;
/// Time from the end of one to the beginning of the next \[s\].
const PAUSE: Range<f64> = 2.0..5.0;
/// Time from a fault to the state that it leads to \[s\].
const AT_ONCE: f64 = 0.2;
/// Time from the beginning of what is wrong with frames to the arrival of the first of them \[s\].
const FRAME: f64 = 0.14;
/// Ages at which frames that stay away lead to reduced speed and to a stop \[s\].
const STALE: [f64; 2] = [0.3, 0.8];
/// After so long without a measurement a loop halts the robot \[s\].
const BLIND: f64 = 0.1;
/// Duration and force of a push on the tool \[s, N\].
const PUSH: f64 = 0.1;
const FORCE: f64 = 150.0;
/// Distance of the person in an absurd frame: the least, and the most along each axis \[m\].
const TOO_FAR: f64 = 4.0;
const ANYWHERE: f64 = 30.0;

impl Disturbance {
    /// Disturbances in the order of the enum.
    pub const ALL: [Self; 22] = [
        Self::FramesLost,
        Self::FramesFrozen,
        Self::FramesLate,
        Self::FramesRepeated,
        Self::FramesOutOfOrder,
        Self::FramesAbsurd,
        Self::CameraAhead,
        Self::CameraBehind,
        Self::CameraEpoch,
        Self::CameraStands,
        Self::CameraMoved,
        Self::MeasurementNan,
        Self::MeasurementMissing,
        Self::MeasurementFrozen,
        Self::TicksLate,
        Self::TimeNan,
        Self::TimeStands,
        Self::TimeBack,
        Self::TimeAhead,
        Self::ArmPushed,
        Self::CommandsThinned,
        Self::CommandsLost,
    ];

    /// The state that the book promises at least, `time` \[s\] after it began.
    pub fn least_state(self, time: f64) -> SafetyState {
        let delay = AT_ONCE + if self.is_of_frames() { FRAME } else { 0.0 };
        let at_once = if time > delay { self.state_at_once() } else { SafetyState::Normal };
        let [reduced, stopped] = STALE.map(|age| time > age + delay);
        let stale = match (reduced, stopped) {
            _ if !self.hides_the_person() => SafetyState::Normal,
            (_, true) => SafetyState::ProtectiveStop,
            (true, false) => SafetyState::Reduced,
            (false, false) => SafetyState::Normal,
        };
        at_once.max(stale)
    }

    /// Returns true if something is wrong with the camera's frames.
    fn is_of_frames(self) -> bool {
        self.hides_the_person()
            || matches!(self, Self::FramesLate | Self::FramesRepeated | Self::FramesOutOfOrder)
    }

    /// Returns true if no frame with news of the person comes, so that their age grows.
    pub(super) fn hides_the_person(self) -> bool {
        matches!(
            self,
            Self::FramesLost
                | Self::FramesFrozen
                | Self::FramesAbsurd
                | Self::CameraAhead
                | Self::CameraBehind
                | Self::CameraEpoch
                | Self::CameraStands
        )
    }

    /// Returns true if only a robot under torques has it: it has a mass, and a line to its controller.
    fn is_of_torques(self) -> bool {
        matches!(
            self,
            Self::ArmPushed
                | Self::CommandsThinned
                | Self::CommandsLost
                | Self::MeasurementMissing
                | Self::MeasurementFrozen
        )
    }

    /// Returns true if the controller has no time, or no measurement, for which it could solve anything.
    pub(crate) fn leaves_nothing_to_solve(self) -> bool {
        self == Self::MeasurementNan || self.is_of_time()
    }

    /// Returns true if the loop's time is wrong, and with it the age of all that was seen.
    pub(super) fn is_of_time(self) -> bool {
        matches!(self, Self::TimeNan | Self::TimeStands | Self::TimeBack | Self::TimeAhead)
    }

    fn state_at_once(self) -> SafetyState {
        match self {
            // The last three for good: one cannot be noticed, one is bridged, and one is no fault.
            Self::FramesLost
            | Self::FramesAbsurd
            | Self::CameraMoved
            | Self::CommandsThinned
            | Self::TicksLate => SafetyState::Normal,
            Self::FramesLate
            | Self::FramesFrozen
            | Self::FramesRepeated
            | Self::FramesOutOfOrder
            | Self::CameraBehind
            | Self::CameraStands => SafetyState::Reduced,
            Self::CameraAhead
            | Self::CameraEpoch
            | Self::MeasurementNan
            | Self::MeasurementMissing
            | Self::MeasurementFrozen
            | Self::TimeNan
            | Self::TimeStands
            | Self::TimeBack
            | Self::TimeAhead
            | Self::ArmPushed
            | Self::CommandsLost => SafetyState::ProtectiveStop,
        }
    }
}

/// One disturbance after the other, with pauses.
#[derive(Clone, Debug)]
pub(super) struct Disturbances {
    draw: ChaCha8Rng,
    drive: Drive,
    /// Disturbance that lasts at present.
    now: Option<Disturbance>,
    /// Since when, and until when, what lasts or the pause \[s\].
    since: f64,
    until: f64,
    /// The frame that arrived last.
    last: Option<Percept>,
    /// When the last one was taken that showed the person where they were \[s\].
    shown: f64,
    /// Displacement in the world at which a moved camera sees everybody.
    camera_error: Isometry3<f64>,
}

impl Disturbances {
    /// Never disturbs anything.
    pub(super) fn none(draw: ChaCha8Rng, drive: Drive) -> Self {
        Self { until: f64::INFINITY, ..Self::new(draw, drive) }
    }

    pub(super) fn new(mut draw: ChaCha8Rng, drive: Drive) -> Self {
        let until = draw.random_range(PAUSE);
        Self {
            draw,
            drive,
            now: None,
            since: 0.0,
            until,
            last: None,
            shown: f64::NEG_INFINITY,
            camera_error: Isometry3::identity(),
        }
    }

    /// Advances to `time` \[s\]. Returns the disturbance that has ended there.
    pub(super) fn advance(&mut self, time: f64) -> Option<Disturbance> {
        if time < self.until {
            return None;
        }
        self.since = time;
        if let Some(ended) = self.now.take() {
            self.until = time + self.draw.random_range(PAUSE);
            return Some(ended);
        }
        self.until = time + self.draw.random_range(LENGTH);
        let drawn = Disturbance::ALL[self.draw.random_range(0..Disturbance::ALL.len())];
        let is_felt = self.drive == Drive::Torque || !drawn.is_of_torques();
        self.now = is_felt.then_some(drawn);
        let aside = self.draw.random_range(-PI..PI);
        self.camera_error = Isometry3::new(
            Vector3::new(aside.cos(), aside.sin(), 0.0) * CAMERA_SHIFT,
            Vector3::z() * self.draw.random_range(-CAMERA_TURN..CAMERA_TURN),
        );
        None
    }

    /// Disturbance that lasts, and its duration so far \[s\].
    pub(super) fn present(&self, time: f64) -> Option<(Disturbance, f64)> {
        self.now.map(|disturbance| (disturbance, time - self.since))
    }

    /// Percepts that arrive when the camera has sent `percept`.
    pub(super) fn frames(&mut self, percept: Percept) -> Vec<Percept> {
        let before = self.last.replace(percept.clone());
        match self.now {
            Some(Disturbance::FramesLost) => {
                self.last = before;
                Vec::new()
            }
            Some(Disturbance::FramesFrozen) => {
                self.last.clone_from(&before);
                before.into_iter().collect()
            }
            Some(Disturbance::FramesRepeated) => vec![percept.clone(), percept],
            Some(Disturbance::FramesOutOfOrder) => std::iter::once(percept).chain(before).collect(),
            // Where the robot knows of nobody there is nobody to misplace: no frame comes.
            Some(Disturbance::FramesAbsurd) => {
                let is_known = percept.time - self.shown < PAUSE.start && percept.body.is_some();
                is_known.then(|| self.absurd(percept)).into_iter().collect()
            }
            Some(Disturbance::CameraMoved) => vec![moved(percept, &self.camera_error)],
            Some(Disturbance::CameraAhead) => vec![stamped(&percept, percept.time + 20.0)],
            Some(Disturbance::CameraBehind) => vec![stamped(&percept, percept.time - 20.0)],
            Some(Disturbance::CameraEpoch) => vec![stamped(&percept, percept.time + 1.7e9)],
            Some(Disturbance::CameraStands) => {
                let stands = before.map_or(percept.time, |before| before.time);
                self.last = Some(stamped(&percept, stands));
                vec![stamped(&percept, stands)]
            }
            _ => {
                if percept.body.is_some() {
                    self.shown = percept.time;
                }
                vec![percept]
            }
        }
    }

    /// The loop's time where the true one is `time` \[s\], and the one of the tick before `last`.
    pub(super) fn time(&self, time: f64, last: f64) -> f64 {
        match self.now {
            Some(Disturbance::TimeNan) => f64::NAN,
            Some(Disturbance::TimeStands) => last,
            Some(Disturbance::TimeBack) => time - 1.0,
            Some(Disturbance::TimeAhead) => time + 3600.0,
            _ => time,
        }
    }

    /// Reports of the robot that reach the controller.
    pub(super) fn heard(&self) -> Heard {
        match self.now {
            Some(Disturbance::MeasurementMissing) => Heard::Nothing,
            Some(Disturbance::MeasurementFrozen) => Heard::Frozen,
            _ => Heard::Measurement,
        }
    }

    /// Force that pushes the tool \[N, world\].
    pub(super) fn push(&self, time: f64) -> Vector3<f64> {
        match self.present(time) {
            Some((Disturbance::ArmPushed, lasts)) if lasts < PUSH => Vector3::new(FORCE, 0.0, 0.0),
            _ => Vector3::zeros(),
        }
    }

    /// The share of the commands that do not arrive. A robot that is not measured for long is halted by its loop.
    pub(super) fn loss(&self, time: f64) -> f64 {
        match self.present(time) {
            Some((Disturbance::CommandsThinned, _)) => 1.0 / 3.0,
            Some((Disturbance::CommandsLost, _)) => 1.0,
            Some((Disturbance::MeasurementMissing | Disturbance::MeasurementFrozen, lasts))
                if lasts > BLIND =>
            {
                1.0
            }
            _ => DynamicRobotSettings::default().loss,
        }
    }

    /// Delay of frames beyond the usual one \[s\].
    pub(super) fn delay(&self) -> f64 {
        if self.now == Some(Disturbance::FramesLate) { 0.6 } else { 0.0 }
    }

    /// The same person, where nobody can have gone.
    fn absurd(&mut self, percept: Percept) -> Percept {
        let draw = || Vector3::from_fn(|_, _| self.draw.random_range(-ANYWHERE..ANYWHERE));
        let mut drawn = std::iter::repeat_with(draw);
        let away = drawn.find(|away| away.norm() > TOO_FAR).unwrap_or_default();
        moved(percept, &away.into())
    }

    /// Displacement of all people in the camera's view at present.
    pub(super) fn camera_error(&self) -> Option<&Isometry3<f64>> {
        (self.now == Some(Disturbance::CameraMoved)).then_some(&self.camera_error)
    }
}

fn moved(percept: Percept, motion: &Isometry3<f64>) -> Percept {
    Percept { body: percept.body.map(|body| body.transformed(motion)), ..percept }
}

fn stamped(percept: &Percept, time: f64) -> Percept {
    Percept { time, ..percept.clone() }
}

/// Counts of how often each disturbance ended in each state.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Endings(BTreeMap<Disturbance, StateCounts>);

/// Counts of how often something ended in each state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateCounts {
    /// Ended at full speed.
    pub normal: u64,
    /// Ended at reduced speed.
    pub reduced: u64,
    /// Ended coming no nearer.
    pub retreat: u64,
    /// Ended at rest.
    pub protective_stop: u64,
}

impl Default for Endings {
    fn default() -> Self {
        Self(Disturbance::ALL.map(|disturbance| (disturbance, StateCounts::default())).into())
    }
}

impl Endings {
    /// Counts one that has ended in this state.
    pub fn count(&mut self, disturbance: Disturbance, state: SafetyState) {
        let counts = self.0.entry(disturbance).or_default();
        match state {
            SafetyState::Normal => counts.normal += 1,
            SafetyState::Reduced => counts.reduced += 1,
            SafetyState::Retreat => counts.retreat += 1,
            SafetyState::ProtectiveStop => counts.protective_stop += 1,
        }
    }

    /// Returns the counts of each disturbance.
    pub fn counts(&self) -> impl Iterator<Item = (Disturbance, StateCounts)> {
        self.0.iter().map(|(disturbance, counts)| (*disturbance, *counts))
    }
}

impl std::ops::AddAssign<&Self> for Endings {
    fn add_assign(&mut self, other: &Self) {
        for (disturbance, other) in &other.0 {
            let counts = self.0.entry(*disturbance).or_default();
            counts.normal += other.normal;
            counts.reduced += other.reduced;
            counts.retreat += other.retreat;
            counts.protective_stop += other.protective_stop;
        }
    }
}
