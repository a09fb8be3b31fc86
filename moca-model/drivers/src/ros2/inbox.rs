//! Messages of one topic.

use std::collections::HashMap;
use std::time::SystemTime;

use ros2_client::{Gid, ReadError, Subscription};
use serde::de::DeserializeOwned;

use super::error::Ros2Error;
use super::peers::Peers;
use super::refusal::Refusal;
use super::statistics::TopicStatistics;

/// Subscription with the statistics of its messages.
pub(super) struct Inbox<M: 'static> {
    pub(super) subscription: Subscription<M>,
    pub(super) statistics: TopicStatistics,
    /// Number of the newest message of each publisher.
    newest: HashMap<Gid, i64>,
}

impl<M: DeserializeOwned> Inbox<M> {
    pub(super) fn new(subscription: Subscription<M>, statistics: TopicStatistics) -> Self {
        Self { subscription, statistics, newest: HashMap::new() }
    }

    /// Takes all waiting messages without blocking. `take` returns the age of a message, where it has one.
    ///
    /// # Errors
    /// [`Ros2Error::Read`]
    pub(super) fn drain(
        &mut self,
        peers: &Peers,
        mut take: impl FnMut(&M, SystemTime) -> Result<Option<f64>, Refusal>,
    ) -> Result<(), Ros2Error> {
        loop {
            match self.subscription.take() {
                Ok(None) => return Ok(()),
                Ok(Some((message, info))) => {
                    let (publisher, number) = (info.publisher_gid(), info.sequence_number());
                    self.count(publisher, number);
                    let taken = match peers.refusal(publisher) {
                        Some(refusal) => Err(refusal),
                        None => take(&message, SystemTime::now()),
                    };
                    match taken {
                        Ok(age) => {
                            self.statistics.taken += 1;
                            if let Some(age) = age {
                                self.statistics.age.push(age);
                            }
                        }
                        Err(refusal) => self.statistics.refuse(refusal),
                    }
                }
                Err(ReadError::Deserialization { reason }) => {
                    self.statistics.refuse(Refusal::Bytes { reason });
                }
                Err(error) => {
                    let (topic, reason) = (self.statistics.name.clone(), error.to_string());
                    return Err(Ros2Error::Read { topic, reason });
                }
            }
        }
    }

    /// Counts the messages that are missing between the newest one of this publisher and this one.
    fn count(&mut self, publisher: Gid, number: i64) {
        let newest = self.newest.entry(publisher).or_insert(number);
        let missing = number.saturating_sub(*newest).saturating_sub(1);
        self.statistics.lost += u64::try_from(missing).unwrap_or_default();
        *newest = number.max(*newest);
    }
}
