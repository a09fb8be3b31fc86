//! The program that finds the place of a camera.

use std::fmt::Write;
use std::fs;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::support::Runs;

/// Where the camera truly stands: 2 m high, looking down at the robot.
fn truth() -> Isometry3<f64> {
    Isometry3::look_at_rh(&Point3::new(2.0, 1.0, 2.0), &Point3::new(0.4, 0.0, 0.5), &Vector3::z())
        .inverse()
        * Isometry3::rotation(Vector3::x() * std::f64::consts::PI)
}

/// Pixel and depth of a point, by the pinhole's own formula.
fn seen(point: &Point3<f64>) -> [f64; 3] {
    let point = truth().inverse_transform_point(point);
    [319.5 + 615.0 * point.x / point.z, 239.5 + 615.0 * point.y / point.z, point.z]
}

const TOOL: [[f64; 3]; 5] =
    [[0.5, 0.0, 0.4], [0.4, 0.4, 0.6], [0.6, -0.3, 0.9], [0.3, 0.1, 1.0], [0.7, 0.2, 0.5]];

struct Folder(tempfile::TempDir);

impl Folder {
    /// A camera that was never placed.
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let camera = r#"{"format":"moca-frames","version":1,"width":640,"height":480,"fx":615.0,"fy":615.0,"cx":319.5,"cy":239.5,"depth_scale":0.001,"position":[0,0,0],"quaternion":[0,0,0,1],"noise":{"constant":0.001,"quadratic":0.004},"gravity":null,"stature":1.8}"#;
        fs::write(folder.path().join("camera.json"), camera).unwrap();
        fs::create_dir(folder.path().join("depth")).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    fn calibrate(&self, table: &str, more: &[&str]) -> Runs {
        fs::write(self.path("points.csv"), table).unwrap();
        Runs::new("calibrate").with(&[&self.path(""), &self.path("points.csv")]).with(more)
    }
}

fn table() -> String {
    let rows = TOOL.map(|point| {
        let ([u, v, depth], [x, y, z]) = (seen(&point.into()), point);
        format!("{u},{v},{depth},{x},{y},{z}\n")
    });
    format!("u,v,depth,x,y,z\n{}", rows.concat())
}

fn pose_of(json: &serde_json::Value) -> Vec<f64> {
    json["pose"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn exact_points_give_the_place() {
    let folder = Folder::new();
    let placed = folder.path("placed.json");
    let ran = folder.calibrate(&table(), &["--output", &placed, "--json"]).run().done();
    let json = ran.json();
    let pose = pose_of(&json);
    let truth = truth();
    for (found, expected) in pose.iter().zip(truth.translation.vector.iter()) {
        assert!((found - expected).abs() < 1e-9, "{json}");
    }
    let turn: f64 = pose[3..].iter().zip(truth.rotation.coords.iter()).map(|(a, b)| a * b).sum();
    assert!((turn.abs() - 1.0).abs() < 1e-9, "{json}");
    assert!(json["deviation"].as_f64().unwrap() < 1e-9, "{json}");
    assert!(
        ran.output.contains("[camera]\npose = [2.000000, 1.000000, 2.000000, "),
        "{}",
        ran.output
    );
    // What else the file says is kept.
    let file: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(placed).unwrap()).unwrap();
    assert_eq!((&file["fx"], &file["stature"]), (&615.0.into(), &1.8.into()));
    assert!((file["position"][0].as_f64().unwrap() - 2.0).abs() < 1e-9);
}

#[test]
fn depths_come_from_the_images() {
    let folder = Folder::new();
    let mut table = "frame, u, v, x, y, z\n".to_owned();
    for (frame, point) in TOOL.into_iter().enumerate() {
        let ([u, v, depth], [x, y, z]) = (seen(&point.into()), point);
        let mut image = image::ImageBuffer::<image::Luma<u16>, _>::new(640, 480);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the image")]
        let (column, row, unit) =
            (u.round() as u32, v.round() as u32, (depth * 1e3).round() as u16);
        // Not at the pixel itself: the sensor has a hole there.
        for (aside, below) in [(1, 0), (0, 1), (2, 2), (1, 1)] {
            image.put_pixel(column + aside, row + below, image::Luma([unit]));
        }
        image.save(folder.path(&format!("depth/{frame:06}.png"))).unwrap();
        writeln!(table, "{frame}, {u}, {v}, {x}, {y}, {z}").unwrap();
    }
    let json = folder.calibrate(&table, &["--json"]).run().done().json();
    let place = Vector3::from_iterator(pose_of(&json));
    assert!((place - Vector3::new(2.0, 1.0, 2.0)).norm() < 2e-3, "{json}");
    // Nothing is measured far from these pixels.
    let missed = table.replace(&format!("0, {}", seen(&TOOL[0].into())[0]), "0, 10");
    folder.calibrate(&missed, &[]).run().failed(1, "no depth is measured around the pixel 10");
}

#[test]
fn faults_are_named_with_their_point() {
    let folder = Folder::new();
    let whole = table();
    let wrong = whole.replace(",0.9\n", ",1.4\n");
    let ran = folder.calibrate(&wrong, &[]).run().done();
    assert!(ran.errors.contains("the points contradict each other"), "{}", ran.errors);
    for (table, says) in [
        ("u,v,depth,x,y,z\n1,2,1.0,0,0,0\n".to_owned(), "three or more"),
        (whole.replace("depth", "distance"), "point 1"),
        (whole.replace(",0.9\n", ",high\n"), "point 3"),
        ("u,v,x,y,z\n1,2,0,0,0\n".to_owned(), "neither a depth nor a frame"),
        ("u,v,depth,x,y,z\n641,2,1.0,0,0,0\n".to_owned(), "outside the image"),
        ("u,v,depth,x,y,z\n64,2,-1.0,0,0,0\n".to_owned(), "the depth is -1"),
        ("frame,u,v,x,y,z\n7,64,2,0,0,0\n".to_owned(), "000007.png"),
    ] {
        folder.calibrate(&table, &[]).run().failed(1, says);
    }
}
