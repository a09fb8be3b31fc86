//! Measures of how the workpiece follows a person who sets out and walks.

use std::ops::Range;

use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

/// Speed of the trunk from which on a person has set out \[m/s\].
const SETS_OUT: f64 = 0.2;
/// Speed of the workpiece from which on it has set out \[m/s\].
const FOLLOWS: f64 = 0.1;
/// Time before and after a walk begins in which the person sets out, and until when their direction is known \[s\].
const AROUND: f64 = 1.0;
/// Samples to each side for the speed of a trunk that sets out: a mean over 0.2 s.
const SIDE: usize = 2;

/// How the workpiece follows a person who walks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Following {
    /// Number of times that the person set out after they had stood.
    pub settings_out: usize,
    /// Mean time from when the person's trunk exceeds 0.2 m/s until the workpiece exceeds 0.1 m/s in their direction
    /// \[s\]. The whole walk counts if it never does. `None` if they never set out.
    pub onset: Option<f64>,
    /// The greatest of these times \[s\].
    pub onset_worst: Option<f64>,
    /// Mean distance by which the workpiece stays behind its place, along the direction of walking, from 0.5 s after
    /// the walk began \[m\]. The place is where the workpiece is on average while the person stands, relative to their
    /// trunk and heading. `None` if they never stood for 3 s.
    pub lag: Option<f64>,
}

/// The person's trunk, sample by sample.
#[derive(Debug, Clone)]
pub(super) struct Path {
    /// Sampling period \[s\].
    pub(super) step: f64,
    /// Place on the floor \[m\].
    pub(super) trunk: Vec<Vector2<f64>>,
    /// The same, smoothed so that gait does not sway it \[m\].
    pub(super) smooth: Vec<Vector2<f64>>,
    /// Heading, in any branch \[rad\].
    pub(super) heading: Vec<Rotation2<f64>>,
}

impl Path {
    /// The index before a time \[s\], and the share of the step after it.
    fn sample(&self, time: f64) -> (usize, f64) {
        let at = time / self.step;
        (super::whole(at.floor()), at - at.floor())
    }

    fn place(&self, time: f64) -> Vector2<f64> {
        let (before, share) = self.sample(time);
        let last = self.trunk.len() - 1;
        self.trunk[before.min(last)].lerp(&self.trunk[(before + 1).min(last)], share)
    }

    fn heading(&self, time: f64) -> Rotation2<f64> {
        self.heading[self.sample(time).0.min(self.heading.len() - 1)]
    }

    /// Direction of walking, a unit vector.
    fn direction(&self, time: f64) -> Vector2<f64> {
        let last = self.smooth.len() - 1;
        let at = self.sample(time).0.min(last);
        let way = self.smooth[(at + 1).min(last)] - self.smooth[at.saturating_sub(1)];
        way.try_normalize(0.0).unwrap_or_default()
    }

    /// Speed of the trunk about a sample \[m/s\].
    fn speed(&self, at: usize) -> f64 {
        let (from, to) = (at.saturating_sub(SIDE), (at + SIDE).min(self.trunk.len() - 1));
        (self.trunk[to] - self.trunk[from]).norm() / ((to - from) as f64 * self.step)
    }

    /// The time at which the person set out on a walk that begins about then \[s\]; `None` if they did not stand
    /// before.
    fn set_out(&self, begin: f64) -> Option<f64> {
        let from = self.sample((begin - AROUND).max(0.0)).0;
        let to = self.sample(begin + AROUND).0.min(self.trunk.len() - 1);
        if self.speed(from) >= super::STANDING[0] {
            return None;
        }
        let at = (from + 1..=to).find(|at| self.speed(*at) > SETS_OUT)?;
        let [before, after] = [at - 1, at].map(|at| self.speed(at));
        let share = (SETS_OUT - before) / (after - before);
        Some((at as f64 - 1.0 + share) * self.step)
    }
}

/// The workpiece, tick by tick.
#[derive(Debug)]
pub(super) struct Workpiece<'a> {
    pub(super) period: f64,
    /// Its place and velocity over the floor \[m, m/s\].
    pub(super) motion: &'a [[Vector2<f64>; 2]],
}

impl Workpiece<'_> {
    /// Judges walks, which `walking` marks from 0.5 s after they began. `settled` marks the ticks in which the person
    /// stands.
    pub(super) fn judge(
        &self,
        path: &Path,
        [walks, settled]: [&[bool]; 2],
        walking: &[bool],
    ) -> Option<Following> {
        let walks: Vec<_> = ranges(walks).collect();
        if walks.is_empty() {
            return None;
        }
        let onsets: Vec<f64> =
            walks.into_iter().filter_map(|walk| self.onset(path, walk)).collect();
        let mean = |values: &[f64]| {
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        Some(Following {
            settings_out: onsets.len(),
            onset: mean(&onsets),
            onset_worst: onsets.iter().copied().reduce(f64::max),
            lag: self.lag(path, settled, walking),
        })
    }

    fn onset(&self, path: &Path, walk: Range<usize>) -> Option<f64> {
        let begin = path.set_out(walk.start as f64 * self.period)?;
        let direction = (path.place(begin + AROUND) - path.place(begin)).try_normalize(0.0)?;
        let first = super::whole((begin / self.period).ceil());
        let sets_out =
            (first..walk.end).find(|tick| self.motion[*tick][1].dot(&direction) > FOLLOWS);
        Some(sets_out.unwrap_or(walk.end) as f64 * self.period - begin)
    }

    fn lag(&self, path: &Path, settled: &[bool], walking: &[bool]) -> Option<f64> {
        let times = |mask: &'_ [bool]| -> Vec<(usize, f64)> {
            let ticks = ranges(mask).flatten();
            ticks.map(|tick| (tick, tick as f64 * self.period)).collect()
        };
        let (stands, walks) = (times(settled), times(walking));
        if stands.is_empty() || walks.is_empty() {
            return None;
        }
        let place: Vector2<f64> = stands
            .iter()
            .map(|&(tick, time)| {
                path.heading(time).inverse() * (self.motion[tick][0] - path.place(time))
            })
            .sum::<Vector2<f64>>()
            / stands.len() as f64;
        let behind = walks.iter().map(|&(tick, time)| {
            let due = path.place(time) + path.heading(time) * place;
            (due - self.motion[tick][0]).dot(&path.direction(time))
        });
        Some(behind.sum::<f64>() / walks.len() as f64)
    }
}

/// The stretches of ticks that are marked.
fn ranges(mask: &[bool]) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let start = next + mask[next..].iter().position(|marked| *marked)?;
        let end = mask[start..].iter().position(|marked| !marked).map_or(mask.len(), |n| start + n);
        next = end;
        Some(start..end)
    })
}
