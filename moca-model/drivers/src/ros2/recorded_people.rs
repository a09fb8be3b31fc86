//! Camera of a simulated robot, in a thread of its own.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, SystemTime};

use moca_model::whole_body::control_loop::{Clock, MonotonicClock};
use moca_model::{MOCA_BASE_JOINTS, Scene};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector4};

use super::WORLD_FRAME;
use super::hand_over::{Giver, Taker, hand_over};
use super::people_publisher::{PeoplePublisher, PublishedPeople};
use crate::recorded_camera::RecordedCamera;
use crate::simulated::SimulatedSide;

/// Longest time between two looks at the robot. Its queue of places is longer.
const LOOKS: Duration = Duration::from_millis(5);
/// Numbers of a place: the base, the tool's position and quaternion, whether it holds an object.
const PLACE: usize = MOCA_BASE_JOINTS + 3 + 4 + 1;

/// A simulated robot as its cameras see it.
#[derive(Clone, Copy, Debug)]
pub struct ServedRobot {
    /// Pose of the base on the floor: x, y \[m\] and yaw \[rad\].
    pub base: [f64; MOCA_BASE_JOINTS],
    /// Pose of the tool in the world.
    pub tool: Isometry3<f64>,
    /// True if the robot holds an object.
    pub holds: bool,
}

/// The end that shows the robot, once a period.
pub(super) struct ShownRobot(Giver<f64>);

/// Creates both ends of what the camera is told of the robot.
pub(super) fn show_robot() -> (ShownRobot, Taker<f64>) {
    let (given, taken) = hand_over(PLACE);
    (ShownRobot(given), taken)
}

impl ShownRobot {
    /// Shows where the robot is. The configuration of a simulated robot is always valid.
    pub(super) fn show(&mut self, robot: &mut SimulatedSide) {
        let Ok(tool) = robot.tool_pose() else { return };
        let holds = f64::from(u8::from(robot.status().holds == Some(true)));
        let mut place = [0.0; PLACE];
        let base = robot.position().iter().take(MOCA_BASE_JOINTS);
        let numbers = base.chain(tool.translation.vector.iter()).chain(tool.rotation.coords.iter());
        place.iter_mut().zip(numbers.chain([&holds])).for_each(|(own, number)| *own = *number);
        self.0.give(&place);
    }
}

impl ServedRobot {
    fn read(place: &[f64]) -> Option<Self> {
        let &[x, y, yaw, px, py, pz, i, j, k, w, holds] = place.first_chunk::<PLACE>()?;
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from(Vector4::new(i, j, k, w)));
        let tool = Isometry3::from_parts(Translation3::new(px, py, pz), rotation);
        Some(Self { base: [x, y, yaw], tool, holds: holds > 0.5 })
    }
}

/// A recorded person before the camera of a robot.
pub(super) struct RecordedPeople<'a> {
    camera: RecordedCamera,
    robot: Taker<f64>,
    people: &'a mut PeoplePublisher,
}

impl<'a> RecordedPeople<'a> {
    pub(super) fn new(
        camera: RecordedCamera,
        robot: Taker<f64>,
        people: &'a mut PeoplePublisher,
    ) -> Self {
        Self { camera, robot, people }
    }

    /// Plays the frames in a loop, from the first place of the robot until the end.
    pub(super) fn play(
        mut self,
        mut see: impl FnMut(Scene, &ServedRobot) -> Scene,
        ended: &AtomicBool,
    ) {
        let (clock, mut robot) = (MonotonicClock::default(), None);
        while !ended.load(Ordering::Acquire) {
            robot = self.robot.take().and_then(|(place, _)| ServedRobot::read(place)).or(robot);
            let mut wait = LOOKS;
            if let Some(robot) = &robot {
                let now = clock.now();
                let people = &self.people;
                let (_, due) = self.camera.show(now, |frame| publish(people, &see(frame, robot)));
                wait = Duration::try_from_secs_f64(due - now).unwrap_or_default().min(LOOKS);
            }
            thread::sleep(wait);
        }
    }
}

/// Publishes a camera frame.
fn publish(people: &PeoplePublisher, frame: &Scene) {
    let percept = &frame.percept;
    // What nobody can be told, the next frame says.
    let _ = people.publish(&PublishedPeople {
        stamp: SystemTime::now().into(),
        frame: WORLD_FRAME,
        person: percept.body.as_ref(),
        others: frame.others(),
        places: &[],
        action: percept.action,
        surface: percept.surface,
        delays: [f64::NAN; 6],
    });
}
