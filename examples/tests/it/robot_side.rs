//! Robots at the other end of a loop.

use std::net::UdpSocket;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use examples::robot_side::{Packet, PacketError, PacketKind, SimulatedSide, UdpServer, UdpSide};
use moca_model::MOCA_HOME;
use moca_model::whole_body::{
    ControlLaw, ControlLoop, JointCommand, JointMeasurement, LoopSettings, ManualClock,
    MonotonicClock, Received, RobotSide, StopCause,
};
use proptest::prelude::*;

use crate::support::{Runs, coarse_map_file};

pub(crate) fn at_rest(joints: usize) -> JointMeasurement {
    JointMeasurement::resting(vec![0.0; joints], joints)
}

proptest! {
    #[test]
    fn what_is_sent_comes_back(sequence in any::<u64>(), numbers in prop::collection::vec(-1e9..1e9_f64, 9)) {
        let mut sent = Packet::new(3);
        sent.write(PacketKind::Measurement, sequence, [&numbers[..3], &numbers[3..6], &numbers[6..]]);
        let mut received = Packet::new(3);
        prop_assert_eq!(received.take(sent.bytes()), Ok((PacketKind::Measurement, sequence)));
        let got: Vec<f64> = received.numbers().into_iter().flatten().collect();
        prop_assert_eq!(got, numbers);
    }

    #[test]
    fn no_bytes_are_taken_for_a_packet_of_another_size(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut packet = Packet::new(3);
        // A kind that is right by chance does not make the size right.
        let refused = packet.take(&bytes).is_err() || bytes.len() == packet.bytes().len();
        prop_assert!(refused);
        let mut marked = b"MOm1".to_vec();
        marked.extend(&bytes);
        let expected = packet.bytes().len();
        if marked.len() != expected {
            let found = marked.len();
            prop_assert_eq!(packet.take(&marked), Err(PacketError::Size { found, expected }));
        }
    }
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut sent = Packet::new(1);
    for wrong in [f64::NAN, f64::INFINITY] {
        sent.write(PacketKind::Command, 1, [&[0.0], &[wrong], &[0.0]]);
        assert_eq!(Packet::new(1).take(sent.bytes()), Err(PacketError::NotFinite));
    }
}

#[test]
fn only_the_newest_measurement_of_this_robot_counts() {
    let robot = UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut side = UdpSide::connect(robot.local_addr().unwrap(), 1).unwrap();
    let mut measured = at_rest(1);
    assert_eq!(side.receive(&mut measured).unwrap(), Received::Nothing);
    // It has said hello.
    let mut bytes = [0; 100];
    let (length, from) = robot.recv_from(&mut bytes).unwrap();
    assert_eq!(Packet::new(1).take(&bytes[..length]).unwrap().0, PacketKind::Hello);
    let mut packet = Packet::new(1);
    for (sequence, position) in [(5, 0.5), (7, 0.7), (6, 0.6)] {
        packet.write(PacketKind::Measurement, sequence, [&[position], &[1.0], &[2.0]]);
        robot.send_to(packet.bytes(), from).unwrap();
    }
    robot.send_to(b"nonsense", from).unwrap();
    robot.send_to(Packet::new(2).bytes(), from).unwrap();
    let mut tries = 0;
    while side.refused() < 2 && tries < 1000 {
        side.receive(&mut measured).unwrap();
        thread::sleep(std::time::Duration::from_millis(1));
        tries += 1;
    }
    assert_eq!(
        (measured.position[0], measured.velocity[0], measured.torque[0]),
        (0.7, 1.0, Some(2.0))
    );
    assert_eq!(side.receive(&mut measured).unwrap(), Received::Nothing);
}

/// Turns the base at 0.2 rad/s, and carries the arm by the torques measured.
struct Turn(f64);

impl ControlLaw for Turn {
    type Error = std::convert::Infallible;

    fn step(
        &mut self,
        _now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Self::Error> {
        command.velocity[2] = self.0;
        for (own, torque) in command.torque.iter_mut().zip(&measured.torque) {
            *own = torque.unwrap_or_default();
        }
        Ok(())
    }

    fn perception_age(&self) -> Option<f64> {
        None
    }

    fn request_stop(&mut self) {
        self.0 = 0.0;
    }

    fn is_at_rest(&self) -> bool {
        self.0 == 0.0
    }
}

#[test]
fn a_loop_moves_a_robot_behind_udp() {
    let robot = SimulatedSide::new(&MOCA_HOME, 1e-3, 1).unwrap();
    let mut server = UdpServer::bind("127.0.0.1:0", robot, &MOCA_HOME).unwrap();
    let address = server.address().unwrap();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let stop = || over.load(Ordering::Relaxed);
            server.serve(1e-3, &mut MonotonicClock::default(), stop).unwrap();
        });
        let mut side = UdpSide::connect(address, MOCA_HOME.len()).unwrap();
        // However busy the machine is.
        let patient = LoopSettings { robot_timeout: 20.0, ..LoopSettings::default() };
        let mut control = ControlLoop::new(patient, at_rest(MOCA_HOME.len())).unwrap();
        let (mut asked, mut clock) = (0, MonotonicClock::default());
        let ending = control.run(&mut side, &mut Turn(0.2), &mut clock, || {
            asked += 1;
            asked > 200
        });
        over.store(true, Ordering::Relaxed);
        assert_eq!(ending.unwrap().cause, StopCause::Requested);
        let turned = control.measured().position[2];
        assert!(turned > 1e-3, "{turned} rad");
    });
}

#[test]
fn nobody_at_the_other_end_is_an_error_that_says_so() {
    let gone = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut side = UdpSide::connect(gone, 10).unwrap();
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
    assert!(ticks >= 300, "{json}");
    drive().with(&["--robot=nowhere"]).run().failed(1, "--robot nowhere");
    drive().with(&["--priority=0"]).run().failed(1, "from 1 to 99");
}
