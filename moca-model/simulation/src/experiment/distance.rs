//! Measurement of how well the robot keeps its place beside a walking person.

use std::collections::VecDeque;

use moca_model::{ControllerSettings, SharedSpace};
use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

use moca_replay::report::TickRow;
use simulated_people::Truth;

/// Time after the last change of velocity from which on a person counts as standing or walking evenly \[s\].
const SETTLE: f64 = 2.0;
/// Smallest change of velocity that counts \[m/s\].
const CHANGE: f64 = 0.03;
/// Speed below which people stand \[m/s\].
const STANDING: f64 = 0.02;
/// Time before they walk over which the hand's place is averaged \[s\]. The robot has reached the person by then.
const BESIDE: f64 = 1.5;

/// The distance of the hand from its nominal place, in the person's own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DistanceError {
    /// Mean distance from the nominal place at the person's speed while they walk evenly \[m\]; `None` if they never
    /// did.
    pub steady: Option<f64>,
    /// Mean distance from the place beside the standing person while they walk evenly \[m\]; `None` if they never did.
    pub behind: Option<f64>,
    /// Largest distance from the place beside the standing person while they walk \[m\].
    pub largest: f64,
}

/// The distance by which the hand stays behind a person who walks away and is seen T_r late, by S_p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowingDistance {
    /// Unit vector from the person to the workspace, in the person's axes.
    outward: Vector2<f64>,
    /// T_r, and a of the base \[s, m/s²\].
    reaction_time: f64,
    deceleration: f64,
    /// C + Z_d + Z_r minus the clearance beside a standing person \[m\].
    constant: f64,
}

impl FollowingDistance {
    /// Creates the distance of these settings; `None` if no distances from people are kept.
    pub fn new(settings: &ControllerSettings) -> Option<Self> {
        let (space, terms) = (&settings.space, &settings.safety.separation);
        settings.safety.keeps_distances().then(|| Self {
            outward: (space.min + space.max).xy().normalize(),
            reaction_time: terms.reaction_time,
            deceleration: terms.base.map_or(terms.deceleration, |base| base.deceleration),
            constant: terms.intrusion + terms.human_uncertainty + terms.robot_uncertainty
                - SharedSpace::CLEARANCE,
        })
    }

    /// The nominal displacement of the hand from its place beside a standing person \[m\]. The person walks at this
    /// velocity in their own axes.
    pub fn displacement(&self, velocity: &Vector2<f64>) -> Vector2<f64> {
        let speed = (-velocity.dot(&self.outward)).max(0.0);
        // The robot's distance until it brakes, and the person's until the robot notices.
        let reaction = 2.0 * speed * self.reaction_time;
        let needed = reaction + speed * speed / (2.0 * self.deceleration);
        self.outward * (needed + self.constant).max(0.0)
    }
}

/// Compares the true hand with the true person.
#[derive(Clone, Debug)]
pub struct DistanceMonitor<'a> {
    truth: &'a [Truth],
    following: Option<FollowingDistance>,
    /// The velocity that is kept, and since when \[m/s, s\].
    kept: (Vector2<f64>, f64),
    /// Places of the hand since the person stands, and their times \[m, s\].
    standing: VecDeque<(f64, Vector2<f64>)>,
    /// The hand's place beside the standing person, once they walk \[m\].
    usual: Option<Vector2<f64>>,
    walking: Mean,
    /// Mean nominal distance from there \[m\].
    asked: Mean,
    largest: f64,
}

/// A running mean.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: Vector2<f64>,
    count: f64,
}

impl Mean {
    fn push(&mut self, value: Vector2<f64>) {
        self.sum += value;
        self.count += 1.0;
    }

    fn value(self) -> Option<Vector2<f64>> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

impl<'a> DistanceMonitor<'a> {
    /// Creates a monitor for the true motion of a person, and a robot that keeps this distance.
    pub fn new(truth: &'a [Truth], following: Option<FollowingDistance>) -> Self {
        Self {
            truth,
            following,
            kept: (Vector2::zeros(), f64::INFINITY),
            standing: VecDeque::new(),
            usual: None,
            walking: Mean::default(),
            asked: Mean::default(),
            largest: 0.0,
        }
    }

    /// Takes a tick.
    pub fn push(&mut self, row: &TickRow) {
        let Some((floor, heading, velocity)) = self.person(row.time) else { return };
        if (velocity - self.kept.0).norm() > CHANGE || self.kept.1 > row.time {
            self.kept = (velocity, row.time);
        }
        if !row.collaborating {
            return;
        }
        let hand = Vector2::new(row.actual[0], row.actual[1]) - floor;
        let hand = Rotation2::new(-heading) * hand;
        let settled = row.time - self.kept.1 >= SETTLE;
        if velocity.norm() > STANDING {
            if !self.standing.is_empty() {
                let mut mean = Mean::default();
                self.standing.drain(..).for_each(|(_, hand)| mean.push(hand));
                self.usual = self.usual.or(mean.value());
            }
            if let Some(usual) = self.usual {
                self.largest = self.largest.max((hand - usual).norm());
            }
            if settled {
                self.walking.push(hand);
                let velocity = Rotation2::new(-heading) * velocity;
                let asked = |following: FollowingDistance| following.displacement(&velocity);
                self.asked.push(self.following.map_or(Vector2::zeros(), asked));
            }
        } else if settled {
            self.standing.push_back((row.time, hand));
            while self.standing.front().is_some_and(|(time, _)| row.time - time > BESIDE) {
                self.standing.pop_front();
            }
        }
    }

    /// The person's place, heading and velocity at a time.
    fn person(&self, time: f64) -> Option<(Vector2<f64>, f64, Vector2<f64>)> {
        let next = self.truth.partition_point(|truth| truth.time <= time);
        let before = self.truth.get(next.checked_sub(1)?)?;
        let after = self.truth.get(next).unwrap_or(before);
        let span = after.time - before.time;
        let share = if span > 0.0 { (time - before.time) / span } else { 0.0 };
        let floor = before.floor.coords.lerp(&after.floor.coords, share);
        let heading = before.heading + (after.heading - before.heading) * share;
        Some((floor, heading, before.velocity.lerp(&after.velocity, share)))
    }

    /// The result.
    pub fn error(&self) -> DistanceError {
        let displacement = self.usual.zip(self.walking.value());
        let displacement = displacement.map(|(standing, walking)| walking - standing);
        DistanceError {
            steady: displacement
                .zip(self.asked.value())
                .map(|(found, asked)| (found - asked).norm()),
            behind: displacement.map(|found| found.norm()),
            largest: self.largest,
        }
    }
}
