//! Thread that takes messages.

use std::io::ErrorKind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;

use moca_model::whole_body::control_loop::{JointMeasurement, RobotStatus};
use ros2_client::dds::rustdds::mio1::{Events, Interest, Poll, Token};

use super::error::Ros2Error;
use super::hand_over::Giver;
use super::inbox::Inbox;
use super::measurements::Measurements;
use super::messages::{Empty, Float64MultiArray, JointState, Odometry, PoseArray, Text, TfMessage};
use super::node::RosNode;
use super::peers::Peers;
use super::perceived::{Perceived, SeenPeople};
use super::statistics::TopicStatistics;
use super::topic::{JointInterface, Topic};
use super::wakes::WAKES;

/// Handle of the thread that takes messages.
pub(super) struct Reader {
    poll: Poll,
    peers: Peers,
    joint_states: Inbox<JointState>,
    odometry: Inbox<Odometry>,
    modes: Inbox<Text>,
    transforms: Inbox<TfMessage>,
    static_transforms: Inbox<TfMessage>,
    confidences: Inbox<Float64MultiArray>,
    covariances: Inbox<Float64MultiArray>,
    bodies: Inbox<PoseArray>,
    actions: Inbox<Text>,
    surfaces: Inbox<Text>,
    acknowledgements: Inbox<Empty>,
    measurements: Measurements,
    perceived: Perceived,
    measured: Measured,
    persons: SyncSender<SeenPeople>,
    acknowledged: SyncSender<()>,
}

/// Queues for measurements (positions, velocities and torques of all joints) and for the status of the robot.
pub(super) struct Measured {
    pub(super) numbers: Giver<Option<f64>>,
    pub(super) status: Giver<RobotStatus>,
}

impl Reader {
    pub(super) fn new(
        node: &mut RosNode,
        measurements: Measurements,
        interface: JointInterface,
        measured: Measured,
        (persons, acknowledged): (SyncSender<SeenPeople>, SyncSender<()>),
    ) -> Result<Self, Ros2Error> {
        let topics = [
            Topic::JointStates,
            Topic::Odometry,
            Topic::RobotMode,
            Topic::Transforms,
            Topic::StaticTransforms,
            Topic::BodyConfidences,
            Topic::BodyCovariances,
            Topic::BodyJoints,
            Topic::Action,
            Topic::Surface,
            Topic::Acknowledge,
            Topic::BaseTwist,
            Topic::JointCommands(interface),
            Topic::ControlState,
        ];
        let poll = Poll::new().map_err(|error| Ros2Error::create("a poll", &error))?;
        let mut reader = Self {
            peers: node.peers(topics.to_vec()),
            joint_states: node.inbox(Topic::JointStates)?,
            odometry: node.inbox(Topic::Odometry)?,
            modes: node.inbox(Topic::RobotMode)?,
            transforms: node.inbox(Topic::Transforms)?,
            static_transforms: node.inbox(Topic::StaticTransforms)?,
            confidences: node.inbox(Topic::BodyConfidences)?,
            covariances: node.inbox(Topic::BodyCovariances)?,
            bodies: node.inbox(Topic::BodyJoints)?,
            actions: node.inbox(Topic::Action)?,
            surfaces: node.inbox(Topic::Surface)?,
            acknowledgements: node.inbox(Topic::Acknowledge)?,
            poll,
            measurements,
            perceived: Perceived::default(),
            measured,
            persons,
            acknowledged,
        };
        let registry = reader.poll.registry();
        // All topics are drained whenever the thread wakes.
        registry
            .register(&mut reader.joint_states.subscription, Token(0), Interest::READABLE)
            .and_then(|()| {
                registry.register(&mut reader.bodies.subscription, Token(1), Interest::READABLE)
            })
            .map_err(|error| Ros2Error::create("a poll", &error))?;
        Ok(reader)
    }

    pub(super) fn run(mut self, ending: &AtomicBool) -> Result<Vec<TopicStatistics>, Ros2Error> {
        let mut events = Events::with_capacity(8);
        while !ending.load(Ordering::Acquire) {
            match self.poll.poll(&mut events, Some(WAKES)) {
                Err(error) if error.kind() != ErrorKind::Interrupted => {
                    return Err(Ros2Error::create("a wait for messages", &error));
                }
                _ => self.drain()?,
            }
        }
        let came = [
            self.joint_states.statistics,
            self.odometry.statistics,
            self.modes.statistics,
            self.transforms.statistics,
            self.static_transforms.statistics,
            self.confidences.statistics,
            self.covariances.statistics,
            self.bodies.statistics,
            self.actions.statistics,
            self.surfaces.statistics,
            self.acknowledgements.statistics,
        ];
        let told: Vec<_> = self.peers.statistics_after(came.len()).collect();
        let mut statistics: Vec<_> = came.into_iter().chain(told).collect();
        for topic in &mut statistics {
            self.peers.count(topic);
        }
        Ok(statistics)
    }

    fn drain(&mut self) -> Result<(), Ros2Error> {
        self.peers.update();
        let Self { peers, measurements, perceived, measured, persons, acknowledged, .. } = self;
        self.odometry
            .drain(peers, |odometry, now| measurements.take_odometry(odometry, now).map(Some))?;
        self.modes.drain(peers, |mode, now| measurements.take_mode(mode, now).map(|()| None))?;
        let mut numbers = Vec::new();
        self.joint_states.drain(peers, |state, now| {
            let age = measurements.take_joint_state(state, now)?;
            let JointMeasurement { position, velocity, torque, robot, .. } = measurements.newest();
            numbers.clear();
            numbers.extend(position.iter().chain(velocity).copied().map(Some));
            numbers.extend(torque);
            measured.status.give(&[*robot]);
            measured.numbers.give(&numbers);
            Ok(Some(age))
        })?;
        self.actions
            .drain(peers, |action, now| perceived.take_action(action, now).map(|()| None))?;
        self.surfaces
            .drain(peers, |surface, now| perceived.take_surface(surface, now).map(|()| None))?;
        self.acknowledgements.drain(peers, |_, _| {
            // One that waits already counts for both.
            let _ = acknowledged.try_send(());
            Ok(None)
        })?;
        self.transforms.drain(peers, |transforms, now| {
            perceived.take_transforms(transforms, now).map(|()| None)
        })?;
        self.static_transforms.drain(peers, |transforms, _| {
            perceived.take_static_transforms(transforms).map(|()| None)
        })?;
        self.confidences.drain(peers, |confidences, _| {
            perceived.take_confidences(confidences).map(|()| None)
        })?;
        self.covariances.drain(peers, |covariances, _| {
            perceived.take_covariances(covariances).map(|()| None)
        })?;
        self.bodies.drain(peers, |poses, now| {
            // A loop that reads no people for a while misses these, as with a real camera.
            let _ = persons.try_send(perceived.take_body(poses, now)?);
            Ok(None)
        })
    }
}
