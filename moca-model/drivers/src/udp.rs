//! A robot that is reached by UDP.

use std::convert::Infallible;
use std::io::{self, ErrorKind};
use std::net::{ToSocketAddrs, UdpSocket};
use std::time::{Duration, Instant};

use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, Received, RobotSide};

use super::link::{LARGEST, LinkRefusal, LinkStatistics, MOST, Newest};
use super::packet::{Packet, PacketHead, PacketKind};
use super::shared_key::SharedKey;

/// The loop's end of the connection.
///
/// Until the first command it sends a hello in each call, and the robot answers each with a measurement. Only
/// measurements of this session count. A session has one number that this end chose at random and one that the robot
/// chose. If the operating system refuses a send or a receive, that counts as a lost packet: the watchdogs at both ends
/// detect it.
#[derive(Debug)]
pub struct UdpSide {
    socket: UdpSocket,
    outgoing: Packet,
    incoming: Packet,
    buffer: Vec<u8>,
    /// Numbers of the session: the controller's own, and the robot's once it has answered.
    controller: u64,
    robot: Option<u64>,
    sent: u64,
    /// True if a packet other than a hello was sent to the robot.
    commands: bool,
    newest: Option<Newest>,
    statistics: LinkStatistics,
}

impl UdpSide {
    /// Connects to a robot with this number of joints at this address. `key` is the robot's key, if it has one.
    ///
    /// # Errors
    /// An invalid address, or an operating system that gives no socket.
    pub fn connect(
        address: impl ToSocketAddrs,
        joints: usize,
        key: Option<&SharedKey>,
    ) -> io::Result<Self> {
        let socket = UdpSocket::bind("0.0.0.0:0")?;
        socket.connect(address)?;
        socket.set_nonblocking(true)?;
        let packet = Packet::new(joints, key);
        Ok(Self {
            socket,
            outgoing: packet.clone(),
            incoming: packet,
            buffer: vec![0; LARGEST],
            controller: rand::random(),
            robot: None,
            sent: 0,
            commands: false,
            newest: None,
            statistics: LinkStatistics::default(),
        })
    }

    /// Returns the counts of the connection's packets.
    pub fn statistics(&self) -> &LinkStatistics {
        &self.statistics
    }

    fn head(&mut self, kind: PacketKind) -> PacketHead {
        self.sent += 1;
        let robot = if kind == PacketKind::Hello { 0 } else { self.robot.unwrap_or_default() };
        PacketHead { kind, controller: self.controller, robot, counter: self.sent }
    }

    /// Sends a hello, until the first command.
    fn hello(&mut self) {
        if !self.commands {
            let head = self.head(PacketKind::Hello);
            self.outgoing.write(head);
            self.transmit();
        }
    }

    /// Changes this end to one that waits for packets, in a session with this number.
    pub(super) fn waiting(mut self, controller: u64, patience: Duration) -> io::Result<Self> {
        self.socket.set_nonblocking(false)?;
        self.socket.set_read_timeout(Some(patience))?;
        self.controller = controller;
        Ok(self)
    }

    /// Waits for the robot's next packet. Returns `None` if it does not come within the patience. A period without a
    /// measurement is a packet, too.
    pub(super) fn next(
        &mut self,
        measured: &mut JointMeasurement,
        patience: Duration,
    ) -> Option<Received> {
        self.hello();
        let since = Instant::now();
        while since.elapsed() < patience {
            match self.socket.recv(&mut self.buffer) {
                Ok(length) => match self.take(length) {
                    Ok(kind) => return Some(self.read(kind, measured)),
                    Err(refusal) => self.statistics.refuse(refusal),
                },
                Err(_) => self.statistics.lost += 1,
            }
        }
        None
    }

    /// Reads the packet that was taken.
    fn read(&mut self, kind: PacketKind, measured: &mut JointMeasurement) -> Received {
        self.statistics.taken += 1;
        if kind == PacketKind::Measurement {
            self.incoming.read_measurement(measured);
            Received::Fresh
        } else {
            Received::Nothing
        }
    }

    fn transmit(&mut self) {
        self.statistics.lost += u64::from(self.socket.send(self.outgoing.bytes()).is_err());
    }

    /// Takes a received packet.
    fn take(&mut self, length: usize) -> Result<PacketKind, LinkRefusal> {
        let bytes = self.buffer.get(..length).unwrap_or_default();
        let head = self.incoming.take(bytes)?;
        if !matches!(head.kind, PacketKind::Measurement | PacketKind::Nothing) {
            return Err(LinkRefusal::Direction);
        }
        let same_robot = !self.commands || self.robot == Some(head.robot);
        if head.controller != self.controller || !same_robot {
            return Err(LinkRefusal::Session);
        }
        match &mut self.newest {
            Some(newest) => newest.admit(head.counter)?,
            // The answer to a hello has the counter of the hello.
            None if head.counter > self.sent => {
                return Err(LinkRefusal::Ahead { counter: head.counter, most: self.sent });
            }
            None => self.newest = Some(Newest::begin(head.counter)?),
        }
        self.robot = Some(head.robot);
        Ok(head.kind)
    }
}

impl RobotSide for UdpSide {
    type Error = Infallible;

    fn receive(&mut self, measured: &mut JointMeasurement) -> Result<Received, Infallible> {
        self.hello();
        let mut received = Received::Nothing;
        for _ in 0..MOST {
            match self.socket.recv(&mut self.buffer) {
                Ok(length) => match self.take(length) {
                    Ok(kind) => {
                        if self.read(kind, measured) == Received::Fresh {
                            received = Received::Fresh;
                        }
                    }
                    Err(refusal) => self.statistics.refuse(refusal),
                },
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => self.statistics.lost += 1,
            }
        }
        Ok(received)
    }

    fn send(&mut self, command: &JointCommand) -> Result<(), Infallible> {
        self.commands = true;
        let head = self.head(PacketKind::Command);
        self.outgoing.write_command(head, command);
        self.transmit();
        Ok(())
    }

    fn halt(&mut self) -> Result<(), Infallible> {
        if self.commands {
            let head = self.head(PacketKind::Halt);
            self.outgoing.write(head);
            self.transmit();
        }
        Ok(())
    }
}
