//! The person's frame and the shared workspace, from percepts.

use ergo_map::PersonFrame;
use hrsw::{
    Attachment, Bounds, FloorMotion, FrameFollower, HeldFrame, MovingWorkspace, PositionShape,
    Workspace,
};
use hrsw_safety::FollowingDistance;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};
use vision_models::{BodyTracker, Intention, Percept, StatureEstimate, TrackedPerson};

use crate::error::Error;
use crate::intention::IntentionFilter;
use crate::settings::ControllerSettings;
use crate::situation::Situation;

/// Distance of the workspace from the person's frame, beside its lead, up to which it is in place \[m, rad\].
const IN_PLACE: f64 = 0.05;
/// Room for rows of the position: a change from a box to a polytope with 14 faces.
pub(crate) const POSITION_ROWS: usize = 20;
/// Distance of the person's frame from where it is to be, up to which it has reached them \[m\].
const AT_PERSON: f64 = 0.25;
/// Largest angular speed \[rad/s\] and acceleration \[rad/s²\] of the person's frame. It turns more slowly if the farthest
/// corner of the workspace would be faster than the tool.
const TURNING: [f64; 2] = [0.5, 1.5];
/// Largest speed of that corner over that of the tool \[-\].
const SLOWER: f64 = 0.95;
/// Least speed of the workspace over that of the desired pose, so that the workspace is not the slower one \[-\].
const FASTER: f64 = 1.2;

/// Tracks the person, filters their intention, and moves the shared workspace with them.
///
/// While person and robot work together, the workspace is attached to the person and leads them in their walking
/// direction. It falls behind a person who walks away faster than the robot may follow. While they are apart, or while
/// the person is lost, it stays where it is, unless it was [assigned](Self::assign) another place.
#[derive(Debug, Clone)]
pub struct SharedSpace {
    tracker: BodyTracker,
    intention: IntentionFilter,
    hold: HeldFrame,
    frame: FrameFollower,
    /// Twist of what the frame follows, linear, then angular, in world axes.
    drift: Vector6<f64>,
    person: Option<TrackedPerson>,
    moving: MovingWorkspace,
    assigned: Option<Attachment>,
    carrier: Carrier,
    lead: f64,
    /// Distance behind a person who walks away; `None` if no distances are kept.
    following_distance: Option<FollowingDistance>,
    /// Horizontal unit vector from the person to the workspace, in the person's axes.
    bearing: Vector3<f64>,
    situation: Situation,
}

/// The carrier of the workspace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Carrier {
    Nothing,
    Person,
    Assigned,
}

impl SharedSpace {
    /// Assumed distance of a robot that works with a standing person from the nearest part that it must not touch
    /// \[m\]. The robot kept its place best with this value in the walks of `experiment following`.
    ///
    /// When the person walks away and separation needs more at their speed, the workspace falls behind by the
    /// difference ([`FollowingDistance`]).
    pub const CLEARANCE: f64 = 0.4;

    /// Creates a space that nobody shares, around the tool's present pose.
    ///
    /// # Errors
    /// Settings out of range, or a pose that is not finite.
    pub fn new(settings: &ControllerSettings, tool: &Isometry3<f64>) -> Result<Self, Error> {
        let space = &settings.space;
        let bounds = Bounds::new(space.min, space.max)?;
        let turn = Bounds::symmetric(space.turn)?;
        let rotation = tool.rotation * space.tool.inverse();
        let centre = (space.min + space.max) * 0.5;
        let origin = tool.translation.vector - rotation * centre;
        let frame = Isometry3::from_parts(Translation3::from(origin), rotation);
        let workspace = Workspace::new(frame, bounds, turn)?.with_reference(space.tool);
        let speed = FrameFollower::SPEED.max(FASTER * settings.desired.velocity);
        let safety = &settings.safety;
        let following = FollowingDistance::new(safety.separation, Self::CLEARANCE)?;
        let level = Vector3::new(centre.x, centre.y, 0.0);
        let farthest = space.min.abs().sup(&space.max.abs()).xy().norm();
        let [turning, turning_acceleration] = TURNING;
        let turning = turning.min(SLOWER * settings.desired.velocity / farthest.max(1e-9));
        let follower = FrameFollower::new(Isometry3::identity())?.with_speed(speed)?;
        Ok(Self {
            tracker: BodyTracker::new(settings.tracker())?,
            intention: IntentionFilter::new(),
            hold: HeldFrame::following(),
            drift: Vector6::zeros(),
            frame: follower.with_turning(turning, turning_acceleration)?,
            person: None,
            moving: MovingWorkspace::new(workspace, speed)?,
            assigned: None,
            carrier: Carrier::Nothing,
            lead: space.lead,
            following_distance: safety.keeps_distances().then_some(following),
            bearing: level.try_normalize(1e-9).unwrap_or_else(Vector3::x),
            situation: Situation::unknown(PersonFrame::new(Vector3::zeros(), 0.0)?),
        })
    }

    /// Takes a camera frame. A person with another id than before is somebody else: what is known of the one before
    /// is forgotten, the intention too.
    ///
    /// # Errors
    /// [`Error::Perception`] for times that go backwards; the frame is then ignored.
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        let before = self.tracker.id();
        self.tracker.update(percept)?;
        if let (Some(before), Some(now)) = (before, self.tracker.id())
            && before != now
        {
            self.person = None;
            self.intention.forget();
        }
        self.intention.update(percept.time, percept.action.as_ref());
        Ok(())
    }

    /// Forgets the person and their intention, after frames whose times turned out to be wrong. The workspace comes to
    /// rest.
    pub fn forget(&mut self) {
        self.tracker.forget();
        self.intention.forget();
        self.person = None;
        (self.situation.worker, self.situation.intention) = (None, Intention::Apart);
    }

    /// Sets the place of the workspace while robot and person are apart. `None` leaves it where it is.
    ///
    /// # Errors
    /// [`Error::Workspace`] for a pose that is not finite; the place then stays as it was.
    pub fn assign(&mut self, attachment: Option<Attachment>) -> Result<(), Error> {
        if self.carrier != Carrier::Person {
            match &attachment {
                Some(attachment) => self.moving.attach(attachment.clone())?,
                None => self.moving.detach(),
            }
            self.carrier = if attachment.is_some() { Carrier::Assigned } else { Carrier::Nothing };
        }
        self.assigned = attachment;
        Ok(())
    }

    /// Changes the shape of positions over `duration` \[s\].
    ///
    /// # Errors
    /// [`Error::Workspace`] for a change that needs more than 20 rows, or a duration that is not positive. A change
    /// between two kinds of shape needs the rows of both.
    pub fn reshape_position(&mut self, shape: &PositionShape, duration: f64) -> Result<(), Error> {
        let present = self.moving.workspace().position_shape();
        let needed = match (present, shape) {
            (PositionShape::Box(_), PositionShape::Box(_)) => 6,
            _ => present.row_count() + shape.row_count(),
        };
        if needed > POSITION_ROWS {
            let (what, most) = ("rows of the position", POSITION_ROWS);
            return Err(hrsw::Error::TooMany { what, got: needed, most }.into());
        }
        Ok(self.moving.reshape_position(shape, duration)?)
    }

    /// Moves a held frame to the mean place of the person, while the robot moves anyway.
    pub(crate) fn recentre(&mut self) {
        self.hold.recentre();
    }

    /// Advances frame and workspace by `period` to the time `now` \[s\], and returns the situation then.
    ///
    /// # Errors
    /// Poses that are not finite.
    pub fn advance(&mut self, now: f64, period: f64) -> Result<Situation, Error> {
        let seen_before = self.person.is_some();
        let was_usable = self.person.is_some_and(|person| person.freshness.is_usable());
        self.person = self.tracker.predict(now).or(self.person);
        let usable = self.person.filter(|person| person.freshness.is_usable());
        if let Some(person) = usable {
            if !seen_before {
                self.frame.reset(person.world_from_person())?;
                self.hold = HeldFrame::following();
            }
            let (target, twist) = self.hold(&person, period);
            self.frame.retarget(target, twist)?;
            if !was_usable {
                self.frame.approach_slowly();
            }
            self.drift = twist;
        } else {
            self.frame.hold();
            self.drift = Vector6::zeros();
        }
        let before = *self.frame.pose();
        self.frame.advance(period);
        if self.person.is_some() {
            self.moving.set_person(before, self.frame.twist())?;
        }
        self.follow(period)?;
        self.carry(usable.is_some())?;
        self.moving.advance(period)?;
        self.situation = self.present()?;
        Ok(self.situation)
    }

    /// The situation at the time of the last advance.
    pub fn situation(&self) -> &Situation {
        &self.situation
    }

    /// Computes the situation.
    fn present(&self) -> Result<Situation, Error> {
        let is_shared = self.carrier == Carrier::Person;
        let (pose, behind) = (self.frame.pose(), self.following_distance());
        let way = pose.inv_mul(self.workspace().world_from_workspace());
        let off = way.translation.vector - behind;
        let forward = pose.rotation * Vector3::x();
        let twist = self.frame.twist();
        let is_slow = twist.xy().norm() <= 0.06 && twist[5].abs() <= 0.12;
        Ok(Situation {
            worker: self.person,
            intention: self.intention.intention(),
            is_shared,
            is_in_place: is_shared
                && self.frame.distance() <= AT_PERSON
                && off.norm() <= self.lead + IN_PLACE
                && way.rotation.angle() <= IN_PLACE,
            is_at_rest: self.hold.is_held() && is_slow,
            frame: PersonFrame::new(
                pose.translation.vector + pose.rotation * behind,
                forward.y.atan2(forward.x),
            )?,
            velocity: self.drift.fixed_rows::<3>(0).into_owned(),
        })
    }

    /// The target of the person's frame, and its twist.
    fn hold(&mut self, person: &TrackedPerson, period: f64) -> (Isometry3<f64>, Vector6<f64>) {
        let stops = self.frame.stopping_pose();
        let forward = stops.rotation * Vector3::x();
        let stops = FloorMotion {
            position: stops.translation.vector.xy(),
            heading: forward.y.atan2(forward.x),
        };
        let seen = FloorMotion { position: person.floor.coords, heading: person.heading };
        let rate = FloorMotion { position: person.velocity, heading: person.heading_rate };
        let (target, rate) = self.hold.advance(seen, rate, stops, period);
        let (p, v) = (target.position, rate.position);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), target.heading);
        let pose = Isometry3::from_parts(Translation3::new(p.x, p.y, 0.0), turn);
        (pose, Vector6::new(v.x, v.y, 0.0, 0.0, 0.0, rate.heading))
    }

    /// Falls behind a person who walks away while they work with the robot, and catches up otherwise.
    fn follow(&mut self, period: f64) -> Result<(), Error> {
        let Some(following) = &mut self.following_distance else { return Ok(()) };
        let person = self.person.filter(|person| {
            person.freshness.is_usable() && self.intention.intention().is_together()
        });
        let away = person.map_or(0.0, |person| {
            let outward = person.world_from_person().rotation * self.bearing;
            -self.drift.xy().dot(&outward.xy())
        });
        Ok(following.advance(away, period)?)
    }

    /// Changes the carrier of the workspace when working together begins or ends.
    fn carry(&mut self, usable: bool) -> Result<(), Error> {
        let together = self.intention.intention().is_together() && self.person.is_some();
        let wanted = match (together, &self.assigned) {
            (true, _) => Carrier::Person,
            (false, Some(_)) => Carrier::Assigned,
            (false, None) => Carrier::Nothing,
        };
        // The workspace stops where it can when its person is lost.
        let lost = wanted == Carrier::Person && !usable;
        if lost && !matches!(self.moving.attachment(), Attachment::World(_)) {
            self.moving.detach();
        }
        let back = wanted == Carrier::Person
            && usable
            && !matches!(self.moving.attachment(), Attachment::Person(_));
        if wanted != self.carrier || back {
            match (wanted, &self.assigned) {
                (Carrier::Person, _) if usable => {
                    self.moving.attach(Attachment::Person(Isometry3::identity()))?;
                }
                (Carrier::Assigned, Some(attachment)) => self.moving.attach(attachment.clone())?,
                _ => self.moving.detach(),
            }
            self.carrier = wanted;
        }
        let direction = self.intention.intention().walking().filter(|_| together && usable);
        let lead = direction.map_or(Vector3::zeros(), |direction| {
            let unit = direction.unit();
            Vector3::new(unit.x, unit.y, 0.0) * self.lead
        });
        let behind = if together && usable { self.following_distance() } else { Vector3::zeros() };
        Ok(self.moving.set_lead(lead + behind)?)
    }

    /// The smooth frame that follows the person, and is held in the world while they stand.
    ///
    /// # Errors
    /// Poses that are not finite.
    pub fn person_frame(&self) -> Result<PersonFrame, Error> {
        let pose = self.frame.pose();
        let forward = pose.rotation * Vector3::x();
        Ok(PersonFrame::new(pose.translation.vector, forward.y.atan2(forward.x))?)
    }

    /// The shared workspace.
    pub fn workspace(&self) -> &Workspace {
        self.moving.workspace()
    }

    /// The motion of the workspace.
    pub fn moving(&self) -> &MovingWorkspace {
        &self.moving
    }

    /// The motion of the workspace, to reorient it and to change the shape of its orientations.
    pub fn moving_mut(&mut self) -> &mut MovingWorkspace {
        &mut self.moving
    }

    /// The tracked person's stature, once it was measured often enough.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.tracker.stature()
    }

    /// The offset by which the workspace stays behind a person who walks away, in the person's axes \[m\].
    fn following_distance(&self) -> Vector3<f64> {
        self.bearing * self.following_distance.map_or(0.0, |following| following.distance())
    }
}
