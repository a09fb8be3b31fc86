//! State that both ends of a connection keep about each other's packets.

use std::fmt;
use std::mem::discriminant;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::command_limits::CommandRefusal;
use super::packet_error::PacketError;

/// Largest number of packets that are read in one call; the others wait for the next call.
pub(super) const MOST: usize = 256;
/// Size of the receive buffer \[bytes\]. It is larger than any packet.
pub(super) const LARGEST: usize = 64 * 1024;
/// Number of counts by which a counter may jump ahead, at once and per millisecond that has passed.
const AHEAD: u64 = 16;
const AHEAD_A_MILLISECOND: u64 = 4;
/// Counter that no sender reaches: at 4 kHz it would take two thousand years.
const EVER: u64 = 1 << 48;

/// Reason why a received packet does not count.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkRefusal {
    /// The bytes are no packet of this protocol.
    #[error(transparent)]
    Packet(#[from] PacketError),
    /// The packet belongs to the other direction.
    #[error("it is what this end sends, not what it takes")]
    Direction,
    /// The packet belongs to another session or comes from another sender.
    #[error("it is of another session")]
    Session,
    /// A newer packet came before this one.
    #[error("a newer one has come before it")]
    Overtaken,
    /// The counter is farther ahead than any sender can have reached since the packet before.
    #[error("its counter is {counter}, and can be at most {most}")]
    Ahead {
        /// Counter of the packet.
        counter: u64,
        /// Largest possible counter.
        most: u64,
    },
    /// The robot obeys another controller, or still moves.
    #[error("the robot obeys somebody else, or has not come to rest")]
    Busy,
    /// The packet comes from an address that cannot be answered.
    #[error("it comes from {0}, which cannot be answered")]
    Address(SocketAddr),
    /// The robot refuses the command.
    #[error(transparent)]
    Command(#[from] CommandRefusal),
}

/// Newest counter of a session, and when it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct Newest {
    counter: u64,
    at: Instant,
}

impl Newest {
    /// Starts with a counter that the other end can have reached.
    pub(super) fn begin(counter: u64) -> Result<Self, LinkRefusal> {
        if counter >= EVER {
            return Err(LinkRefusal::Ahead { counter, most: EVER });
        }
        Ok(Self { counter, at: Instant::now() })
    }

    /// Accepts a counter that is newer and that the sender can have reached since the last one.
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

    /// Returns the time since the newest counter came.
    pub(super) fn age(&self) -> Duration {
        self.at.elapsed()
    }
}

/// Number of packets that were refused for one reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedPackets {
    /// Reason of the last of these packets.
    pub refusal: LinkRefusal,
    /// Number of packets.
    pub count: u64,
}

/// Counts of the packets at one end of a connection.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkStatistics {
    /// Number of packets that were accepted.
    pub taken: u64,
    /// Number of sends and receives that the operating system refused. Each counts as a lost packet.
    pub lost: u64,
    refused: Vec<RefusedPackets>,
}

impl Default for LinkStatistics {
    fn default() -> Self {
        // The capacity exceeds the number of reasons, because the loop must not allocate.
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

    /// Returns the number of refused packets for each reason.
    pub fn refused(&self) -> &[RefusedPackets] {
        &self.refused
    }

    /// Returns the number of all refused packets.
    pub fn refused_count(&self) -> u64 {
        self.refused.iter().map(|refused| refused.count).sum()
    }
}

/// Packets of a connection, for people and for programs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkReport {
    taken: u64,
    lost: u64,
    refused: Vec<RefusalReport>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct RefusalReport {
    count: u64,
    /// Reason of the last refusal.
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
