//! `drive --lockstep`, advanced by a robot's packets.

use std::net::{SocketAddr, UdpSocket};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use moca_drivers::{Packet, PacketHead, PacketKind, SimulatedSide};
use moca_model::MOCA_HOME;
use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, RobotSide};
use moca_simulation::plant::RobotNoise;

use crate::support::{Runs, coarse_map_file};

/// The simulated robot answers as fast as its controller until it is halted. It measures nothing in ticks for which
/// `silent` returns true. Returns the commands.
fn robot(silent: fn(u32) -> bool) -> (SocketAddr, JoinHandle<Vec<Vec<u8>>>) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let address = socket.local_addr().unwrap();
    let answering = thread::spawn(move || {
        let mut robot = SimulatedSide::new(&MOCA_HOME, 1e-3, RobotNoise::new(1)).unwrap();
        let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), 10);
        let mut command = JointCommand::at_rest(&measured);
        let (mut packet, mut bytes, mut commands) = (Packet::new(10, None), [0; 1000], Vec::new());
        loop {
            let (length, from) = socket.recv_from(&mut bytes).unwrap();
            let head = packet.take(&bytes[..length]).unwrap();
            match head.kind {
                PacketKind::Command => {
                    packet.read_command(&mut command);
                    robot.send(&command).unwrap();
                    commands.push(bytes[..length].to_vec());
                }
                PacketKind::Halt => return commands,
                _ => {}
            }
            robot.receive(&mut measured).unwrap();
            if silent(commands.len().try_into().unwrap()) {
                packet.write(PacketHead { kind: PacketKind::Nothing, robot: 9, ..head });
            } else {
                let kind = PacketKind::Measurement;
                packet.write_measurement(PacketHead { kind, robot: 9, ..head }, &measured);
            }
            socket.send_to(packet.bytes(), from).unwrap();
        }
    });
    (address, answering)
}

fn drive(address: SocketAddr, duration: &str) -> Runs {
    let robot = format!("--robot={address}");
    let options = ["--lockstep", "--compensation=nothing", "--json", "--map", coarse_map_file()];
    Runs::new("drive").with(&options).with(&[&robot, &format!("--duration={duration}")])
}

#[test]
fn the_same_run_twice_sends_the_same_bytes() {
    let run = || {
        let (address, answering) = robot(|_| false);
        let json = drive(address, "0.5").run().done().json();
        (json, answering.join().unwrap())
    };
    let ((json, first), (again, second)) = (run(), run());
    // The loop listens for the first 50 ms.
    assert!((450..470).contains(&first.len()), "{}", first.len());
    assert_eq!(first, second);
    assert_eq!(json, again);
    assert_eq!(json["missed"], 0);
    assert_eq!(json["at_rest"], true);
}

#[test]
fn missing_measurement_is_listed_as_a_fault() {
    let (address, answering) = robot(|tick| (300..310).contains(&tick));
    let json = drive(address, "0.5").run().done().json();
    answering.join().unwrap();
    assert_eq!(json["unmeasured"], 10);
    let fault = &json["faults"][0];
    assert_eq!(fault["fault"], "measurement missing");
    let begin = fault["begin"].as_f64().unwrap();
    assert!((0.303..0.310).contains(&begin), "{begin}");
    assert_eq!(json["faults"][1]["fault"], "stop requested");
}

#[test]
fn silent_robot_ends_drive_by_name() {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    drive(socket.local_addr().unwrap(), "1").run().failed(1, "no packet for 5 s");
}
