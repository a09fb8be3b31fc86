//! A lossy line of commands to a robot.

use crate::error::{Error, check_size};

/// A line of commands to a robot that bridges losses as libfranka's robots do. While packets are lost, velocities
/// continue at constant acceleration and torques stay constant. After too many losses in a row the robot stops by
/// itself. It then takes no commands until it is recovered.
///
/// ```
/// use whole_body::simulation::CommandLine;
///
/// // A velocity and a torque; the robot stops after two losses in a row.
/// let mut line = CommandLine::new(&[0.0, 5.0], 1, 2)?;
/// assert_eq!(line.pass(&[0.1, 6.0], true)?, Some(&[0.1, 6.0][..]));
/// assert_eq!(line.pass(&[0.2, 7.0], false)?, Some(&[0.2, 6.0][..]));
/// assert_eq!(line.pass(&[0.2, 7.0], false)?, None);
/// assert_eq!(line.pass(&[0.2, 7.0], true)?, None);
/// line.recover();
/// assert_eq!(line.pass(&[0.0, 7.0], true)?, Some(&[0.0, 7.0][..]));
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CommandLine {
    /// The command that the robot follows.
    obeyed: Vec<f64>,
    /// Change of each velocity with the last packet that arrived.
    change: Vec<f64>,
    tolerated: u32,
    lost_in_a_row: u32,
    stopped: bool,
}

impl CommandLine {
    /// Creates a line. The robot follows `initial` until the first packet arrives. The first `velocities` numbers of a
    /// packet are velocities, the others torques. The robot stops after `tolerated` losses in a row.
    ///
    /// # Errors
    /// [`Error::Value`] for a robot that would stop without a loss.
    pub fn new(initial: &[f64], velocities: usize, tolerated: u32) -> Result<Self, Error> {
        if tolerated == 0 {
            let (what, expected) = ("the number of lost packets that stop a robot", "1 or more");
            return Err(Error::value(what, 0.0, expected));
        }
        Ok(Self {
            obeyed: initial.to_vec(),
            change: vec![0.0; velocities.min(initial.len())],
            tolerated,
            lost_in_a_row: 0,
            stopped: false,
        })
    }

    /// Sends a packet, which `arrives` or is lost. Returns what the robot follows; `None` if it has stopped. Allocates
    /// nothing.
    ///
    /// # Errors
    /// [`Error::Size`].
    pub fn pass(&mut self, packet: &[f64], arrives: bool) -> Result<Option<&[f64]>, Error> {
        check_size("the packet", packet.len(), self.obeyed.len())?;
        let velocities = self.change.iter_mut().zip(&mut self.obeyed);
        if arrives {
            self.lost_in_a_row = 0;
            for ((change, obeyed), sent) in velocities.zip(packet) {
                *change = sent - *obeyed;
            }
            self.obeyed.copy_from_slice(packet);
        } else {
            self.lost_in_a_row = self.lost_in_a_row.saturating_add(1);
            for (change, obeyed) in velocities {
                *obeyed += *change;
            }
        }
        self.stopped |= self.lost_in_a_row >= self.tolerated;
        Ok((!self.stopped).then_some(&self.obeyed[..]))
    }

    /// True if the robot has stopped by itself.
    pub fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Recovers a stopped robot, so that it takes commands again.
    pub fn recover(&mut self) {
        self.stopped = false;
        self.lost_in_a_row = 0;
        self.change.fill(0.0);
        let velocities = self.change.len();
        self.obeyed.iter_mut().take(velocities).for_each(|velocity| *velocity = 0.0);
    }
}
