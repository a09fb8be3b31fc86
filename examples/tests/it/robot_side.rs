//! Robots at the other end of a loop over UDP.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use moca_drivers::{
    CommandRefusal, LinkRefusal, Packet, PacketError, PacketHead, PacketKind, SharedKey,
    SimulatedSide, UdpServer, UdpSide,
};
use moca_model::MOCA_HOME;
use moca_model::whole_body::control_loop::{
    ControlLaw, ControlLoop, JointCommand, JointMeasurement, LoopSettings, ManualClock,
    MonotonicClock, Received, RobotMode, RobotSide, StopCause,
};
use moca_simulation::plant::RobotNoise;

use crate::support::{Runs, coarse_map_file};

pub(crate) fn at_rest(joints: usize) -> JointMeasurement {
    JointMeasurement::resting(vec![0.0; joints], joints)
}

/// A robot of one joint, written by hand, and the loop's end that has sent a hello to it.
struct Hand {
    socket: UdpSocket,
    side: UdpSide,
    measured: JointMeasurement,
    /// The hello, and its sender.
    hello: PacketHead,
    from: SocketAddr,
    key: Option<SharedKey>,
}

impl Hand {
    fn new(key: Option<SharedKey>) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let mut side = UdpSide::connect(socket.local_addr().unwrap(), 1, key.as_ref()).unwrap();
        let mut measured = at_rest(1);
        assert_eq!(side.receive(&mut measured).unwrap(), Received::Nothing);
        let mut bytes = [0; 100];
        let (length, from) = socket.recv_from(&mut bytes).unwrap();
        let hello = Packet::new(1, key.as_ref()).take(&bytes[..length]).unwrap();
        assert_eq!((hello.kind, hello.robot), (PacketKind::Hello, 0));
        Self { socket, side, measured, hello, from, key }
    }

    fn head(&self, counter: u64) -> PacketHead {
        PacketHead { kind: PacketKind::Measurement, robot: 9, counter, ..self.hello }
    }

    fn send(&self, head: PacketHead, position: f64) {
        let mut packet = Packet::new(1, self.key.as_ref());
        let measured = JointMeasurement { position: vec![position], ..at_rest(1) };
        packet.write_measurement(head, &measured);
        self.socket.send_to(packet.bytes(), self.from).unwrap();
    }

    /// Receives until this number of packets was judged.
    fn judged(&mut self, count: u64) {
        for _ in 0..2000 {
            let statistics = self.side.statistics();
            if statistics.taken + statistics.refused_count() >= count {
                return;
            }
            self.side.receive(&mut self.measured).unwrap();
            thread::sleep(Duration::from_millis(1));
        }
        panic!("{:?}", self.side.statistics());
    }

    fn refusals(&self) -> Vec<LinkRefusal> {
        self.side.statistics().refused().iter().map(|refused| refused.refusal).collect()
    }
}

#[test]
fn only_the_newest_measurement_of_this_session_counts() {
    let mut hand = Hand::new(None);
    hand.send(hand.head(hand.hello.counter), 0.1);
    hand.judged(1);
    for (counter, position) in [(5, 0.5), (7, 0.7), (6, 0.6)] {
        hand.send(hand.head(counter), position);
    }
    hand.socket.send_to(b"nonsense", hand.from).unwrap();
    hand.socket.send_to(Packet::new(2, None).bytes(), hand.from).unwrap();
    // The sender does not know the number that the controller chose.
    hand.send(PacketHead { controller: hand.hello.controller ^ 1, ..hand.head(8) }, 0.8);
    hand.send(PacketHead { kind: PacketKind::Command, ..hand.head(8) }, 0.8);
    hand.judged(8);
    assert_eq!(hand.measured.position, [0.7]);
    let refusals = hand.refusals();
    assert_eq!(refusals.len(), 4, "{refusals:?}");
    assert!(refusals.contains(&LinkRefusal::Overtaken));
    assert!(refusals.contains(&LinkRefusal::Session));
    assert!(refusals.contains(&LinkRefusal::Direction));
}

/// A stranger who sees the packets sends the highest counter with the numbers of the session and without a key.
#[test]
fn a_spoofed_counter_locks_nobody_out() {
    for first in [true, false] {
        let mut hand = Hand::new(None);
        let mut judged = 0;
        if !first {
            hand.send(hand.head(1), 0.1);
            judged += 1;
            hand.judged(judged);
        }
        for counter in [u64::MAX, u64::MAX - 1, 1 << 40] {
            hand.send(hand.head(counter), 66.6);
            judged += 1;
            hand.judged(judged);
            assert!(hand.measured.position[0] < 1.0, "{counter} was taken");
        }
        hand.send(hand.head(if first { 1 } else { 2 }), 0.2);
        hand.judged(judged + 1);
        assert_eq!(hand.measured.position, [0.2], "the right peer is heard");
    }
}

#[test]
fn only_packets_of_session_and_key_count() {
    let key = SharedKey::new(&[7; 32]).unwrap();
    let mut hand = Hand::new(Some(key.clone()));
    hand.send(hand.head(1), 0.1);
    hand.judged(1);
    // The packet was recorded in another session with the same key.
    let other = Hand::new(Some(key));
    hand.send(other.head(2), 0.2);
    hand.judged(2);
    // The sender has another key.
    hand.key = Some(SharedKey::new(&[8; 32]).unwrap());
    hand.send(hand.head(3), 0.3);
    hand.judged(3);
    assert_eq!(hand.measured.position, [0.1]);
    assert_eq!(hand.refusals(), [LinkRefusal::Session, LinkRefusal::Packet(PacketError::Code)]);
}

/// Every error of a socket is a lost packet. Nobody listens at this port, which the system reports at the next call.
#[test]
fn errors_of_the_socket_are_lost_packets() {
    let gone = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut side = UdpSide::connect(gone, 1, None).unwrap();
    let mut measured = at_rest(1);
    for _ in 0..50 {
        assert_eq!(side.receive(&mut measured).unwrap(), Received::Nothing);
        side.send(&JointCommand::at_rest(&measured)).unwrap();
    }
    assert!(side.statistics().lost >= 50, "{:?}", side.statistics());
    // The network cannot be reached: no route leads there from a loopback address.
    side.halt().unwrap();
}

/// Creates a robot at its own port with a thread that serves it. `use_it` sends as its controller.
fn with_server<T>(key: Option<&SharedKey>, use_it: impl FnOnce(SocketAddr) -> T) -> (T, UdpServer) {
    let robot = SimulatedSide::new(&MOCA_HOME, 1e-3, RobotNoise::new(1)).unwrap();
    let mut server = UdpServer::bind("127.0.0.1:0", robot, &MOCA_HOME, key).unwrap();
    let address = server.address().unwrap();
    let over = AtomicBool::new(false);
    let used = thread::scope(|scope| {
        let serving = scope.spawn(|| {
            let stop = || over.load(Ordering::Relaxed);
            server.serve(1e-3, &mut MonotonicClock::default(), stop).unwrap();
        });
        let used = use_it(address);
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap();
        used
    });
    (used, server)
}

/// Receives until a measurement has come.
fn wait(side: &mut UdpSide, measured: &mut JointMeasurement) -> bool {
    (0..3000).any(|_| {
        thread::sleep(Duration::from_millis(1));
        side.receive(measured).unwrap() == Received::Fresh
    })
}

fn command(measured: &JointMeasurement) -> JointCommand {
    let mut command = JointCommand::at_rest(measured);
    for (own, torque) in command.torque.iter_mut().zip(&measured.torque) {
        *own = torque.unwrap_or_default();
    }
    command
}

#[test]
fn the_robots_own_status_comes_with_its_measurements() {
    let ((), server) = with_server(None, |address| {
        let mut side = UdpSide::connect(address, 10, None).unwrap();
        let mut measured = at_rest(10);
        assert!(wait(&mut side, &mut measured));
        assert_eq!(measured.robot.mode, Some(RobotMode::Running));
        assert_eq!(measured.robot.took_command, None);
        // The base measures no torques; the arm does.
        assert_eq!(measured.torque[..3], [None; 3]);
        assert!(measured.torque[3..].iter().all(Option::is_some));
        let mut took = false;
        for _ in 0..50 {
            side.send(&command(&measured)).unwrap();
            assert!(wait(&mut side, &mut measured));
            took |= measured.robot.took_command == Some(true);
        }
        assert!(took);
        // No more commands come. The robot stops by itself and reports it.
        let stopped = (0..2000).any(|_| {
            wait(&mut side, &mut measured) && measured.robot.mode == Some(RobotMode::Stopped)
        });
        assert!(stopped);
        assert_eq!(measured.robot.took_command, Some(false));
        // The robot takes commands again that begin at rest.
        let runs = (0..2000).any(|_| {
            let mut fast = command(&measured);
            fast.velocity[0] = 0.5;
            side.send(&fast).unwrap();
            assert!(wait(&mut side, &mut measured));
            assert_eq!(measured.robot.mode, Some(RobotMode::Stopped), "not from a run");
            side.send(&command(&measured)).unwrap();
            wait(&mut side, &mut measured);
            wait(&mut side, &mut measured) && measured.robot.mode == Some(RobotMode::Running)
        });
        assert!(runs);
        side.halt().unwrap();
        // The next controller finds a robot that is ready.
        let mut next = UdpSide::connect(address, 10, None).unwrap();
        assert!(wait(&mut next, &mut measured));
        assert_eq!(measured.robot.mode, Some(RobotMode::Running));
    });
    assert!(server.robot().refused() > 0);
}

#[test]
fn a_robots_side_refuses_what_its_limits_exclude() {
    let beyond: [(usize, f64, f64); 6] = [
        (0, 98.0, 0.0),
        (0, 1e13, 0.0),
        (2, -3.2, 0.0),
        (3, 2.4, 0.0),
        (3, 0.0, 95.0),
        (9, 0.0, -1e300),
    ];
    for (joint, velocity, torque) in beyond {
        let mut robot = SimulatedSide::new(&MOCA_HOME, 1e-3, RobotNoise::new(1)).unwrap();
        let mut measured = at_rest(10);
        robot.receive(&mut measured).unwrap();
        let mut told = command(&measured);
        told.velocity[joint] = velocity;
        told.torque[joint] += torque;
        let refused = robot.check(&told).unwrap_err();
        assert!(matches!(refused, CommandRefusal::Limit { .. }), "{refused}");
        // The command counts as lost. Twenty of them stop the robot, which has not moved.
        for _ in 0..100 {
            robot.send(&told).unwrap();
            robot.receive(&mut measured).unwrap();
        }
        assert_eq!(measured.robot.mode, Some(RobotMode::Stopped));
        assert_eq!(robot.refused(), 101);
        for (position, home) in measured.position.iter().zip(MOCA_HOME) {
            assert!((position - home).abs() < 0.01, "joint {joint}: {position}");
        }
    }
}

/// None of these packets may end a robot's side or its controller.
#[test]
fn no_packet_ends_a_robots_side() {
    let key = None;
    let ((), server) = with_server(key, |address| {
        let mut side = UdpSide::connect(address, 10, key).unwrap();
        let mut measured = at_rest(10);
        assert!(wait(&mut side, &mut measured));
        // A stranger does not know the numbers of the session. Those of the offer to its hello are for it alone.
        let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
        let mut packet = Packet::new(10, None);
        let mut mad = command(&measured);
        mad.velocity[0] = 1e300;
        for kind in [PacketKind::Command, PacketKind::Halt, PacketKind::Hello] {
            let head = PacketHead { kind, controller: 1, robot: 2, counter: u64::MAX };
            match kind {
                PacketKind::Command => packet.write_command(head, &mad),
                _ => packet.write(head),
            }
            stranger.send_to(packet.bytes(), address).unwrap();
        }
        stranger.send_to(&[], address).unwrap();
        stranger.send_to(&[0xff; 2000], address).unwrap();
        drop(stranger); // What the robot sends it is answered by an error.
        for _ in 0..20 {
            side.send(&mad).unwrap();
            side.send(&command(&measured)).unwrap();
            assert!(wait(&mut side, &mut measured), "it still measures");
        }
        side.halt().unwrap();
    });
    let reasons: Vec<_> = server.statistics().refused().iter().map(|one| one.refusal).collect();
    assert!(reasons.contains(&LinkRefusal::Session), "{reasons:?}");
    let excluded = |refusal: &LinkRefusal| {
        matches!(
            refusal,
            LinkRefusal::Command(CommandRefusal::Limit { what: "velocity", joint: 0, .. })
        )
    };
    assert!(reasons.iter().any(excluded), "{reasons:?}");
}

#[test]
fn a_robot_that_obeys_somebody_answers_nobody_else() {
    let key = SharedKey::new(&[3; 32]).unwrap();
    with_server(Some(&key), |address| {
        let mut side = UdpSide::connect(address, 10, Some(&key)).unwrap();
        let mut measured = at_rest(10);
        assert!(wait(&mut side, &mut measured));
        side.send(&command(&measured)).unwrap();
        assert!(wait(&mut side, &mut measured));
        let mut second = UdpSide::connect(address, 10, Some(&key)).unwrap();
        let mut without = UdpSide::connect(address, 10, None).unwrap();
        let mut other = at_rest(10);
        for _ in 0..50 {
            side.send(&command(&measured)).unwrap();
            assert!(wait(&mut side, &mut measured));
            assert_eq!(second.receive(&mut other).unwrap(), Received::Nothing);
            assert_eq!(without.receive(&mut other).unwrap(), Received::Nothing);
        }
        side.halt().unwrap();
        assert!(wait(&mut second, &mut other), "it is free again");
        assert_eq!(without.receive(&mut other).unwrap(), Received::Nothing);
    });
}

/// Turns the base at 0.2 rad/s, and supports the arm by the measured torques.
struct Turn(f64);

impl ControlLaw for Turn {
    type Error = std::convert::Infallible;

    fn step(
        &mut self,
        _now: f64,
        measured: &JointMeasurement,
        told: &mut JointCommand,
    ) -> Result<(), Self::Error> {
        told.velocity[2] = self.0;
        told.torque = command(measured).torque;
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        None
    }

    fn request_stop(&mut self) {
        self.0 = 0.0;
    }

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        Some(self.0 == 0.0)
    }
}

#[test]
fn a_loop_moves_a_robot_behind_udp() {
    let key = SharedKey::new(&[5; 32]).unwrap();
    for key in [None, Some(&key)] {
        with_server(key, |address| {
            let mut side = UdpSide::connect(address, MOCA_HOME.len(), key).unwrap();
            // The timeout must suit a busy machine.
            let patient = LoopSettings { robot_timeout: 20.0, ..LoopSettings::default() };
            let mut control = ControlLoop::new(patient, at_rest(MOCA_HOME.len())).unwrap();
            let (mut asked, mut clock) = (0, MonotonicClock::default());
            let ending = control.run(&mut side, &mut Turn(0.2), &mut clock, || {
                asked += 1;
                asked > 200
            });
            assert_eq!(ending.unwrap().cause, StopCause::Requested);
            let turned = control.measured().position[2];
            assert!(turned > 1e-3, "{turned} rad");
        });
    }
}

#[test]
fn missing_robot_is_an_error() {
    let gone = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut side = UdpSide::connect(gone, 10, None).unwrap();
    let mut control = ControlLoop::new(LoopSettings::default(), at_rest(10)).unwrap();
    let ending = control.run(&mut side, &mut Turn(0.2), &mut ManualClock::default(), || false);
    let error = ending.unwrap_err().to_string();
    assert!(error.contains("measured nothing for 5") && error.contains("connected"), "{error}");
}

#[test]
fn drive_ends_in_order_and_counts() {
    let drive = || Runs::new("drive").with(&["--map", coarse_map_file(), "--json"]);
    let json = drive().with(&["--duration=0.3"]).run().done().json();
    assert_eq!((&json["ended"], &json["at_rest"]), (&"requested".into(), &true.into()));
    let ticks = json["ticks"].as_u64().unwrap() + json["missed"].as_u64().unwrap();
    // The loop listens for 0.05 of the 0.3 s how often the robot measures.
    assert!(ticks >= 248, "{json}");
    drive().with(&["--robot=127.0.0.1:9"]).run().failed(1, "--compensation: say what");
    let drive = || drive().with(&["--compensation=nothing"]);
    drive().with(&["--robot=nowhere"]).run().failed(1, "--robot nowhere");
    drive().with(&["--priority=0"]).run().failed(1, "from 1 to 99");
    let serve = Runs::new("drive").with(&["--serve=127.0.0.1:0", "--priority=0"]);
    serve.run().failed(1, "from 1 to 99");
    drive().with(&["--key=none", "--robot=127.0.0.1:9"]).run().failed(1, "--key none");
    drive().with(&["--key=none"]).run().failed(1, "--robot or --serve");
}
