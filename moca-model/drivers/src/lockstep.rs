//! A robot that is reached by UDP and whose packets are the clock.

use std::io;
use std::time::Duration;

use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, Received, RobotSide};

use super::error::Error;
use super::link::LinkStatistics;
use super::udp::UdpSide;

/// Longest time to wait for the next packet.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);
/// Number of each session. It is fixed instead of random, so that two runs with equal inputs send equal bytes.
const SESSION: u64 = 1;

/// The loop's end of a connection in lockstep. Each packet of the robot is one period, however long it takes to come.
///
/// The robot answers every hello and every command with one packet. This is a measurement, or a packet that says that
/// nothing was measured. The loop waits for it on a clock that only its own waits advance
/// ([`ManualClock`](moca_model::whole_body::control_loop::ManualClock)).
#[derive(Debug)]
pub struct LockstepSide {
    side: UdpSide,
}

impl LockstepSide {
    /// Creates the end of the connection from a side that has not been used.
    ///
    /// # Errors
    /// The error that the operating system reports.
    pub fn new(side: UdpSide) -> io::Result<Self> {
        Ok(Self { side: side.waiting(SESSION, PATIENCE)? })
    }

    /// Returns the counts of the connection's packets.
    pub fn statistics(&self) -> &LinkStatistics {
        self.side.statistics()
    }
}

impl RobotSide for LockstepSide {
    type Error = Error;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Error> {
        self.side.next(measured, PATIENCE).ok_or(Error::Silent)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), Error> {
        // A command that cannot be sent is not answered either.
        self.side.send(command).or(Ok(()))
    }

    fn halt(&mut self) -> Result<(), Error> {
        self.side.halt().or(Ok(()))
    }
}
