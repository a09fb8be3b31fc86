//! Converts a frame's images to a percept, with the times at which its parts were seen and known.

use std::time::{Duration, Instant};

use percept_recording::{MeasuredSegments, Stamp, Timing};
use vision_models::{
    Body, BodySegment, Percept, PersonId, PersonTrack, RecognisedAction, RecognisedSurface,
    StatureEstimate,
};

use super::{
    action_network::ActionNetwork,
    action_thread::ActionThread,
    chain::Perceiver,
    pose_source::{Frame, PoseSource},
    posture::{Assessor, MeasuredAssessment, PostureSettings},
    sighting::Sightings,
    surface_network::SurfaceNetwork,
};
use crate::{error::Error, frames::FrameImages};

/// Largest age of an action's or a surface's images (s). Older results are not reported.
const OLDEST: f64 = 2.0;

/// Processing of frames: joints in each frame, surface and action in some frames.
#[derive(Debug)]
pub struct Pipeline {
    perceiver: Perceiver,
    poses: Box<dyn PoseSource>,
    surface: Option<SurfaceNetwork>,
    /// Number of camera frames between two images of the surface.
    surface_interval: u64,
    action: Option<ActionSource>,
    seen_surface: Option<Seen<RecognisedSurface>>,
    seen_action: Option<Seen<RecognisedAction>>,
    /// Number of the next frame for the surface.
    next_surface: u64,
    posture: PostureSettings,
    assessor: Option<(PersonId, Assessor)>,
    sightings: Sightings,
    stature: Option<StatureEstimate>,
}

/// Place where the action is recognised.
#[derive(Debug)]
enum ActionSource {
    /// Between two frames, which wait for it.
    Between(Box<ActionNetwork>),
    /// Beside the frames.
    Beside(ActionThread),
}

/// A recognition result and its times.
#[derive(Clone, Copy, Debug)]
struct Seen<T> {
    what: T,
    stamp: Stamp,
}

/// The results of one frame.
#[derive(Clone, Debug)]
pub struct Perceived {
    /// The percept that is recorded.
    pub percept: Percept,
    /// The other people in the frame.
    pub others: Vec<Body>,
    /// Times at which its parts were seen and known.
    pub timing: Timing,
    /// Time at which its images had arrived, on the clock of the percept (s), if it is known.
    pub came: Option<f64>,
    /// The posture of the person who works with the robot.
    pub posture: Option<MeasuredAssessment>,
    /// True if the frame was searched for people.
    pub has_skeletons: bool,
    /// Duration of each stage that ran.
    pub times: StageTimes,
}

/// Durations of the processing of one frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Joints in the image, including reading.
    pub poses: Duration,
    /// Lifting and tracking.
    pub tracking: Duration,
    /// Recognition of the surface.
    pub surface: Option<Duration>,
    /// Recognition of the action.
    pub action: Option<Duration>,
    /// Total.
    pub whole: Duration,
}

impl Pipeline {
    /// Creates a pipeline with joints from this source.
    pub fn new(perceiver: Perceiver, poses: Box<dyn PoseSource>) -> Self {
        Self {
            perceiver,
            poses,
            surface: None,
            surface_interval: 1,
            action: None,
            seen_surface: None,
            seen_action: None,
            next_surface: 0,
            posture: PostureSettings::default(),
            assessor: None,
            sightings: Sightings::default(),
            stature: None,
        }
    }

    /// Adds recognition of the surface every `interval` camera frames.
    #[must_use]
    pub fn with_surface(mut self, network: SurfaceNetwork, interval: u64) -> Self {
        (self.surface, self.surface_interval) = (Some(network), interval.max(1));
        self
    }

    /// Adds recognition of the action. Frames wait for it, so that equal frames give equal percepts.
    #[must_use]
    pub fn with_action(mut self, network: ActionNetwork) -> Self {
        self.action = Some(ActionSource::Between(Box::new(network)));
        self
    }

    /// Adds recognition of the action in a thread of its own, for a camera that goes on. No frame
    /// waits: a percept has the last action that was found.
    #[must_use]
    pub fn with_action_beside(mut self, network: ActionNetwork) -> Self {
        self.action = Some(ActionSource::Beside(ActionThread::new(network)));
        self
    }

    /// Sets what is known about the person who works with the robot.
    #[must_use]
    pub fn with_posture(mut self, posture: PostureSettings) -> Self {
        self.posture = posture;
        self
    }

    /// Returns the perceiver, which has the people.
    pub fn perceiver(&self) -> &Perceiver {
        &self.perceiver
    }

    /// Checks that people could be found in the frames so far, if none was found.
    ///
    /// # Errors
    /// The reason why none could be found. `frame` is the first of the frames.
    pub fn check_sightings(&self, frame: u64) -> Result<(), Error> {
        let expected = self.poses.expected(frame).map(|path| path.display().to_string());
        self.sightings.clone().check(expected.as_deref())
    }

    /// Returns the stature of the person who worked with the robot last.
    pub fn stature(&self) -> Option<StatureEstimate> {
        self.stature
    }

    /// Returns the segment lengths of the engaged person that are known to a centimetre, rounded to
    /// millimetres.
    pub fn segments(&self) -> MeasuredSegments {
        let length = |segment| {
            let known = self.perceiver.engaged()?.segment(segment)?;
            (known.standard_error < 0.01).then(|| (known.length * 1e3).round() / 1e3)
        };
        MeasuredSegments {
            thigh: length(BodySegment::Thigh),
            shank: length(BodySegment::Shank),
            trunk: length(BodySegment::Trunk),
            upper_arm: length(BodySegment::UpperArm),
            forearm: length(BodySegment::Forearm),
            shoulders: length(BodySegment::Shoulders),
        }
    }

    /// Processes the next frame.
    ///
    /// # Errors
    /// - [`Error::Frame`] with the file's name, if a file cannot be used. The next frame can then
    ///   be processed.
    /// - Those of [`Perceiver::see`].
    pub fn perceive(&mut self, images: &FrameImages) -> Result<Perceived, Error> {
        let FrameImages { entry, depth, colour, surface: on_board, arrived: started } = images;
        let known = || entry.arrived.map(|arrived| arrived + started.elapsed().as_secs_f64());
        let frame = Frame {
            entry,
            colour,
            depth,
            camera: self.perceiver.camera(),
            expected: self.perceiver.expected(entry.time),
        };
        let people = self.poses.people(&frame).map_err(Error::of_frame)?;
        self.sightings.push(people.as_deref(), depth);
        let mut times = StageTimes { poses: started.elapsed(), ..StageTimes::default() };
        let has_skeletons = people.is_some();
        self.perceiver.see(entry.time, &people.unwrap_or_default(), depth)?;
        times.tracking = self.perceiver.time_taken();
        let body = self.perceiver.body().cloned();
        let others = self.perceiver.others().cloned().collect();
        let posture = self.assess(entry.time)?;
        let stature = self.perceiver.engaged().and_then(PersonTrack::stature);
        self.stature = stature.or(self.stature);
        let mut timing = Timing { arrived: known(), ..Timing::default() };

        let stamp = || Stamp { captured: Some(entry.time), arrived: known() };
        if let Some((network, image)) = self.surface.as_mut().zip(on_board.as_ref())
            && entry.frame >= self.next_surface
        {
            let begun = Instant::now();
            let what = network.recognise(image).map_err(Error::of_frame)?;
            self.seen_surface = what.map(|what| Seen { what, stamp: stamp() });
            self.next_surface = entry.frame.saturating_add(self.surface_interval);
            times.surface = Some(begun.elapsed());
        }
        match &mut self.action {
            Some(ActionSource::Between(network)) if network.wants(entry.frame) => {
                let begun = Instant::now();
                if let Some(what) = network.push(entry.frame, colour).map_err(Error::of_frame)? {
                    self.seen_action = Some(Seen { what, stamp: stamp() });
                    times.action = Some(begun.elapsed());
                }
            }
            Some(ActionSource::Beside(thread)) => {
                thread.offer(entry.frame, entry.time, colour);
                while let Some(found) = thread.found().map_err(Error::of_frame)? {
                    let stamp = Stamp { captured: Some(found.captured), ..stamp() };
                    self.seen_action = Some(Seen { what: found.action, stamp });
                    times.action = Some(found.taken);
                }
            }
            _ => {}
        }
        let surface = self.seen_surface.filter(|seen| seen.is_recent(entry.time));
        let action = self.seen_action.filter(|seen| seen.is_recent(entry.time));
        timing.surface = surface.map(|seen| seen.stamp).unwrap_or_default();
        timing.action = action.map(|seen| seen.stamp).unwrap_or_default();
        let percept = Percept {
            time: entry.time,
            body,
            action: action.map(|seen| seen.what),
            surface: surface.map(|seen| seen.what),
        };
        times.whole = started.elapsed();
        Ok(Perceived {
            percept,
            others,
            timing,
            came: entry.arrived,
            posture,
            has_skeletons,
            times,
        })
    }

    /// Returns the posture of the engaged person, filtered from frame to frame. The filter restarts
    /// for another person.
    fn assess(&mut self, time: f64) -> Result<Option<MeasuredAssessment>, Error> {
        let Some(person) = self.perceiver.engaged().filter(|person| person.is_in_frame()) else {
            return Ok(None);
        };
        let id = person.id();
        let (_, assessor) = match &mut self.assessor {
            Some(same) if same.0 == id => same,
            other => other.insert((id, Assessor::new(self.posture))),
        };
        Ok(assessor.update(time, person.body())?)
    }
}

impl<T> Seen<T> {
    /// Returns true if the images are recent enough at a time (s).
    fn is_recent(&self, time: f64) -> bool {
        self.stamp.captured.is_some_and(|captured| time - captured <= OLDEST)
    }
}
