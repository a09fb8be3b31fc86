//! Several people in the image, and the one who works with the robot.

mod person;
mod settings;

use nalgebra::Vector2;

pub use person::PersonTrack;
pub use settings::PeopleSettings;

use super::{
    keypoints::Body,
    person_id::PersonId,
    seen::{Facing, Seen},
    settings::TrackerSettings,
    tracker::check_time,
};
use crate::error::Error;
use crate::percept::Percept;

/// Follows several people at once and selects the one who engages with the robot.
///
/// Each body is assigned to the track whose expected position is nearest. A person engages by
/// standing near the workplace and facing it for a while. The person then stays engaged until they
/// leave or are lost, even if another person comes nearer.
///
/// ```
/// use vision_models::{Body, People, PeopleSettings, TrackerSettings};
///
/// let mut people = People::new(PeopleSettings::default(), TrackerSettings::default())?;
/// people.update(0.0, &[Body::default()])?;
/// assert!(people.engaged().is_none());
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct People {
    settings: PeopleSettings,
    tracker: TrackerSettings,
    tracks: Vec<PersonTrack>,
    engaged: Option<PersonId>,
    /// The person who may engage next, and the time since when (s).
    candidate: Option<(PersonId, f64)>,
    last_time: Option<f64>,
    next: u64,
    /// True if the source of the frames has given ids.
    source_has_ids: bool,
}

impl People {
    /// Creates a set of people without any person.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is outside its range.
    pub fn new(settings: PeopleSettings, tracker: TrackerSettings) -> Result<Self, Error> {
        settings.validate()?;
        tracker.validate()?;
        Ok(Self {
            tracks: Vec::with_capacity(settings.most),
            settings,
            tracker,
            engaged: None,
            candidate: None,
            last_time: None,
            next: 0,
            source_has_ids: false,
        })
    }

    /// Updates the tracks with the bodies of one frame. Frames must come in the order of their time
    /// stamps.
    ///
    /// # Errors
    /// [`Error::Value`]. Nothing is then changed.
    pub fn update<'a>(
        &mut self,
        time: f64,
        bodies: impl IntoIterator<Item = &'a Body, IntoIter: Clone>,
    ) -> Result<(), Error> {
        check_time(time, self.last_time)?;
        let bodies = bodies.into_iter();
        let interval = self.last_time.map_or(f64::INFINITY, |previous| time - previous);
        self.last_time = Some(time);
        for track in &mut self.tracks {
            track.expect(time);
        }
        let mut claimed = 0;
        while let Some((track, body)) = self.nearest_pair(&bodies, interval, time) {
            if let Some(track) = self.tracks.get_mut(track) {
                track.claim(body, time)?;
            }
            claimed += 1;
        }
        if claimed < bodies.clone().count() {
            self.begin(bodies, interval, time)?;
        }
        for track in &mut self.tracks {
            track.miss(time)?;
        }
        self.tracks.retain(|track| !track.is_gone(time, &self.settings));
        self.merge(time);
        self.select(time);
        Ok(())
    }

    /// Gives ids to the person of a percept and to the `others` of its frame, if their source has
    /// none. The settings are best [`PeopleSettings::untracked`]. A body that cannot be followed
    /// stays without an id. While one person is alone, there is nobody to confuse them with, and
    /// they get no id. A source that has given an id tells people apart itself, and its bodies without
    /// an id stay so.
    ///
    /// # Errors
    /// Those of [`update`](Self::update).
    pub fn identify(&mut self, percept: &mut Percept, others: &mut [Body]) -> Result<(), Error> {
        let is_alone = others.is_empty() && self.tracks.is_empty();
        let bodies = percept.body.iter().chain(&*others);
        self.source_has_ids |= bodies.clone().any(|body| body.id().is_some());
        if is_alone || self.source_has_ids {
            return Ok(());
        }
        self.update(percept.time, bodies)?;
        for body in percept.body.iter_mut().chain(others) {
            if let Some(track) = self.tracks.iter().find(|track| track.has(body)) {
                body.clone_from(track.measured());
            }
        }
        Ok(())
    }

    /// Forgets all people and the time. Use it if time stamps were wrong or a clock was set. Ids of
    /// the people before are not given again.
    pub fn forget(&mut self) {
        self.tracks.clear();
        (self.engaged, self.candidate, self.last_time) = (None, None, None);
        self.source_has_ids = false;
    }

    /// Returns all people who are followed.
    pub fn tracks(&self) -> &[PersonTrack] {
        &self.tracks
    }

    /// Returns the person who works with the robot or is about to.
    pub fn engaged(&self) -> Option<&PersonTrack> {
        let engaged = self.engaged?;
        self.tracks.iter().find(|track| track.id() == engaged)
    }

    /// Returns the heading at the time `now` (s) of the tracked person nearest to this body (rad).
    /// It is an input of [`Lifter::lift`](crate::Lifter::lift).
    pub fn heading_near(&self, body: &Body, now: f64) -> Option<f64> {
        let near = self.tracks.iter().filter_map(|track| {
            let person = track.predict(now).filter(|person| person.freshness.is_usable())?;
            let floor = floor(body, &self.tracker, f64::INFINITY, track.facing(now))?;
            Some(((person.floor.coords - floor).norm(), person.heading))
        });
        near.filter(|(distance, _)| *distance <= self.settings.reach)
            .min_by(|(one, _), (other, _)| one.total_cmp(other))
            .map(|(_, heading)| heading)
    }

    /// Returns the nearest pair of a track without a body and a body without a track.
    fn nearest_pair<'a>(
        &self,
        bodies: &(impl Iterator<Item = &'a Body> + Clone),
        interval: f64,
        now: f64,
    ) -> Option<(usize, &'a Body)> {
        let mut best: Option<(f64, usize, &Body)> = None;
        for (index, track) in self.tracks.iter().enumerate() {
            let Some(expected) = track.expected() else { continue };
            let facing = track.facing(now);
            for body in bodies.clone() {
                if self.tracks.iter().any(|track| track.has(body)) {
                    continue;
                }
                let floor = floor(body, &self.tracker, interval, facing);
                let distance = floor.map_or(f64::INFINITY, |floor| (floor - expected).norm());
                let near = distance <= self.settings.reach;
                if near && best.is_none_or(|(nearest, ..)| distance < nearest) {
                    best = Some((distance, index, body));
                }
            }
        }
        best.map(|(_, track, body)| (track, body))
    }

    /// Begins tracks for bodies without a track. A second skeleton of the same person gets none.
    fn begin<'a>(
        &mut self,
        bodies: impl Iterator<Item = &'a Body>,
        interval: f64,
        time: f64,
    ) -> Result<(), Error> {
        for body in bodies {
            let Some(floor) = floor(body, &self.tracker, interval, None) else { continue };
            let taken = self
                .tracks
                .iter()
                .any(|track| track.has(body) || track.is_at(&floor, time, self.settings.separate));
            if taken || self.tracks.len() >= self.settings.most {
                continue;
            }
            let mut track = PersonTrack::new(PersonId::new(self.next), &self.tracker)?;
            self.next += 1;
            track.expect(time);
            track.claim(body, time)?;
            self.tracks.push(track);
        }
        Ok(())
    }

    /// Merges tracks at the same position. The younger one ends, unless it belongs to the engaged
    /// person.
    fn merge(&mut self, time: f64) {
        let double = (1..self.tracks.len()).find_map(|younger| {
            let (before, track) = (self.tracks.get(..younger)?, self.tracks.get(younger)?);
            let here = track.place(time)?;
            let same = |other: &&PersonTrack| other.is_at(&here, time, self.settings.separate);
            let older = before.iter().find(same)?;
            let ends = if self.engaged == Some(track.id()) { older } else { track };
            Some(ends.id())
        });
        if let Some(double) = double {
            self.tracks.retain(|track| track.id() != double);
        }
    }

    /// Keeps the engaged person, or selects the person nearest to the workplace who faces it.
    fn select(&mut self, time: f64) {
        let settings = &self.settings;
        let kept = self.engaged.filter(|&id| {
            let track = self.tracks.iter().find(|track| track.id() == id);
            track.is_some_and(|track| track.stays(time, settings))
        });
        let nearest = self
            .tracks
            .iter()
            .filter(|track| track.engages(time, settings))
            .min_by(|one, other| {
                one.distance(time, settings).total_cmp(&other.distance(time, settings))
            })
            .map(PersonTrack::id);
        let lost = self.engaged().is_none_or(|track| !track.is_seen(time));
        self.candidate =
            nearest.filter(|_| kept.is_none() || lost).map(|id| match self.candidate {
                Some((before, since)) if before == id => (id, since),
                _ => (id, time),
            });
        let ready = self.candidate.filter(|(_, since)| time - since >= settings.dwell);
        self.engaged = ready.map(|(id, _)| id).or(kept);
    }
}

/// Returns the floor position below a body. `facing` is the direction that the person faces, if it
/// is known.
fn floor(
    body: &Body,
    settings: &TrackerSettings,
    interval: f64,
    facing: Option<Facing>,
) -> Option<Vector2<f64>> {
    Seen::new(body, settings, interval).best_floor(facing).map(|floor| floor.position)
}
