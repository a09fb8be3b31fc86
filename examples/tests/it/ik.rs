//! The program `ik`, which moves any robot along a path.

use std::path::Path;

use crate::support::Runs;

fn urdf(name: &str) -> String {
    format!("{}/../moca-model/whole-body/examples/urdf/{name}.urdf", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn panda_follows_circle_and_writes_report() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().to_str().unwrap();
    let start = "--start=0,-0.785,0,-2.356,0,1.571,0.785";
    let ran = Runs::new("ik")
        .with(&[&urdf("panda"), "--frame", "panda_hand_tcp", start, "--rounds", "1"])
        .with(&["--duration", "2", "--json", "--quiet", "--output", output])
        .run();
    assert!(ran.status.success(), "{ran:?}");
    let last: serde_json::Value = serde_json::from_str(ran.output.lines().last().unwrap()).unwrap();
    assert_eq!(last["ticks"], 4000);
    assert_eq!(last["limit_violations"], 0);
    assert_eq!(last["infeasible"], 0);
    assert!(last["position_rms_mm"].as_f64().unwrap() < 0.1);
    assert!(last["orientation_rms_rad"].as_f64().unwrap() < 1e-3);
    assert!(last["tick_us_p50"].is_number() && last["tick_us_p999"].is_number());
    let table = std::fs::read_to_string(Path::new(output).join("ik.csv")).unwrap();
    assert_eq!(table.lines().count(), 4001);
    assert!(table.lines().next().unwrap().contains("panda_joint7_margin"));
    let picture = std::fs::read_to_string(Path::new(output).join("ik.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("position error"));
}

#[test]
fn frame_that_ends_off_its_path_is_reported() {
    let ran = Runs::new("ik")
        .with(&[&urdf("panda"), "--frame", "panda_hand_tcp", "--path", "line", "--length", "2.5"])
        .with(&["--rounds", "0.5", "--json", "--quiet", "--no-report"])
        .run();
    assert_eq!(ran.status.code(), Some(1), "{ran:?}");
    assert!(ran.errors.contains("mm off its path"), "{}", ran.errors);
    let last: serde_json::Value = serde_json::from_str(ran.output.lines().last().unwrap()).unwrap();
    assert!(last["position_end_mm"].as_f64().unwrap() > 1.0);
}

#[test]
fn limits_that_cannot_be_meant_name_the_option() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(urdf("panda")).unwrap();
    let speed = "velocity=\"2.175\"";
    assert!(text.contains(speed));
    let path = folder.path().join("slow.urdf");
    std::fs::write(&path, text.replacen(speed, "velocity=\"0\"", 1)).unwrap();
    let ran = Runs::new("ik")
        .with(&[path.to_str().unwrap(), "--frame", "panda_hand", "--no-report"])
        .run();
    assert_eq!(ran.status.code(), Some(1), "{ran:?}");
    assert!(ran.errors.contains("--ignore-bad-limits"), "{}", ran.errors);
    assert!(!ran.errors.contains("UnusableLimits"), "{}", ran.errors);
}

#[test]
fn what_cannot_be_done_is_said() {
    for (options, words) in [
        (vec!["--frame", "panda_hnd"], "panda_hand"),
        (vec!["--frame", "panda_link0"], "no joint moves"),
        (vec!["--frame", "panda_hand", "--path", "/nowhere.csv"], "/nowhere.csv"),
        (vec!["--frame", "panda_hand", "--start=1,2"], "has 7"),
    ] {
        let ran =
            Runs::new("ik").with(&[urdf("panda")]).with(&options).with(&["--no-report"]).run();
        assert_eq!(ran.status.code(), Some(1), "{ran:?}");
        assert!(ran.errors.contains(words), "{}", ran.errors);
    }
}
