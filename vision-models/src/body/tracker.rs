//! From noisy bodies to a pose that the control loop can use.

use nalgebra::Point2;

use super::{
    filter::Measurement,
    identity::Identity,
    lean::Lean,
    lengths::{SegmentLength, StatureEstimate},
    pose::{TrackStatus, TrackedPerson},
    seen::{Facing, Heading, Seen},
    segment::BodySegment,
    settings::TrackerSettings,
    track::{Candidate, Track, nearest_branch},
    two_models::TwoModels,
};
use crate::error::Error;
use crate::percept::Percept;

/// Follows one person through the camera's frames.
///
/// Floor position and heading each have two Kalman filters, of who stands and of who moves, weighed by how well they
/// explain the frames. Measurements have the covariances of the body's joints where these are known. Measurements
/// outside the gate are left out; when they persist for some frames, agree with one another and are
/// too far away for noise, the person really is there and the track starts again. Without
/// measurements the person is coasted along at constant velocity for at most half a second and is
/// then lost. Lengths of segments measured after that tell whether it is another person.
///
/// [`update`](Self::update) takes each percept as it comes; [`predict`](Self::predict) says where
/// the person is now, at any rate, and allocates nothing. Joints that are missing, doubtful or not
/// finite are done without: whatever the input, no pose ever holds NaN.
///
/// ```
/// use vision_models::{BodyTracker, Percept, TrackerSettings};
///
/// let mut tracker = BodyTracker::new(TrackerSettings::default())?;
/// tracker.update(&Percept { time: 0.0, body: None, action: None, surface: None })?;
/// assert_eq!(tracker.predict(0.01), None); // Nobody seen yet.
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BodyTracker {
    settings: TrackerSettings,
    last_time: Option<f64>,
    track: Option<Track>,
    candidate: Option<Candidate>,
    identity: Identity,
    lean: Lean,
    jumps: u64,
}

impl BodyTracker {
    /// A tracker that has seen nobody yet.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is outside its range.
    pub fn new(settings: TrackerSettings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(Self {
            settings,
            last_time: None,
            track: None,
            candidate: None,
            identity: Identity::default(),
            lean: Lean::default(),
            jumps: 0,
        })
    }

    /// The parameters.
    pub fn settings(&self) -> &TrackerSettings {
        &self.settings
    }

    /// Takes a percept in. Percepts come in the order of their time stamps, at any rate.
    ///
    /// # Errors
    /// [`Error::Value`] for a time stamp that is not finite or not later than
    /// the one before; the tracker is then as it was.
    pub fn update(&mut self, percept: &Percept) -> Result<(), Error> {
        let time = percept.time;
        check_time(time, self.last_time)?;
        let interval = self.last_time.map_or(f64::INFINITY, |previous| time - previous);
        self.last_time = Some(time);
        let Some(body) = &percept.body else {
            return Ok(());
        };
        let seen = Seen::new(body, &self.settings, interval);
        self.identity.update(&seen);
        let facing = self.facing(time);
        let lean = facing.map(|facing| self.lean.in_world(facing.angle, time)).unwrap_or_default();
        let (floors, heading) = (seen.floors(&lean, facing), seen.heading());
        let best = seen.best_floor(facing);

        let track = self
            .track
            .as_mut()
            .filter(|track| time - track.floor_time <= self.settings.coast_limit);
        let outlier = match (track, best) {
            (Some(track), Some(_)) => {
                let floors = floors.into_iter().flatten();
                track.take_floor(floors, time, &self.settings).err()
            }
            (Some(_), None) => None,
            (None, _) => Some(f64::INFINITY),
        };
        match (outlier, best) {
            (None, _) => {
                if let (Some(track), Some(heading)) = (&mut self.track, heading) {
                    self.jumps += u64::from(track.take_heading(heading, time, &self.settings));
                }
                if let (Some((offset, variance)), Some(facing)) = (seen.lean(facing), facing) {
                    self.lean.update(&offset, variance, facing.angle, time);
                }
                if best.is_some() {
                    self.candidate = None;
                }
            }
            (Some(distance), Some(floor)) => {
                self.consider(floor, heading, time, distance);
            }
            (Some(_), None) => {}
        }
        Ok(())
    }

    /// Forgets where anybody was, and when: for frames whose time stamps turned out to be wrong, or a
    /// clock that was set. The lengths of the person's segments stay.
    pub fn forget(&mut self) {
        self.last_time = None;
        self.track = None;
        self.candidate = None;
    }

    /// Where the person is at the time `now` (s), or `None` if nobody has been taken up yet. A time
    /// before the last measurement gives the pose of that measurement; one that is earlier by more
    /// than `tracked_age` says that a clock is wrong, and the person counts as lost.
    pub fn predict(&self, now: f64) -> Option<TrackedPerson> {
        let settings = &self.settings;
        let track = self.track.as_ref()?;
        let age = age_at(now, track.floor_time, settings.tracked_age);
        let heading_age = age_at(now, track.heading_time, settings.tracked_age);
        let status = if age <= settings.tracked_age {
            TrackStatus::Tracked
        } else if age <= settings.coast_limit {
            TrackStatus::Coasting
        } else {
            TrackStatus::Lost
        };
        let coasted = extrapolated(now, track.floor_time, settings.coast_limit);
        let advanced = track.floor.advanced(coasted, &settings.walking());
        let moving = if status == TrackStatus::Lost { 0.0 } else { 1.0 };
        let turning = if heading_age > settings.turn_limit { 0.0 } else { 1.0 };
        let heading = self.heading(track, now);
        Some(TrackedPerson {
            floor: Point2::from(advanced.position()),
            heading: heading.position().x,
            velocity: advanced.velocity() * moving,
            heading_rate: heading.velocity().x * turning,
            floor_covariance: advanced.position_covariance(),
            velocity_covariance: advanced.velocity_covariance(),
            age,
            heading_age,
            status,
        })
    }

    /// The way that the person faces at the time `now` (s), as far as it is known.
    pub(super) fn facing(&self, now: f64) -> Option<Facing> {
        let heading = self.heading(self.track.as_ref()?, now);
        Some(Facing { angle: heading.position().x, variance: heading.position_covariance().x })
    }

    fn heading(&self, track: &Track, now: f64) -> TwoModels<1> {
        let age = extrapolated(now, track.heading_time, self.settings.coast_limit);
        track.heading.advanced(age, &self.settings.turning())
    }

    /// The person's stature, once the legs were seen often enough.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.identity.stature()
    }

    /// The length of one of the person's segments, once it was seen often enough.
    pub fn segment(&self, segment: BodySegment) -> Option<SegmentLength> {
        self.identity.length(segment)
    }

    /// How many times a person who was tracked was somewhere else at once, or turned at once.
    pub fn jumps(&self) -> u64 {
        self.jumps
    }

    /// Somebody is seen where the track does not expect anybody: `distance` squared away, infinite
    /// without a track.
    fn consider(
        &mut self,
        floor: Measurement<2>,
        heading: Option<Heading>,
        time: f64,
        distance: f64,
    ) {
        let settings = &self.settings;
        let candidate = Candidate::seen(self.candidate, floor, heading, time, distance, settings);
        self.candidate = Some(candidate);
        if let Some((floor, heading)) = candidate.accepted(settings) {
            // The heading stays on the branch where it was, so that it never jumps by a turn.
            let angle = self
                .predict(time)
                .map_or(heading.angle, |old| nearest_branch(heading.angle, old.heading));
            let heading = settings.heading(angle, heading.variance);
            let (jumped, lost) = (candidate.is_jump(&self.settings), distance.is_infinite());
            if self.track.is_some() && (jumped || lost) {
                self.identity.doubt();
                self.lean = Lean::default();
            }
            self.jumps += u64::from(jumped);
            self.track = Some(Track::starting_at(&floor, &heading, time, settings));
            self.candidate = None;
        }
    }
}

/// The time since `then`; infinite if `now` is no time at all, or earlier by more than `tolerance`.
fn age_at(now: f64, then: f64, tolerance: f64) -> f64 {
    let age = now - then;
    if age >= -tolerance { age.max(0.0) } else { f64::INFINITY }
}

/// How long a motion measured at `then` is carried on until `now`: at most `limit`, and for all of it
/// if `now` is no time at all.
fn extrapolated(now: f64, then: f64, limit: f64) -> f64 {
    if now < then { 0.0 } else { (now - then).min(limit) }
}

/// Checks that a time is finite and later than the one before.
pub(super) fn check_time(time: f64, previous: Option<f64>) -> Result<(), Error> {
    if !time.is_finite() {
        return Err(Error::value("time stamp", format!("{time} s"), "finite seconds"));
    }
    match previous.filter(|&previous| time <= previous) {
        Some(previous) => {
            let got = format!("{time} s, not later than {previous} s of the percept before");
            Err(Error::value(
                "time stamp",
                got,
                "percepts in the order in which the camera took them",
            ))
        }
        None => Ok(()),
    }
}
