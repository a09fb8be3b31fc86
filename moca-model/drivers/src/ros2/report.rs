//! Messages of a connection, for people and for programs.

use std::fmt;

use moca_model::whole_body::control_loop::TimeHistogram;
use serde::Serialize;

use super::side::Ros2Statistics;
use super::statistics::{RefusalCount, TopicStatistics};

/// Messages of a connection. Times in µs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ros2Report {
    published: u64,
    failed: u64,
    superseded: u64,
    topics: Vec<TopicReport>,
}

/// Messages of a topic. Times in µs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicReport {
    topic: String,
    taken: u64,
    lost: u64,
    /// `None` where no message has an age.
    #[serde(skip_serializing_if = "Option::is_none")]
    age_us: Option<Ages>,
    refused: Vec<RefusalReport>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Ages {
    p50: f64,
    p99: f64,
    max: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct RefusalReport {
    count: u64,
    /// Reason of the last refusal.
    because: String,
}

impl From<&Ros2Statistics> for Ros2Report {
    fn from(statistics: &Ros2Statistics) -> Self {
        let Ros2Statistics { topics, published, failed, superseded } = statistics;
        Self {
            published: *published,
            failed: *failed,
            superseded: *superseded,
            topics: topics.iter().map(TopicReport::from).collect(),
        }
    }
}

impl From<&TopicStatistics> for TopicReport {
    fn from(statistics: &TopicStatistics) -> Self {
        let TopicStatistics { name, taken, lost, age, .. } = statistics;
        let report = |RefusalCount { refusal, count }: &RefusalCount| RefusalReport {
            count: *count,
            because: refusal.to_string(),
        };
        Self {
            topic: name.clone(),
            taken: *taken,
            lost: *lost,
            age_us: (age.count() > 0).then(|| Ages::from(age)),
            refused: statistics.refused().iter().map(report).collect(),
        }
    }
}

impl From<&TimeHistogram> for Ages {
    fn from(ages: &TimeHistogram) -> Self {
        let [p50, p99] = [0.5, 0.99].map(|share| 1e6 * ages.quantile(share));
        Self { p50, p99, max: 1e6 * ages.longest() }
    }
}

impl fmt::Display for Ros2Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { published, failed, superseded, topics } = self;
        write!(f, "{:30} {published:>10}", "commands published")?;
        write!(f, "\n{:30} {superseded:>10}", "commands superseded")?;
        write!(f, "\n{:30} {failed:>10}", "commands not taken by DDS")?;
        topics.iter().try_for_each(|topic| write!(f, "\n{topic}"))
    }
}

impl fmt::Display for TopicReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { topic, taken, lost, age_us, refused } = self;
        write!(f, "{topic:40} {taken:>8} taken, {lost} lost")?;
        if let Some(Ages { p50, p99, max }) = age_us {
            write!(f, ", age [µs] p50 p99 max {p50:.0}, {p99:.0}, {max:.0}")?;
        }
        for RefusalReport { count, because } in refused {
            write!(f, "\n{:40} {count:>8} refused, the last: {because}", "")?;
        }
        Ok(())
    }
}
