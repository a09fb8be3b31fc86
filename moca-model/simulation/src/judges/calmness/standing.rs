//! Stillness of the workpiece in runs of any length.

use std::collections::VecDeque;
use std::ops::AddAssign;

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::{AT_REST, AVERAGED, LEFT, RIGHT, STANDING, TRUNK, middle, whole};
use simulated_people::Joints;

/// Time over which the motion of the person is averaged \[s\].
const WINDOW: f64 = 0.2;
/// Time after which a person counts who stands and works with the robot \[s\].
const SETTLING: f64 = 1.0;

/// How still workpiece and base are while the person stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stillness {
    /// Ticks in which the person stands.
    pub ticks: u64,
    /// Those of them with the base at rest.
    pub base_at_rest: u64,
    /// Sum of the squared speed of the workpiece over these ticks \[mm²/s²\].
    pub workpiece: u64,
}

impl Stillness {
    /// Root mean square of the speed of the workpiece \[mm/s\]; `None` without ticks.
    pub fn workpiece_rms(&self) -> Option<f64> {
        Some(self.share(self.workpiece)?.sqrt())
    }

    /// Share of the ticks with the base at rest; `None` without ticks.
    pub fn base_at_rest(&self) -> Option<f64> {
        self.share(self.base_at_rest)
    }

    fn share(&self, of: u64) -> Option<f64> {
        (self.ticks > 0).then(|| of as f64 / self.ticks as f64)
    }
}

impl AddAssign for Stillness {
    fn add_assign(&mut self, other: Self) {
        self.ticks += other.ticks;
        self.base_at_rest += other.base_at_rest;
        self.workpiece += other.workpiece;
    }
}

/// Watches a run, tick by tick, in memory that does not grow.
#[derive(Clone, Debug)]
pub(crate) struct StillnessMonitor {
    period: f64,
    person: VecDeque<[Vector2<f64>; 2]>,
    workpiece: VecDeque<Vector3<f64>>,
    /// Ticks since the person stands and works with the robot.
    since: usize,
    ticks: [u64; 2],
    squares: f64,
}

impl StillnessMonitor {
    /// Creates a monitor. Ticks are `period` \[s\] apart.
    pub(crate) fn new(period: f64) -> Self {
        let (person, workpiece) = (VecDeque::new(), VecDeque::new());
        Self { period, person, workpiece, since: 0, ticks: [0; 2], squares: 0.0 }
    }

    /// Takes a tick: the true person, the place of the workpiece \[m\], the velocity of the base \[m/s\], and whether
    /// person and robot work together undisturbed.
    pub(crate) fn watch(
        &mut self,
        person: &Joints,
        workpiece: Vector3<f64>,
        base: Vector2<f64>,
        together: bool,
    ) {
        let count = |time: f64| whole((time / self.period).round()).max(1);
        let across = middle(person, &LEFT) - middle(person, &RIGHT);
        let person = [middle(person, &TRUNK), across];
        let moved = oldest(&mut self.person, person, count(WINDOW));
        // The mean over some ticks moves by the difference of its ends.
        let averaged = count(AVERAGED);
        let before = oldest(&mut self.workpiece, workpiece, averaged);
        let turn = across.perp(&moved[1]).atan2(across.dot(&moved[1])).abs();
        let stands =
            (person[0] - moved[0]).norm() < STANDING[0] * WINDOW && turn < STANDING[1] * WINDOW;
        self.since = if stands && together { self.since + 1 } else { 0 };
        if self.since > count(SETTLING) {
            let speed = 1e3 * (workpiece - before).norm() / (averaged as f64 * self.period);
            self.squares += speed * speed;
            self.ticks[0] += 1;
            self.ticks[1] += u64::from(base.amax() < AT_REST);
        }
    }

    /// The result so far.
    pub(crate) fn stillness(&self) -> Stillness {
        let [ticks, base_at_rest] = self.ticks;
        Stillness { ticks, base_at_rest, workpiece: whole(self.squares.round()) as u64 }
    }
}

/// Adds a value, and returns the one of so many ticks before, or the first.
fn oldest<T: Copy>(values: &mut VecDeque<T>, value: T, ticks: usize) -> T {
    values.push_back(value);
    if values.len() > ticks + 1 {
        values.pop_front();
    }
    values.front().copied().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;

    #[test]
    fn a_swinging_workpiece_is_measured() {
        let mut monitor = StillnessMonitor::new(1e-3);
        let mut joints = [Point3::new(1.0, 0.0, 1.0); 25];
        joints[5].y = 0.2;
        joints[2].y = -0.2;
        for tick in 0..20_000 {
            let time = f64::from(tick) * 1e-3;
            // They stand for 12 s, and then walk.
            if tick > 12_000 {
                joints = joints.map(|joint| joint + Vector3::x() * 3e-4);
            }
            let x = 0.02 * (std::f64::consts::TAU * time).sin();
            let base = Vector2::new(if tick % 4 == 0 { 0.1 } else { 0.0 }, 0.0);
            monitor.watch(&joints, Vector3::new(x, 0.0, 1.0), base, tick > 500);
        }
        let still = monitor.stillness();
        assert!((10_400..10_700).contains(&still.ticks), "{still:?}");
        assert!((still.workpiece_rms().unwrap() - 88.9).abs() < 1.0, "{still:?}");
        assert!((still.base_at_rest().unwrap() - 0.75).abs() < 1e-3, "{still:?}");
    }
}
