//! Simulated robot behind UDP.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::Duration;

use moca_model::Error;
use moca_model::whole_body::control_loop::{Clock, JointCommand, JointMeasurement, RobotSide};

use super::link::{LARGEST, LinkRefusal, LinkStatistics, MOST, Newest};
use super::packet::{Packet, PacketHead, PacketKind};
use super::shared_key::SharedKey;
use super::simulated::SimulatedSide;

/// Longest time after which a robot in lockstep asks whether to stop.
const WAKES: Duration = Duration::from_millis(50);
/// Time without commands after which a session ends.
const ENDS: Duration = Duration::from_secs(1);

/// A robot at a UDP address. It measures once a period and moves by the newest command.
///
/// While it stands still and obeys nobody, it answers each hello with one measurement. The first command with the
/// numbers of such an answer begins a session, and each period's measurement then goes to its sender. A period without
/// a command counts as one with a lost command: the robot bridges it, and stops by itself after twenty. The session
/// ends with a halt, or after a second without a command.
#[derive(Debug)]
pub struct UdpServer {
    socket: UdpSocket,
    robot: SimulatedSide,
    measured: JointMeasurement,
    command: JointCommand,
    /// Command that has come but is not accepted yet.
    candidate: JointCommand,
    outgoing: Packet,
    incoming: Packet,
    buffer: Vec<u8>,
    /// Robot's number of the next session.
    offered: u64,
    session: Option<Session>,
    /// True if the robot has been told to move since it was last recovered.
    moved: bool,
    statistics: LinkStatistics,
}

/// Session with the controller that the robot obeys.
#[derive(Debug)]
struct Session {
    peer: SocketAddr,
    controller: u64,
    robot: u64,
    newest: Newest,
    sent: u64,
}

impl UdpServer {
    /// Binds the robot to this address. It answers only controllers that have the key, if there is one.
    ///
    /// # Errors
    /// An address that is taken or does not belong to this machine.
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

    /// Returns the address.
    ///
    /// # Errors
    /// The error that the operating system reports.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Returns the counts of the packets so far, with the reasons of refusals.
    pub fn statistics(&self) -> &LinkStatistics {
        &self.statistics
    }

    /// Returns the robot.
    pub fn robot(&self) -> &SimulatedSide {
        &self.robot
    }

    /// Runs until `stop` returns true.
    ///
    /// # Errors
    /// Errors of the simulation; no packet can cause one.
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

    /// Runs until `stop` returns true, with the commands as the clock: each moves the robot for one period, however long
    /// it takes to come, and is answered by one measurement. A session ends with a halt, after which the robot brakes.
    ///
    /// # Errors
    /// [`io::Error`] if the socket cannot wait; an error of the simulation is its source.
    pub fn serve_in_lockstep(&mut self, mut stop: impl FnMut() -> bool) -> io::Result<()> {
        self.socket.set_nonblocking(false)?;
        self.socket.set_read_timeout(Some(WAKES))?;
        self.robot.receive(&mut self.measured).map_err(io::Error::other)?;
        while !stop() {
            let received = self.socket.recv_from(&mut self.buffer);
            // Nothing has come.
            let Ok((length, from)) = received else { continue };
            match self.take(length, from) {
                Ok(kind) => {
                    self.statistics.taken += 1;
                    match kind {
                        PacketKind::Command => self.robot.obey(&self.command),
                        PacketKind::Halt => self.brake(),
                        _ => continue,
                    }
                }
                Err(refusal) => {
                    self.statistics.refuse(refusal);
                    match refusal {
                        LinkRefusal::Command(_) => self.robot.miss(),
                        _ => continue,
                    }
                }
            }
            .and_then(|()| self.robot.receive(&mut self.measured).map(drop))
            .map_err(io::Error::other)?;
            self.tell();
        }
        Ok(())
    }

    /// Brakes to rest, ready for another controller.
    fn brake(&mut self) -> Result<(), Error> {
        loop {
            self.robot.miss()?;
            if self.robot.status().is_stopped() && self.robot.is_at_rest() {
                self.robot.recover();
                return Ok(());
            }
        }
    }

    /// Takes all waiting packets. Returns true if a command came that no halt followed.
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

    /// Takes a received packet.
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

    /// Answers a hello. The answer is no longer than the hello, so that the robot cannot be misused to flood others.
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

    /// Accepts a command of the session, or the first command of a new one.
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

    /// Ends a session without packets for long. A robot that stands still without a session is ready for the next one.
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

    /// Sends the measurement to the controller.
    fn tell(&mut self) {
        let Some(session) = &mut self.session else { return };
        session.sent += 1;
        let Session { peer, controller, robot, sent: counter, .. } = *session;
        let head = PacketHead { kind: PacketKind::Measurement, controller, robot, counter };
        self.transmit(head, peer);
    }

    /// Sends the measurement. An error of the operating system counts as a lost packet.
    fn transmit(&mut self, head: PacketHead, to: SocketAddr) {
        self.outgoing.write_measurement(head, &self.measured);
        let sent = self.socket.send_to(self.outgoing.bytes(), to);
        self.statistics.lost += u64::from(sent.is_err());
    }
}
