//! A robot that is reached by UDP.

use std::io::{self, ErrorKind};
use std::net::{ToSocketAddrs, UdpSocket};

use moca_model::whole_body::{JointCommand, JointMeasurement, Received, RobotSide};

use super::packet::{Packet, PacketKind};

/// More than any packet.
const LARGEST: usize = 64 * 1024;

/// The loop's end of the connection. Packets that are old, of another size, or of something else are left out.
#[derive(Debug)]
pub struct UdpSide {
    socket: UdpSocket,
    outgoing: Packet,
    incoming: Packet,
    buffer: Vec<u8>,
    sent: u64,
    /// The sequence number of the newest measurement.
    newest: Option<u64>,
    refused: u64,
}

impl UdpSide {
    /// To a robot of so many joints at this address.
    ///
    /// # Errors
    /// An address that is none, and a system without a socket.
    pub fn connect(address: impl ToSocketAddrs, joints: usize) -> io::Result<Self> {
        let socket = UdpSocket::bind("0.0.0.0:0")?;
        socket.connect(address)?;
        socket.set_nonblocking(true)?;
        let (packet, buffer) = (Packet::new(joints), vec![0; LARGEST]);
        let (outgoing, incoming) = (packet.clone(), packet);
        Ok(Self { socket, outgoing, incoming, buffer, sent: 0, newest: None, refused: 0 })
    }

    /// How many packets were no measurements of this robot.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    fn transmit(&mut self) -> io::Result<()> {
        self.sent += 1;
        // A packet that is lost here is lost like any other: the watchdogs at both ends know.
        self.socket.send(self.outgoing.bytes()).map(drop).or_else(passing)
    }
}

/// What goes by again is no error: nobody listens yet, or a full buffer.
fn passing(error: io::Error) -> io::Result<()> {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::ConnectionRefused | ErrorKind::Interrupted => Ok(()),
        _ => Err(error),
    }
}

impl RobotSide for UdpSide {
    type Error = io::Error;

    fn receive(&mut self, measured: &mut JointMeasurement) -> io::Result<Received> {
        if self.newest.is_none() {
            self.outgoing.write(PacketKind::Hello, self.sent, [&[], &[], &[]]);
            self.transmit()?;
        }
        let mut received = Received::Nothing;
        loop {
            let length = match self.socket.recv(&mut self.buffer) {
                Ok(length) => length,
                Err(error) => return passing(error).map(|()| received),
            };
            let bytes = self.buffer.get(..length).unwrap_or_default();
            match self.incoming.take(bytes) {
                Ok((PacketKind::Measurement, sequence)) => {
                    if self.newest.is_some_and(|newest| sequence <= newest) {
                        continue;
                    }
                    self.newest = Some(sequence);
                    received = Received::Fresh;
                    let JointMeasurement { position, velocity, torque, .. } = measured;
                    let [positions, velocities, torques] = self.incoming.numbers();
                    position.iter_mut().zip(positions).for_each(|(own, number)| *own = number);
                    velocity.iter_mut().zip(velocities).for_each(|(own, number)| *own = number);
                    torque.iter_mut().zip(torques).for_each(|(own, number)| *own = Some(number));
                }
                Ok(_) | Err(_) => self.refused += 1,
            }
        }
    }

    fn send(&mut self, command: &JointCommand) -> io::Result<()> {
        self.outgoing.write_command(self.sent, command);
        self.transmit()
    }

    fn halt(&mut self) -> io::Result<()> {
        self.outgoing.write(PacketKind::Halt, self.sent, [&[], &[], &[]]);
        self.transmit()
    }
}
