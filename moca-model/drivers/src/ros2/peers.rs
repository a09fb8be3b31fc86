//! Publishers and subscribers of others on the topics in use.

use std::collections::HashMap;

use ros2_client::Gid;
use ros2_client::dds::rustdds::DomainParticipantStatusListener;
use ros2_client::dds::rustdds::dds::statusevents::{DomainParticipantStatusEvent, StatusEvented};

use super::refusal::Refusal;
use super::statistics::TopicStatistics;
use super::topic::Topic;
use crate::topic_names::TopicNames;

/// Publishers and subscribers with other message types on topics in use.
pub(super) struct Peers {
    events: DomainParticipantStatusListener,
    topics: Vec<Topic>,
    names: TopicNames,
    strangers: HashMap<Gid, (Topic, Refusal)>,
}

impl Peers {
    /// Creates the peers on some topics, of which `events` tells.
    pub(super) fn new(
        events: DomainParticipantStatusListener,
        topics: Vec<Topic>,
        names: TopicNames,
    ) -> Self {
        Self { events, topics, names, strangers: HashMap::new() }
    }

    /// Takes the results of discovery since the last call.
    pub(super) fn update(&mut self) {
        while let Some(event) = self.events.try_recv_status() {
            let peer = match event {
                DomainParticipantStatusEvent::WriterDetected { writer } => writer,
                DomainParticipantStatusEvent::ReaderDetected { reader } => reader,
                _ => continue,
            };
            // DDS names of ROS topics begin with `rt`.
            let named = |topic: &&Topic| {
                peer.topic_name.strip_prefix("rt") == Some(topic.name(&self.names))
            };
            let Some(topic) = self.topics.iter().find(named) else { continue };
            if let Err(refusal) = topic.check_type(&peer.type_name) {
                self.strangers.insert(peer.guid.into(), (*topic, refusal));
            }
        }
    }

    /// Returns statistics without messages of all topics but the first ones.
    pub(super) fn statistics_after(&self, first: usize) -> impl Iterator<Item = TopicStatistics> {
        let topics = self.topics.iter().skip(first);
        topics.map(|topic| TopicStatistics::new(*topic, &self.names))
    }

    /// Returns why messages of this publisher are refused; `None` if they are not.
    pub(super) fn refusal(&self, publisher: Gid) -> Option<Refusal> {
        self.strangers.get(&publisher).map(|(_, refusal)| refusal.clone())
    }

    /// Adds the number of peers with other types on a topic to its statistics.
    pub(super) fn count(&self, statistics: &mut TopicStatistics) {
        let topic = statistics.topic;
        for (_, refusal) in self.strangers.values().filter(|(on, _)| *on == topic) {
            statistics.refuse(refusal.clone());
        }
    }
}
