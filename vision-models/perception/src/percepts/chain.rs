//! Converts joints in the image to the person who works with the robot.

use std::time::{Duration, Instant};

use vision_models::{
    Body, Body25, Camera, DepthImage, ImageBody, Lifter, LiftingSettings, People, PeopleSettings,
    PersonBox, PersonTrack, TrackerSettings,
};

use crate::error::Error;

/// Stature of a person who was not measured yet (m).
const STATURE: f64 = 1.75;

/// Number of bodies that are tested for upside-down images, and the share that must be upside down.
const BODIES: u32 = 20;
const SHARE: f64 = 0.8;

/// The parameters of a [`Perceiver`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PerceiverSettings {
    /// Parameters of the lifting.
    pub lifting: LiftingSettings,
    /// Parameters for distinguishing people.
    pub people: PeopleSettings,
    /// Parameters for tracking each person.
    pub tracker: TrackerSettings,
}

/// Lifts the joints of all people in a frame into the world, tracks the people, and selects the one
/// who engages with the robot.
///
/// ```
/// use human_perception::percepts::{Perceiver, PerceiverSettings};
/// use vision_models::{Camera, DepthNoise, Intrinsics, nalgebra::Point3};
///
/// let intrinsics = Intrinsics::new([32, 24], [30.0, 30.0], [15.5, 11.5])?;
/// let (eye, target) = (Point3::new(0.0, 0.0, 1.0), Point3::new(2.0, 0.0, 1.0));
/// let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I)?;
/// let perceiver = Perceiver::new(camera, PerceiverSettings::default())?;
/// assert!(perceiver.body().is_none());
/// # Ok::<(), human_perception::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Perceiver {
    lifter: Lifter,
    people: People,
    bodies: Vec<Body>,
    /// Number of upside-down bodies, and of all bodies.
    seen: [u32; 2],
    time_taken: Duration,
}

impl Perceiver {
    /// Creates the perceiver of a camera.
    ///
    /// # Errors
    /// [`Error::Vision`] if a setting is outside its range.
    pub fn new(camera: Camera, settings: PerceiverSettings) -> Result<Self, Error> {
        Ok(Self {
            lifter: Lifter::new(camera, settings.lifting)?,
            people: People::new(settings.people.clone(), settings.tracker)?,
            bodies: Vec::with_capacity(settings.people.most),
            seen: [0; 2],
            time_taken: Duration::ZERO,
        })
    }

    /// Updates the people with a frame: the people in the image, and the depth image that is
    /// aligned to it.
    ///
    /// # Errors
    /// - [`Error::Vision`] if the depth image has another size or times are out of order.
    /// - [`Error::Unfit`] if the images are upside down.
    pub fn see(
        &mut self,
        time: f64,
        people: &[ImageBody],
        depth: &DepthImage,
    ) -> Result<(), Error> {
        let started = Instant::now();
        self.bodies.clear();
        for image in people {
            self.check_upright(image)?;
            let facing = |body: &Body| self.people.heading_near(body, time);
            let body = self.lifter.lift_facing(image, depth, facing)?;
            self.bodies.push(body);
        }
        self.people.update(time, &self.bodies)?;
        self.time_taken = started.elapsed();
        Ok(())
    }

    /// Returns the person who works with the robot or is about to.
    pub fn engaged(&self) -> Option<&PersonTrack> {
        self.people.engaged()
    }

    /// Returns the box in which the engaged person is expected at a time (s).
    pub fn expected(&self, time: f64) -> Option<PersonBox> {
        let person = self.engaged()?;
        let place = person.predict(time).filter(|place| place.freshness.is_usable())?;
        let stature = person.stature().map_or(STATURE, |estimate| estimate.stature);
        PersonBox::around(self.lifter.camera(), &place.floor, stature)
    }

    /// Returns the camera.
    pub fn camera(&self) -> &Camera {
        self.lifter.camera()
    }

    /// Returns all people who are followed.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// Returns the measured joints of the engaged person, if they are in the newest frame.
    pub fn body(&self) -> Option<&Body> {
        self.engaged().filter(|person| person.is_in_frame()).map(PersonTrack::measured)
    }

    /// Returns the measured joints of all other people in the newest frame.
    pub fn others(&self) -> impl Iterator<Item = &Body> {
        let engaged = self.engaged().map(PersonTrack::id);
        let others = self.people.tracks().iter().filter(move |person| Some(person.id()) != engaged);
        others.filter(|person| person.is_in_frame()).map(PersonTrack::measured)
    }

    /// Returns the duration of lifting and tracking for the newest frame.
    pub fn time_taken(&self) -> Duration {
        self.time_taken
    }

    fn check_upright(&mut self, image: &ImageBody) -> Result<(), Error> {
        let row = |joint| image.get(joint).map(|joint| joint.position.y);
        let Some((neck, hips)) = row(Body25::Neck).zip(row(Body25::MidHip)) else {
            return Ok(());
        };
        let [upside_down, bodies] = &mut self.seen;
        *bodies = bodies.saturating_add(1);
        *upside_down = upside_down.saturating_add(u32::from(neck > hips));
        if *bodies == BODIES && f64::from(*upside_down) > SHARE * f64::from(BODIES) {
            return Err(Error::unfit(
                format_args!("{upside_down} of {bodies} people have the neck below the hips"),
                "the images are upside down, or the camera's pose is wrong",
                "turn the images or correct camera.json",
            ));
        }
        Ok(())
    }
}
