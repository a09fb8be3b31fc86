//! The simulated robot behind UDP.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};

use anyhow::Result;
use moca_model::whole_body::{Clock, JointCommand, JointMeasurement, RobotSide};

use super::packet::{Packet, PacketKind};
use super::simulated::SimulatedSide;

/// Without a command for so many periods the robot stands, as if its brakes had closed.
const SILENCE: u64 = 50;

/// A robot at a UDP address. It measures once a period, tells whoever has spoken to it last, and moves as the
/// last command says; without commands it stands.
#[derive(Debug)]
pub struct UdpServer {
    socket: UdpSocket,
    robot: SimulatedSide,
    measured: JointMeasurement,
    command: JointCommand,
    packet: Packet,
    buffer: Vec<u8>,
    client: Option<SocketAddr>,
    sent: u64,
    /// The newest command's number, and the periods since.
    newest: Option<u64>,
    silent: u64,
}

impl UdpServer {
    /// At this address.
    ///
    /// # Errors
    /// An address that is taken or not the machine's.
    pub fn bind(
        address: impl ToSocketAddrs,
        robot: SimulatedSide,
        start: &[f64],
    ) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        socket.set_nonblocking(true)?;
        let measured = JointMeasurement::resting(start.to_vec(), start.len());
        Ok(Self {
            command: JointCommand::at_rest(&measured),
            packet: Packet::new(start.len()),
            buffer: vec![0; 64 * 1024],
            client: None,
            sent: 0,
            newest: None,
            silent: 0,
            socket,
            robot,
            measured,
        })
    }

    /// Its address.
    ///
    /// # Errors
    /// What the system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Runs until `stop` returns true.
    ///
    /// # Errors
    /// A socket that fails, and commands that the simulation refuses.
    pub fn serve(
        &mut self,
        period: f64,
        clock: &mut impl Clock,
        mut stop: impl FnMut() -> bool,
    ) -> Result<()> {
        let mut due = clock.now();
        while !stop() {
            due = (due + period).max(clock.now() - period);
            clock.sleep_until(due);
            self.listen()?;
            self.robot.receive(&mut self.measured)?;
            if self.newest.is_some() && self.silent < SILENCE {
                self.robot.send(&self.command)?;
            }
            self.silent += 1;
            let Some(client) = self.client else { continue };
            self.packet.write_measurement(self.sent, &self.measured);
            self.sent += 1;
            passing(self.socket.send_to(self.packet.bytes(), client).map(drop))?;
        }
        Ok(())
    }

    /// Takes what has come.
    fn listen(&mut self) -> io::Result<()> {
        loop {
            let (length, from) = match self.socket.recv_from(&mut self.buffer) {
                Ok(received) => received,
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) => return passing(Err(error)),
            };
            let bytes = self.buffer.get(..length).unwrap_or_default();
            match self.packet.take(bytes) {
                Ok((PacketKind::Hello, _)) => {
                    self.client = Some(from);
                    self.newest = None;
                }
                Ok((PacketKind::Halt, _)) if self.client == Some(from) => self.newest = None,
                Ok((PacketKind::Command, sequence))
                    if self.client == Some(from)
                        && self.newest.is_none_or(|newest| sequence > newest) =>
                {
                    self.newest = Some(sequence);
                    self.silent = 0;
                    let JointCommand { position, velocity, torque } = &mut self.command;
                    for (own, numbers) in
                        [position, velocity, torque].into_iter().zip(self.packet.numbers())
                    {
                        own.iter_mut().zip(numbers).for_each(|(own, number)| *own = number);
                    }
                }
                Ok(_) | Err(_) => {}
            }
        }
    }
}

/// A client that has gone is no error.
fn passing(outcome: io::Result<()>) -> io::Result<()> {
    outcome.or_else(|error| match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::ConnectionRefused | ErrorKind::Interrupted => Ok(()),
        _ => Err(error),
    })
}
