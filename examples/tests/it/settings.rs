//! Settings in files: no setting is lost or unknown, and errors have their line.

use std::fs;
use std::path::Path;

use examples::drive::DrivenRobot;
use examples::settings::{CameraFrame, RobotSettings, SettingsError, SettingsFile};
use hrsw_safety::{Capsule, ContactKind};
use moca_model::Goal;
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::support::Runs;

fn read(text: &str) -> Result<RobotSettings, SettingsError> {
    SettingsFile::parse(text)?.over(&RobotSettings::default())
}

fn error(below_version: &str) -> String {
    read(&format!("version = 1\n{below_version}")).unwrap_err().to_string()
}

/// Settings with values of every kind that differ from the default.
fn others() -> RobotSettings {
    let mut settings = RobotSettings::default();
    let controller = &mut settings.controller;
    controller.tool = String::from("panda_hand \"x\"");
    controller.goal = Goal::LeastMotion;
    controller.base = None;
    controller.budget.iterations = Some(77);
    controller.budget.time = Some(std::time::Duration::from_micros(400));
    controller.space.min = Vector3::new(0.1, -0.2, 0.3);
    controller.space.tool = UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1);
    controller.safety.supervisor.stop_age = f64::MAX;
    controller.safety.supervisor.acknowledge = true;
    controller.safety.separation.base = None;
    controller.safety.contact = controller
        .safety
        .contact
        .clone()
        .with_kind(ContactKind::Transient)
        .with_area(1e-4)
        .unwrap();
    controller.safety.bodies.truncate(2);
    controller.safety.bodies[0].capsule = Capsule::sphere(Vector3::zeros(), 0.1).unwrap();
    controller.safety.own_pairs = vec![(0, 1)];
    settings.torque.impedance.damping[3] = 1.0 / 3.0;
    settings.robot.urdf = Some("robots/arm.urdf".into());
    settings.camera.frame = CameraFrame::Map;
    settings.camera.pose = Some([1.0, -2.0, 2.5, 0.5, 0.5, 0.5, -0.5]);
    settings
}

#[test]
fn written_settings_are_read_back_exactly() {
    for settings in [RobotSettings::default(), others()] {
        let text = settings.to_toml().unwrap();
        assert_eq!(read(&text).unwrap(), settings, "{text}");
        assert_eq!(read(&text).unwrap().to_toml().unwrap(), text);
    }
}

#[test]
fn every_setting_is_written_with_what_it_means() {
    let text = RobotSettings::default().to_toml().unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let mut settings = 0;
    for (number, line) in lines.iter().enumerate().filter(|(_, line)| !line.starts_with("  ")) {
        let line = line.trim_start_matches("# ");
        let named = line.split(' ').next().is_some_and(|name| {
            name != "version" && name.chars().all(|c| c.is_ascii_lowercase() || c == '_')
        });
        if line.starts_with('[') || (named && line.contains(" = ")) {
            settings += 1;
            assert!(lines[number - 1].starts_with("# "), "{line} has no comment");
        }
    }
    assert!(settings > 110, "{settings} settings");
    assert!(!text.contains("\\[") && !text.contains("](") && !text.contains('`'), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn numbers_survive(velocity in 1e-3..0.4_f64, gain in 1e-12..1e3_f64) {
        let mut settings = RobotSettings::default();
        settings.controller.desired.velocity = velocity;
        settings.controller.gain[2] = gain;
        prop_assert_eq!(read(&settings.to_toml().unwrap()).unwrap(), settings);
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "(version = 1\n)?[\\[\\]a-z_.=\"0-9{}, \n-]{0,60}") {
        let _ = read(&text);
    }
}

#[test]
fn settings_missing_in_file_stay_unchanged() {
    let mut base = RobotSettings::default();
    base.controller.space.min = Vector3::new(0.3, -0.3, 0.8);
    let file = SettingsFile::parse("version = 1\n[controller.space]\nlead = 0.1\n").unwrap();
    let settings = file.over(&base).unwrap();
    base.controller.space.lead = 0.1;
    assert_eq!(settings, base);
    // This also holds within an optional table.
    let text = "version = 1\n[controller.safety.separation.base]\ndeceleration = 0.7\n";
    let braking = read(text).unwrap().controller.safety.separation.base.unwrap();
    assert_eq!((braking.joints, braking.deceleration), (3, 0.7));
}

#[test]
fn errors_have_line_and_remedy() {
    for (text, line, says) in [
        ("[controler]\n", 2, "nearest is controller"),
        ("\n[controller.safety]\ncontact_sped = 1\n", 4, "controller.safety.contact_speed"),
        // The setting is in the wrong table.
        ("[controller]\nlead = 0.1\n", 3, "controller.space.lead"),
        ("controller.space = 3\n", 2, "[controller.space]"),
        ("[controller]\ntool = 3.0\n", 3, "expected a string"),
        ("[controller]\ngoal = \"most\"\n", 3, "`least_motion`"),
        ("[controller]\ngain = [1, 2]\n", 3, "expected 6"),
        ("[controller.space]\ntool = [0, 0, 0, 2]\n", 3, "norm of 1"),
        ("[controller.budget]\ntime = -1.0\n", 3, "negative"),
        ("[controller.safety.contact]\narea = 0.0\n", 3, "positive"),
        ("[controller.desired]\nvelocity = -1\n", 3, "positive and finite"),
        ("[controller.following_error]\nrevolute = -1.0\n", 3, "positive and finite"),
        ("[controller]\nhorizon = 0.01\n", 3, "leave room to brake"),
        ("[controller]\nhorizon = \"none\"\n", 3, "expected f64"),
        ("x = [\n", 2, "array"),
        ("[controller]\n[controller]\n", 3, "duplicate"),
    ] {
        let error = error(text);
        assert!(error.contains(&format!("line {line}: ")), "{text}: {error}");
        assert!(error.contains(says), "{text}: {error}");
    }
    assert!(read("").unwrap_err().to_string().contains("version = 1"));
    let other = read("version = 2\n").unwrap_err().to_string();
    assert!(other.contains("version 2") && other.contains("reads version 1"), "{other}");
}

#[test]
fn the_programs_write_and_take_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (file, again) = (path("settings.toml"), path("again.toml"));
    Runs::new("follow").with(&["--write-settings", &file]).run().done();
    let copy = ["--settings", &file, "--write-settings", &again];
    Runs::new("follow").with(&copy).run().done();
    assert_eq!(fs::read(&file).unwrap(), fs::read(&again).unwrap());

    let counts = |settings: Option<&str>| {
        let soak = Runs::new("soak").with(&["--ticks=300", "--kinematic", "--json"]);
        let soak = settings.into_iter().fold(soak, |soak, file| soak.with(&["--settings", file]));
        let mut json = soak.run().done().json();
        for key in ["tick_us_p50", "tick_us_p999"] {
            json.as_object_mut().unwrap().remove(key);
        }
        json
    };
    assert_eq!(counts(Some(&file)), counts(None));
    fs::write(&file, "version = 1\n[controller]\ntol = \"x\"\n").unwrap();
    let follow = Runs::follow().with(&["--settings", &file, "--no-report"]);
    follow.run().failed(1, "settings.toml: line 3: there is no setting controller.tol");
    Runs::new("soak").with(&["--settings", &path("none")]).run().failed(1, "cannot read");
}

#[test]
fn only_drive_takes_another_robot() {
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), "version = 1\n[robot]\nurdf = \"arm.urdf\"\n").unwrap();
    let path = file.path().to_str().unwrap();
    let follow = Runs::new("follow").with(&["--settings", path]);
    follow.run().failed(1, "drive moves others");
    let drive = Runs::new("drive").with(&["--settings", path, "--duration=1"]);
    drive.run().failed(1, "arm.urdf");
}

#[test]
fn an_arm_of_six_joints_takes_its_gains() {
    let urdf =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../moca-model/whole-body/examples/urdf/panda.urdf");
    let joints: Vec<_> = (1..=6).map(|joint| format!("panda_joint{joint}")).collect();
    let text = |stiffness: &str, damping: &str| {
        let posture = "[0, -0.785, 0, -2.356, 0, 1.571]";
        let controller =
            format!("[controller]\ntool = \"panda_link6\"\nposture.configuration = {posture}");
        let torque = format!("[torque.impedance]\nstiffness = {stiffness}\ndamping = {damping}");
        format!("version = 1\n[robot]\nurdf = {urdf:?}\n{controller}\n{torque}\n")
    };
    let read = |gains: &str| {
        let file = SettingsFile::parse(&text(gains, gains)).unwrap();
        DrivenRobot::read(RobotSettings::default(), Some((Path::new("arm.toml"), &file)))
    };
    let robot = read("[60, 50, 40, 30, 20, 10]").unwrap();
    assert_eq!(robot.model.joints().len(), 6);
    assert_eq!(robot.settings.torque.impedance.stiffness, [60.0, 50.0, 40.0, 30.0, 20.0, 10.0]);
    assert_eq!(robot.settings.torque.joints, joints);
    let error = format!("{:#}", read("[60, 50, 40, 30, 20, 10, 5]").unwrap_err());
    assert!(error.contains("stiffness has 7 elements; the robot needs 6"), "{error}");
    let gainless = text("[]", "[]").replace("[torque.impedance]\nstiffness = []\ndamping = []", "");
    let file = SettingsFile::parse(&gainless).unwrap();
    let error = DrivenRobot::read(RobotSettings::default(), Some((Path::new("arm.toml"), &file)));
    let error = format!("{:#}", error.unwrap_err());
    assert!(error.contains("torque.impedance.stiffness is missing"), "{error}");
    assert!(error.contains("6 joints"), "{error}");
    let file = tempfile::NamedTempFile::new().unwrap();
    let text = text("[600, 600, 600, 600, 250, 150]", "[50, 50, 50, 20, 20, 20]");
    fs::write(file.path(), text).unwrap();
    let path = file.path().to_str().unwrap();
    let ran = Runs::new("drive").with(&["--settings", path, "--duration=1", "--json"]).run().done();
    let json = ran.json();
    assert_eq!(json["at_rest"], true, "{json}");
    let faults = json["faults"].as_array().unwrap();
    assert!(faults.iter().all(|fault| fault["fault"] != "following error"), "{json}");
}
