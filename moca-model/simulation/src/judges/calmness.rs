//! Measures of how still robot and workpiece are while the person stands, and how smooth while they walk.
//!
//! The person's true motion, smoothed over 2.05 s, distinguishes standing and walking, since gait sways the trunk.

mod following;
mod standing;

use moca_model::Command;
use moca_model::whole_body::Model;
use nalgebra::{Point3, Rotation2, Vector2, Vector3};
use serde::{Deserialize, Serialize};
use simulated_people::Joints;
use vision_models::Body25;

pub use self::following::Following;
use self::following::{Path, Workpiece};
pub use self::standing::Stillness;
pub(crate) use self::standing::StillnessMonitor;
use crate::quantile::quantile;

/// Sampling period of the person's motion \[s\].
const STEP: f64 = 0.05;
/// Number of samples to each side for the smoothing parabola.
const SIDE: usize = 20;
/// Speeds of trunk \[m/s\] and heading \[rad/s\] below which the person stands.
const STANDING: [f64; 2] = [0.12, 0.15];
/// Speed above which the person walks \[m/s\].
const WALKING: f64 = 0.2;
/// Averaging time of the workpiece's place, before its speed is computed \[s\].
const AVERAGED: f64 = 0.021;
/// Speed of each axis below which the base is at rest \[m/s\].
const AT_REST: f64 = 1e-3;
/// Share of its acceleration limit from which on the base is at the limit.
const AT_LIMIT: f64 = 0.95;

/// Calmness of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Calmness {
    /// Motion while the person stands, from 1 s after the beginning; `None` if they did not stand for 2 s.
    pub standing: Option<Motion>,
    /// Motion while the person stands, from 2 s after the beginning.
    pub settled: Option<Motion>,
    /// Motion while the person does not walk, from 2 s after the beginning: they stand, turn, lean or take a step.
    pub on_the_spot: Option<Motion>,
    /// Motion while they walk, from 0.5 s after the beginning; `None` if they did not walk for 1 s.
    pub walking: Option<Motion>,
    /// How the workpiece follows them; `None` if they did not walk for 1 s.
    pub following: Option<Following>,
}

/// The motion of a robot in a part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Duration of the part \[s\].
    pub duration: f64,
    /// Root mean square of the speed of the person's trunk \[m/s\].
    pub person: f64,
    /// Root mean square of the speed of the workpiece \[m/s\].
    pub workpiece: f64,
    /// 99th percentile of the speed of the workpiece \[m/s\].
    pub workpiece_p99: f64,
    /// Root mean square of the commanded speed of the base \[m/s\].
    pub base: f64,
    /// Share of the ticks with the base at rest.
    pub base_at_rest: f64,
    /// Share of the ticks with an axis of the base at its acceleration limit.
    pub base_at_limit: f64,
    /// Rate at which the commanded velocity of an axis of the base changes its sign, also from and to zero \[1/s\].
    pub base_reversals: f64,
    /// Root mean square of ‖q̇‖ of the other joints \[rad/s\].
    pub joints: f64,
    /// Root mean square of the distance from the workpiece to the desired position \[m\].
    pub tracking_error: f64,
}

/// A tick.
#[derive(Debug, Clone, Copy)]
struct Tick {
    workpiece: Vector3<f64>,
    base: Vector2<f64>,
    /// ‖q̇‖² of the other joints.
    joints: f64,
    at_limit: bool,
    /// The squared tracking error.
    error: f64,
    together: bool,
}

/// Watches a run, tick by tick.
#[derive(Debug, Clone)]
pub struct CalmnessMonitor {
    period: f64,
    /// Number of base joints, which come first.
    base: usize,
    /// Change of the base's velocity in a tick that counts as at its limit \[m/s\].
    most: Vector2<f64>,
    ticks: Vec<Tick>,
}

impl CalmnessMonitor {
    /// Creates a monitor for a robot at rest whose first `base` joints are those of a base. Ticks are `period` \[s\]
    /// apart.
    pub fn new(model: &Model, base: usize, period: f64) -> Self {
        let limit =
            |axis: usize| model.limits().get(axis).map_or(f64::INFINITY, |l| l.acceleration);
        let most = Vector2::new(limit(0), limit(1)) * (AT_LIMIT * period);
        Self { period, base, most, ticks: Vec::new() }
    }

    /// Takes a tick: its command, the true place of the workpiece \[m\], and whether person and robot work together.
    pub fn watch(&mut self, command: &Command, workpiece: Vector3<f64>, together: bool) {
        let (base, rest) =
            command.joint_velocity.split_at(self.base.min(command.joint_velocity.len()));
        let base = match base {
            [x, y, ..] => Vector2::new(*x, *y),
            _ => Vector2::zeros(),
        };
        let before = self.ticks.last().map_or_else(Vector2::zeros, |tick| tick.base);
        let change = (base - before).abs();
        self.ticks.push(Tick {
            workpiece,
            base,
            joints: rest.iter().map(|velocity| velocity * velocity).sum(),
            at_limit: change.x > self.most.x || change.y > self.most.y,
            error: (command.desired.translation.vector - workpiece).norm_squared(),
            together,
        });
    }

    /// The result for a person whose joints are at `person` at times after the first tick \[s\].
    pub fn judge(&self, person: impl Fn(f64) -> Option<Joints>) -> Calmness {
        let Some((path, motion)) = self.person(person) else { return Calmness::default() };
        let ticks = |time: f64| whole((time / self.period).round());
        // The robot's approach to the person does not count.
        let together =
            stretches(self.ticks.iter().map(|tick| tick.together), ticks(4.0), ticks(3.0));
        let all = || together.iter().zip(&motion);
        let stands = |settling: f64| {
            let stands = all().map(|(together, [speed, turn])| {
                *together && *speed < STANDING[0] && *turn < STANDING[1]
            });
            stretches(stands, ticks(settling + 1.0), ticks(settling))
        };
        let walks = all().map(|(together, [speed, _])| *together && *speed > WALKING);
        let walks = stretches(walks, ticks(1.0), 0);
        let walking = stretches(walks.iter().copied(), ticks(1.0), ticks(0.5));
        let settled = stands(2.0);
        let on_the_spot = all().map(|(together, [speed, _])| *together && *speed <= WALKING);
        let on_the_spot = stretches(on_the_spot, ticks(3.0), ticks(2.0));
        let velocities = self.workpiece_velocities();
        let floor = self.ticks.iter().zip(&velocities);
        let floor: Vec<_> = floor.map(|(tick, v)| [tick.workpiece.xy(), v.xy()]).collect();
        let workpiece = Workpiece { period: self.period, motion: &floor };
        let following = workpiece.judge(&path, [&walks, &settled], &walking);
        let speeds: Vec<f64> = velocities.iter().map(Vector3::norm).collect();
        let motion = |mask: &[bool]| self.motion(mask, &motion, &speeds);
        Calmness {
            standing: motion(&stands(1.0)),
            settled: motion(&settled),
            on_the_spot: motion(&on_the_spot),
            walking: motion(&walking),
            following,
        }
    }

    fn motion(&self, mask: &[bool], person: &[[f64; 2]], workpiece: &[f64]) -> Option<Motion> {
        let chosen = |index: usize| mask.get(index).copied().unwrap_or_default();
        let count = mask.iter().filter(|chosen| **chosen).count();
        if count == 0 {
            return None;
        }
        let number = count as f64;
        let ticks = || self.ticks.iter().enumerate().filter(|(index, _)| chosen(*index));
        let mean =
            |of: &dyn Fn(&Tick) -> f64| ticks().map(|(_, tick)| of(tick)).sum::<f64>() / number;
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            (values.map(|value| value * value).sum::<f64>() / number).sqrt()
        };
        let of = |values: &[f64]| -> Vec<f64> {
            let values = values.iter().enumerate().filter(|(index, _)| chosen(*index));
            values.map(|(_, value)| *value).collect()
        };
        let mut speeds = of(workpiece);
        let workpiece_p99 = quantile(&mut speeds, 990).unwrap_or_default();
        let people: Vec<f64> = person.iter().map(|[speed, _]| *speed).collect();
        let sign = |value: f64| if value == 0.0 { 0.0 } else { value.signum() };
        let pairs = self.ticks.windows(2).enumerate().filter(|(index, _)| chosen(index + 1));
        let reversals: usize = pairs
            .map(|(_, pair)| {
                let [before, now] = [pair[0].base, pair[1].base];
                (0..2).filter(|axis| sign(before[*axis]) != sign(now[*axis])).count()
            })
            .sum();
        Some(Motion {
            duration: number * self.period,
            person: rms(&mut of(&people).into_iter()),
            workpiece: rms(&mut speeds.iter().copied()),
            workpiece_p99,
            base: mean(&|tick| tick.base.norm_squared()).sqrt(),
            base_at_rest: mean(&|tick| f64::from(tick.base.amax() < AT_REST)),
            base_at_limit: mean(&|tick| f64::from(tick.at_limit)),
            base_reversals: reversals as f64 / (number * self.period),
            joints: mean(&|tick| tick.joints).sqrt(),
            tracking_error: mean(&|tick| tick.error).sqrt(),
        })
    }

    /// The velocity of the workpiece in each tick \[m/s\].
    fn workpiece_velocities(&self) -> Vec<Vector3<f64>> {
        let side = whole((0.5 * AVERAGED / self.period).round());
        let last = self.ticks.len().saturating_sub(1);
        let mut sums = vec![Vector3::zeros()];
        for tick in &self.ticks {
            sums.push(sums.last().copied().unwrap_or_default() + tick.workpiece);
        }
        // The moving average is updated by what enters and leaves its window.
        (0..self.ticks.len())
            .map(|tick| {
                let average = |tick: usize| {
                    let (from, to) = (tick.saturating_sub(side), (tick + side).min(last) + 1);
                    (sums[to] - sums[from]) / (to - from) as f64
                };
                let (from, to) = (tick.saturating_sub(1), (tick + 1).min(last));
                if from == to {
                    return Vector3::zeros();
                }
                (average(to) - average(from)) / ((to - from) as f64 * self.period)
            })
            .collect()
    }

    /// The path of the person's trunk, and the speeds of it over the floor and of their heading, tick by tick \[m/s,
    /// rad/s\]; `None` if unknown.
    fn person(&self, person: impl Fn(f64) -> Option<Joints>) -> Option<(Path, Vec<[f64; 2]>)> {
        let duration = self.ticks.len() as f64 * self.period;
        let steps = whole((duration / STEP).ceil()) + 2;
        let seen: Option<Vec<Joints>> = (0..steps).map(|step| person(step as f64 * STEP)).collect();
        let seen = seen?;
        let trunk: Vec<_> = seen.iter().map(|joints| middle(joints, &TRUNK)).collect();
        let place = smooth(&trunk);
        let across = seen.iter().map(|joints| middle(joints, &LEFT) - middle(joints, &RIGHT));
        let across = smooth(&across.collect::<Vec<_>>());
        let rates: Vec<[f64; 2]> = (0..steps)
            .map(|step| {
                let (from, to) = (step.saturating_sub(1), (step + 1).min(steps - 1));
                let time = (to - from) as f64 * STEP;
                let turn = across[from].perp(&across[to]).atan2(across[from].dot(&across[to]));
                [(place[to] - place[from]).norm() / time, turn.abs() / time]
            })
            .collect();
        let at = |tick: usize| {
            let at = tick as f64 * self.period / STEP;
            let before = at.floor();
            let (share, before) = (at - before, whole(before));
            let (from, to) = (rates[before], rates[before + 1]);
            [0, 1].map(|part| from[part] + (to[part] - from[part]) * share)
        };
        let motion = (0..self.ticks.len()).map(at).collect();
        let heading =
            across.iter().map(|across| Rotation2::rotation_between(&Vector2::y(), across));
        let heading = heading.collect();
        Some((Path { step: STEP, trunk, smooth: place, heading }, motion))
    }
}

const TRUNK: [Body25; 6] = [
    Body25::Neck,
    Body25::RightShoulder,
    Body25::LeftShoulder,
    Body25::MidHip,
    Body25::RightHip,
    Body25::LeftHip,
];
const LEFT: [Body25; 2] = [Body25::LeftShoulder, Body25::LeftHip];
const RIGHT: [Body25; 2] = [Body25::RightShoulder, Body25::RightHip];

/// The mean of these joints over the floor.
fn middle(joints: &Joints, of: &[Body25]) -> Vector2<f64> {
    let place = |joint: &Body25| -> Point3<f64> { joints[joint.index()] };
    of.iter().map(|joint| place(joint).coords.xy()).sum::<Vector2<f64>>() / of.len() as f64
}

/// Fits a parabola to each value and its neighbours (Savitzky and Golay, 1964). The end values are continued.
fn smooth(values: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let m = SIDE as f64;
    let weight = |offset: f64| {
        3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * offset * offset)
            / ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0))
    };
    let last = values.len().saturating_sub(1);
    let at = |index: usize| {
        (0..=2 * SIDE)
            .map(|step| {
                let neighbour = (index + step).saturating_sub(SIDE).min(last);
                values[neighbour] * weight(step as f64 - m)
            })
            .sum()
    };
    (0..values.len()).map(at).collect()
}

/// Converts a computed number to a count; zero if it is not a valid count.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "ticks count far below 2^52"
)]
fn whole(count: f64) -> usize {
    count.max(0.0) as usize
}

/// Marks stretches of at least `least` ticks in which a condition holds, without their first `settling` ticks.
fn stretches(holds: impl Iterator<Item = bool>, least: usize, settling: usize) -> Vec<bool> {
    let mut mask: Vec<bool> = holds.collect();
    let mut first = 0;
    for tick in 0..=mask.len() {
        if mask.get(tick).copied().unwrap_or_default() {
            continue;
        }
        let length = tick - first;
        let spoilt = if length < least { length } else { settling.min(length) };
        mask[first..first + spoilt].fill(false);
        first = tick + 1;
    }
    mask
}
