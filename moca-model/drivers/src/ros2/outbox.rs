//! Thread that publishes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, SystemTime};

use moca_model::MOCA_BASE_JOINTS;
use ros2_client::Publisher;

use super::BASE_FRAME;
use super::error::Ros2Error;
use super::gripper::{GripState, Gripper};
use super::hand_over::Taker;
use super::messages::{Float64MultiArray, Header, MultiArrayLayout, TwistStamped};
use super::node::RosNode;
use super::topic::{JointInterface, Topic};
use super::wakes::WAKES;

/// Time that the last message has to leave before the connection closes.
const LEAVES: Duration = Duration::from_millis(50);

/// Results of the publishing thread.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Publishing {
    pub(super) taken: u64,
    pub(super) failed: u64,
    pub(super) superseded: u64,
}

/// Handle of the publishing thread.
pub(super) struct Outbox {
    /// Twists for a robot with a base.
    twist: Option<Publisher<TwistStamped>>,
    joints: Publisher<Float64MultiArray>,
    commands: Taker<f64>,
    gripper: Gripper,
    epoch: SystemTime,
    interface: JointInterface,
    arm_joints: usize,
    done: Publishing,
    /// Keeps the connection open.
    _node: RosNode,
}

impl Outbox {
    /// Creates the thread for commands to an arm with this number of joints, and to a base if there is one. Times count
    /// since `epoch`.
    pub(super) fn new(
        mut node: RosNode,
        interface: JointInterface,
        (has_base, arm_joints): (bool, usize),
        (commands, grip): (Taker<f64>, GripState),
        epoch: SystemTime,
    ) -> Result<Self, Ros2Error> {
        Ok(Self {
            twist: has_base.then(|| node.publisher(Topic::BaseTwist)).transpose()?,
            joints: node.publisher(Topic::JointCommands(interface))?,
            commands,
            gripper: Gripper::new(&mut node, grip)?,
            epoch,
            interface,
            arm_joints,
            done: Publishing::default(),
            _node: node,
        })
    }

    pub(super) fn run(mut self, ending: &AtomicBool) -> Publishing {
        loop {
            // Whoever wakes this thread has sent a command before or has asked it to end.
            thread::park_timeout(WAKES);
            let ends = ending.load(Ordering::Acquire);
            self.publish_newest();
            self.gripper.update();
            if ends {
                self.publish_halt();
                thread::sleep(LEAVES);
                return self.done;
            }
        }
    }

    fn publish_newest(&mut self) {
        let Some((numbers, superseded)) = self.commands.take() else { return };
        let Some(([time, x, y, turn], arm)) = numbers.split_first_chunk() else { return };
        let stamp = self.epoch + Duration::try_from_secs_f64(*time).unwrap_or_default();
        let (twist, arm) = ([*x, *y, *turn], arm.to_vec());
        self.done.superseded += superseded;
        if self.publish(stamp, twist, Some(arm)) {
            self.done.taken += 1;
        } else {
            self.done.failed += 1;
        }
    }

    fn publish_halt(&self) {
        let stands = self.interface == JointInterface::Velocity;
        let arm = stands.then(|| vec![0.0; self.arm_joints]);
        self.publish(SystemTime::now(), [0.0; MOCA_BASE_JOINTS], arm);
    }

    /// Returns true if the library has taken both messages.
    fn publish(
        &self,
        stamp: SystemTime,
        twist: [f64; MOCA_BASE_JOINTS],
        arm: Option<Vec<f64>>,
    ) -> bool {
        let header = Header { stamp: stamp.into(), frame_id: BASE_FRAME.to_owned() };
        let twist = TwistStamped { header, twist: twist.into() };
        let moved = self.twist.as_ref().is_none_or(|base| base.publish(twist).is_ok());
        let layout = MultiArrayLayout::default();
        let held =
            arm.is_none_or(|data| self.joints.publish(Float64MultiArray { layout, data }).is_ok());
        moved && held
    }
}
