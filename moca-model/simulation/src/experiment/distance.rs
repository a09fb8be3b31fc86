//! How well the robot keeps its place beside a walking person.

use std::collections::VecDeque;

use moca_model::ControllerSettings;
use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

use crate::people::Truth;
use moca_replay::report::TickRow;

/// A person counts as standing, or as walking evenly, from so long after the last change of velocity \[s\].
const SETTLE: f64 = 2.0;
/// Changes of velocity below this are none \[m/s\].
const CHANGE: f64 = 0.03;
/// Slower than this, people stand \[m/s\].
const STANDING: f64 = 0.02;
/// Where the hand is when the person stands is the mean of so long before they walk \[s\]: by then the robot has
/// come to them.
const BESIDE: f64 = 1.5;

/// How far the hand is from where it should be, in the person's own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DistanceError {
    /// From its place at the person's speed, in the mean while they walk evenly \[m\]; none if they never did.
    pub steady: Option<f64>,
    /// From where it is when they stand, likewise \[m\].
    pub behind: Option<f64>,
    /// The largest distance from where it is when they stand while they walk at all \[m\].
    pub largest: f64,
}

/// How far the hand is to stay behind somebody who walks away from it, by S_p, and is seen T_r late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowingDistance {
    /// From the person to the workspace, in their axes, of length 1.
    outward: Vector2<f64>,
    /// T_r and a of the base \[s, m/s²\].
    reaction_time: f64,
    deceleration: f64,
    /// How much less than C + Z_d + Z_r is there when they stand, negative \[m\].
    constant: f64,
}

impl FollowingDistance {
    /// By these settings; none where people are not kept at a distance.
    pub fn new(settings: &ControllerSettings) -> Option<Self> {
        let (space, terms) = (&settings.space, &settings.safety.separation);
        (settings.safety.pairs > 0).then(|| Self {
            outward: (space.min + space.max).xy().normalize(),
            reaction_time: terms.reaction_time,
            deceleration: terms.base.map_or(terms.deceleration, |base| base.deceleration),
            constant: terms.intrusion + terms.human_uncertainty + terms.robot_uncertainty
                - space.clearance,
        })
    }

    /// Where the hand is to be, from its place beside a standing person, behind one who walks at this velocity
    /// in their own axes \[m\].
    pub fn displacement(&self, velocity: &Vector2<f64>) -> Vector2<f64> {
        let speed = (-velocity.dot(&self.outward)).max(0.0);
        // The robot's way until it brakes, and the person's until the robot knows of it.
        let reaction = 2.0 * speed * self.reaction_time;
        let needed = reaction + speed * speed / (2.0 * self.deceleration);
        self.outward * (needed + self.constant).max(0.0)
    }
}

/// Watches the true person and the true hand.
#[derive(Clone, Debug)]
pub struct DistanceMonitor<'a> {
    truth: &'a [Truth],
    following: Option<FollowingDistance>,
    /// Of the velocity that is kept, and since when \[m/s, s\].
    kept: (Vector2<f64>, f64),
    /// Where the hand has been since the person stands, and when \[m, s\].
    standing: VecDeque<(f64, Vector2<f64>)>,
    /// Its place beside the standing person, once they walk \[m\].
    usual: Option<Vector2<f64>>,
    walking: Mean,
    /// How far from there it was to be meanwhile \[m\].
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
    /// For a person who truly moves so, and a robot that is to keep this distance.
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

    /// Where the person is at a time, which way they face, and how fast they move.
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

    /// What it came to.
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
