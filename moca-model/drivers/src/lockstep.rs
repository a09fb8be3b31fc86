//! A robot that is reached by UDP, whose packets are the clock.

use std::io;
use std::time::Duration;

use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, Received, RobotSide};

use super::link::LinkStatistics;
use super::udp::UdpSide;

/// How long the next packet may take to come.
const PATIENCE: Duration = Duration::from_secs(5);
/// The number of each session: nothing of it is chosen at random, so that the same run twice sends the same bytes.
const SESSION: u64 = 1;

/// Why a loop in lockstep ends.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LockstepError {
    /// The robot does not answer.
    #[error(
        "no packet for {} s; in lockstep the robot answers every hello and command with one, `MOn2` where it measures \
         nothing",
        PATIENCE.as_secs()
    )]
    Silent,
}

/// The loop's end of a connection in lockstep: each packet of the robot's is one period, however long it takes to come.
///
/// The robot answers every hello and every command with one packet: a measurement, or one that says that it measured
/// nothing. The loop waits for it on a clock that only its own waits move on
/// ([`ManualClock`](moca_model::whole_body::control_loop::ManualClock)).
#[derive(Debug)]
pub struct LockstepSide {
    side: UdpSide,
}

impl LockstepSide {
    /// Over a connection that has not been used.
    ///
    /// # Errors
    /// What the system says.
    pub fn new(side: UdpSide) -> io::Result<Self> {
        Ok(Self { side: side.waiting(SESSION, PATIENCE)? })
    }

    /// What went over the connection.
    pub fn statistics(&self) -> &LinkStatistics {
        self.side.statistics()
    }
}

impl RobotSide for LockstepSide {
    type Error = LockstepError;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, LockstepError> {
        self.side.next(measured, PATIENCE).ok_or(LockstepError::Silent)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), LockstepError> {
        // What cannot be sent is not answered.
        self.side.send(command).or(Ok(()))
    }

    fn halt(&mut self) -> Result<(), LockstepError> {
        self.side.halt().or(Ok(()))
    }
}
