//! From noisy bodies to a pose that the control loop can use.

use nalgebra::{Point2, Vector1, Vector2, vector};

use super::{
    filter::ConstantVelocity,
    heading::Seen,
    pose::{TrackStatus, TrackedPerson},
    settings::TrackerSettings,
    stature::{StatureEstimate, StatureMean},
};
use crate::{Error, Percept};

/// Follows one person through the camera's frames.
///
/// Floor position and heading each have a Kalman filter of nearly constant velocity. Measurements
/// outside the gate are left out; when they persist for some frames and agree with one another, the
/// person really is there and the track starts again. Without measurements the person is coasted
/// along at constant velocity for at most half a second and is then lost.
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
    stature: StatureMean,
}

/// The person as of the last measurements that were taken in.
#[derive(Clone, Copy, Debug)]
struct Track {
    floor: ConstantVelocity<2>,
    floor_time: f64,
    heading: ConstantVelocity<1>,
    heading_time: f64,
    /// Headings in a row that were outliers.
    heading_outliers: u32,
}

/// Someone seen away from the track, who becomes the track if seen there for long enough.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    floor: Vector2<f64>,
    heading: Option<f64>,
    time: f64,
    frames: u32,
}

impl BodyTracker {
    /// A tracker that has seen nobody yet.
    ///
    /// # Errors
    /// [`Error::Setting`] if a setting is outside its range.
    pub fn new(settings: TrackerSettings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(Self {
            settings,
            last_time: None,
            track: None,
            candidate: None,
            stature: StatureMean::default(),
        })
    }

    /// The parameters.
    pub fn settings(&self) -> &TrackerSettings {
        &self.settings
    }

    /// Takes a percept in. Percepts come in the order of their time stamps, at any rate.
    ///
    /// # Errors
    /// [`Error::Time`] or [`Error::TimeOrder`] for a time stamp that is not finite or not later than
    /// the one before; the tracker is then as it was.
    pub fn update(&mut self, percept: &Percept) -> Result<(), Error> {
        let time = percept.time;
        if !time.is_finite() {
            return Err(Error::Time { time });
        }
        if let Some(previous) = self.last_time.filter(|&previous| time <= previous) {
            return Err(Error::TimeOrder { time, previous });
        }
        self.last_time = Some(time);
        let Some(body) = &percept.body else {
            return Ok(());
        };
        let seen = Seen::new(body, &self.settings);
        self.stature.update(&seen);
        let (floor, heading) = (seen.floor().map(|point| point.coords), seen.heading());

        let track = self
            .track
            .as_mut()
            .filter(|track| time - track.floor_time <= self.settings.coast_limit);
        let expected = match (track, floor) {
            (Some(track), Some(floor)) => track.take_floor(floor, time, &self.settings),
            (track, None) => track.is_some(),
            (None, Some(_)) => false,
        };
        if expected {
            if let (Some(track), Some(heading)) = (&mut self.track, heading) {
                track.take_heading(heading, time, &self.settings);
            }
            if floor.is_some() {
                self.candidate = None;
            }
        } else if let Some(floor) = floor {
            self.consider(floor, heading, time);
        }
        Ok(())
    }

    /// Forgets where anybody was, and when: for frames whose time stamps turned out to be wrong, or a
    /// clock that was set. The stature stays.
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
        let moving = if status == TrackStatus::Lost { 0.0 } else { 1.0 };
        let turning = if heading_age > settings.turn_limit { 0.0 } else { 1.0 };
        let turned =
            track.heading.velocity * extrapolated(now, track.heading_time, settings.turn_limit);
        let walked =
            track.floor.velocity * extrapolated(now, track.floor_time, settings.coast_limit);
        Some(TrackedPerson {
            floor: Point2::from(track.floor.position + walked),
            heading: (track.heading.position + turned).x,
            velocity: track.floor.velocity * moving,
            heading_rate: track.heading.velocity.x * turning,
            age,
            heading_age,
            status,
        })
    }

    /// The person's stature, once the legs were seen often enough.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.stature.estimate()
    }

    /// Somebody is seen where the track does not expect anybody.
    fn consider(&mut self, floor: Vector2<f64>, heading: Option<f64>, time: f64) {
        let settings = &self.settings;
        let candidate = match self.candidate {
            Some(before) if before.agrees_with(floor, time, settings) => Candidate {
                floor,
                heading: heading.or(before.heading),
                time,
                frames: before.frames.saturating_add(1),
            },
            _ => Candidate { floor, heading, time, frames: 1 },
        };
        self.candidate = Some(candidate);
        if let Some(heading) =
            candidate.heading.filter(|_| candidate.frames >= settings.acquire_frames)
        {
            // The heading stays on the branch where it was, so that it never jumps by a turn.
            let heading =
                self.predict(time).map_or(heading, |old| nearest_branch(heading, old.heading));
            self.track = Some(Track {
                floor: ConstantVelocity::starting_at(floor, &self.settings.position_noise()),
                floor_time: time,
                heading: ConstantVelocity::starting_at(
                    vector![heading],
                    &self.settings.heading_noise(),
                ),
                heading_time: time,
                heading_outliers: 0,
            });
            self.candidate = None;
        }
    }
}

impl Track {
    /// Takes a position in unless it is an outlier; whether it was taken in.
    fn take_floor(&mut self, floor: Vector2<f64>, time: f64, settings: &TrackerSettings) -> bool {
        let noise = settings.position_noise();
        let mut filter = self.floor.advanced(time - self.floor_time, &noise);
        if filter.surprise(&floor, &noise) > settings.gate {
            return false;
        }
        filter.correct(&floor, &noise);
        self.floor = filter;
        self.floor_time = time;
        true
    }

    /// Takes a heading in unless it is an outlier that does not last.
    fn take_heading(&mut self, heading: f64, time: f64, settings: &TrackerSettings) {
        let noise = settings.heading_noise();
        let elapsed = (time - self.heading_time).min(settings.coast_limit);
        let mut filter = self.heading.advanced(elapsed, &noise);
        // Turned no further than `predict` says.
        filter.position =
            self.heading.position + self.heading.velocity * elapsed.min(settings.turn_limit);
        let measured = Vector1::new(nearest_branch(heading, filter.position.x));
        if filter.surprise(&measured, &noise) <= settings.gate {
            filter.correct(&measured, &noise);
        } else if self.heading_outliers + 1 < settings.acquire_frames {
            self.heading_outliers += 1;
            return;
        } else {
            filter = ConstantVelocity::starting_at(measured, &noise);
        }
        self.heading = filter;
        self.heading_time = time;
        self.heading_outliers = 0;
    }
}

impl Candidate {
    fn agrees_with(&self, floor: Vector2<f64>, time: f64, settings: &TrackerSettings) -> bool {
        let elapsed = time - self.time;
        elapsed <= settings.coast_limit
            && (floor - self.floor).norm() <= settings.acquire_radius + settings.max_speed * elapsed
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

/// The angle that differs from `angle` by whole turns and is nearest to `reference` (rad).
fn nearest_branch(angle: f64, reference: f64) -> f64 {
    use std::f64::consts::TAU;
    angle + TAU * ((reference - angle) / TAU).round()
}
