//! Places of frames in each other.

use std::collections::HashMap;
use std::time::SystemTime;

use nalgebra::{Isometry3, Quaternion as Coordinates, Translation3, UnitQuaternion};

use super::measurements::NORM;
use super::messages::{TfMessage, TransformStamped};
use super::refusal::Refusal;
use super::{MAP_FRAME, WORLD_FRAME};

/// Time for which a transform on `/tf` stays valid \[s\].
const HOLDS: f64 = 1.0;
/// Largest number of frames that are remembered, since others name them.
const MOST: usize = 1000;

/// Frames, each with its place in its parent.
///
/// Transforms on `/tf_static` stay valid. On `/tf`, only the place of the odometry in the map counts, as a localisation
/// publishes it. It changes slowly and holds for a second. Frames that move with the robot are therefore tied to no
/// place in the room.
///
/// ```
/// use std::time::SystemTime;
///
/// use moca_drivers::ros2::FrameTree;
/// use moca_drivers::ros2::messages::{Header, TfMessage, TransformStamped};
///
/// let mut camera = TransformStamped::default();
/// camera.header.frame_id = "map".to_owned();
/// camera.child_frame_id = "camera_link".to_owned();
/// camera.transform.translation.z = 2.0;
/// let mut frames = FrameTree::default();
/// frames.take_static(&TfMessage { transforms: vec![camera] })?;
/// let pose = frames.pose("camera_link", "map", SystemTime::now());
/// assert_eq!(pose.map(|pose| pose.translation.z), Some(2.0));
/// # Ok::<(), moca_drivers::ros2::Refusal>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct FrameTree {
    links: HashMap<String, Link>,
}

/// Place of a frame in its parent.
#[derive(Clone, Debug)]
struct Link {
    parent: String,
    pose: Isometry3<f64>,
    /// Time at which it came; `None` if it stays valid.
    came: Option<SystemTime>,
}

impl FrameTree {
    /// Takes transforms of `/tf` that came at time `now`, of which only that from `map` to `odom` counts.
    ///
    /// # Errors
    /// Why that transform is refused; the one before is then kept.
    pub fn take(&mut self, message: &TfMessage, now: SystemTime) -> Result<(), Refusal> {
        let of_odometry = |transform: &&TransformStamped| {
            transform.header.frame_id == MAP_FRAME && transform.child_frame_id == WORLD_FRAME
        };
        let Some(found) = message.transforms.iter().find(of_odometry) else { return Ok(()) };
        self.link(found, Some(now))
    }

    /// Takes transforms of `/tf_static`.
    ///
    /// # Errors
    /// Why the first refused transform is refused; those before it count, and the others stay as they were.
    pub fn take_static(&mut self, message: &TfMessage) -> Result<(), Refusal> {
        message.transforms.iter().try_for_each(|transform| self.link(transform, None))
    }

    fn link(&mut self, found: &TransformStamped, came: Option<SystemTime>) -> Result<(), Refusal> {
        let (place, turned) = (found.transform.translation, found.transform.rotation);
        if ![place.x, place.y, place.z].into_iter().all(f64::is_finite) {
            return Err(Refusal::NotFinite { what: "translation" });
        }
        let turn = Coordinates::new(turned.w, turned.x, turned.y, turned.z);
        let norm = turn.norm();
        if norm.is_nan() || (norm - 1.0).abs() > NORM {
            return Err(Refusal::Orientation { norm });
        }
        let child = &found.child_frame_id;
        if self.links.len() >= MOST && !self.links.contains_key(child) {
            return Err(Refusal::Frames { most: MOST });
        }
        let pose = Isometry3::from_parts(
            Translation3::new(place.x, place.y, place.z),
            UnitQuaternion::from_quaternion(turn),
        );
        let link = Link { parent: found.header.frame_id.clone(), pose, came };
        self.links.insert(child.clone(), link);
        Ok(())
    }

    /// Returns the pose of a frame in another at time `now`; `None` if valid transforms do not tie them.
    pub fn pose(&self, of: &str, within: &str, now: SystemTime) -> Option<Isometry3<f64>> {
        let ancestors: Vec<_> = self.ancestors(of, now).collect();
        self.ancestors(within, now).find_map(|(common, within)| {
            let (_, of) = ancestors.iter().find(|(ancestor, _)| *ancestor == common)?;
            Some(within.inverse() * of)
        })
    }

    /// Returns a frame and its ancestors, each with the frame's pose in it.
    fn ancestors<'a>(
        &'a self,
        frame: &'a str,
        now: SystemTime,
    ) -> impl Iterator<Item = (&'a str, Isometry3<f64>)> {
        let holds = move |came: SystemTime| {
            now.duration_since(came).map_or(true, |since| since.as_secs_f64() <= HOLDS)
        };
        let above = move |(frame, pose): &(&'a str, Isometry3<f64>)| {
            let link = self.links.get(*frame)?;
            link.came.is_none_or(holds).then(|| (link.parent.as_str(), link.pose * pose))
        };
        // Transforms of others may tie frames to a ring.
        std::iter::successors(Some((frame, Isometry3::identity())), above).take(MOST)
    }

    /// Moves poses of a frame into that of the odometry. `None` for the frame of the odometry itself.
    ///
    /// # Errors
    /// [`Refusal::NoTransform`]
    pub(super) fn odom_from(
        &self,
        frame: &str,
        now: SystemTime,
    ) -> Result<Option<Isometry3<f64>>, Refusal> {
        if frame == WORLD_FRAME {
            return Ok(None);
        }
        let unknown =
            || Refusal::NoTransform { frame: frame.to_owned(), to: WORLD_FRAME, oldest: HOLDS };
        self.pose(frame, WORLD_FRAME, now).map(Some).ok_or_else(unknown)
    }
}
