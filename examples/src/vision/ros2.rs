//! Camera and percepts on the ROS 2 graph.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, anyhow};
use human_perception::frames::{FrameEntry, FrameImages, Picture, PlacedCamera};
use human_perception::percepts::{Perceived, Perceiver};
use moca_drivers::ros2::messages::Time;
use moca_drivers::ros2::{
    CameraReport, PeoplePublisher, Place, PublishedPeople, Ros2Camera, RosDomain,
};
use vision_models::{Camera, PersonTrack};

use crate::settings::RobotSettings;

/// A camera on the ROS 2 graph, at the place that a file tells.
#[derive(Debug)]
pub struct Ros2Source {
    link: Ros2Camera,
    camera: Camera,
    stature: Option<f64>,
    wait: Duration,
}

impl Ros2Source {
    /// Joins the graph, and waits for the camera's geometry, and for its place if the settings say that it is there.
    /// The noise of the camera, the person's stature, and the camera's place unless the settings have it, are those of
    /// `camera.json` in the folder. An on-board camera is listened to if `on_board`.
    ///
    /// # Errors
    /// A file that cannot be used, and a camera that says nothing of itself for `wait`.
    pub fn join(
        folder: &Path,
        settings: &RobotSettings,
        on_board: bool,
        wait: Duration,
        stop: impl Fn() -> bool,
    ) -> Result<(Self, PeoplePublisher)> {
        let PlacedCamera { camera, stature, .. } = PlacedCamera::read(folder)?;
        let names = &settings.topics;
        let place = &settings.camera;
        let placed = place.isometry()?.unwrap_or(*camera.world_from_camera());
        let (link, publisher) = Ros2Camera::join(RosDomain::of_environment()?, names, on_board)?;
        let Some(intrinsics) = link.intrinsics(wait, &stop) else {
            let missing = "no camera has said how its images are made, on";
            return Err(silent(link, format!("{missing} {}", names.camera_info)));
        };
        let placed = if place.from_tf {
            let (topic, within) = (&names.static_transforms, place.frame.name());
            let Some(placed) = link.pose(within, wait, stop) else {
                let missing = "nothing ties the frame of the camera's images to";
                return Err(silent(link, format!("{missing} {within:?} on {topic}")));
            };
            placed
        } else {
            placed
        };
        let camera = Camera::new(intrinsics, placed, *camera.noise())
            .with_context(|| names.camera_info.clone())?;
        Ok((Self { link, camera, stature, wait }, publisher))
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Stature of the person \[m\], if the camera's file has it.
    pub fn stature(&self) -> Option<f64> {
        self.stature
    }

    /// Number of frames that a newer one overtook.
    pub fn overtaken(&self) -> u64 {
        self.link.overtaken()
    }

    /// The newest frame; `None` if the camera is silent, or once `stop` returns true.
    pub fn next(&mut self, stop: impl Fn() -> bool) -> Option<FrameImages> {
        let received = self.link.next(self.wait, stop)?;
        let (images, came) = (received.images, received.came);
        let time = seconds(images.stamp);
        let now = seconds(std::time::SystemTime::now().into());
        // The camera's clock may be a little ahead.
        let arrived = (now - came.elapsed().as_secs_f64()).max(time);
        let entry = FrameEntry { frame: received.number, time, arrived: Some(arrived) };
        let colour = Picture::Pixels(images.colour);
        let mut frame = FrameImages::new(entry, images.depth, colour).arrived_at(came);
        frame.surface = received.on_board.map(|pixels| Picture::Pixels((*pixels).clone()));
        Some(frame)
    }

    /// Leaves the graph. Returns what came, and what was not processed.
    ///
    /// # Errors
    /// The error that ended the connection.
    pub fn close(self) -> Result<CameraReport> {
        Ok(self.link.close()?)
    }
}

/// Ends a connection on which something is missing, and tells what came.
fn silent(link: Ros2Camera, missing: String) -> anyhow::Error {
    match link.close() {
        Ok(report) => {
            let topics = report.topics.iter().map(ToString::to_string).collect::<Vec<_>>();
            anyhow!("{}", topics.join("\n")).context(missing)
        }
        Err(error) => error.into(),
    }
}

/// Seconds since 1970.
fn seconds(time: Time) -> f64 {
    time.seconds_since(Time::default())
}

/// The stamp of a time in seconds since 1970.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the fraction is below a second"
)]
fn stamp(time: f64) -> Time {
    // Numbers of this size are known to 240 ns.
    let nanosec = (time.rem_euclid(1.0) * 1e6).round() as u32 * 1000;
    let whole = time.floor() as i32;
    match nanosec.checked_sub(1_000_000_000) {
        Some(nanosec) => Time { sec: whole.saturating_add(1), nanosec },
        None => Time { sec: whole, nanosec },
    }
}

/// Publishes the percept of a camera frame, with the people in this frame of reference.
///
/// # Errors
/// A message that is not taken for publication.
pub fn publish(
    to: &PeoplePublisher,
    frame: &str,
    perceived: &Perceived,
    perceiver: &Perceiver,
) -> Result<()> {
    let Perceived { percept, others, timing, .. } = perceived;
    let time = percept.time;
    let since = |time_of: Option<f64>| time_of.map_or(f64::NAN, |at| at - time);
    let engaged = perceiver.engaged().filter(|person| person.is_in_frame());
    let followed = perceiver.people().tracks().iter().filter(|person| person.is_in_frame());
    let other =
        followed.filter(|person| Some(person.id()) != perceiver.engaged().map(PersonTrack::id));
    let place = |person: &PersonTrack| {
        let place = person.predict(time)?;
        let (number, velocity) = (person.id().number(), place.velocity.into());
        Some(Place { number, floor: place.floor, heading: place.heading, velocity })
    };
    let places: Vec<_> = std::iter::once(engaged.and_then(place)).chain(other.map(place)).collect();
    to.publish(&PublishedPeople {
        stamp: stamp(time),
        frame,
        person: percept.body.as_ref(),
        others,
        places: &places,
        action: percept.action,
        surface: percept.surface,
        delays: [
            since(perceived.came),
            since(timing.arrived),
            since(timing.action.captured),
            since(timing.action.arrived),
            since(timing.surface.captured),
            since(timing.surface.arrived),
        ],
    })?;
    Ok(())
}
