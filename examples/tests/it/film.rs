//! The program that scores people on film: joints of one camera and of several, images and videos.

use std::{fs, os::unix::fs::PermissionsExt, path::Path};

use image::{Rgb, RgbImage};
use nalgebra::{Matrix3, Vector3, vector};
use serde_json::{Value, json};

use crate::support::Runs;

/// Somebody upright who looks along x, by COCO's seventeen joints (m).
const UPRIGHT: [[f64; 3]; 17] = [
    [0.13, 0.0, 1.55],
    [0.1, 0.03, 1.58],
    [0.1, -0.03, 1.58],
    [0.02, 0.075, 1.56],
    [0.02, -0.075, 1.56],
    [-0.04, 0.18, 1.43],
    [-0.04, -0.18, 1.43],
    [-0.04, 0.21, 1.11],
    [-0.04, -0.21, 1.11],
    [-0.02, 0.21, 0.86],
    [-0.02, -0.21, 0.86],
    [0.0, 0.09, 0.93],
    [0.0, -0.09, 0.93],
    [0.0, 0.09, 0.51],
    [0.0, -0.09, 0.51],
    [-0.01, 0.09, 0.08],
    [-0.01, -0.09, 0.08],
];

/// Index of each among MediaPipe's landmarks.
const LANDMARKS: [usize; 17] = [0, 2, 5, 7, 8, 11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28];

/// The trunk and what it carries leans forward from the hips (degrees).
fn leaning(degrees: f64) -> [Vector3<f64>; 17] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    UPRIGHT.map(|[x, y, z]| {
        let above = z - 0.93;
        if above < 0.02 && z != 0.86 {
            return vector![x, y, z];
        }
        vector![x * cos + above * sin, y, 0.93 + above * cos - x * sin]
    })
}

/// A camera of 1280 × 720 pixels, focal length 1000: the rows of its axes and its place.
struct Eye {
    axes: Matrix3<f64>,
    place: Vector3<f64>,
}

impl Eye {
    fn at(place: Vector3<f64>) -> Self {
        let ahead = (vector![0.0, 0.0, 1.0] - place).normalize();
        let right = ahead.cross(&Vector3::z()).normalize();
        let rows = [right, ahead.cross(&right), ahead].map(|axis| axis.transpose());
        Self { axes: Matrix3::from_rows(&rows), place }
    }

    fn pixel(&self, point: &Vector3<f64>) -> [f64; 2] {
        let seen = self.axes * (point - self.place);
        [639.5 + 1000.0 * seen.x / seen.z, 359.5 + 1000.0 * seen.y / seen.z]
    }

    fn yaml(&self) -> String {
        let list =
            |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let shift = -(self.axes * self.place);
        format!(
            "image_width: 1280\nimage_height: 720\n\
             camera_matrix: {{rows: 3, cols: 3, data: [1000, 0, 639.5, 0, 1000, 359.5, 0, 0, 1]}}\n\
             distortion_coefficients: {{rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}}\nR: [{}]\nT: [{}]\n",
            list(self.axes.transpose().as_slice()),
            list(shift.as_slice())
        )
    }
}

/// Results of COCO's form: two seconds upright, then leaning by 40°.
fn coco(eye: &Eye) -> String {
    let person = |image: u32| {
        let joints = leaning(if image < 50 { 0.0 } else { 40.0 });
        let keypoints = joints.iter().flat_map(|joint| {
            let [x, y] = eye.pixel(joint);
            [x, y, 0.9]
        });
        json!({ "image_id": image, "keypoints": keypoints.collect::<Vec<_>>(), "score": 1.0 })
    };
    Value::from((0..100).map(person).collect::<Vec<_>>()).to_string()
}

/// MediaPipe's landmarks of the same film.
fn mediapipe(eye: &Eye) -> String {
    let frame = |image: u32| {
        let joints = leaning(if image < 50 { 0.0 } else { 40.0 });
        let hips = (joints[11] + joints[12]) * 0.5;
        let mut landmarks = vec![json!({ "x": 0.5, "y": 0.5, "z": 0.0, "visibility": 0.1 }); 33];
        let mut world = landmarks.clone();
        for (joint, place) in joints.iter().zip(LANDMARKS) {
            let ([u, v], metric) = (eye.pixel(joint), eye.axes * (joint - hips));
            landmarks[place] =
                json!({ "x": u / 1280.0, "y": v / 720.0, "z": 0.0, "visibility": 0.9 });
            world[place] =
                json!({ "x": metric.x, "y": metric.y, "z": metric.z, "visibility": 0.9 });
        }
        json!({ "frame": image, "landmarks": [landmarks], "worldLandmarks": [world] })
    };
    Value::from((0..100).map(frame).collect::<Vec<_>>()).to_string()
}

fn write(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The trunk's sub-scores at a second and at three, by a table of images.
fn trunk(table: &str) -> [String; 2] {
    let mut rows = csv::Reader::from_path(table).unwrap();
    let column = rows.headers().unwrap().iter().position(|name| name == "s_trunk").unwrap();
    let rows: Vec<_> = rows.records().map(Result::unwrap).collect();
    [25, 80].map(|row| rows[row][column].to_owned())
}

#[test]
fn several_cameras_score_a_person() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let eyes =
        [vector![3.0, 1.0, 1.4], vector![2.0, -3.0, 1.8], vector![-2.5, 2.0, 1.2]].map(Eye::at);
    let mut arguments = vec!["--joints".to_owned()];
    for (index, eye) in eyes.iter().enumerate() {
        arguments.push(write(folder, &format!("{index}.json"), coco(eye)));
    }
    let alone = Runs::new("reba").with(&arguments).run();
    alone.failed(1, "several films: give --calibration");
    arguments.push("--calibration".to_owned());
    for (index, eye) in eyes.iter().enumerate() {
        arguments.push(write(folder, &format!("{index}.yaml"), eye.yaml()));
    }
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let [table, picture, recording] = ["table.csv", "scores.svg", "joints.jsonl"].map(path);
    let outputs = ["--output", &table, "--picture", &picture, "--recording", &recording, "--json"];
    let ran = Runs::new("reba").with(&arguments).with(&outputs).run().done();
    assert!(ran.output.contains("100 images, the person in 100\n"), "{ran:?}");
    assert!(ran.output.contains("\"images\":100,\"seen\":100,\"scored\":100,"), "{ran:?}");
    assert_eq!(trunk(&table), ["1", "3"]);
    assert!(fs::read_to_string(&picture).unwrap().contains("<svg"));
    // The first frame's right wrist is where it was, to a millimetre.
    let recorded = fs::read_to_string(&recording).unwrap();
    let frame: Value = serde_json::from_str(recorded.lines().nth(1).unwrap()).unwrap();
    for (axis, expected) in UPRIGHT[10].iter().enumerate() {
        assert!((frame["keypoints"][4][axis].as_f64().unwrap() - expected).abs() < 1e-3, "{frame}");
    }
    // Its first columns are a table of sheets.
    let first = fs::read_to_string(&table).unwrap();
    let sheets = first.lines().map(|line| line.split(',').take(16).collect::<Vec<_>>().join(","));
    let sheets = sheets.collect::<Vec<_>>().join("\n");
    let again = Runs::new("reba").with(&["--input", "-", "--quiet"]).run_on(&sheets).done();
    let scores = |text: &str| -> Vec<String> {
        let mut rows = csv::Reader::from_reader(text.as_bytes());
        let column = rows.headers().unwrap().iter().position(|column| column == "reba").unwrap();
        rows.records().map(|row| row.unwrap()[column].to_owned()).collect()
    };
    assert_eq!(scores(&first), scores(&again.output));
}

#[test]
fn one_camera_without_depth_scores_a_person() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let eye = Eye::at(vector![3.0, 1.5, 1.0]);
    let joints = write(folder, "film.json", mediapipe(&eye));
    let table = folder.join("table.csv").to_str().unwrap().to_owned();
    let reba = |more: &[&str]| {
        let arguments = ["--joints", joints.as_str(), "--output", table.as_str(), "--json"];
        Runs::new("reba").with(&arguments).with(more).run()
    };
    reba(&[])
        .failed(1, "film.json: no JSON of joints: landmarks that are parts of the image's sides");
    let sized = ["--size", "1280x720", "--field-of-view", "65.2", "--camera-height", "1"];
    let ran = reba(&sized).done();
    assert!(ran.output.contains("\"seen\":100,\"scored\":100,"), "{ran:?}");
    assert_eq!(trunk(&table), ["1", "3"]);
    let stature = |ran: &str| {
        let line: Value = serde_json::from_str(ran.lines().last().unwrap()).unwrap();
        [line["stature"].as_f64().unwrap(), line["stature_sigma"].as_f64().unwrap()]
    };
    let [own, sigma] = stature(&ran.output);
    assert!((own - 0.85 / 0.491).abs() < sigma && sigma < 0.15, "{own} {sigma}");
    let known = reba(&[&sized[..], &["--stature", "1.9"]].concat()).done();
    assert!(stature(&known.output)[0] > own + 0.03);
    for (wrong, says) in [
        (["--stature", "19"], "stature is 19"),
        (["--camera-height", "0"], "--camera-height 0: give 0.05 to 20 m"),
        (["--field-of-view", "180"], "--field-of-view 180"),
        (["--rate", "0"], "--rate 0: give 0.1 to 1000"),
        (["--calibration", "/not/there.yaml"], "/not/there.yaml"),
    ] {
        let size = ["--size", "1280x720"];
        reba(&[&size[..], &wrong[..]].concat()).failed(1, says);
    }
    reba(&["--size", "large"]).failed(2, "give width and height");
    // COCO's joints alone place nobody.
    let coco = write(folder, "coco.json", coco(&eye));
    Runs::new("reba").with(&["--joints", &coco]).run().failed(1, "nobody whose trunk was seen");
}

/// An image in which the small networks of the tests see a person (`vision-models/tests/data/blaze_pose.py`).
fn seen() -> RgbImage {
    let mut image = RgbImage::new(224, 224);
    image.put_pixel(96, 64, Rgb([255; 3]));
    for (x, y) in (148..=152).flat_map(|x| (36..=40).map(move |y| (x, y))) {
        image.put_pixel(x, y, Rgb([255; 3]));
    }
    image
}

#[test]
fn images_and_videos_are_looked_at_by_networks() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../vision-models/tests/data");
    let [landmarks, detector] =
        ["blaze_landmarks", "blaze_detector"].map(|name| format!("{data}/{name}.tflite"));
    let images = folder.join("images");
    fs::create_dir(&images).unwrap();
    for index in 0..3 {
        seen().save(images.join(format!("{index}.png"))).unwrap();
    }
    let networks = ["--pose", &landmarks, "--pose-detector", &detector];
    let reba =
        |film: &Path| Runs::new("reba").with(&["--video", film.to_str().unwrap()]).with(&networks);
    let of_folder = reba(&images).run().done();
    assert!(of_folder.output.contains("3 images, the person in 3\n"), "{of_folder:?}");

    // A program called ffmpeg that gives the same images whatever it is asked.
    let [programs, empty] = ["programs", "empty"].map(|name| folder.join(name));
    fs::create_dir(&programs).unwrap();
    fs::create_dir(&empty).unwrap();
    let mut frame = b"P6\n224 224\n255\n".to_vec();
    frame.extend(seen().as_raw());
    let frame = write(folder, "frame.ppm", frame);
    let program = |text: String| {
        let path = write(&programs, "ffmpeg", text);
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    };
    let video = folder.join("film.mp4");
    fs::write(&video, "a video").unwrap();
    program(format!("#!/bin/sh\n/bin/cat {frame} {frame} {frame}\n"));
    let of_video = reba(&video).with_programs_in(&programs).run().done();
    assert_eq!(of_video.output, of_folder.output);
    program("#!/bin/sh\necho 'film.mp4: Invalid data found' >&2\nexit 1\n".to_owned());
    reba(&video)
        .with_programs_in(&programs)
        .run()
        .failed(1, "ffmpeg says: film.mp4: Invalid data found");
    program(format!("#!/bin/sh\n/usr/bin/head -c 1000 {frame}\n"));
    reba(&video)
        .with_programs_in(&programs)
        .run()
        .failed(1, "film.mp4: failed to fill whole buffer");
    reba(&video).with_programs_in(&empty).run().failed(1, "no ffmpeg on the PATH");
    reba(&folder.join("none.mp4")).run().failed(1, "none.mp4");
    Runs::new("reba").with(&["--video", video.to_str().unwrap()]).run().failed(2, "--pose");
}
