//! Node of the ROS graph.

use ros2_client::action::{
    ActionClient, ActionClientQosPolicies, ActionServer, ActionServerQosPolicies,
};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    ActionTypeName, Context, ContextOptions, MessageTypeName, Name, Node, NodeName, NodeOptions,
    Publisher, QosProfile, ServiceMapping,
};
use serde::{Serialize, de::DeserializeOwned};

use super::domain::RosDomain;
use super::error::Ros2Error;
use super::inbox::Inbox;
use super::messages::{GripperCommand, GripperFeedback, GripperResult};
use super::peers::Peers;
use super::statistics::TopicStatistics;
use super::topic::Topic;
use crate::topic_names::TopicNames;

/// Number of messages that may wait while a thread does not run.
const DEPTH: usize = 64;

/// Node with its connection.
pub(super) struct RosNode {
    context: Context,
    node: Node,
    names: TopicNames,
}

impl RosNode {
    /// Joins a domain as a node of this name.
    ///
    /// # Errors
    /// [`Ros2Error::Create`]
    pub(super) fn join(
        domain: RosDomain,
        name: &str,
        names: &TopicNames,
    ) -> Result<Self, Ros2Error> {
        let options = ContextOptions::new().domain_id(domain.number());
        let context = Context::with_options(options)
            .map_err(|error| Ros2Error::create("a participant", &error))?;
        let name = NodeName::new("/", name).map_err(|error| Ros2Error::create(name, &error))?;
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let node = context
            .new_node(name, options)
            .map_err(|error| Ros2Error::create("a node", &format!("{error:?}")))?;
        Ok(Self { context, node, names: names.clone() })
    }

    /// Creates a publisher that suits every subscriber: reliable and volatile. It never waits for a subscriber.
    pub(super) fn publisher<M: Serialize>(
        &mut self,
        topic: Topic,
    ) -> Result<Publisher<M>, Ros2Error> {
        let reliable = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::Fail)
            .history(History::KeepLast { depth: DEPTH });
        let handle = self.topic(topic, &reliable)?;
        let made = self.node.create_publisher(&handle, None);
        made.map_err(|error| Ros2Error::create(topic.name(&self.names), &error))
    }

    /// Creates a subscription that suits every publisher. It uses best effort, because a newer message is better than a
    /// repeated old one. A topic of latched messages is reliable, and its subscription also receives the messages that
    /// came before it.
    pub(super) fn inbox<M: DeserializeOwned>(
        &mut self,
        topic: Topic,
    ) -> Result<Inbox<M>, Ros2Error> {
        let mut qos =
            QosProfile::subscription_default().history(History::KeepLast { depth: DEPTH });
        if topic == Topic::StaticTransforms {
            qos = qos.reliability_reliable(WhenFull::Fail).durability(Durability::TransientLocal);
        }
        let handle = self.topic(topic, &qos)?;
        let subscription = self
            .node
            .create_subscription(&handle, None)
            .map_err(|error| Ros2Error::create(topic.name(&self.names), &error))?;
        Ok(Inbox::new(subscription, TopicStatistics::new(topic, &self.names)))
    }

    /// Creates the client of the gripper's action.
    pub(super) fn gripper(
        &mut self,
    ) -> Result<ActionClient<GripperCommand, GripperResult, GripperFeedback>, Ros2Error> {
        let (action, kind, reliable) = self.gripper_action()?;
        let qos = ActionClientQosPolicies {
            goal_service: reliable.clone(),
            result_service: reliable.clone(),
            cancel_service: reliable.clone(),
            feedback_subscription: reliable.clone(),
            status_subscription: reliable,
        };
        let made = self.node.create_action_client(ServiceMapping::Enhanced, &action, &kind, qos);
        made.map_err(|error| Ros2Error::create(&self.names.gripper, &error))
    }

    /// Creates the server of the gripper's action.
    pub(super) fn gripper_server(
        &mut self,
    ) -> Result<ActionServer<GripperCommand, GripperResult, GripperFeedback>, Ros2Error> {
        let (action, kind, reliable) = self.gripper_action()?;
        let qos = ActionServerQosPolicies {
            goal_service: reliable.clone(),
            result_service: reliable.clone(),
            cancel_service: reliable.clone(),
            feedback_publisher: reliable.clone(),
            status_publisher: reliable,
        };
        let made = self.node.create_action_server(ServiceMapping::Enhanced, &action, &kind, qos);
        made.map_err(|error| Ros2Error::create(&self.names.gripper, &error))
    }

    /// Returns name and type of the gripper's action, and the quality of its services, which are reliable in ROS.
    fn gripper_action(&self) -> Result<(Name, ActionTypeName, QosProfile), Ros2Error> {
        let name = &self.names.gripper;
        let action = Name::parse(name).map_err(|error| Ros2Error::create(name, &error))?;
        let kind = ActionTypeName::new("control_msgs", "GripperCommand");
        let reliable = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::Fail)
            .history(History::KeepLast { depth: 10 });
        Ok((action, kind, reliable))
    }

    /// Returns the other users of these topics.
    pub(super) fn peers(&self, topics: Vec<Topic>) -> Peers {
        let events = self.context.domain_participant().status_listener();
        Peers::new(events, topics, self.names.clone())
    }

    fn topic(
        &self,
        topic: Topic,
        qos: &QosProfile,
    ) -> Result<ros2_client::dds::rustdds::Topic, Ros2Error> {
        let failed = |reason: String| Ros2Error::create(topic.name(&self.names), &reason);
        let name =
            Name::parse(topic.name(&self.names)).map_err(|error| failed(error.to_string()))?;
        let (package, message) = topic.message();
        self.node
            .create_topic(&name, MessageTypeName::new(package, message), qos)
            .map_err(|error| failed(error.to_string()))
    }
}
