//! JSON of joints: every program's, several people, and what is refused.

use proptest::prelude::*;
use vision_models::{Body25, Error, ImageBody, JointFrame, JointLayout, MetricBody};

/// A file of one person with the numbers of each joint.
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

/// The people in the only image of a file.
fn people(text: &str) -> Vec<ImageBody> {
    let mut frames = JointFrame::from_json(text.as_bytes(), None).unwrap();
    assert_eq!(frames.len(), 1);
    frames.remove(0).people.into_iter().map(|person| person.image).collect()
}

fn problem(text: &str) -> String {
    match JointFrame::from_json(text.as_bytes(), None) {
        Err(error @ Error::Malformed { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn body_25_keeps_order_and_zeros_are_unseen() {
    let mut joints = counted(25);
    joints[4] = [0.0, 0.0, 0.0];
    let found = people(&file(&[joints]));
    for joint in Body25::ALL {
        let seen = found[0].get(joint).map(|keypoint| keypoint.position.x);
        let expected = (joint != Body25::RightWrist).then_some(joint.index() as f64);
        assert_eq!(seen, expected);
    }
}

#[test]
fn coco_18_is_recognised_by_its_joint_count() {
    let found = people(&file(&[counted(18), counted(18)]));
    assert_eq!(found.len(), 2);
    let x = |joint| found[1].get(joint).unwrap().position.x;
    assert_eq!(x(Body25::LeftAnkle), 13.0);
    assert_eq!(x(Body25::MidHip), 9.5);
    assert_eq!(found[1].get(Body25::LeftHeel), None);
}

/// Every layout that a number of joints tells comes out with its joints in their places.
#[test]
fn a_layout_is_told_by_its_number() {
    for layout in JointLayout::all() {
        if layout.count() == Body25::COUNT {
            continue;
        }
        let found = people(&file(&[counted(layout.count())]));
        for (joint, place) in layout.joints() {
            let x = found[0].get(joint).map(|seen| seen.position.x);
            assert_eq!(
                x,
                (place > 0 || joint != Body25::Nose).then_some(place as f64).or(Some(0.0))
            );
        }
        assert!(layout.derived().all(|middle| found[0].is_derived(middle.joint)));
    }
}

/// A film as mmpose's demo writes it: nobody in its second image.
fn film_of_mmpose() -> String {
    let person = |shift: f64| {
        let places: Vec<_> = (0..26).map(|joint| [f64::from(joint) + shift, 7.0]).collect();
        let scores = vec![1.2; 26];
        serde_json::json!({ "keypoints": places, "keypoint_scores": scores, "bbox_score": 0.9 })
    };
    let people = [vec![person(0.0), person(50.0)], vec![], vec![person(100.0)]];
    let frames: Vec<_> = people
        .iter()
        .enumerate()
        .map(|(index, people)| serde_json::json!({ "frame_id": index + 1, "instances": people }))
        .collect();
    serde_json::json!({ "meta_info": { "dataset_name": "halpe26" }, "instance_info": frames })
        .to_string()
}

#[test]
fn mmposes_film_keeps_its_numbers() {
    let frames = JointFrame::from_json(film_of_mmpose().as_bytes(), None).unwrap();
    let numbers: Vec<_> = frames.iter().map(|frame| (frame.number, frame.people.len())).collect();
    assert_eq!(numbers, [(1, 2), (3, 1)]);
    let neck = frames[1].people[0].image.get(Body25::Neck).unwrap();
    assert_eq!((neck.position.x, neck.confidence.value()), (118.0, 1.0));
    let image: serde_json::Value = serde_json::from_str(&film_of_mmpose()).unwrap();
    let image = image["instance_info"][0]["instances"].to_string();
    assert_eq!(people(&image).len(), 2);
    let short = film_of_mmpose().replacen("1.2,", "", 1);
    assert!(problem(&short).contains("\"keypoints\" of 26 places and 25 scores"));
    let flat = film_of_mmpose().replacen("[0.0,7.0]", "[7.0]", 1);
    assert!(problem(&flat).contains("no pair as keypoint 0"));
}

/// Results of COCO's form, as AlphaPose writes them, whose images have names.
fn results_of_coco() -> String {
    let person = |image: &str| serde_json::json!({ "image_id": image, "category_id": 1, "keypoints": counted(17).concat(), "score": 2.9 });
    serde_json::json!([person("10.jpg"), person("film_2.jpg"), person("10.jpg")]).to_string()
}

#[test]
fn results_are_put_together_by_their_image() {
    let frames = JointFrame::from_json(results_of_coco().as_bytes(), None).unwrap();
    let numbers: Vec<_> = frames.iter().map(|frame| (frame.number, frame.people.len())).collect();
    assert_eq!(numbers, [(2, 1), (10, 2)]);
    assert!(
        problem(&results_of_coco().replace("film_2", "film")).contains("as the number of an image")
    );
}

/// Landmarks as MediaPipe's messages give them: 1/2 of the image along x, each 1/100 farther down.
fn landmarks(scale: f64) -> Vec<serde_json::Value> {
    let landmark = |index| {
        let y = scale * 0.01 * f64::from(index);
        serde_json::json!({ "x": 0.5 * scale, "y": y, "z": -0.25, "visibility": 0.75, "presence": 0.5 })
    };
    (0..33).map(landmark).collect()
}

fn film_of_mediapipe() -> String {
    let frame = |image, world| serde_json::json!({ "landmarks": image, "worldLandmarks": world });
    let whole = frame(vec![landmarks(1.0)], vec![landmarks(2.0)]);
    serde_json::json!([whole, frame(vec![], vec![]), whole]).to_string()
}

#[test]
fn mediapipes_landmarks_are_of_the_image_and_metric() {
    let size = Some([640, 480]);
    let frames = JointFrame::from_json(film_of_mediapipe().as_bytes(), size).unwrap();
    assert_eq!(frames.iter().map(|frame| frame.number).collect::<Vec<_>>(), [0, 2]);
    let person = &frames[0].people[0];
    let shoulder = person.image.get(Body25::LeftShoulder).unwrap();
    assert_eq!(shoulder.position, nalgebra::point![320.0, 0.11 * 480.0]);
    assert_eq!(shoulder.confidence.value(), 0.5);
    let metric = person.metric.as_ref().unwrap();
    assert_eq!(metric.get(Body25::LeftShoulder), Some(nalgebra::point![1.0, 0.22, -0.25]));
    let neck = metric.get(Body25::Neck).unwrap();
    assert!((neck - nalgebra::point![1.0, 0.23, -0.25]).norm() < 1e-12);
    assert_eq!(metric.get(Body25::LeftSmallToe), None);

    // The other ways in which people write one person down.
    let marks = serde_json::Value::from(landmarks(1.0));
    let numbers: Vec<_> = landmarks(1.0)
        .iter()
        .map(|mark| {
            serde_json::json!([
                mark["x"],
                mark["y"],
                mark["z"],
                mark["visibility"],
                mark["presence"]
            ])
        })
        .collect();
    for text in [
        serde_json::json!({ "landmark": marks }),
        serde_json::json!({ "poseLandmarks": marks }),
        serde_json::json!({ "pose_landmarks": [marks] }),
        serde_json::json!({ "pose_landmarks": { "landmark": marks } }),
        marks.clone(),
        serde_json::Value::from(numbers.clone()),
        serde_json::json!([marks]),
        serde_json::json!([[numbers]]),
        serde_json::json!([{ "frame": 0, "landmarks": marks }]),
    ] {
        let frames = JointFrame::from_json(text.to_string().as_bytes(), size).unwrap();
        assert_eq!(frames[0].people[0].image, person.image, "{text}");
    }
    assert!(problem(&film_of_mediapipe()).contains("give its size"));
    let short = serde_json::json!({ "landmark": landmarks(1.0)[..32] }).to_string();
    assert!(problem(&short).contains("32 landmarks of a person, not 33"));
}

#[test]
fn nobody_is_nobody() {
    assert_eq!(people(&file(&[])), Vec::new());
}

#[test]
fn other_models_and_other_files_are_named() {
    assert!(problem(&file(&[counted(25), counted(16)])).contains("person 1"));
    assert!(
        problem(&file(&[counted(3)])).contains("person 0 (from 0) has 3 joints: BODY_25 has 25")
    );
    assert!(problem("{}").contains("an object without joints; give"));
    assert!(problem("[1, 2]").contains("1 as element 0; give OpenPose's"));
    assert!(problem("{\"people\":[{}]}").contains("no array \"pose_keypoints_2d\""));
    assert!(problem("{\"people\":[").contains("EOF"));
    assert!(problem(&file(&[counted(140)])).contains("140 joints"));
    let text = file(&[counted(25)]).replacen("0.5", "0.5,1", 1);
    assert!(problem(&text).contains("76 numbers, which are no x, y, confidence"));
    let mut joints = counted(25);
    joints[7] = [1e9, 3.0, 0.5];
    assert!(problem(&file(std::slice::from_ref(&joints))).contains("keypoint 7"));
    joints[7] = [1.0, 3.0, -0.5];
    assert!(problem(&file(&[joints])).contains("1.0, 3.0, -0.5 as keypoint 7"));
    let text = file(&[counted(25)]).replacen("0.5", "null", 1);
    assert!(problem(&text).contains("null as keypoint 0"));
    assert!(problem(&file(&vec![counted(18); 65])).contains("65 people"));
}

/// BODY_25B has as many joints as BODY_25, and the eyes where that has the neck.
#[test]
fn body_25b_is_recognised_by_neck_and_hip() {
    let whole = include_str!("../data/body_25b.json");
    let found = people(whole);
    let x = |joint| found[0].get(joint).map(|keypoint| keypoint.position.x);
    // The names of the joints are those that the file was made with.
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
    // The same person of BODY_25 stays as it is, seen from before, from the side and lying.
    let standing: Vec<[f64; 3]> = Body25::ALL
        .into_iter()
        .map(|joint| {
            let place = found[0].get(joint).unwrap().position;
            [place.x, place.y, 0.9]
        })
        .collect();
    for turn in [
        |[x, y, c]: [f64; 3]| [x, y, c],
        |[x, y, c]: [f64; 3]| [320.0 + 0.1 * (x - 320.0), y, c],
        |[x, y, c]: [f64; 3]| [y, x, c],
    ] {
        let joints: Vec<_> = standing.iter().copied().map(turn).collect();
        let body = &people(&file(std::slice::from_ref(&joints)))[0];
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
    // Two joints in the corner are none.
    let mut corner = vec![[0.0; 3]; 25];
    (corner[0], corner[1]) = ([0.5, 0.5, 0.9], [0.7, 0.9, 0.9]);
    assert_eq!(people(&file(&[corner])).len(), 1);
}

/// However many people, numbers or brackets a file has, it takes five times its size and 64 KiB at most.
#[test]
fn a_file_of_nothing_useful_stays_small() {
    let many = "0,".repeat(2 << 20);
    let deep = "[".repeat(1 << 20) + &"]".repeat(1 << 20);
    for (text, says) in [
        (format!("{{\"people\":[{many}0]}}"), "2097153 people"),
        (format!("{{\"people\":[{{\"pose_keypoints_2d\":[{many}0]}}]}}"), "2097153 numbers"),
        (format!("{{\"people\":[{{\"pose_keypoints_2d\":[{deep}]}}]}}"), "1 numbers, which"),
        (format!("{{\"people\":[{many}0],\"people\":[]}}"), "duplicate field"),
        (format!("{{\"x\":[{many}0],\"people\":{{}}}}"), "expected an array"),
        (format!("{{\"people\":\"{many}\"}}"), "invalid type: string"),
        (format!("[{many}0]"), "0 as element 0"),
        (format!("[[{many}0]]"), "landmarks of a person"),
    ] {
        let refused = || assert!(problem(&text).contains(says), "{}", problem(&text));
        let held = allocation_counter::measure(refused).bytes_max;
        assert!(held < 5 * text.len() as u64 + (64 << 10), "{held} bytes, {says}");
    }
}

proptest! {
    /// Whatever a file holds, nothing panics, and what is read is finite.
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}", at in 0..900_usize, byte: u8) {
        let size = Some([640, 480]);
        let _ = JointFrame::from_json(text.as_bytes(), size);
        for whole in [file(&[counted(25)]), film_of_mmpose(), results_of_coco(), film_of_mediapipe()] {
            let mut bytes = whole.into_bytes();
            let at = at % bytes.len();
            bytes[at] = byte;
            let frames = JointFrame::from_json(&bytes, size).unwrap_or_default();
            for person in frames.into_iter().flat_map(|frame| frame.people) {
                for (_, seen) in person.image.iter() {
                    prop_assert!(seen.position.iter().all(|x| x.is_finite()));
                }
                for (_, place) in person.metric.iter().flat_map(MetricBody::iter) {
                    prop_assert!(place.iter().all(|x| x.is_finite()));
                }
            }
        }
    }
}
