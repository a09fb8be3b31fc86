//! What has come on a topic.

use std::mem::discriminant;

use moca_model::whole_body::control_loop::TimeHistogram;

use super::refusal::Refusal;
use super::topic::Topic;

/// How many messages were refused for one reason.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusalCount {
    /// The newest of them.
    pub refusal: Refusal,
    /// How many.
    pub count: u64,
}

/// What has come on a topic.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicStatistics {
    /// The topic.
    pub topic: Topic,
    /// Messages that were taken.
    pub taken: u64,
    /// Messages that never came, by the numbers that their publishers give them; and those refused for their bytes,
    /// whose numbers are not known.
    pub lost: u64,
    /// From the stamp of a message to when it was taken \[s\].
    pub age: TimeHistogram,
    refused: Vec<RefusalCount>,
}

impl TopicStatistics {
    /// Nothing yet.
    pub fn new(topic: Topic) -> Self {
        Self { topic, taken: 0, lost: 0, age: TimeHistogram::default(), refused: Vec::new() }
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

    /// The messages that were refused, by reason.
    pub fn refused(&self) -> &[RefusalCount] {
        &self.refused
    }
}
