//! One of several people.

use nalgebra::Vector2;

use super::super::joints::{JointFilter, JointVelocity};
use super::super::keypoints::{Body, Body25};
use super::super::lengths::{SegmentLength, StatureEstimate};
use super::super::pose::TrackedPerson;
use super::super::seen::{Facing, Seen};
use super::super::segment::BodySegment;
use super::super::settings::TrackerSettings;
use super::super::tracker::BodyTracker;
use crate::body::people::settings::PeopleSettings;
use crate::error::Error;
use crate::percept::Percept;

/// The number of a person who is followed. Nobody gets the number of somebody before.
///
/// ```
/// use vision_models::PersonId;
///
/// fn same(one: PersonId, other: PersonId) -> bool {
///     one == other
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PersonId(u64);

impl PersonId {
    pub(super) fn new(number: u64) -> Self {
        Self(number)
    }

    /// Counted from zero.
    pub fn number(self) -> u64 {
        self.0
    }
}

/// One person among several: their track, their joints and the lengths of their segments.
#[derive(Clone, Debug)]
pub struct PersonTrack {
    id: PersonId,
    tracker: BodyTracker,
    joints: JointFilter,
    /// As measured, of the newest frame in which the person was seen, and as filtered.
    measured: Body,
    body: Body,
    /// When the person was seen first and last (s).
    first: f64,
    last: f64,
    expected: Option<Vector2<f64>>,
    claimed: bool,
}

impl PersonTrack {
    pub(super) fn new(id: PersonId, settings: &TrackerSettings) -> Result<Self, Error> {
        Ok(Self {
            id,
            tracker: BodyTracker::new(settings.clone())?,
            joints: JointFilter::new(),
            measured: Body::default(),
            body: Body::default(),
            first: f64::INFINITY,
            last: f64::NEG_INFINITY,
            expected: None,
            claimed: false,
        })
    }

    /// Who it is.
    pub fn id(&self) -> PersonId {
        self.id
    }

    /// The joints at the time of the newest frame in which the person was seen, filtered, with their
    /// covariances.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The joints as they were measured in the newest frame in which the person was seen: for who follows or
    /// judges them by itself, as a controller does. A body that is filtered is not to be filtered again.
    pub fn measured(&self) -> &Body {
        &self.measured
    }

    /// Returns true if the person was seen in the newest frame.
    pub fn is_in_frame(&self) -> bool {
        self.claimed
    }

    /// Where the person is at the time `now` (s), once they have been taken up.
    pub fn predict(&self, now: f64) -> Option<TrackedPerson> {
        self.tracker.predict(now)
    }

    /// How fast a joint moves at the time `now` (s), if it was seen of late.
    pub fn velocity(&self, joint: Body25, now: f64) -> Option<JointVelocity> {
        self.joints.velocity(joint, now, self.tracker.settings())
    }

    /// The person's stature, once the legs were seen often enough.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.tracker.stature()
    }

    /// The length of one of the person's segments, once it was seen often enough.
    pub fn segment(&self, segment: BodySegment) -> Option<SegmentLength> {
        self.tracker.segment(segment)
    }

    /// How many times the person was somewhere else at once.
    pub fn jumps(&self) -> u64 {
        self.tracker.jumps()
    }

    /// A new frame: where the person should be in it.
    pub(super) fn expect(&mut self, time: f64) {
        self.claimed = false;
        let tracked = self.tracker.predict(time).map(|person| person.floor.coords);
        self.expected = tracked.or(self.expected);
    }

    /// Where the person should be, if no body of the frame is theirs yet.
    pub(super) fn expected(&self) -> Option<Vector2<f64>> {
        self.expected.filter(|_| !self.claimed)
    }

    /// The way that the person faces at the time `now` (s), as far as it is known.
    pub(super) fn facing(&self, now: f64) -> Option<Facing> {
        self.tracker.facing(now)
    }

    /// Returns true if this body of the newest frame is the person's.
    pub(super) fn has(&self, body: &Body) -> bool {
        self.claimed && self.measured == *body
    }

    /// Takes the body of a frame for this person's.
    pub(super) fn claim(&mut self, body: &Body, time: f64) -> Result<(), Error> {
        let interval = time - self.last;
        let percept = Percept { time, body: Some(body.clone()), action: None, surface: None };
        self.tracker.update(&percept)?;
        let settings = self.tracker.settings();
        let seen = Seen::new(body, settings, interval);
        let floor = seen.best_floor(self.tracker.facing(time));
        self.expected = floor.map(|floor| floor.position).or(self.expected);
        let length = |segment| self.tracker.segment(segment).map(|known| known.length);
        let walking = self.tracker.predict(time).map(|person| person.velocity).unwrap_or_default();
        self.body = self.joints.update(body, &seen, time, walking, settings, length);
        self.measured = body.clone();
        (self.first, self.last) = (self.first.min(time), time);
        self.claimed = true;
        Ok(())
    }

    /// The frame is over; if the person was not in it, they are moved on.
    pub(super) fn miss(&mut self, time: f64) -> Result<(), Error> {
        if self.claimed {
            return Ok(());
        }
        self.tracker.update(&Percept { time, body: None, action: None, surface: None })
    }

    /// Not seen for long, or never for long enough to be followed.
    pub(super) fn is_gone(&self, time: f64, settings: &PeopleSettings) -> bool {
        let unseen = time - self.last;
        let coast = self.tracker.settings().coast_limit;
        unseen > settings.keep || (unseen > coast && self.tracker.predict(time).is_none())
    }

    pub(super) fn is_seen(&self, time: f64) -> bool {
        self.tracker.predict(time).is_some_and(|person| person.status.is_usable())
    }

    pub(super) fn is_at(&self, floor: &Vector2<f64>, time: f64, radius: f64) -> bool {
        self.place(time).is_some_and(|here| (here - floor).norm() < radius)
    }

    /// Where the person is or, before they are taken up, was seen.
    pub(super) fn place(&self, time: f64) -> Option<Vector2<f64>> {
        self.tracker.predict(time).map(|person| person.floor.coords).or(self.expected)
    }

    /// From the place of work (m).
    pub(super) fn distance(&self, time: f64, settings: &PeopleSettings) -> f64 {
        let person = self.tracker.predict(time);
        person.map_or(f64::INFINITY, |person| (person.floor - settings.place).norm())
    }

    /// Near the place of work and facing it.
    pub(super) fn engages(&self, time: f64, settings: &PeopleSettings) -> bool {
        let person = self.tracker.predict(time).filter(|person| person.status.is_usable());
        person.is_some_and(|person| {
            let towards = settings.place - person.floor;
            let facing = Vector2::new(person.heading.cos(), person.heading.sin());
            let angle = facing.angle(&towards);
            towards.norm() <= settings.radius && (angle <= settings.facing || is_there(&towards))
        })
    }

    /// Of a person who is engaged, whether they still are.
    pub(super) fn stays(&self, time: f64, settings: &PeopleSettings) -> bool {
        time - self.last <= settings.keep && self.distance(time, settings) <= settings.release
    }
}

/// On the place itself there is no direction to it.
fn is_there(towards: &Vector2<f64>) -> bool {
    towards.norm() < 0.1
}
