//! `drive` as a whole: objects that are handed over, acknowledgements, and what it records.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::UdpSocket;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use moca_drivers::{Packet, PacketHead, PacketKind, SimulatedSide};
use moca_model::whole_body::Data;
use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, RobotMode, RobotSide};
use moca_model::{BoxSide, ControllerSettings, GraspedObject, MOCA_HOME, moca};
use moca_simulation::plant::RobotNoise;
use nalgebra::{Isometry3, Vector3};
use percept_recording::{Header, IfPartial, Recording, Writer};
use vision_models::{Body25, Percept};

use crate::support::{Ran, Runs, coarse_map_file, signal};

/// Runs a controller beside `drive --serve` in lockstep, over UDP on this machine.
fn beside_a_robot(controller: Runs) -> Ran {
    let mut robot = Runs::new("drive").with(&["--serve=127.0.0.1:0", "--lockstep"]).start();
    let mut line = String::new();
    BufReader::new(robot.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.split("robot at ").nth(1).unwrap().split(';').next().unwrap();
    let options = ["--lockstep", "--compensation=nothing", "--json", "--map", coarse_map_file()];
    let ran = controller.with(&options).with(&["--robot", address]).run();
    signal(&robot, "INT");
    robot.wait().unwrap();
    ran
}

fn labels(json: &serde_json::Value, lane: &str) -> Vec<String> {
    let spans = json[lane]["spans"].as_array().unwrap().iter();
    spans.map(|span| span["label"].as_str().unwrap().to_owned()).collect()
}

/// The configuration in the last line of a table of ticks \[m, rad\].
fn last_configuration(table: &Path) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let names = reader.headers().unwrap().clone();
    let last = reader.records().last().unwrap().unwrap();
    let columns = names.iter().zip(&last).filter(|(name, _)| name.starts_with("q_"));
    columns.map(|(_, value)| value.parse().unwrap()).collect()
}

/// The pose of the tool at this configuration, in the world.
fn tool_at(configuration: &[f64]) -> Isometry3<f64> {
    let model = moca().unwrap();
    let tool = model.frame_id(&ControllerSettings::default().tool).unwrap();
    let mut data = Data::new(&model);
    data.pose(&model, configuration).unwrap().world_from(tool).unwrap()
}

/// Experiment 3: the person hands the object over, and takes the tool for the side that they do not see.
#[test]
fn person_gets_the_surface_that_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let (offer, out) = (folder.path().join("offer.jsonl"), folder.path().join("out"));
    let (offer, out) = (offer.to_str().unwrap(), out.to_str().unwrap());
    let person = ["--offer=10", "--tool=polisher", "--path=1.4,0", "--duration=24"];
    Runs::new("record").with(&person).with(&["--output", offer]).run().done();
    // The person goes away at 25 s.
    let options = ["--object=offered-drilled", "--duration=24", "--output", out];
    let drive = Runs::new("drive").with(&options).with(&["--recording", offer]);
    let ran = beside_a_robot(drive).done();
    let json = ran.json();
    let phases = labels(&json, "phase");
    let reaches = ["handover", "grasping", "working", "turning to the back", "working"];
    let mut rest = phases.iter();
    for phase in reaches {
        assert!(rest.any(|label| label.starts_with(phase)), "{phase}: {phases:?}");
    }
    assert!(ran.errors.contains("the right surface is shown"), "{}", ran.errors);
    assert_eq!(json["protective_stops"], 0, "{json}");
    assert_eq!(json["unmeasured"], 0);
    let faults = json["faults"].as_array().unwrap();
    assert!(faults.iter().all(|fault| fault["fault"] == "stop requested"), "{faults:?}");
    // The smooth back faces the person, as the joints say that the robot measured last.
    let read = |path: &str| {
        Recording::read(percept_recording::open(Path::new(path)).unwrap(), IfPartial::Refuse)
    };
    let recording = format!("{out}/recording.jsonl");
    let seen = read(&recording).unwrap().percepts;
    let shoulders = seen.iter().rev().find_map(|percept| {
        let at = |joint| Some(percept.body.as_ref()?.get(joint)?.position);
        Some(at(Body25::LeftShoulder)? - at(Body25::RightShoulder)?)
    });
    let facing = shoulders.unwrap().cross(&Vector3::z()).normalize();
    let object = GraspedObject::default().tool_from_object;
    let object = tool_at(&last_configuration(Path::new(&format!("{out}/ticks.csv")))) * object;
    let faces = -(object * BoxSide::Back.normal()).dot(&facing);
    assert!(faces > 0.85, "cosine {faces}");
    // What it saw is the recording, with the surfaces of what it held by then, and `follow` plays it.
    let given = read(offer).unwrap().percepts;
    assert!(seen.len() + 5 > given.len(), "{} of {} frames", seen.len(), given.len());
    let holds = json["phase"]["spans"][3]["begin"].as_f64().unwrap();
    let first = seen.iter().find(|percept| percept.surface.is_some()).unwrap().time;
    assert!((holds..holds + 1.0).contains(&first), "{first} s, held from {holds} s");
    let follow = Runs::follow().with(&["--kinematic", "--no-report", "--json", "--recording"]);
    let played = follow.with(&[&recording]).run().done().json();
    assert!(played["duration_s"].as_f64().unwrap() > 23.0, "{played}");
    assert!(fs::read_to_string(format!("{out}/drive.svg")).unwrap().contains("score e_s"));
}

/// The first motion of a robot: twice around a circle of 0.1 m, as its own joints say.
#[test]
fn tool_goes_around_a_small_circle() {
    let folder = tempfile::tempdir().unwrap();
    let drive = Runs::new("drive").with(&["--circle", "--duration=18", "--output"]);
    let json = beside_a_robot(drive.with(&[folder.path()])).done().json();
    assert_eq!(json["protective_stops"], 0, "{json}");
    assert_eq!(labels(&json, "phase"), ["apart"]);
    let mut reader = csv::Reader::from_path(folder.path().join("ticks.csv")).unwrap();
    let names = reader.headers().unwrap().clone();
    let joint = |name: &&str| name.starts_with("q_");
    let first = names.iter().position(|name| joint(&name)).unwrap();
    let home = tool_at(&MOCA_HOME).translation.vector;
    let (mut turned, mut before) = (0.0, None);
    for tick in reader.records().step_by(50) {
        let tick = tick.unwrap();
        let q: Vec<f64> = (first..first + 10).map(|column| tick[column].parse().unwrap()).collect();
        let way = tool_at(&q).translation.vector - home - Vector3::z() * 0.05;
        assert!((way.norm() - 0.05).abs() < 0.006 && way.x.abs() < 0.006, "{way}");
        let angle = way.y.atan2(-way.z);
        let step = angle - before.replace(angle).unwrap_or(angle);
        turned += step - std::f64::consts::TAU * (step / std::f64::consts::TAU).round();
    }
    assert!((turned - 2.0 * std::f64::consts::TAU).abs() < 0.1, "{turned} rad");
    #[cfg(feature = "mcap")]
    crate::mcap_files::check_drive(folder.path());
}

#[test]
fn held_object_is_known_from_the_beginning() {
    let folder = tempfile::tempdir().unwrap();
    let run = |options: &[&str], name: &str| {
        let out = folder.path().join(name);
        let drive = Runs::new("drive").with(options).with(&["--duration=0.5", "--output"]);
        let json = beside_a_robot(drive.with(&[&out])).done().json();
        assert_eq!(json["at_rest"], true);
        let configuration = last_configuration(&out.join("ticks.csv"));
        (tool_at(&configuration).translation.vector, tool_at(&MOCA_HOME).translation.vector)
    };
    // A kilogram that nobody knows of would push the soft arm down by centimetres.
    let (tool, home): (Vector3<f64>, _) = run(&["--object=held"], "held");
    assert!((tool - home).norm() < 0.01, "{tool}");
    Runs::new("drive").with(&["--object=apple"]).run().failed(2, "offered-drilled");
    Runs::new("drive").with(&["--lockstep"]).run().failed(1, "--robot or --serve");
}

/// Somebody presses the robot's stop for a tenth of a second, and Enter a little later.
#[test]
fn enter_acknowledges_a_stop() {
    for enters in [true, false] {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let address = socket.local_addr().unwrap().to_string();
        let options = ["--lockstep", "--compensation=nothing", "--json", "--keys", "--duration=5"];
        let drive = Runs::new("drive").with(&options).with(&["--map", coarse_map_file()]);
        let mut child = drive.with(&["--robot", &address]).start();
        let mut keys = child.stdin.take().unwrap();
        let answering = thread::spawn(move || {
            let mut robot = SimulatedSide::new(&MOCA_HOME, 1e-3, RobotNoise::new(1)).unwrap();
            let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), 10);
            let mut command = JointCommand::at_rest(&measured);
            let (mut packet, mut bytes) = (Packet::new(10, None), [0; 1000]);
            let mut commands = 0;
            loop {
                let (length, from) = socket.recv_from(&mut bytes).unwrap();
                let head = packet.take(&bytes[..length]).unwrap();
                match head.kind {
                    PacketKind::Halt => return,
                    PacketKind::Command => {
                        commands += 1;
                        packet.read_command(&mut command);
                        robot.send(&command).unwrap();
                    }
                    _ => {}
                }
                robot.receive(&mut measured).unwrap();
                if (1000..1100).contains(&commands) {
                    measured.robot.mode = Some(RobotMode::UserStop);
                }
                if enters && commands == 2000 {
                    keys.write_all(b"\n").unwrap();
                    thread::sleep(Duration::from_millis(500));
                }
                let kind = PacketKind::Measurement;
                packet.write_measurement(PacketHead { kind, robot: 9, ..head }, &measured);
                socket.send_to(packet.bytes(), from).unwrap();
            }
        });
        let json = Ran::of(child).done().json();
        answering.join().unwrap();
        assert_eq!(json["protective_stops"], 1);
        let states = labels(&json, "safety");
        let stop = "protective stop: robot stopped";
        assert!(states.iter().any(|label| label.starts_with(stop)), "{states:?}");
        let spans = json["safety"]["spans"].as_array().unwrap();
        let again = spans.iter().find(|span| {
            span["label"] == "normal" && span["begin"].as_f64().is_some_and(|begin| begin > 1.0)
        });
        assert_eq!(again.is_some(), enters, "{states:?}");
        assert!(again.is_none_or(|span| span["begin"].as_f64().unwrap() > 1.9), "{spans:?}");
    }
}

/// Percepts come through a pipe while the loop runs, with times of the system's clock.
#[test]
fn loop_sees_percepts_as_they_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let (pipe, out) = (folder.path().join("pipe"), folder.path().join("out"));
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let drive = Runs::new("drive").with(&["--duration=2", "--json", "--map", coarse_map_file()]);
    let child =
        drive.with(&["--percepts"]).with(&[&pipe]).with(&["--output"]).with(&[&out]).start();
    let into = fs::File::options().write(true).open(&pipe).unwrap();
    let mut writer = Writer::new(into, &Header::default()).unwrap();
    let mut times = Vec::new();
    loop {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
        // The images are 30 ms old.
        let percept = Percept { time: now - 0.03, body: None, action: None, surface: None };
        if writer.write(&percept).is_err() {
            break;
        }
        times.push(percept.time);
        thread::sleep(Duration::from_millis(50));
    }
    let json = Ran::of(child).done().json();
    assert_eq!(json["ended"], "requested");
    let recording = percept_recording::open(out.join("recording.jsonl")).unwrap();
    let seen = Recording::read(recording, IfPartial::Refuse).unwrap().percepts;
    assert!(seen.len() > 10 && seen.len() <= times.len(), "{} of {}", seen.len(), times.len());
    // The times between frames stay: one clock runs as fast as the other.
    let matches =
        |between: f64| times.windows(2).any(|pair| (pair[1] - pair[0] - between).abs() < 2e-3);
    let same = seen.windows(2).filter(|pair| matches(pair[1].time - pair[0].time)).count();
    assert!(2 * same > seen.len(), "{same} of {}", seen.len());
}
