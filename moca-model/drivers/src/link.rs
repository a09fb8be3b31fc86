//! What two ends of a connection know of each other's packets.

use std::fmt;
use std::mem::discriminant;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::command_limits::CommandRefusal;
use super::packet_error::PacketError;

/// More packets than these wait for the next call.
pub(super) const MOST: usize = 256;
/// Longer than any packet.
pub(super) const LARGEST: usize = 64 * 1024;
/// A counter may be so far ahead at once, and by so many a millisecond that has passed.
const AHEAD: u64 = 16;
const AHEAD_A_MILLISECOND: u64 = 4;
/// No sender has sent so many packets: at 4 kHz it would take two thousand years.
const EVER: u64 = 1 << 48;

/// Why a packet that has come does not count.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkRefusal {
    /// It is no packet of this protocol.
    #[error(transparent)]
    Packet(#[from] PacketError),
    /// It goes the other way.
    #[error("it is what this end sends, not what it takes")]
    Direction,
    /// It is of another session, or of somebody else.
    #[error("it is of another session")]
    Session,
    /// A newer one has come before it.
    #[error("a newer one has come before it")]
    Overtaken,
    /// Its counter is farther ahead than anybody can have sent packets since the one before.
    #[error("its counter is {counter}, and can be at most {most}")]
    Ahead {
        /// Its counter.
        counter: u64,
        /// What it can be.
        most: u64,
    },
    /// The robot obeys somebody else, or still moves.
    #[error("the robot obeys somebody else, or has not come to rest")]
    Busy,
    /// It comes from where nobody can be answered.
    #[error("it comes from {0}, which cannot be answered")]
    Address(SocketAddr),
    /// A command that the robot does not take.
    #[error(transparent)]
    Command(#[from] CommandRefusal),
}

/// The newest counter of a session, and when it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct Newest {
    counter: u64,
    at: Instant,
}

impl Newest {
    /// Begins with a counter that the other end may have reached.
    pub(super) fn begin(counter: u64) -> Result<Self, LinkRefusal> {
        if counter >= EVER {
            return Err(LinkRefusal::Ahead { counter, most: EVER });
        }
        Ok(Self { counter, at: Instant::now() })
    }

    /// Takes a counter that is newer, and can have been reached since.
    pub(super) fn admit(&mut self, counter: u64) -> Result<(), LinkRefusal> {
        let now = Instant::now();
        if counter <= self.counter {
            return Err(LinkRefusal::Overtaken);
        }
        let passed = u64::try_from((now - self.at).as_millis()).unwrap_or(EVER).min(EVER);
        let most = self.counter + AHEAD + AHEAD_A_MILLISECOND * passed;
        if counter > most {
            return Err(LinkRefusal::Ahead { counter, most });
        }
        *self = Self { counter, at: now };
        Ok(())
    }

    /// The time since it came.
    pub(super) fn age(&self) -> Duration {
        self.at.elapsed()
    }
}

/// How many packets were refused for one reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedPackets {
    /// Why, of the last of them.
    pub refusal: LinkRefusal,
    /// How many.
    pub count: u64,
}

/// What went over a connection at one end of it.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkStatistics {
    /// Packets that were taken.
    pub taken: u64,
    /// Sends and receives that the system refused: each counts as a packet that was lost.
    pub lost: u64,
    refused: Vec<RefusedPackets>,
}

impl Default for LinkStatistics {
    fn default() -> Self {
        // More than there are reasons: the loop must not allocate.
        Self { taken: 0, lost: 0, refused: Vec::with_capacity(32) }
    }
}

impl LinkStatistics {
    /// Counts a packet that was refused.
    pub(super) fn refuse(&mut self, refusal: LinkRefusal) {
        let same = |known: &&mut RefusedPackets| match (known.refusal, refusal) {
            (LinkRefusal::Packet(known), LinkRefusal::Packet(new)) => {
                discriminant(&known) == discriminant(&new)
            }
            (LinkRefusal::Command(known), LinkRefusal::Command(new)) => {
                discriminant(&known) == discriminant(&new)
            }
            (known, new) => discriminant(&known) == discriminant(&new),
        };
        match self.refused.iter_mut().find(same) {
            Some(known) => *known = RefusedPackets { refusal, count: known.count + 1 },
            None => self.refused.push(RefusedPackets { refusal, count: 1 }),
        }
    }

    /// The packets that were refused, by reason.
    pub fn refused(&self) -> &[RefusedPackets] {
        &self.refused
    }

    /// How many packets were refused.
    pub fn refused_count(&self) -> u64 {
        self.refused.iter().map(|refused| refused.count).sum()
    }
}

/// What went over a connection, for people and for programs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkReport {
    taken: u64,
    lost: u64,
    refused: Vec<RefusalReport>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct RefusalReport {
    count: u64,
    /// Of the last.
    because: String,
}

impl From<&LinkStatistics> for LinkReport {
    fn from(statistics: &LinkStatistics) -> Self {
        let report = |refused: &RefusedPackets| RefusalReport {
            count: refused.count,
            because: refused.refusal.to_string(),
        };
        let LinkStatistics { taken, lost, refused } = statistics;
        Self { taken: *taken, lost: *lost, refused: refused.iter().map(report).collect() }
    }
}

impl fmt::Display for LinkReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { taken, lost, refused } = self;
        write!(f, "{:30} {taken:>10}", "packets taken")?;
        write!(f, "\n{:30} {lost:>10}", "packets lost at the socket")?;
        let all: u64 = refused.iter().map(|refused| refused.count).sum();
        write!(f, "\n{:30} {all:>10}", "packets refused")?;
        for RefusalReport { count, because } in refused {
            write!(f, "\n{:30} {count:>10}, the last: {because}", "")?;
        }
        Ok(())
    }
}
