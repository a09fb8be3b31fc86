//! Tracks a person from noisy bodies and predicts a pose for the control loop.

use nalgebra::Point2;

use super::{
    filter::Measurement,
    frame_noise::FrameNoise,
    freshness::Freshness,
    heading::Heading,
    identity::Identity,
    keypoints::Body,
    lean::Lean,
    lengths::{SegmentLength, StatureEstimate},
    person_id::PersonId,
    pose::TrackedPerson,
    seen::{Facing, Seen},
    segment::BodySegment,
    settings::{TURN_LIMIT, TrackerSettings, turning, walking},
    track::{Candidate, Track, nearest_branch},
    two_models::TwoModels,
};
use crate::error::Error;
use crate::percept::Percept;

/// Follows one person through the camera's frames.
///
/// Position and heading each have two Kalman filters, one for a standing and one for a moving
/// person. Their weights follow from how well they explain the frames. The body's covariances are
/// used if they are known. If not, the noise of the position is estimated from the frames.
///
/// Measurements outside the gate are left out. If they last for several frames, agree with one
/// another and are too far away for noise, the track restarts there. If measurements are missing,
/// the track is predicted at constant velocity for at most half a second. [`Freshness`] states how
/// well the person's place is known. The lengths of segments measured after a restart show whether it is another person.
/// A body with another id than the one before is another person: the tracker begins anew.
///
/// [`update`](Self::update) takes each percept as it comes. [`predict`](Self::predict) returns the
/// person's pose at any time and allocates nothing. Joints that are missing, have low confidence or
/// are not finite are ignored. No pose ever contains NaN, whatever the input.
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
    id: Option<PersonId>,
    track: Option<Track>,
    candidate: Option<Candidate>,
    identity: Identity,
    lean: Lean,
    noise: FrameNoise,
    jumps: u64,
}

impl BodyTracker {
    /// Creates a tracker without a person.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is outside its range.
    pub fn new(settings: TrackerSettings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(Self::unseen(settings))
    }

    fn unseen(settings: TrackerSettings) -> Self {
        Self {
            noise: FrameNoise::at_least(settings.position_sigma),
            settings,
            last_time: None,
            id: None,
            track: None,
            candidate: None,
            identity: Identity::default(),
            lean: Lean::default(),
            jumps: 0,
        }
    }

    /// Updates the track with a percept. Percepts must come in the order of their time stamps, at
    /// any rate.
    ///
    /// # Errors
    /// [`Error::Value`] if a time stamp is not finite or not later than the previous one. The
    /// tracker is then unchanged.
    pub fn update(&mut self, percept: &Percept) -> Result<(), Error> {
        let time = percept.time;
        check_time(time, self.last_time)?;
        let interval = self.last_time.map_or(f64::INFINITY, |previous| time - previous);
        self.last_time = Some(time);
        let Some(body) = &percept.body else {
            return Ok(());
        };
        self.recognise(body.id());
        let seen = self.look(body, interval);
        self.identity.update(&seen);
        let facing = self.facing(time);
        let lean = facing.map(|facing| self.lean.in_world(facing.angle, time)).unwrap_or_default();
        let (floors, heading) = (seen.floors(&lean, facing), seen.heading());
        let best = seen.best_floor(facing);

        let track =
            self.track.as_mut().filter(|track| time - track.floor_time <= Freshness::COASTING);
        let outlier = match (track, best) {
            (Some(track), Some(_)) => {
                let floors = floors.into_iter().flatten();
                track.take_floor(floors, time).err()
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
                if let Some(floor) = best {
                    self.candidate = None;
                    self.noise.update(time, floor.position);
                }
            }
            (Some(distance), Some(floor)) => {
                self.consider(floor, heading, time, distance);
            }
            (Some(_), None) => {}
        }
        Ok(())
    }

    /// Forgets the person before if the body seen before this one has another id.
    fn recognise(&mut self, seen: Option<PersonId>) {
        if let (Some(before), Some(now)) = (self.id, seen)
            && before != now
        {
            let Self { last_time, jumps, .. } = *self;
            *self = Self { last_time, jumps, ..Self::unseen(self.settings.clone()) };
        }
        self.id = seen;
    }

    /// Returns the id of the body seen last, if it has one.
    pub fn id(&self) -> Option<PersonId> {
        self.id
    }

    /// Returns the view of a body, with the noise of frames so far. `interval` is the time since the
    /// previous frame (s).
    pub(super) fn look<'body>(&self, body: &'body Body, interval: f64) -> Seen<'body> {
        let (noise, lasting) = (self.noise.covariance(), self.noise.lasting());
        Seen::new(body, &self.settings, interval).with_noise(noise, lasting)
    }

    /// Forgets the track and the time. Use it if time stamps were wrong or a clock was set. The
    /// lengths of the person's segments stay.
    pub fn forget(&mut self) {
        self.last_time = None;
        self.track = None;
        self.candidate = None;
        self.noise = FrameNoise::at_least(self.settings.position_sigma);
    }

    /// Returns the person's pose at the time `now` (s), or `None` if no person is tracked yet. A
    /// time before the last measurement gives the pose of that measurement. If it is earlier by
    /// more than 0.12 s, a clock is wrong and the person counts as lost.
    pub fn predict(&self, now: f64) -> Option<TrackedPerson> {
        let track = self.track.as_ref()?;
        let age = age_at(now, track.floor_time, Freshness::TRACKED);
        let heading_age = age_at(now, track.heading_time, Freshness::TRACKED);
        let freshness = Freshness::at(age);
        let coasted = extrapolated(now, track.floor_time);
        let advanced = track.floor.advanced(coasted, &walking());
        let moving = if freshness.is_usable() { 1.0 } else { 0.0 };
        let turning = if heading_age > TURN_LIMIT { 0.0 } else { 1.0 };
        let heading = Self::heading(track, now);
        Some(TrackedPerson {
            floor: Point2::from(advanced.position()),
            heading: heading.position().x,
            velocity: advanced.velocity() * moving,
            heading_rate: heading.velocity().x * turning,
            floor_covariance: advanced.position_covariance(),
            velocity_covariance: advanced.velocity_covariance(),
            age,
            heading_age,
            freshness,
        })
    }

    /// Returns the direction that the person faces at the time `now` (s), if it is known.
    pub(super) fn facing(&self, now: f64) -> Option<Facing> {
        let heading = Self::heading(self.track.as_ref()?, now);
        Some(Facing { angle: heading.position().x, variance: heading.position_covariance().x })
    }

    fn heading(track: &Track, now: f64) -> TwoModels<1> {
        let age = extrapolated(now, track.heading_time);
        track.heading.advanced(age, &turning())
    }

    /// Returns the person's stature, if enough segments were measured.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.identity.stature()
    }

    /// Returns the length of one of the person's segments, if it was measured often enough.
    pub fn segment(&self, segment: BodySegment) -> Option<SegmentLength> {
        self.identity.length(segment)
    }

    /// Returns how many times a tracked person's position or heading jumped.
    pub fn jumps(&self) -> u64 {
        self.jumps
    }

    /// Considers a person seen away from the track. `distance` is squared, and infinite without a
    /// track.
    fn consider(
        &mut self,
        floor: Measurement<2>,
        heading: Option<Heading>,
        time: f64,
        distance: f64,
    ) {
        let candidate = Candidate::seen(self.candidate, floor, heading, time, distance);
        self.candidate = Some(candidate);
        if let Some((floor, heading)) = candidate.accepted() {
            // The heading stays near the previous one, so that it never jumps by a whole turn.
            let angle = self
                .predict(time)
                .map_or(heading.angle, |old| nearest_branch(heading.angle, old.heading));
            let heading = self.settings.heading(angle, &heading);
            let (jumped, lost) = (candidate.is_jump(), distance.is_infinite());
            if self.track.is_some() && (jumped || lost) {
                self.identity.doubt();
                self.lean = Lean::default();
                self.noise = FrameNoise::at_least(self.settings.position_sigma);
            }
            self.jumps += u64::from(jumped);
            self.track = Some(Track::starting_at(&floor, &heading, time));
            self.candidate = None;
        }
    }
}

/// Returns the time since `then`. Infinite if `now` is not a number, or earlier by more than
/// `tolerance`.
fn age_at(now: f64, then: f64, tolerance: f64) -> f64 {
    let age = now - then;
    if age >= -tolerance { age.max(0.0) } else { f64::INFINITY }
}

/// Returns how long a motion measured at `then` is continued until `now`: at most for
/// [`Freshness::COASTING`], and for it if `now` is not a number.
fn extrapolated(now: f64, then: f64) -> f64 {
    if now < then { 0.0 } else { (now - then).min(Freshness::COASTING) }
}

/// Checks that a time is finite and later than the previous one.
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
