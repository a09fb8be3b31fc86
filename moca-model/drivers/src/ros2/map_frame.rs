//! Place of the map in the frame of the odometry.

use std::time::SystemTime;

use nalgebra::{Isometry3, Quaternion as Coordinates, Translation3, UnitQuaternion};

use super::measurements::NORM;
use super::messages::{TfMessage, TransformStamped};
use super::refusal::Refusal;
use super::{MAP_FRAME, WORLD_FRAME};

/// Time for which a transform stays valid \[s\].
const HOLDS: f64 = 1.0;

/// The place of the frame of the odometry in the map, as a localisation publishes it on `/tf`. Odometry drifts, so that
/// it changes slowly.
#[derive(Clone, Copy, Debug, Default)]
pub struct MapFrame {
    odom_from_map: Option<(Isometry3<f64>, SystemTime)>,
}

impl MapFrame {
    /// Takes transforms that came at time `now`, of which only that from `map` to `odom` counts.
    ///
    /// # Errors
    /// Why that transform is refused; the one before is then kept.
    pub fn take(&mut self, message: &TfMessage, now: SystemTime) -> Result<(), Refusal> {
        let of_odometry = |transform: &&TransformStamped| {
            transform.header.frame_id == MAP_FRAME && transform.child_frame_id == WORLD_FRAME
        };
        let Some(found) = message.transforms.iter().find(of_odometry) else { return Ok(()) };
        let (place, turned) = (found.transform.translation, found.transform.rotation);
        if ![place.x, place.y, place.z].into_iter().all(f64::is_finite) {
            return Err(Refusal::NotFinite { what: "translation" });
        }
        let turn = Coordinates::new(turned.w, turned.x, turned.y, turned.z);
        let norm = turn.norm();
        if norm.is_nan() || (norm - 1.0).abs() > NORM {
            return Err(Refusal::Orientation { norm });
        }
        let map_from_odom = Isometry3::from_parts(
            Translation3::new(place.x, place.y, place.z),
            UnitQuaternion::from_quaternion(turn),
        );
        self.odom_from_map = Some((map_from_odom.inverse(), now));
        Ok(())
    }

    /// Moves poses of the map into the frame of the odometry. `None` for the frame of the odometry itself.
    ///
    /// # Errors
    /// [`Refusal::Frame`] for another frame, [`Refusal::NoTransform`] for the map if its place was not published within
    /// the last second.
    pub(super) fn odom_from(
        &self,
        frame: &str,
        now: SystemTime,
    ) -> Result<Option<Isometry3<f64>>, Refusal> {
        if frame == WORLD_FRAME {
            return Ok(None);
        }
        if frame != MAP_FRAME {
            return Err(Refusal::Frame { found: frame.to_owned(), expected: WORLD_FRAME });
        }
        let holds = |at: SystemTime| {
            now.duration_since(at).map_or(true, |since| since.as_secs_f64() <= HOLDS)
        };
        let known = self.odom_from_map.filter(|(_, at)| holds(*at));
        let (motion, _) = known.ok_or(Refusal::NoTransform { oldest: HOLDS })?;
        Ok(Some(motion))
    }
}
