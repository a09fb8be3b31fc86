//! OpenPose's JSON: the models, several people, and rejected files.

use proptest::prelude::*;
use vision_models::{Body25, Error, ImageBody};

/// Returns a file of people with the numbers of each joint.
fn file(people: &[Vec<[f64; 3]>]) -> String {
    let people: Vec<_> = people
        .iter()
        .map(
            |joints| serde_json::json!({ "person_id": [-1], "pose_keypoints_2d": joints.concat() }),
        )
        .collect();
    serde_json::json!({ "version": 1.3, "people": people }).to_string()
}

fn counted(joints: usize) -> Vec<[f64; 3]> {
    (0..joints).map(|joint| [joint as f64, 2.0 * joint as f64, 0.5]).collect()
}

fn problem(text: &str) -> String {
    match ImageBody::from_openpose(text.as_bytes()) {
        Err(error @ Error::Malformed { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn body_25_keeps_order_and_zeros_are_unseen() {
    let mut joints = counted(25);
    joints[4] = [0.0, 0.0, 0.0];
    let people = ImageBody::from_openpose(file(&[joints]).as_bytes()).unwrap();
    for joint in Body25::ALL {
        let seen = people[0].get(joint).map(|keypoint| keypoint.position.x);
        let expected = (joint != Body25::RightWrist).then_some(joint.index() as f64);
        assert_eq!(seen, expected);
    }
}

#[test]
fn coco_18_is_recognised_by_its_joint_count() {
    let people = ImageBody::from_openpose(file(&[counted(18), counted(18)]).as_bytes()).unwrap();
    assert_eq!(people.len(), 2);
    let x = |joint| people[1].get(joint).unwrap().position.x;
    assert_eq!(x(Body25::LeftAnkle), 13.0);
    assert_eq!(x(Body25::MidHip), 9.5);
    assert_eq!(people[1].get(Body25::LeftHeel), None);
}

#[test]
fn files_without_people_give_none() {
    assert_eq!(ImageBody::from_openpose(file(&[]).as_bytes()), Ok(Vec::new()));
}

#[test]
fn other_models_and_other_files_are_named() {
    assert!(
        problem(&file(&[counted(15)]))
            .contains("person 0 (from 0) has 45 numbers, the 15 joints of MPI")
    );
    assert!(problem(&file(&[counted(25), counted(17)])).contains("person 1"));
    assert!(problem(&file(&[counted(3)])).contains("9 numbers; give"));
    assert!(problem("{}").contains("missing field `people`"));
    assert!(problem("[1, 2]").contains("BODY_25"));
    assert!(problem("{\"people\":[{}]}").contains("no array \"pose_keypoints_2d\""));
    assert!(problem("{\"people\":[").contains("EOF"));
    let mut joints = counted(25);
    joints[7] = [1e9, 3.0, 0.5];
    assert!(problem(&file(std::slice::from_ref(&joints))).contains("keypoint 7"));
    joints[7] = [1.0, 3.0, -0.5];
    assert!(problem(&file(&[joints])).contains("1.0, 3.0, -0.5 as keypoint 7"));
    let text = file(&[counted(25)]).replacen("0.5", "null", 1);
    assert!(problem(&text).contains("null as keypoint 0"));
    assert!(problem(&file(&vec![counted(18); 65])).contains("65 people"));
}

/// BODY_25B has as many joints as BODY_25, and the eyes where BODY_25 has the neck.
#[test]
fn body_25b_is_recognised_by_neck_and_hip() {
    let whole = include_str!("../data/body_25b.json");
    let people = ImageBody::from_openpose(whole.as_bytes()).unwrap();
    let x = |joint| people[0].get(joint).map(|keypoint| keypoint.position.x);
    // The names of the joints, as the file was made.
    for (joint, expected) in [
        (Body25::Nose, 320.0),
        (Body25::LeftEye, 328.0),
        (Body25::RightEar, 302.0),
        (Body25::LeftShoulder, 355.0),
        (Body25::RightShoulder, 285.0),
        (Body25::Neck, 320.0),
        (Body25::RightWrist, 265.0),
        (Body25::LeftHip, 342.0),
        (Body25::MidHip, 320.0),
        (Body25::RightAnkle, 294.0),
        (Body25::LeftBigToe, 352.0),
    ] {
        assert_eq!(x(joint), Some(expected), "{joint:?}");
    }
    // The same person in BODY_25 keeps this order, seen from the front, from the side and lying.
    let standing: Vec<[f64; 3]> = Body25::ALL
        .into_iter()
        .map(|joint| {
            let place = people[0].get(joint).unwrap().position;
            [place.x, place.y, 0.9]
        })
        .collect();
    for turn in [
        |[x, y, c]: [f64; 3]| [x, y, c],
        |[x, y, c]: [f64; 3]| [320.0 + 0.1 * (x - 320.0), y, c],
        |[x, y, c]: [f64; 3]| [y, x, c],
    ] {
        let joints: Vec<_> = standing.iter().copied().map(turn).collect();
        let body =
            &ImageBody::from_openpose(file(std::slice::from_ref(&joints)).as_bytes()).unwrap()[0];
        for joint in Body25::ALL {
            assert_eq!(body.get(joint).unwrap().position.x, joints[joint.index()][0]);
        }
    }
}

#[test]
fn scaled_joints_are_refused_with_advice() {
    for (scale, shift) in [(1.0 / 640.0, 0.0), (2.0 / 640.0, -1.0)] {
        let scaled = |[x, y, c]: [f64; 3]| [scale * x + shift, scale * y + shift, c];
        let joints: Vec<_> = counted(25)
            .into_iter()
            .map(|[x, y, c]| scaled([10.0 * x + 1.0, 9.0 * y + 1.0, c]))
            .collect();
        let problem = problem(&file(&[joints]));
        assert!(problem.contains("--keypoint_scale 0"), "{problem}");
    }
    // Two joints in the corner are not taken for scaled ones.
    let mut corner = vec![[0.0; 3]; 25];
    (corner[0], corner[1]) = ([0.5, 0.5, 0.9], [0.7, 0.9, 0.9]);
    assert!(ImageBody::from_openpose(file(&[corner]).as_bytes()).is_ok());
}

/// A file takes at most five times its size and 64 KiB, however many people, numbers or brackets it
/// has.
#[test]
fn a_file_of_nothing_useful_stays_small() {
    let many = "0,".repeat(2 << 20);
    let deep = "[".repeat(1 << 20) + &"]".repeat(1 << 20);
    for (text, says) in [
        (format!("{{\"people\":[{many}0]}}"), "2097153 people"),
        (format!("{{\"people\":[{{\"pose_keypoints_2d\":[{many}0]}}]}}"), "2097153 numbers"),
        (format!("{{\"people\":[{{\"pose_keypoints_2d\":[{deep}]}}]}}"), "1 numbers"),
        (format!("{{\"people\":[{many}0],\"people\":[]}}"), "duplicate field"),
        (format!("{{\"x\":[{many}0],\"people\":{{}}}}"), "expected an array"),
        (format!("{{\"people\":\"{many}\"}}"), "invalid type: string"),
    ] {
        let refused = || assert!(problem(&text).contains(says), "{}", problem(&text));
        let held = allocation_counter::measure(refused).bytes_max;
        assert!(held < 5 * text.len() as u64 + (64 << 10), "{held} bytes, {says}");
    }
}

proptest! {
    /// Any file is read without a panic, and the result is finite.
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}", at in 0..900_usize, byte: u8) {
        let _ = ImageBody::from_openpose(text.as_bytes());
        let mut bytes = file(&[counted(25)]).into_bytes();
        let at = at % bytes.len();
        bytes[at] = byte;
        for body in ImageBody::from_openpose(&bytes).unwrap_or_default() {
            prop_assert!(body.iter().all(|(_, seen)| seen.position.iter().all(|x| x.is_finite())));
        }
    }
}
