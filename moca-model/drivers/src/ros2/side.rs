//! A robot that is reached by ROS 2.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::SystemTime;

use moca_model::MOCA_BASE_JOINTS;
use moca_model::whole_body::control_loop::{
    JointCommand, JointMeasurement, Received, RobotSide, RobotStatus,
};

use ros2_client::Publisher;

use super::commands::{base_velocity, joint_values};
use super::domain::RosDomain;
use super::error::Ros2Error;
use super::gripper::GripState;
use super::hand_over::{Giver, Taker, hand_over};
use super::measurements::{Measurements, RobotJoints};
use super::messages::Text;
use super::node::RosNode;
use super::outbox::{Outbox, Publishing};
use super::perceived::SeenPeople;
use super::reader::{Measured, Reader};
use super::statistics::TopicStatistics;
use super::topic::{JointInterface, Topic};
use crate::topic_names::TopicNames;

/// Number of people that may wait in the queue.
const WAITING: usize = 8;

/// The loop's end of the connection.
///
/// It publishes the commands of the base in the axes of the base as last measured. The commands of the arm go to the
/// controller of one [`JointInterface`]. To halt, it publishes a twist of zero, and velocities of zero if the arm
/// follows velocities. Then it publishes nothing more.
#[derive(Debug)]
pub struct Ros2Side {
    measured: Taker<Option<f64>>,
    status: Taker<RobotStatus>,
    commands: Giver<f64>,
    /// Command that is sent: time since `epoch` \[s\], the base's twist, the arm's part.
    outgoing: Vec<f64>,
    epoch: SystemTime,
    interface: JointInterface,
    grip: GripState,
    /// Number of the base's joints.
    base_joints: usize,
    yaw: f64,
    ending: Ending,
    reader: JoinHandle<Result<Vec<TopicStatistics>, Ros2Error>>,
    publisher: JoinHandle<Publishing>,
}

/// People and acknowledgements from others on the graph, and reports of the loop to them.
pub struct Ros2People {
    /// The people whom others see.
    pub seen: Receiver<SeenPeople>,
    /// Acknowledgements of stops.
    pub acknowledgements: Receiver<()>,
    state: Publisher<Text>,
}

impl fmt::Debug for Ros2People {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ros2People").finish_non_exhaustive()
    }
}

impl Ros2People {
    /// Publishes phase and safety state of the loop.
    pub fn tell(&self, state: String) {
        // What nobody can be told, the next message says.
        let _ = self.state.publish(Text { data: state });
    }
}

/// Tells the threads to end, at the latest when the last copy is dropped.
#[derive(Debug)]
pub(super) struct Ending(pub(super) Arc<AtomicBool>);

impl Ending {
    pub(super) fn begin(&self) {
        self.0.store(true, Ordering::Release);
    }
}

impl Drop for Ending {
    fn drop(&mut self) {
        self.begin();
    }
}

/// Counts of a connection that is closed.
#[derive(Clone, Debug)]
pub struct Ros2Statistics {
    /// Statistics of each topic. They also count the peers with another type, on the topics of commands too.
    pub topics: Vec<TopicStatistics>,
    /// Number of commands that were published.
    pub published: u64,
    /// Number of commands that the library refused.
    pub failed: u64,
    /// Number of commands that a newer one replaced before they were published.
    pub superseded: u64,
}

impl Ros2Side {
    /// Joins a domain as the node `moca_control`. Also returns what others on the graph see and say.
    ///
    /// # Errors
    /// [`Ros2Error::Create`]
    pub fn join(
        domain: RosDomain,
        names: &TopicNames,
        joints: RobotJoints,
        interface: JointInterface,
    ) -> Result<(Self, Ros2People), Ros2Error> {
        let mut node = RosNode::join(domain, "moca_control", names)?;
        let (count, arm_joints) = (joints.count(), joints.arm().len());
        let base_joints = joints.of_base();
        let (numbers, taken) = hand_over(3 * count);
        let (status, said) = hand_over(1);
        let measured = Measured { numbers, status };
        let (commands, outgoing) = hand_over(1 + MOCA_BASE_JOINTS + arm_joints);
        let (persons, seen) = sync_channel(WAITING);
        let (acknowledged, acknowledgements) = sync_channel(1);
        let state = node.publisher(Topic::ControlState)?;
        let (epoch, grip) = (SystemTime::now(), GripState::default());
        let reader = Reader::new(
            &mut node,
            Measurements::new(joints),
            interface,
            measured,
            (persons, acknowledged),
        )?;
        let outbox = Outbox::new(
            node,
            interface,
            (base_joints > 0, arm_joints),
            (outgoing, grip.clone()),
            epoch,
        )?;
        let ending = Ending(Arc::new(AtomicBool::new(false)));
        let (reads, publishes) = (ending.0.clone(), ending.0.clone());
        let side = Self {
            measured: taken,
            status: said,
            commands,
            outgoing: vec![0.0; 1 + MOCA_BASE_JOINTS + arm_joints],
            base_joints,
            epoch,
            interface,
            grip,
            yaw: 0.0,
            ending,
            reader: spawn("ros2-reader", move || reader.run(&reads))?,
            publisher: spawn("ros2-publisher", move || outbox.run(&publishes))?,
        };
        Ok((side, Ros2People { seen, acknowledgements, state }))
    }

    /// Closes the connection and returns its counts.
    ///
    /// # Errors
    /// The error that ended one of its threads.
    pub fn close(self) -> Result<Ros2Statistics, Ros2Error> {
        self.end();
        let Publishing { taken: published, failed, superseded } =
            self.publisher.join().map_err(|_| Ros2Error::Ended { does: "publishes" })?;
        let topics = self.reader.join().map_err(|_| Ros2Error::Ended { does: "takes" })??;
        Ok(Ros2Statistics { topics, published, failed, superseded })
    }

    fn end(&self) {
        self.ending.begin();
        self.publisher.thread().unpark();
    }
}

pub(super) fn spawn<T: Send + 'static>(
    name: &str,
    run: impl FnOnce() -> T + Send + 'static,
) -> Result<JoinHandle<T>, Ros2Error> {
    thread::Builder::new()
        .name(name.to_owned())
        .spawn(run)
        .map_err(|error| Ros2Error::create("a thread", &error))
}

impl RobotSide for Ros2Side {
    type Error = Ros2Error;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Ros2Error> {
        if self.measured.is_abandoned() {
            return Err(Ros2Error::Ended { does: "takes" });
        }
        measured.robot.holds = self.grip.holds();
        let Some((numbers, _)) = self.measured.take() else { return Ok(Received::Nothing) };
        let (known, torques) = numbers.split_at(2 * numbers.len() / 3);
        let (positions, velocities) = known.split_at(known.len() / 2);
        let JointMeasurement { position, velocity, torque, robot, .. } = measured;
        for (own, numbers) in [(position, positions), (velocity, velocities)] {
            own.iter_mut().zip(numbers).for_each(|(own, number)| *own = number.unwrap_or(*own));
        }
        torque.iter_mut().zip(torques).for_each(|(own, torque)| *own = *torque);
        if let Some(([status], _)) = self.status.take() {
            *robot = RobotStatus { holds: self.grip.holds(), ..*status };
        }
        let yaw = self.base_joints.checked_sub(1).and_then(|yaw| measured.position.get(yaw));
        self.yaw = yaw.copied().unwrap_or_default();
        Ok(Received::Fresh)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), Ros2Error> {
        if self.commands.is_abandoned() {
            return Err(Ros2Error::Ended { does: "publishes" });
        }
        self.grip.want(command.grip);
        let time = self.epoch.elapsed().map_or(0.0, |since| since.as_secs_f64());
        // An arm that stands has no twist.
        let base = command.velocity.get(..self.base_joints).unwrap_or_default();
        let numbers = [time].into_iter().chain(base_velocity(base, self.yaw));
        let arm = joint_values(command, self.base_joints, self.interface);
        let numbers = numbers.chain(arm.iter().copied());
        self.outgoing.iter_mut().zip(numbers).for_each(|(own, number)| *own = number);
        self.commands.give(&self.outgoing);
        self.publisher.thread().unpark();
        Ok(())
    }

    fn halt(&mut self) -> Result<(), Ros2Error> {
        self.end();
        Ok(())
    }
}
