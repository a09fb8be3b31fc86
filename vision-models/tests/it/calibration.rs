//! Calibrations of cameras in files.

use nalgebra::{Point2, Point3, Rotation3, Vector3, point};
use proptest::prelude::*;
use vision_models::{CalibratedCamera, Distortion, Error};

/// A system of a camera for video and one for markers. The first is two metres to the right of the origin and 1.5 m high, and
/// looks along y. Qualisys' cameras look along their own -z, y upwards: its axes are x, z and -y of the world.
const QUALISYS: &str = r#"<?xml version="1.0"?>
<calibration type="regular">
  <cameras>
    <camera active="1" serial="26578" model="Miqus M3" viewrotation="0">
      <fov_video bottom="1087" left="0" right="1919" top="0"/>
    </camera>
    <camera active="1" avg-residual="0.4" serial="cam 1" model="Miqus Video" viewrotation="0">
      <fov_marker bottom="1" left="0" right="1" top="0"/>
      <fov_video bottom="1087" left="0" right="1919" top="0"/>
      <transform r11="1" r12="0" r13="0" r21="0" r22="0" r23="1" r31="0" r32="-1" r33="0" x="2000" y="0" z="1500"/>
      <intrinsic centerPointU="61408" centerPointV="34784" focalLengthU="102400" focalLengthV="102400" skew="0"
        radialDistortion1="-0.05" radialDistortion2="0.1" radialDistortion3="0" tangentalDistortion1="0"
        tangentalDistortion2="0" sensorMaxU="122816"/>
    </camera>
  </cameras>
</calibration>"#;

const ROS: &str = "image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [600.0, 0.0, 320.5, 0.0, 601.0, 240.5, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.1, 0.01, 0.001, -0.002, 0.0]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix:
  rows: 3
  cols: 4
  data: [600.0, 0.0, 320.5, 0.0, 0.0, 601.0, 240.5, 0.0, 0.0, 0.0, 1.0, 0.0]
";

const OPENCV: &str = "%YAML:1.0
---
calibration_time: \"Tue 01 Jan 2030\"
nframes: 13
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 6.0e+02, 0., 3.205e+02, 0., 6.0e+02,
       2.405e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 0., 0., 0., 0., 0. ]
rvec: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [ 1.2, -0.3, 0.4 ]
tvec: [ 0.1, 0.2, 3.0 ]
";

fn one(text: &str) -> CalibratedCamera {
    let mut cameras = CalibratedCamera::parse(text, "file").unwrap();
    assert_eq!(cameras.len(), 1);
    cameras.remove(0)
}

fn problem(text: &str) -> String {
    match CalibratedCamera::parse(text, "file") {
        Err(error @ (Error::Malformed { .. } | Error::Value { .. })) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn qualisys_has_its_own_units_and_axes() {
    let camera = one(QUALISYS);
    assert_eq!((camera.name.as_str(), camera.intrinsics.size()), ("cam 1", [1920, 1088]));
    // Straight ahead is the principal point; up is up, and right is right.
    let at = |x, z| camera.project(&Point3::new(2.0 + x, 4.0, 1.5 + z)).unwrap();
    assert!((at(0.0, 0.0) - point![959.5, 543.5]).norm() < 1e-9);
    let bent = |far: f64| 1600.0 * far * (1.0 - 0.05 * far * far + 0.1 * far.powi(4));
    assert!((at(1.0, 0.0) - point![959.5 + bent(0.25), 543.5]).norm() < 1e-9);
    assert!((at(0.0, 0.8) - point![959.5, 543.5 - bent(0.2)]).norm() < 1e-9);
    // Where none is for video, all are taken: the other lacks its lens.
    let markers = QUALISYS.replace("Miqus Video", "Miqus M3");
    assert!(
        problem(&markers).contains("camera 26578 lacks the number focalLengthU of <intrinsic>")
    );
    assert!(
        problem(&QUALISYS.replace(r#"viewrotation="0""#, r#"viewrotation="90""#))
            .contains("rotated by 90")
    );
    assert!(problem(&QUALISYS.replace(r#"r11="1""#, r#"r11="2""#)).contains("no rigid motion"));
    assert!(problem("<calibration/>").contains("without a <camera>"));
    assert!(problem("<calibration><camera").contains("no calibration of cameras"));
}

#[test]
fn ros_and_opencv_tell_lens_and_place() {
    let camera = one(ROS);
    assert_eq!(camera.name, "narrow_stereo");
    assert_eq!(camera.intrinsics.focal(), [600.0, 601.0]);
    assert_eq!(camera.intrinsics.centre(), [320.5, 240.5]);
    let expected = Distortion::Radial([-0.1, 0.01, 0.001, -0.002, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!((camera.distortion, camera.world_from_camera), (expected, None));
    let fisheye = ROS
        .replace("plumb_bob", "equidistant")
        .replace("[-0.1, 0.01, 0.001, -0.002, 0.0]", "[0.1, 0.01, 0.001, 0.002]");
    assert_eq!(one(&fisheye).distortion, Distortion::Fisheye([0.1, 0.01, 0.001, 0.002]));

    let camera = one(OPENCV);
    assert_eq!((camera.name.as_str(), camera.distortion), ("file", Distortion::None));
    // OpenCV's motion: a point of the world in the camera's frame.
    let point = Vector3::new(0.5, -0.3, 1.0);
    let seen = Rotation3::new(Vector3::new(1.2, -0.3, 0.4)) * point + Vector3::new(0.1, 0.2, 3.0);
    let expected = Point2::new(320.5 + 600.0 * seen.x / seen.z, 240.5 + 600.0 * seen.y / seen.z);
    assert!((camera.project(&point.into()).unwrap() - expected).norm() < 1e-9);
    let rows = Rotation3::new(Vector3::new(1.2, -0.3, 0.4)).matrix().transpose();
    let rows: Vec<_> = rows.iter().map(f64::to_string).collect();
    let matrix = OPENCV
        .replace("rvec", "R")
        .replace("[ 1.2, -0.3, 0.4 ]", &format!("[{}]", rows.join(", ")));
    let pose = one(&matrix).world_from_camera.unwrap();
    assert!((pose.inverse_transform_point(&point.into()) - Point3::from(seen)).norm() < 1e-12);
}

#[test]
fn what_is_missing_in_yaml_is_named() {
    for (text, says) in [
        ("a: 1".to_owned(), "no image_width"),
        (ROS.replace("640", "wide"), "wide in image_width"),
        (ROS.replace("camera_matrix", "matrix"), "no camera_matrix"),
        (ROS.replace("plumb_bob", "thin_prism"), "distortion_model thin_prism with 5 coefficients"),
        (ROS.replace("[600.0, 0.0, 320.5", "[600.0, 3.0, 320.5"), "skew of 3"),
        (OPENCV.replace("tvec", "shift"), "rvec alone: give both"),
        (OPENCV.replace("[ 0.1, 0.2, 3.0 ]", "[ 0.1, 0.2 ]"), "a translation of 2 numbers"),
        (ROS.replace("640", "&a 640").replace("480", "*a"), "an alias"),
        ("a: [".to_owned(), "no calibration of cameras"),
    ] {
        assert!(problem(&text).contains(says), "{says}: {}", problem(&text));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("left.yaml");
    std::fs::write(&path, "a: 1").unwrap();
    let error = CalibratedCamera::read(&path).unwrap_err().to_string();
    assert!(error.contains("left.yaml: no calibration"), "{error}");
    assert!(CalibratedCamera::read(folder.path().join("none")).is_err());
}

proptest! {
    /// Whatever a file holds, nothing panics.
    #[test]
    fn any_calibration_is_read_or_refused(text in "\\PC{0,200}", at: prop::sample::Index, byte: u8) {
        let _ = CalibratedCamera::parse(&text, "file");
        for whole in [QUALISYS, ROS, OPENCV] {
            let mut bytes = whole.as_bytes().to_vec();
            let at = at.index(bytes.len());
            bytes[at] = byte;
            let _ = CalibratedCamera::parse(&String::from_utf8_lossy(&bytes), "file");
        }
    }
}
