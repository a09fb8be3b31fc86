//! A line with delay and losses.

use crate::error::{Error, check_size};

/// A line that sends a packet of numbers each tick. A packet arrives a fixed number of ticks later or is lost. The
/// packet received last holds until the next one arrives.
///
/// ```
/// use whole_body::simulation::Transmission;
///
/// let mut line = Transmission::new(1, 0.1, &[0.0])?;
/// assert_eq!(line.pass(&[1.0], 0.5)?, [0.0]); // on its way
/// assert_eq!(line.pass(&[2.0], 0.05)?, [1.0]); // the second is lost
/// assert_eq!(line.pass(&[3.0], 0.5)?, [1.0]);
/// assert_eq!(line.lost_in_a_row(), 1);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission {
    /// Packets in transit.
    ring: Vec<Vec<f64>>,
    /// True if each of them will arrive.
    arrives: Vec<bool>,
    next: usize,
    loss: f64,
    received: Vec<f64>,
    lost_in_a_row: u32,
}

impl Transmission {
    /// Creates a line with a delay in ticks, a share of lost packets, and the packet that holds until the first one
    /// arrives.
    ///
    /// # Errors
    /// [`Error::Value`] for a share that is not from 0 to 1.
    pub fn new(delay: usize, loss: f64, initial: &[f64]) -> Result<Self, Error> {
        if !(0.0..=1.0).contains(&loss) {
            let (what, expected) = ("the share of lost packets", "from 0 to 1");
            return Err(Error::value(what, loss, expected));
        }
        Ok(Self {
            ring: vec![initial.to_vec(); delay],
            arrives: vec![true; delay],
            next: 0,
            loss,
            received: initial.to_vec(),
            lost_in_a_row: 0,
        })
    }

    /// Sends a packet and returns the one received last. The packet is lost if `draw`, a random number from 0 to 1, is
    /// below the share of losses. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`].
    pub fn pass(&mut self, packet: &[f64], draw: f64) -> Result<&[f64], Error> {
        check_size("the packet", packet.len(), self.received.len())?;
        let mut arrives = draw >= self.loss;
        if let (Some(place), Some(kept)) =
            (self.ring.get_mut(self.next), self.arrives.get_mut(self.next))
        {
            std::mem::swap(&mut arrives, kept);
            if arrives {
                self.received.copy_from_slice(place);
            }
            place.copy_from_slice(packet);
            self.next = (self.next + 1) % self.ring.len();
        } else if arrives {
            self.received.copy_from_slice(packet);
        }
        self.lost_in_a_row = if arrives { 0 } else { self.lost_in_a_row.saturating_add(1) };
        Ok(&self.received)
    }

    /// The packet received last.
    pub fn received(&self) -> &[f64] {
        &self.received
    }

    /// The number of packets lost since the last arrival.
    pub fn lost_in_a_row(&self) -> u32 {
        self.lost_in_a_row
    }
}
