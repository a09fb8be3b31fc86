//! The simulated robot behind UDP.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::Duration;

use moca_model::Error;
use moca_model::whole_body::control_loop::{Clock, JointCommand, JointMeasurement, RobotSide};

use super::link::{LARGEST, LinkRefusal, LinkStatistics, MOST, Newest};
use super::packet::{Packet, PacketHead, PacketKind};
use super::shared_key::SharedKey;
use super::simulated::SimulatedSide;

/// A session ends when no command has come for so long.
const ENDS: Duration = Duration::from_secs(1);

/// A robot at a UDP address. It measures once a period and moves as the newest command says.
///
/// It answers a hello with one measurement, as long as it stands and obeys nobody. The first command that has the
/// numbers of such an answer begins a session, in which each period's measurement goes to its sender. A period
/// without a command is one whose command was lost: the robot bridges it, and stops by itself after twenty. The session
/// ends with a halt, or when no command has come for a second.
#[derive(Debug)]
pub struct UdpServer {
    socket: UdpSocket,
    robot: SimulatedSide,
    measured: JointMeasurement,
    command: JointCommand,
    /// One that has come, until the robot takes it.
    candidate: JointCommand,
    outgoing: Packet,
    incoming: Packet,
    buffer: Vec<u8>,
    /// The robot's number of the next session.
    offered: u64,
    session: Option<Session>,
    /// Whether the robot has been told to move since it was recovered.
    moved: bool,
    statistics: LinkStatistics,
}

/// With the controller that the robot obeys.
#[derive(Debug)]
struct Session {
    peer: SocketAddr,
    controller: u64,
    robot: u64,
    newest: Newest,
    sent: u64,
}

impl UdpServer {
    /// At this address, for controllers that have the key, if there is one.
    ///
    /// # Errors
    /// An address that is taken or not the machine's.
    pub fn bind(
        address: impl ToSocketAddrs,
        robot: SimulatedSide,
        start: &[f64],
        key: Option<&SharedKey>,
    ) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        socket.set_nonblocking(true)?;
        let measured = JointMeasurement::resting(start.to_vec(), start.len());
        let packet = Packet::new(start.len(), key);
        Ok(Self {
            command: JointCommand::at_rest(&measured),
            candidate: JointCommand::at_rest(&measured),
            outgoing: packet.clone(),
            incoming: packet,
            buffer: vec![0; LARGEST],
            offered: rand::random(),
            session: None,
            moved: false,
            statistics: LinkStatistics::default(),
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

    /// What has come so far, and why packets were refused.
    pub fn statistics(&self) -> &LinkStatistics {
        &self.statistics
    }

    /// The robot.
    pub fn robot(&self) -> &SimulatedSide {
        &self.robot
    }

    /// Runs until `stop` returns true.
    ///
    /// # Errors
    /// A simulation that breaks down; no packet does that.
    pub fn serve(
        &mut self,
        period: f64,
        clock: &mut impl Clock,
        mut stop: impl FnMut() -> bool,
    ) -> Result<(), Error> {
        let mut due = clock.now();
        while !stop() {
            due = (due + period).max(clock.now() - period);
            clock.sleep_until(due);
            self.robot.receive(&mut self.measured)?;
            if self.listen() {
                self.moved = true;
                self.robot.obey(&self.command)?;
            } else if self.moved {
                self.robot.miss()?;
            }
            self.end_session();
            self.tell();
        }
        Ok(())
    }

    /// Takes what has come; returns true if a command is among it.
    fn listen(&mut self) -> bool {
        let mut commanded = false;
        for _ in 0..MOST {
            match self.socket.recv_from(&mut self.buffer) {
                Ok((length, from)) => match self.take(length, from) {
                    Ok(kind) => {
                        self.statistics.taken += 1;
                        commanded = match kind {
                            PacketKind::Command => true,
                            PacketKind::Halt => false,
                            _ => commanded,
                        };
                    }
                    Err(refusal) => self.statistics.refuse(refusal),
                },
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => self.statistics.lost += 1,
            }
        }
        commanded
    }

    /// Takes a packet that has come.
    fn take(&mut self, length: usize, from: SocketAddr) -> Result<PacketKind, LinkRefusal> {
        let bytes = self.buffer.get(..length).unwrap_or_default();
        let head = self.incoming.take(bytes)?;
        match head.kind {
            PacketKind::Measurement | PacketKind::Nothing => return Err(LinkRefusal::Direction),
            PacketKind::Hello => self.answer(&head, from)?,
            PacketKind::Halt => {
                self.continue_session(&head, from)?;
                self.session = None;
            }
            PacketKind::Command => {
                self.admit(&head, from)?;
                self.incoming.read_command(&mut self.candidate);
                self.robot.check(&self.candidate)?;
                std::mem::swap(&mut self.command, &mut self.candidate);
            }
        }
        Ok(head.kind)
    }

    /// Answers a hello. What is sent is no longer than what came, so that nobody is flooded in another's name.
    fn answer(&mut self, head: &PacketHead, from: SocketAddr) -> Result<(), LinkRefusal> {
        if from.port() == 0 {
            return Err(LinkRefusal::Address(from));
        }
        if self.session.is_some() || self.moved {
            return Err(LinkRefusal::Busy);
        }
        let answer = PacketHead { kind: PacketKind::Measurement, robot: self.offered, ..*head };
        self.transmit(answer, from);
        Ok(())
    }

    /// Admits a command of the session, or the first of one.
    fn admit(&mut self, head: &PacketHead, from: SocketAddr) -> Result<(), LinkRefusal> {
        if self.session.is_some() {
            return self.continue_session(head, from);
        }
        if head.robot != self.offered || self.moved {
            return Err(LinkRefusal::Session);
        }
        let PacketHead { controller, robot, counter, .. } = *head;
        let newest = Newest::begin(counter)?;
        self.session = Some(Session { peer: from, controller, robot, newest, sent: counter });
        self.offered = rand::random();
        Ok(())
    }

    fn continue_session(&mut self, head: &PacketHead, from: SocketAddr) -> Result<(), LinkRefusal> {
        let session = self.session.as_mut().filter(|session| {
            (session.peer, session.controller, session.robot) == (from, head.controller, head.robot)
        });
        session.ok_or(LinkRefusal::Session)?.newest.admit(head.counter)
    }

    /// Ends a session in which nothing has come for long; a robot that stands without one is ready for the next.
    fn end_session(&mut self) {
        if self.session.as_ref().is_some_and(|session| session.newest.age() > ENDS) {
            self.session = None;
        }
        let stands = self.robot.status().is_stopped() && self.robot.is_at_rest();
        if self.moved && self.session.is_none() && stands {
            self.robot.recover();
            self.moved = false;
        }
    }

    /// Tells the controller what was measured.
    fn tell(&mut self) {
        let Some(session) = &mut self.session else { return };
        session.sent += 1;
        let Session { peer, controller, robot, sent: counter, .. } = *session;
        let head = PacketHead { kind: PacketKind::Measurement, controller, robot, counter };
        self.transmit(head, peer);
    }

    /// Sends what was measured. Whatever the system says is a packet that was lost.
    fn transmit(&mut self, head: PacketHead, to: SocketAddr) {
        self.outgoing.write_measurement(head, &self.measured);
        let sent = self.socket.send_to(self.outgoing.bytes(), to);
        self.statistics.lost += u64::from(sent.is_err());
    }
}
