//! One of several people.

use nalgebra::Vector2;

use super::super::body_25::Body25;
use super::super::freshness::Freshness;
use super::super::joints::{JointFilter, JointVelocity};
use super::super::keypoints::Body;
use super::super::lengths::{SegmentLength, StatureEstimate};
use super::super::person_id::PersonId;
use super::super::pose::TrackedPerson;
use super::super::seen::Facing;
use super::super::segment::BodySegment;
use super::super::settings::TrackerSettings;
use super::super::tracker::BodyTracker;
use crate::body::people::settings::PeopleSettings;
use crate::error::Error;
use crate::percept::Percept;

/// Person among several who are followed: the track, the joints and the lengths of the segments.
#[derive(Clone, Debug)]
pub struct PersonTrack {
    id: PersonId,
    tracker: BodyTracker,
    joints: JointFilter,
    /// The joints of the newest frame in which the person was seen, as measured and as filtered.
    measured: Body,
    body: Body,
    /// Times when the person was first and last seen (s).
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

    /// Returns the person's number.
    pub fn id(&self) -> PersonId {
        self.id
    }

    /// Returns the filtered joints, with covariances, at the time of the newest frame in which the
    /// person was seen.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Returns the joints as measured in the newest frame in which the person was seen. Use them in
    /// a program that filters or checks the joints itself, such as a controller. Do not filter a
    /// filtered body again.
    pub fn measured(&self) -> &Body {
        &self.measured
    }

    /// Returns true if the person was seen in the newest frame.
    pub fn is_in_frame(&self) -> bool {
        self.claimed
    }

    /// Returns the person's pose at the time `now` (s). None before the track is accepted.
    pub fn predict(&self, now: f64) -> Option<TrackedPerson> {
        self.tracker.predict(now)
    }

    /// Returns the velocity of a joint at the time `now` (s), if it was seen recently.
    pub fn velocity(&self, joint: Body25, now: f64) -> Option<JointVelocity> {
        self.joints.velocity(joint, now)
    }

    /// Returns the person's stature, if enough segments were measured.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.tracker.stature()
    }

    /// Returns the length of one of the person's segments, if it was measured often enough.
    pub fn segment(&self, segment: BodySegment) -> Option<SegmentLength> {
        self.tracker.segment(segment)
    }

    /// Returns how many times the person's position or heading jumped.
    pub fn jumps(&self) -> u64 {
        self.tracker.jumps()
    }

    /// Begins a new frame and computes the person's expected position in it.
    pub(super) fn expect(&mut self, time: f64) {
        self.claimed = false;
        let tracked = self.tracker.predict(time).map(|person| person.floor.coords);
        self.expected = tracked.or(self.expected);
    }

    /// Returns the expected position, if no body of the frame is assigned yet.
    pub(super) fn expected(&self) -> Option<Vector2<f64>> {
        self.expected.filter(|_| !self.claimed)
    }

    /// Returns the direction that the person faces at the time `now` (s), if it is known.
    pub(super) fn facing(&self, now: f64) -> Option<Facing> {
        self.tracker.facing(now)
    }

    /// Returns true if this body of the newest frame belongs to the person.
    pub(super) fn has(&self, body: &Body) -> bool {
        self.claimed && self.measured.keypoints() == body.keypoints()
    }

    /// Assigns a body of the frame to this person.
    pub(super) fn claim(&mut self, body: &Body, time: f64) -> Result<(), Error> {
        let interval = time - self.last;
        // This person is followed by place. Another tracker may have given the body another id.
        let followed = body.clone().with_id(None);
        let percept = Percept { time, body: Some(followed), action: None, surface: None };
        self.tracker.update(&percept)?;
        let seen = self.tracker.look(body, interval);
        let floor = seen.best_floor(self.tracker.facing(time));
        self.expected = floor.map(|floor| floor.position).or(self.expected);
        let length = |segment| self.tracker.segment(segment).map(|known| known.length);
        let walking = self.tracker.predict(time).map(|person| person.velocity).unwrap_or_default();
        self.body = self.joints.update(body, &seen, time, walking, length).with_id(self.id);
        self.measured = body.clone().with_id(self.id);
        (self.first, self.last) = (self.first.min(time), time);
        self.claimed = true;
        Ok(())
    }

    /// Ends the frame. If the person was not in it, the track is predicted forward.
    pub(super) fn miss(&mut self, time: f64) -> Result<(), Error> {
        if self.claimed {
            return Ok(());
        }
        self.tracker.update(&Percept { time, body: None, action: None, surface: None })
    }

    /// Returns true if the person was not seen for long, or was lost before the track was accepted.
    pub(super) fn is_gone(&self, time: f64, settings: &PeopleSettings) -> bool {
        let unseen = time - self.last;
        unseen > settings.keep
            || (unseen > Freshness::COASTING && self.tracker.predict(time).is_none())
    }

    pub(super) fn is_seen(&self, time: f64) -> bool {
        self.tracker.predict(time).is_some_and(|person| person.freshness.is_usable())
    }

    pub(super) fn is_at(&self, floor: &Vector2<f64>, time: f64, radius: f64) -> bool {
        self.place(time).is_some_and(|here| (here - floor).norm() < radius)
    }

    /// Returns the person's position or, before the track is accepted, the expected one.
    pub(super) fn place(&self, time: f64) -> Option<Vector2<f64>> {
        self.tracker.predict(time).map(|person| person.floor.coords).or(self.expected)
    }

    /// Returns the distance from the workplace (m).
    pub(super) fn distance(&self, time: f64, settings: &PeopleSettings) -> f64 {
        let person = self.tracker.predict(time);
        person.map_or(f64::INFINITY, |person| (person.floor - settings.place).norm())
    }

    /// Returns true if the person is near the workplace and faces it.
    pub(super) fn engages(&self, time: f64, settings: &PeopleSettings) -> bool {
        let person = self.tracker.predict(time).filter(|person| person.freshness.is_usable());
        person.is_some_and(|person| {
            let towards = settings.place - person.floor;
            let facing = Vector2::new(person.heading.cos(), person.heading.sin());
            let angle = facing.angle(&towards);
            towards.norm() <= settings.radius && (angle <= settings.facing || is_there(&towards))
        })
    }

    /// Returns true if an engaged person stays engaged.
    pub(super) fn stays(&self, time: f64, settings: &PeopleSettings) -> bool {
        time - self.last <= settings.keep && self.distance(time, settings) <= settings.release
    }
}

/// Returns true if the person is at the workplace itself. The direction to it is then undefined.
fn is_there(towards: &Vector2<f64>) -> bool {
    towards.norm() < 0.1
}
