//! Statistics of a topic.

use std::mem::discriminant;

use moca_model::whole_body::control_loop::TimeHistogram;

use super::refusal::Refusal;
use super::topic::Topic;
use crate::topic_names::TopicNames;

/// Number of messages that were refused for one reason.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusalCount {
    /// Newest of these refusals.
    pub refusal: Refusal,
    /// Number of messages.
    pub count: u64,
}

/// Statistics of the messages of a topic.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicStatistics {
    /// Topic.
    pub topic: Topic,
    /// Name of the topic.
    pub name: String,
    /// Number of messages that were accepted.
    pub taken: u64,
    /// Number of messages that never came, by the numbers that their publishers give them. Messages whose bytes were
    /// refused count too, since their numbers are unknown.
    pub lost: u64,
    /// Time from the stamp of a message until it was taken \[s\].
    pub age: TimeHistogram,
    refused: Vec<RefusalCount>,
}

impl TopicStatistics {
    /// Creates statistics without messages.
    pub fn new(topic: Topic, names: &TopicNames) -> Self {
        let name = topic.name(names).to_owned();
        Self { topic, name, taken: 0, lost: 0, age: TimeHistogram::default(), refused: Vec::new() }
    }

    /// Counts a message that was refused.
    pub fn refuse(&mut self, refusal: Refusal) {
        let same =
            |known: &&mut RefusalCount| discriminant(&known.refusal) == discriminant(&refusal);
        match self.refused.iter_mut().find(same) {
            Some(known) => *known = RefusalCount { refusal, count: known.count + 1 },
            None => self.refused.push(RefusalCount { refusal, count: 1 }),
        }
    }

    /// Returns the number of refused messages for each reason.
    pub fn refused(&self) -> &[RefusalCount] {
        &self.refused
    }
}
