//! Simulated robot behind ROS 2, with a recorded person in front of its camera.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::SystemTime;

use moca_model::MOCA_BASE_JOINTS;
use moca_model::Scene;
use moca_model::whole_body::control_loop::{
    Clock, JointCommand, JointMeasurement, RobotSide, Scheduling,
};
use nalgebra::UnitQuaternion;
use ros2_client::Publisher;

use super::commands::{Commands, base_velocity};
use super::domain::RosDomain;
use super::error::Ros2Error;
use super::gripper_server::GripperServer;
use super::inbox::Inbox;
use super::measurements::{RobotJoints, mode_name};
use super::messages::{
    Float64MultiArray, Header, JointState, Odometry, Pose, PoseWithCovariance, Quaternion, Text,
    TwistStamped, TwistWithCovariance, Vector3,
};
use super::node::RosNode;
use super::peers::Peers;
use super::people_publisher::PeoplePublisher;
use super::recorded_people::{RecordedPeople, ServedRobot, ShownRobot, show_robot};
use super::statistics::TopicStatistics;
use super::topic::{JointInterface, Topic};
use super::{BASE_FRAME, WORLD_FRAME};
use crate::recorded_camera::RecordedCamera;
use crate::simulated::SimulatedSide;
use crate::topic_names::TopicNames;

/// Number of periods for which the newest commands are used. Afterwards each period counts as one with a lost command.
const SILENCE: u64 = 20;
/// Number of periods without commands after which a robot at rest is ready for another controller.
const ENDS: u64 = 1000;
/// Number of periods between two messages about the robot's mode.
const SAYS: u64 = 50;

/// A robot on the ROS graph. It measures and publishes once a period and follows the newest commands of base and arm.
/// It stands still until both have come. Its camera sees a recorded person, in a thread of its own. Its gripper serves the
/// action `control_msgs/GripperCommand`.
#[derive(Debug)]
pub struct Ros2Server {
    robot: ServedSide,
    people: PeoplePublisher,
}

/// The robot without its camera.
struct ServedSide {
    _node: RosNode,
    peers: Peers,
    twists: Inbox<TwistStamped>,
    efforts: Inbox<Float64MultiArray>,
    joint_states: Publisher<JointState>,
    odometry: Publisher<Odometry>,
    modes: Publisher<Text>,
    gripper: GripperServer,
    joints: RobotJoints,
    robot: SimulatedSide,
    measured: JointMeasurement,
    commands: Commands,
    command: JointCommand,
    /// Number of periods since the newest twist and since the newest torques.
    silent: [u64; 2],
    /// True if the robot has been told to move since it was ready.
    moved: bool,
}

impl fmt::Debug for ServedSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ServedSide").field("robot", &self.robot).finish_non_exhaustive()
    }
}

impl Ros2Server {
    /// Joins a domain as the node `moca_robot`, with MOCA at `start` \[m, rad\].
    ///
    /// # Errors
    /// [`Ros2Error::Create`]
    pub fn join(
        domain: RosDomain,
        names: &TopicNames,
        robot: SimulatedSide,
        start: &[f64],
    ) -> Result<Self, Ros2Error> {
        let mut node = RosNode::join(domain, "moca_robot", names)?;
        let joints = RobotJoints::moca();
        let measured = JointMeasurement::resting(start.to_vec(), start.len());
        let efforts = Topic::JointCommands(JointInterface::Effort);
        let people = PeoplePublisher::new(&mut node)?;
        let robot = ServedSide {
            peers: node.peers(vec![Topic::BaseTwist, efforts]),
            twists: node.inbox(Topic::BaseTwist)?,
            efforts: node.inbox(efforts)?,
            joint_states: node.publisher(Topic::JointStates)?,
            odometry: node.publisher(Topic::Odometry)?,
            modes: node.publisher(Topic::RobotMode)?,
            gripper: GripperServer::new(&mut node)?,
            commands: Commands::new(joints.arm().len()),
            command: JointCommand::at_rest(&measured),
            silent: [SILENCE; 2],
            moved: false,
            _node: node,
            joints,
            robot,
            measured,
        };
        Ok(Self { robot, people })
    }

    /// Runs until `stop` returns true, with the calling thread as `scheduling` says. A thread without priority plays
    /// camera frames in a loop from the first command on. `see` makes of each what the cameras see beside the robot.
    ///
    /// # Errors
    /// Errors of reading a topic, commands that the simulation refuses, and a priority that the system refuses.
    pub fn serve(
        &mut self,
        period: f64,
        camera: RecordedCamera,
        see: impl FnMut(Scene, &ServedRobot) -> Scene + Send,
        (clock, scheduling): (&mut impl Clock, Scheduling),
        stop: impl FnMut() -> bool,
    ) -> Result<(), Ros2Error> {
        let Self { robot, people } = self;
        let (mut shown, seen) = show_robot();
        let ended = AtomicBool::new(false);
        thread::scope(|scope| {
            let camera = RecordedPeople::new(camera, seen, people);
            scope.spawn(|| camera.play(see, &ended));
            let applied = scheduling.apply();
            let applied = applied.map_err(|error| Ros2Error::create("the robot's thread", &error));
            let served = applied.and_then(|()| robot.run(period, &mut shown, clock, stop));
            ended.store(true, Ordering::Release);
            served
        })
    }

    /// Returns the statistics of the two topics of commands.
    pub fn statistics(&self) -> [TopicStatistics; 2] {
        let robot = &self.robot;
        [&robot.twists.statistics, &robot.efforts.statistics].map(|topic| {
            let mut topic = topic.clone();
            robot.peers.count(&mut topic);
            topic
        })
    }
}

impl ServedSide {
    /// Runs until `stop` returns true.
    fn run(
        &mut self,
        period: f64,
        shown: &mut ShownRobot,
        clock: &mut impl Clock,
        mut stop: impl FnMut() -> bool,
    ) -> Result<(), Ros2Error> {
        let mut due = clock.now();
        let (mut tick, mut met) = (0_u64, false);
        while !stop() {
            due = (due + period).max(clock.now() - period);
            clock.sleep_until(due);
            self.robot.receive(&mut self.measured)?;
            self.publish_measured();
            self.listen()?;
            if tick.is_multiple_of(SAYS) {
                let mode = self.measured.robot.mode.map_or("stopped", mode_name);
                let _ = self.modes.publish(Text { data: mode.to_owned() });
            }
            tick += 1;
            self.act()?;
            self.silent.iter_mut().for_each(|silent| *silent = silent.saturating_add(1));
            met |= self.moved;
            if met {
                shown.show(&mut self.robot);
            }
        }
        Ok(())
    }

    /// Moves for one period.
    fn act(&mut self) -> Result<(), Ros2Error> {
        self.command.grip = self.gripper.update(self.robot.status().holds);
        let obeys = self.silent.iter().all(|silent| *silent < SILENCE);
        self.commands.write(self.yaw(), &mut self.command);
        let refusal = if obeys { self.robot.check(&self.command).err() } else { None };
        if obeys && refusal.is_none() {
            self.moved = true;
            self.robot.obey(&self.command)?;
        } else if self.moved {
            self.robot.miss()?;
        }
        if let Some(refusal) = refusal {
            self.twists.statistics.refuse(refusal.into());
        }
        let over = self.silent.iter().any(|silent| *silent > ENDS);
        if over && self.moved && self.robot.status().is_stopped() && self.robot.is_at_rest() {
            self.robot.recover();
            self.moved = false;
        }
        Ok(())
    }

    fn yaw(&self) -> f64 {
        self.measured.position.get(MOCA_BASE_JOINTS - 1).copied().unwrap_or_default()
    }

    /// Takes all waiting messages.
    fn listen(&mut self) -> Result<(), Ros2Error> {
        self.peers.update();
        let Self { peers, commands, silent: [twist, effort], .. } = self;
        self.twists.drain(peers, |message, now| {
            let age = commands.take_twist(message, now)?;
            *twist = 0;
            Ok(Some(age))
        })?;
        self.efforts.drain(peers, |message, _| {
            commands.take_effort(message)?;
            *effort = 0;
            Ok(None)
        })
    }

    /// Publishes the measurement. It does not wait for slow subscribers.
    fn publish_measured(&self) {
        let JointMeasurement { position, velocity, torque, .. } = &self.measured;
        // A joint without a measured torque has a NaN, as ROS defines it.
        let torque: Vec<_> = torque.iter().map(|torque| torque.unwrap_or(f64::NAN)).collect();
        let stamp = SystemTime::now().into();
        let arm = |numbers: &[f64]| numbers.get(MOCA_BASE_JOINTS..).unwrap_or_default().to_vec();
        let _ = self.joint_states.publish(JointState {
            header: Header { stamp, frame_id: String::new() },
            name: self.joints.arm().to_vec(),
            position: arm(position),
            velocity: arm(velocity),
            effort: arm(&torque),
        });
        let [x, y, yaw] = position.first_chunk().copied().unwrap_or_default();
        let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, yaw).coords;
        let orientation = Quaternion { x: turned.x, y: turned.y, z: turned.z, w: turned.w };
        let pose = Pose { position: Vector3 { x, y, z: 0.0 }, orientation };
        let twist = base_velocity(velocity, yaw).into();
        let _ = self.odometry.publish(Odometry {
            header: Header { stamp, frame_id: WORLD_FRAME.to_owned() },
            child_frame_id: BASE_FRAME.to_owned(),
            pose: PoseWithCovariance { pose, ..PoseWithCovariance::default() },
            twist: TwistWithCovariance { twist, ..TwistWithCovariance::default() },
        });
    }
}
