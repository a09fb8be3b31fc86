//! A led person: slides along the robot, and walks around it where that leads nowhere.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point2, Rotation2, Vector2, Vector3};
use simulated_people::{Joints, Lead, LedPerson, Way, Workplace};

use super::judge::Judge;
use crate::error::Error;
use crate::judges::Witness;

/// Least distance to which people come to the robot by themselves, but for their arms \[m\].
const ROOM: f64 = 0.01;
/// The way that somebody is moved to see how that changes the distance \[m\], and how much that must be.
const SHIFT: f64 = 1e-5;
const LEAST_SLOPE: f64 = 0.2;
/// Directions aside that are tried on either side \[rad\].
const ASIDE: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// People who get on at less than this share of their speed for so long \[s\] walk around what is in their way.
const STUCK: f64 = 0.2;
const PATIENCE: f64 = 0.4;
/// Angle between the way along an obstacle and the direction away from it \[rad\].
const ALONG: f64 = FRAC_PI_2 - 0.3;
/// Radius of the turn back towards an obstacle that is not at hand \[m\].
const TURN: f64 = 0.4;
/// Steps ahead that must be free before somebody turns to their goal again \[m\].
const AHEAD: [f64; 3] = [0.2, 0.4, 0.6];

/// Somebody who is led, as the judges see them.
#[derive(Clone, Debug)]
pub(super) struct Guided {
    pub(super) person: LedPerson,
    pub(super) witness: Witness,
    /// What they were told; on a detour they do something else.
    order: Lead,
    /// Time for which they have been stuck \[s\].
    stuck: f64,
    /// Side on which they walk around the robot, 1 with it on the right; chosen once for each order.
    side: Option<f64>,
    /// Side and direction of the way around it that they are on.
    detour: Option<(f64, Vector2<f64>)>,
}

impl Guided {
    pub(super) fn new(stature: f64, floor: Point2<f64>) -> Result<Self, Error> {
        let heading = (-floor.y).atan2(-floor.x);
        let person = LedPerson::new(stature, floor, heading)?;
        let (witness, order) = (Witness::default(), *person.told());
        Ok(Self { person, witness, order, stuck: 0.0, side: None, detour: None })
    }

    /// Takes an order.
    pub(super) fn lead(&mut self, lead: Lead) -> Result<(), Error> {
        // Somebody who is told the same way goes on with it.
        let goes_on = lead.way == self.order.way;
        let detour = self.detour.filter(|_| goes_on);
        lead.validate()?;
        self.person
            .lead(Lead { way: detour.map_or(lead.way, |(_, way)| Way::Along(way)), ..lead })?;
        self.side = self.side.filter(|_| goes_on);
        (self.order, self.detour) = (lead, detour);
        Ok(())
    }

    /// Goes on by a period \[s\]. Nobody walks or bends into the robot: they slide along it, and walk around it where
    /// that leads nowhere.
    pub(super) fn advance(&mut self, period: f64, workplace: &Workplace, judge: &Judge) {
        let (before, gap) = (self.person.clone(), judge.gap(&joints(&self.person), ROOM));
        self.person.advance(period, workplace);
        let wanted = self.person.person().floor() - before.person().floor();
        let now = joints(&self.person);
        let lost = gap - judge.gap(&now, ROOM);
        let mut away = None;
        if lost > 0.0 {
            let moved = |by: Vector3<f64>| judge.gap(&now.map(|joint| joint + by), 2.0 * ROOM);
            let slope = |axis: Vector3<f64>| {
                let step = axis * SHIFT;
                (moved(step) - moved(-step)) / (2.0 * SHIFT)
            };
            let slope = Vector2::new(slope(Vector3::x()), slope(Vector3::y()));
            if slope.norm() > LEAST_SLOPE {
                self.person.slide(slope / slope.norm(), lost / slope.norm());
                away = Some(slope / slope.norm());
            }
            if judge.gap(&joints(&self.person), ROOM) < gap - SHIFT {
                self.step_aside(before.clone(), wanted, (gap, judge));
            }
        }
        let went = self.person.person().floor() - before.person().floor();
        self.look_for_a_way((went.norm(), away), period, judge);
        self.witness.push(&joints(&self.person), false);
    }

    /// Goes from where they were in the direction nearest to the wanted one that does not lead into the robot. What is
    /// above or below may leave none; they then stop.
    fn step_aside(&mut self, before: LedPerson, wanted: Vector2<f64>, (gap, judge): (f64, &Judge)) {
        self.person = before;
        let Some(ahead) = wanted.try_normalize(0.0) else { return self.person.bump() };
        for turn in ASIDE.into_iter().flat_map(|turn| [turn, -turn]) {
            let mut aside = self.person.clone();
            aside.slide(Rotation2::new(turn) * ahead, wanted.norm());
            if judge.gap(&joints(&aside), ROOM) >= gap - SHIFT {
                self.person = aside;
                return;
            }
        }
        self.person.bump();
    }

    /// Begins, turns or ends the way around the robot, for somebody who `went` so far \[m\] and touches what lies
    /// against the direction `away`.
    fn look_for_a_way(
        &mut self,
        (went, away): (f64, Option<Vector2<f64>>),
        period: f64,
        judge: &Judge,
    ) {
        let Lead { way: Way::To(goal), speed, .. } = self.order else { return };
        let now = joints(&self.person);
        let left = goal - self.person.person().floor();
        let free = |way: f64| {
            let by = left * (way / left.norm()).min(1.0);
            judge.gap(&now.map(|joint| joint + by.push(0.0)), ROOM) >= ROOM
        };
        let is_free = || AHEAD.into_iter().all(free);
        let is_stuck = went < STUCK * speed * period && !is_free();
        self.stuck = if is_stuck { self.stuck + period } else { 0.0 };
        // Along what they touch; else by and by back to it.
        let along = |side: f64, away: Vector2<f64>| Rotation2::new(-side * ALONG) * away;
        let detour = match (self.detour, away) {
            // Nor do they go on around a robot that stands on the goal.
            (Some(_), _) if is_free() || !free(left.norm()) => None,
            (Some((side, _)), Some(away)) => Some((side, along(side, away))),
            (Some((side, way)), None) => {
                Some((side, Rotation2::new(-side * speed / TURN * period) * way))
            }
            (None, _) if self.stuck > PATIENCE && free(left.norm()) => {
                let away = away.unwrap_or(-left);
                let side = *self.side.get_or_insert(-away.perp(&left).signum());
                Some((side, along(side, away)))
            }
            (None, _) => None,
        };
        if detour != self.detour {
            self.detour = detour;
            let way = detour.map_or(self.order.way, |(_, way)| Way::Along(way));
            // A finite direction is an order that can be followed.
            let _ = self.person.lead(Lead { way, ..self.order });
        }
    }
}

pub(super) fn joints(person: &LedPerson) -> Joints {
    person.person().joints()
}
