use std::f64::consts::FRAC_PI_2;

use moca_drivers::ros2::messages::{
    Float64MultiArray, PoseArray, Quaternion, Text, TfMessage, Time, Transform, TransformStamped,
    Vector3,
};
use moca_drivers::ros2::{Perceived, Refusal, SeenPeople};
use nalgebra::{Matrix3, Point3};
use vision_models::{Action, Body, Body25, PersonId, Surface, Tool};

use super::{after, body};

#[test]
fn poses_follow_the_order_of_body_25() {
    let mut poses = body();
    let unseen = &mut poses.poses[Body25::LeftEar.index()].position;
    (unseen.x, unseen.y, unseen.z) = (f64::NAN, f64::NAN, f64::NAN);
    let seen = Perceived::default().take_body(&poses, after(80)).unwrap();
    let person = seen.body.unwrap();
    assert_eq!(person.get(Body25::LeftEar), None);
    assert_eq!(person.iter().count(), 24);
    assert!(seen.others.is_empty());
    let wrist = person.get(Body25::LeftWrist).unwrap();
    assert!((wrist.position - Point3::new(2.0, 0.0, 0.7)).norm() < 1e-12);
    let taken = seen.taken.duration_since(after(0)).unwrap_or_else(|before| before.duration());
    assert!(taken.as_secs_f64() < 1e-6 && seen.action.is_none(), "{taken:?}");
}

fn no_transform(frame: &str) -> Refusal {
    Refusal::NoTransform { frame: frame.to_owned(), to: "odom", oldest: 1.0 }
}

/// Transforms of a localisation that places odometry at (1, 2) in the map, turned by a quarter.
fn transforms() -> TfMessage {
    let mut transform = TransformStamped {
        header: super::header("map"),
        child_frame_id: "odom".to_owned(),
        ..TransformStamped::default()
    };
    transform.transform.translation = Vector3 { x: 1.0, y: 2.0, z: 0.0 };
    let half = FRAC_PI_2 / 2.0;
    transform.transform.rotation =
        Quaternion { z: half.sin(), w: half.cos(), ..Quaternion::default() };
    let wheel = TransformStamped { child_frame_id: "wheel".to_owned(), ..transform.clone() };
    TfMessage { transforms: vec![wheel, transform] }
}

#[test]
fn people_in_the_map_come_into_the_odometry() {
    let mut poses = body();
    poses.header.frame_id = "map".to_owned();
    let mut perceived = Perceived::default();
    let unknown = no_transform("map");
    assert_eq!(perceived.take_body(&poses, after(80)).unwrap_err(), unknown);
    perceived.take_transforms(&transforms(), after(60)).unwrap();
    let neck = |seen: SeenPeople| seen.body.unwrap().get(Body25::Neck).unwrap().position;
    // Seen from the origin of odometry the map's (2, 0) is at (1, -2). Its x axis is the map's y axis.
    let found = neck(perceived.take_body(&poses, after(80)).unwrap());
    assert!((found - Point3::new(-2.0, -1.0, 0.1)).norm() < 1e-12, "{found}");
    // What stands in the odometry stays, and a transform holds for a second.
    let mut later = body();
    later.header.stamp.nanosec += 1_000_000;
    let found = neck(perceived.take_body(&later, after(80)).unwrap());
    assert_eq!(found, Point3::new(2.0, 0.0, 0.1));
    poses.header.stamp.sec += 2;
    assert_eq!(perceived.take_body(&poses, after(2080)).unwrap_err(), unknown);
}

/// Camera, its mount and the place of odometry in the map are tied by transforms that stay valid.
#[test]
fn people_in_a_static_frame_come_into_odometry() {
    let mut poses = body();
    poses.header.frame_id = "camera".to_owned();
    let mut perceived = Perceived::default();
    assert_eq!(perceived.take_body(&poses, after(80)).unwrap_err(), no_transform("camera"));
    let tie = |parent: &str, child: &str, [x, y, z]: [f64; 3], rotation| {
        let mut transform = TransformStamped::default();
        parent.clone_into(&mut transform.header.frame_id);
        child.clone_into(&mut transform.child_frame_id);
        transform.transform = Transform { translation: Vector3 { x, y, z }, rotation };
        TfMessage { transforms: vec![transform] }
    };
    let (straight, half) = (Quaternion { w: 1.0, ..Quaternion::default() }, FRAC_PI_2 / 2.0);
    // The camera stands 2 m high at (3, 0) in the map, and looks along the map's y axis.
    let quarter = Quaternion { z: half.sin(), w: half.cos(), ..Quaternion::default() };
    perceived.take_static_transforms(&tie("mount", "camera", [0.0, 0.0, 2.0], quarter)).unwrap();
    perceived.take_static_transforms(&tie("map", "mount", [3.0, 0.0, 0.0], straight)).unwrap();
    assert_eq!(perceived.take_body(&poses, after(80)).unwrap_err(), no_transform("camera"));
    perceived.take_static_transforms(&tie("map", "odom", [1.0, 1.0, 0.0], straight)).unwrap();
    // Two metres before the camera are (3, 2) in the map. The time does not matter.
    poses.header.stamp.sec += 3600;
    let seen = perceived.take_body(&poses, after(3_600_080)).unwrap();
    let neck = seen.body.unwrap().get(Body25::Neck).unwrap().position;
    assert!((neck - Point3::new(2.0, 1.0, 2.1)).norm() < 1e-12, "{neck}");
    // A frame that moves with the robot is tied by /tf alone, and nobody stands in it.
    perceived.take_transforms(&tie("odom", "base_link", [0.0; 3], straight), after(80)).unwrap();
    poses.header.frame_id = "base_link".to_owned();
    assert_eq!(
        perceived.take_body(&poses, after(3_600_080)).unwrap_err(),
        no_transform("base_link")
    );
}

#[test]
fn rings_of_frames_end_and_frames_are_bounded() {
    let mut poses = body();
    poses.header.frame_id = "a".to_owned();
    let tie = |parent: &str, child: String| TransformStamped {
        header: super::header(parent),
        child_frame_id: child,
        transform: Transform {
            rotation: Quaternion { w: 1.0, ..Quaternion::default() },
            ..Transform::default()
        },
    };
    let mut perceived = Perceived::default();
    let ring = TfMessage { transforms: vec![tie("a", "b".to_owned()), tie("b", "a".to_owned())] };
    perceived.take_static_transforms(&ring).unwrap();
    assert_eq!(perceived.take_body(&poses, after(80)).unwrap_err(), no_transform("a"));
    let many = (0..2000).map(|frame| tie("a", frame.to_string())).collect();
    let refused = perceived.take_static_transforms(&TfMessage { transforms: many });
    assert_eq!(refused, Err(Refusal::Frames { most: 1000 }));
    // Frames that are known can still move.
    perceived.take_static_transforms(&ring).unwrap();
}

#[test]
fn transforms_that_are_none_are_refused() {
    let refused = |change: fn(&mut TransformStamped)| {
        let mut message = transforms();
        change(&mut message.transforms[1]);
        Perceived::default().take_transforms(&message, after(80))
    };
    let infinite = refused(|of| of.transform.translation.z = f64::INFINITY);
    assert_eq!(infinite, Err(Refusal::NotFinite { what: "translation" }));
    let none = refused(|of| {
        of.transform.rotation = Quaternion { z: 2.0, w: 0.0, ..Quaternion::default() }
    });
    assert_eq!(none, Err(Refusal::Orientation { norm: 2.0 }));
}

/// The joints of others follow those of the person. A body without visible joints is nobody.
#[test]
fn there_may_be_others() {
    let mut poses = body();
    let mut other = body().poses;
    for pose in &mut other {
        pose.position.x += 3.0;
    }
    poses.poses.extend(other.clone());
    let seen = Perceived::default().take_body(&poses, after(80)).unwrap();
    assert!(seen.body.is_some());
    let [far] = &seen.others[..] else { panic!("{} others", seen.others.len()) };
    assert_eq!(far.get(Body25::Neck).unwrap().position.x, 5.0);

    for pose in &mut poses.poses[..25] {
        (pose.position.x, pose.position.y, pose.position.z) = (f64::NAN, f64::NAN, f64::NAN);
    }
    let seen = Perceived::default().take_body(&poses, after(80)).unwrap();
    assert_eq!((seen.body.is_none(), seen.others.len()), (true, 1));

    poses.poses.truncate(49);
    let cut = Perceived::default().take_body(&poses, after(80)).unwrap_err();
    assert_eq!(cut, Refusal::Size { what: "body joints", found: 49, expected: 25 });
    poses.poses.clear();
    let none = Perceived::default().take_body(&poses, after(80)).unwrap_err();
    assert_eq!(none, Refusal::Size { what: "body joints", found: 0, expected: 25 });
}

#[test]
fn bodies_that_are_none_are_refused() {
    let refused = |change: fn(&mut moca_drivers::ros2::messages::PoseArray)| {
        let mut poses = body();
        change(&mut poses);
        Perceived::default().take_body(&poses, after(80)).unwrap_err()
    };
    // The message has OpenPose's COCO model.
    let coco = refused(|poses| poses.poses.truncate(18));
    assert_eq!(coco, Refusal::Size { what: "body joints", found: 18, expected: 25 });
    let half = refused(|poses| poses.poses[3].position.y = f64::NAN);
    assert_eq!(half, Refusal::NotFinite { what: "body joints" });
    let far = refused(|poses| poses.poses[3].position.y = f64::INFINITY);
    assert_eq!(far, Refusal::NotFinite { what: "body joints" });
    let camera = refused(|poses| poses.header.frame_id = "camera".to_owned());
    assert_eq!(camera, no_transform("camera"));
    let simulated = refused(|poses| poses.header.stamp = Time { sec: 3, nanosec: 0 });
    assert!(matches!(simulated, Refusal::Old { .. }), "{simulated}");
}

/// Equal confidences for a body.
fn confidences(poses: &PoseArray, confidence: f64) -> Float64MultiArray {
    let Time { sec, nanosec } = poses.header.stamp;
    let mut data = vec![f64::from(sec), f64::from(nanosec)];
    data.resize(2 + poses.poses.len(), confidence);
    Float64MultiArray { data, ..Float64MultiArray::default() }
}

#[test]
fn confidences_go_with_the_body_of_their_stamp() {
    let mut poses = body();
    let mut message = confidences(&poses, 0.9);
    message.data[2 + Body25::LeftWrist.index()] = 0.2;
    let mut perceived = Perceived::default();
    perceived.take_confidences(&message).unwrap();
    let person = perceived.take_body(&poses, after(80)).unwrap().body.unwrap();
    let of = |joint| person.get(joint).unwrap().confidence.value();
    assert_eq!((of(Body25::LeftWrist), of(Body25::Nose)), (0.2, 0.9));
    // Confidences of another frame do not apply to this one.
    perceived.take_action(&Text { data: "Using The Drill".to_owned() }, after(80)).unwrap();
    poses.header.stamp.nanosec += 50_000_000;
    let seen = perceived.take_body(&poses, after(130)).unwrap();
    assert_eq!(seen.body.unwrap().iter().count(), 25, "who is seen counts");
    assert_eq!(seen.action, None, "but the robot works with nobody of unknown confidence");
}

/// A source that tracks people adds their ids. NaN is none.
#[test]
fn ids_follow_the_confidences() {
    let mut poses = body();
    poses.poses.extend_from_within(..);
    poses.poses.extend_from_within(..25);
    let with_ids = |ids: [f64; 3]| {
        let mut message = confidences(&poses, 0.9);
        message.data.extend(ids);
        message
    };
    let mut perceived = Perceived::default();
    perceived.take_confidences(&with_ids([4.0, f64::NAN, 0.0])).unwrap();
    let seen = perceived.take_body(&poses, after(80)).unwrap();
    let ids: Vec<_> = seen.body.iter().chain(&seen.others).map(Body::id).collect();
    assert_eq!(ids, [Some(PersonId::new(4)), None, Some(PersonId::new(0))]);
    assert_eq!(seen.body.unwrap().get(Body25::Nose).unwrap().confidence.value(), 0.9);
    for wrong in [-1.0, 0.5, 1e17, f64::INFINITY] {
        let refused = perceived.take_confidences(&with_ids([4.0, wrong, 0.0])).unwrap_err();
        assert_eq!(refused, Refusal::Id { value: wrong });
    }
}

#[test]
fn confidences_that_are_none_are_refused() {
    let poses = body();
    for (wrong, expected) in [(1.5, "1.5"), (-0.1, "-0.1"), (f64::NAN, "NaN")] {
        let refused = Perceived::default().take_confidences(&confidences(&poses, wrong));
        let text = refused.unwrap_err().to_string();
        assert!(text.contains(&format!("a confidence of {expected}")), "{text}");
    }
    let mut cut = confidences(&poses, 1.0);
    for length in [26, 2, 1, 0] {
        cut.data.truncate(length);
        let refused = Perceived::default().take_confidences(&cut).unwrap_err();
        let expected = Refusal::Size { what: "body confidences", found: length, expected: 27 };
        assert_eq!(refused, expected);
    }
}

#[test]
fn covariances_go_with_the_body_of_their_stamp() {
    let mut poses = body();
    let mut message = confidences(&poses, f64::NAN);
    message.data.truncate(2);
    for joint in 0..poses.poses.len() {
        let variance = if joint == Body25::Nose.index() { f64::NAN } else { 0.01 };
        message.data.extend([variance, 0.001, 0.0, 0.02, 0.0, 0.03]);
    }
    let mut perceived = Perceived::default();
    perceived.take_covariances(&message).unwrap();
    let person = perceived.take_body(&poses, after(80)).unwrap().body.unwrap();
    assert_eq!(person.covariance(Body25::Nose), None, "unknown");
    let covariance = person.covariance(Body25::LeftWrist).unwrap();
    let expected = Matrix3::new(0.01, 0.001, 0.0, 0.001, 0.02, 0.0, 0.0, 0.0, 0.03);
    assert_eq!(covariance, expected);
    poses.header.stamp.nanosec += 50_000_000;
    let later = perceived.take_body(&poses, after(130)).unwrap().body.unwrap();
    assert_eq!(later.covariance(Body25::LeftWrist), None, "those of another frame");
    message.data.pop();
    let cut = perceived.take_covariances(&message).unwrap_err();
    assert_eq!(cut, Refusal::Size { what: "body covariances", found: 151, expected: 152 });
}

#[test]
fn actions_and_surfaces_have_confidences() {
    let (mut perceived, mut poses) = (Perceived::default(), body());
    let text = |data: &str| Text { data: data.to_owned() };
    perceived.take_confidences(&confidences(&poses, 0.9)).unwrap();
    perceived.take_action(&text("Using The Drill 0.83"), after(0)).unwrap();
    perceived.take_surface(&text("drilled 0.75"), after(0)).unwrap();
    let seen = perceived.take_body(&poses, after(80)).unwrap();
    let action = seen.action.map(|seen| (seen.action, seen.confidence.value()));
    assert_eq!(action, Some((Action::Using(Tool::Drill), 0.83)));
    let surface = seen.surface.map(|seen| (seen.surface, seen.confidence.value()));
    assert_eq!(surface, Some((Surface::Drilled, 0.75)));
    for (wrong, says) in [("Using The Drill 1.5", "1.5"), ("Drilling 0.5", "Drilling")] {
        let refused = perceived.take_action(&text(wrong), after(80)).unwrap_err().to_string();
        assert!(refused.contains(says), "{refused}");
    }
    assert!(perceived.take_surface(&text("rough 0.5"), after(80)).is_err());
    // A surface holds for a second, and is 1 without a confidence.
    perceived.take_surface(&text("smooth"), after(80)).unwrap();
    poses.header.stamp.sec += 1;
    let later = perceived.take_body(&poses, after(1050)).unwrap();
    assert_eq!(later.surface.map(|seen| seen.confidence.value()), Some(1.0));
    poses.header.stamp.nanosec += 50_000_000;
    assert_eq!(perceived.take_body(&poses, after(1100)).unwrap().surface, None);
}

#[test]
fn an_action_holds_for_a_second() {
    let (mut perceived, mut poses) = (Perceived::default(), body());
    perceived.take_confidences(&confidences(&poses, 0.9)).unwrap();
    let named = |name: &str| Text { data: name.to_owned() };
    perceived.take_action(&named("Using The Drill"), after(0)).unwrap();
    let unknown = perceived.take_action(&named("drilling"), after(0)).unwrap_err();
    assert!(unknown.to_string().contains("drilling"), "{unknown}");
    let seen = perceived.take_body(&poses, after(900)).unwrap();
    assert_eq!(seen.action.map(|seen| seen.action), Some(Action::Using(Tool::Drill)));
    poses.header.stamp.sec += 1;
    perceived.take_confidences(&confidences(&poses, 0.9)).unwrap();
    let seen = perceived.take_body(&poses, after(1100)).unwrap();
    assert_eq!(seen.action, None);
}
