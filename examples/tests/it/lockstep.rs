//! `drive --lockstep`, advanced by a robot's packets.

use std::fs;
use std::net::{SocketAddr, UdpSocket};
use std::path::Path;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use moca_drivers::{Packet, PacketHead, PacketKind, SimulatedSide};
use moca_model::MOCA_HOME;
use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, RobotSide};
use moca_model::whole_body::{Data, Description, Model};
use moca_simulation::plant::RobotNoise;

use crate::support::{Runs, coarse_map_file};

/// Simulated MOCA. Returns its commands.
fn robot(silent: fn(u32) -> bool) -> (SocketAddr, JoinHandle<Vec<Vec<u8>>>) {
    let (address, answering) =
        answer(|noise| SimulatedSide::new(&MOCA_HOME, 1e-3, noise).unwrap(), &MOCA_HOME, silent);
    (address, thread::spawn(|| answering.join().unwrap().0))
}

/// Commands, and the measured positions of the ticks.
type Exchanged = (Vec<Vec<u8>>, Vec<Vec<f64>>);

/// A simulated robot answers as fast as its controller until it is halted. It measures nothing in ticks for which
/// `silent` returns true.
fn answer(
    robot: impl FnOnce(RobotNoise) -> SimulatedSide + Send + 'static,
    start: &[f64],
    silent: fn(u32) -> bool,
) -> (SocketAddr, JoinHandle<Exchanged>) {
    let start = start.to_vec();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let address = socket.local_addr().unwrap();
    let answering = thread::spawn(move || {
        let (mut robot, joints) = (robot(RobotNoise::new(1)), start.len());
        let mut measured = JointMeasurement::resting(start, joints);
        let mut command = JointCommand::at_rest(&measured);
        let (mut packet, mut bytes) = (Packet::new(joints, None), [0; 1000]);
        let (mut commands, mut positions) = (Vec::new(), Vec::new());
        loop {
            let (length, from) = socket.recv_from(&mut bytes).unwrap();
            let head = packet.take(&bytes[..length]).unwrap();
            match head.kind {
                PacketKind::Command => {
                    packet.read_command(&mut command);
                    robot.send(&command).unwrap();
                    commands.push(bytes[..length].to_vec());
                }
                PacketKind::Halt => return (commands, positions),
                _ => {}
            }
            robot.receive(&mut measured).unwrap();
            positions.push(measured.position.clone());
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
fn another_robot_moves_by_its_settings() {
    const START: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let urdf = "moca-model/whole-body/examples/urdf/panda.urdf";
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(urdf);
    let panda = || {
        let tips = vec!["panda_hand_tcp".to_owned()];
        Model::from_urdf_file(&urdf, &Description { tips, ..Description::default() }).unwrap()
    };
    let side = |model: Model| {
        move |noise| {
            SimulatedSide::of_robot(model, "panda_hand_tcp", 0, &START, 1e-3, noise).unwrap()
        }
    };
    let (address, answering) = answer(side(panda()), &START, |_| false);
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("panda.toml");
    let text = format!(
        "version = 1\n[robot]\nurdf = {urdf:?}\n[controller]\ntool = \"panda_hand_tcp\"\n\
         [controller.posture]\nconfiguration = {START:?}\n"
    );
    fs::write(&settings, text).unwrap();
    let (settings, output) = (settings.to_str().unwrap(), folder.path().join("kept"));
    let options = ["--circle", "--settings", settings, "--output", output.to_str().unwrap()];
    let json = drive(address, "3").with(&options).run().done().json();
    let (commands, positions) = answering.join().unwrap();
    assert!(commands.iter().all(|bytes| bytes.len() == 32 + 25 * 7));
    assert_eq!(json["faults"].as_array().unwrap().len(), 1, "the requested stop alone: {json}");

    // The tool goes along 0.12 m of an upright circle of 0.1 m, and does not leave its plane.
    let model = panda();
    let mut data = Data::new(&model);
    let tool = model.frame_id("panda_hand_tcp").unwrap();
    let mut place = |q: &[f64]| data.pose(&model, q).unwrap().world_from(tool).unwrap().translation;
    let start = place(&START).vector;
    let ways: Vec<_> = positions.iter().map(|q| place(q).vector - start).collect();
    let farthest = ways.iter().fold(0.0, |most: f64, way| most.max(way.norm()));
    assert!((0.06..0.11).contains(&farthest), "{farthest} m");
    assert!(ways.iter().all(|way| way.x.abs() < 0.01), "out of the plane");
    let ticks = fs::read_to_string(output.join("ticks.csv")).unwrap();
    assert!(ticks.lines().next().unwrap().contains("q_panda_joint7_rad"));
}

#[test]
fn silent_robot_ends_drive_by_name() {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    drive(socket.local_addr().unwrap(), "1").run().failed(1, "no packet for 5 s");
}
