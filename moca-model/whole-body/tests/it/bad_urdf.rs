//! Texts that are not a URDF, or not of a robot, are errors.

use std::fmt::Write as _;

use proptest::prelude::*;
use whole_body::robot::{JointFriction, LimitOverride, UrdfError};
use whole_body::{Base, Data, Description, Error, Model};

const MOCA: &str = include_str!("../../examples/urdf/moca.urdf");

/// Asserts the variant of an error and parts of its message.
macro_rules! assert_error {
    ($error:expr, $variant:pat $(, $word:expr)*) => {{
        let error = $error;
        let message = error.to_string();
        assert!(matches!(error, $variant), "{message}");
        for word in [$($word.to_string()),*] as [String; count!($($word)*)] {
            assert!(message.contains(&word), "no `{word}` in: {message}");
        }
    }};
}
macro_rules! count {
    () => { 0 };
    ($first:expr $(, $rest:expr)*) => { 1 + count!($($rest),*) };
    ($first:tt $($rest:tt)*) => { 1 + count!($($rest)*) };
}

fn error_of(text: &str) -> Error {
    Model::from_urdf(text, &Description::default()).unwrap_err()
}

#[expect(clippy::needless_pass_by_value, reason = "made for the call")]
fn refused(description: Description) -> Error {
    Model::from_urdf(MOCA, &description).unwrap_err()
}

/// MOCA's URDF with one change, and the line of the change.
fn changed(from: &str, to: &str) -> (String, String) {
    let at = MOCA.find(from).unwrap_or_else(|| panic!("no {from}"));
    let line = MOCA[..at].lines().count().max(1);
    (MOCA.replacen(from, to, 1), format!("line {line}:"))
}

#[test]
fn texts_that_are_no_urdf() {
    assert_error!(error_of(""), Error::Urdf(UrdfError::NotAUrdf { .. }), "line 1", "no element");
    assert_error!(error_of("\n\nhello"), Error::Urdf(UrdfError::NotAUrdf { .. }), "line 3", "text");
    assert_error!(error_of("<sdf/>"), Error::Urdf(UrdfError::NotAUrdf { .. }), "<sdf>", "<robot>");
    assert_error!(error_of("<robot/>"), Error::Urdf(UrdfError::NoLinks { .. }));
    assert_error!(
        error_of("<robot/>\n<robot/>"),
        Error::Urdf(UrdfError::NotAUrdf { .. }),
        "line 2",
        "after"
    );
    assert_error!(
        error_of("<robot>\n<link name=\"a\"></robot>"),
        Error::Urdf(UrdfError::Xml { .. }),
        "line 2"
    );
    assert_error!(
        error_of("<robot>\n<link name=\"a/></robot>"),
        Error::Urdf(UrdfError::Xml { .. }),
        "line 2"
    );
}

#[test]
fn a_urdf_cut_anywhere_is_refused() {
    let whole = include_str!("../golden/bush.urdf").trim_end();
    for cut in 0..whole.len() {
        let error = error_of(&whole[..cut]); // all ASCII
        let expected = matches!(
            error,
            Error::Urdf(
                UrdfError::Truncated { .. } | UrdfError::Xml { .. } | UrdfError::NotAUrdf { .. }
            )
        );
        assert!(expected, "at {cut}: {error}");
    }
    assert_error!(
        error_of(&MOCA[..MOCA.find("<mass").unwrap()]),
        Error::Urdf(UrdfError::Truncated { .. }),
        "<inertial>",
        "cut"
    );
}

#[test]
fn depth_and_length_are_no_matter() {
    let deep = format!(
        "<robot name=\"r\"><link name=\"a\">{}{}</link></robot>",
        "<x>".repeat(13_000),
        "</x>".repeat(13_000)
    );
    assert!(
        Model::from_urdf(&deep, &Description { base: Base::Floating, ..Description::default() })
            .is_ok()
    );
    let unclosed = format!("<robot name=\"r\">{}", "<a b='c'>".repeat(300_000));
    assert_error!(error_of(&unclosed), Error::Urdf(UrdfError::Truncated { .. }));
    let attributes = format!("<robot name=\"r\"><link {}/></robot>", "a='b' ".repeat(200_000));
    assert_error!(error_of(&attributes), Error::Urdf(UrdfError::Missing { .. }), "name");
    let names: String = (0..30_000).fold(String::new(), |mut text, number| {
        writeln!(text, "<link name=\"l{number}\"/>").unwrap();
        text
    });
    assert_error!(
        error_of(&format!("<robot name=\"r\">\n{names}</robot>")),
        Error::Urdf(UrdfError::TwoRoots { .. }),
        "`l0` (line 2)",
        "`l1` (line 3)",
        "root"
    );
}

#[test]
fn a_long_chain_of_fixed_joints_is_read() {
    let joints: String = (1..16_000).fold(String::new(), |mut text, number| {
        let parent = number - 1;
        writeln!(text, "<link name=\"l{number}\"/><joint name=\"f{number}\" type=\"fixed\"><origin xyz=\"0.001 0 0\"/><parent link=\"l{parent}\"/><child link=\"l{number}\"/></joint>").unwrap();
        text
    });
    let description = Description { base: Base::Floating, ..Description::default() };
    let text = format!("<robot name=\"r\"><link name=\"l0\"/>{joints}</robot>");
    let model = Model::from_urdf(&text, &description).unwrap();
    let mut data = Data::new(&model);
    let last = model.frame_id("l15999").unwrap();
    let x = data.pose(&model, &model.neutral()).unwrap().world_from(last).unwrap().translation.x;
    assert!((x - 15.999).abs() < 1e-9);
}

#[test]
fn what_a_robot_does_not_need_is_ignored() {
    let visual = "<visual><geometry><mesh filename=\"package://nowhere/x.dae\"/></geometry><material name=\"\"><texture/></material></visual>";
    let text = MOCA
        .replacen("<link name=\"world\"/>", &format!("<link name=\"world\">{visual}<unknown a=\"1\"><link/></unknown></link><gazebo><plugin name='x'/></gazebo><transmission name=\"t\"/>"), 1);
    let model = Model::from_urdf(&text, &Description::default()).unwrap();
    assert_eq!(
        model.frame_count(),
        Model::from_urdf(MOCA, &Description::default()).unwrap().frame_count()
    );
}

#[test]
fn elements_and_attributes_that_are_missing_or_wrong() {
    for (from, to, words) in [
        ("<parent link=\"panda_link3\"/>", "", ["panda_joint4", "<parent"]),
        ("<parent link=\"panda_link3\"/>", "<parent/>", ["<parent>", "`link`"]),
        ("<child link=\"panda_link4\"/>", "<child/>", ["<child>", "`link`"]),
        ("<mass value=\"0.73\"/>", "", ["panda_hand", "<mass"]),
    ] {
        let (text, _) = changed(from, to);
        assert_error!(
            error_of(&text),
            Error::Urdf(UrdfError::Missing { .. }),
            "line",
            words[0],
            words[1]
        );
    }
    for (from, to, word) in [
        ("<mass value=\"0.73\"/>", "<mass value=\"heavy\"/>", "heavy"),
        ("<mass value=\"0.73\"/>", "<mass value=\"inf\"/>", "inf"),
        ("<mass value=\"0.73\"/>", "<mass/>", "`value` of <mass>"),
        ("<origin xyz=\"0 0 0.333\"/>", "<origin xyz=\"0 0\"/>", "three"),
        ("<origin xyz=\"0 0 0.333\"/>", "<origin xyz=\"0 0 1 2\"/>", "0 0 1 2"),
        ("<origin xyz=\"0 0 0.333\"/>", "<origin xyz=\"0 0 nan\"/>", "nan"),
        ("<origin xyz=\"0 0 0.333\"/>", "<origin xyz=\"0 1e308 0\"/>", "1e308"),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"1e308 0 0\"/>", "1e308"),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 nan 1\"/>", "nan"),
        ("<origin xyz=\"-0.003141 -0.02872 0.003495\"/>", "<origin xyz=\"0 inf 0\"/>", "inf"),
        ("ixx=\"0.001\"", "ixx=\"NaN\"", "`ixx` of <inertia>"),
        ("upper=\"1.7628\"", "upper=\"high\"", "`upper` of <limit>"),
    ] {
        let (text, line) = changed(from, to);
        assert_error!(error_of(&text), Error::Urdf(UrdfError::Attribute { .. }), line, word);
    }
    let (text, line) = changed("<mass value=\"0.735522\"/>", "<mass value=\"-0.735522\"/>");
    let line = line.trim_end_matches(':').trim_start_matches("line ").parse::<usize>().unwrap();
    assert_error!(
        error_of(&text),
        Error::Value { .. },
        "panda_link7",
        format!("line {}:", line - 2),
        "-0.735522; it must be zero or positive [kg]"
    );
    let (text, _) = changed("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>");
    assert_error!(error_of(&text), Error::Urdf(UrdfError::ZeroAxis { .. }), "base_y", "direction");
}

#[test]
fn names_that_are_unknown_or_double() {
    let (text, line) = changed("<link name=\"panda_tcp\"/>", "<link name=\"panda_link8\"/>");
    assert_error!(error_of(&text), Error::DuplicateName { .. }, "link", "panda_link8", line);
    let (text, line) = changed("<joint name=\"base_y\"", "<joint name=\"base_x\"");
    assert_error!(error_of(&text), Error::DuplicateName { .. }, "joint", "base_x", line);
    let (text, _) = changed("<parent link=\"panda_link3\"/>", "<parent link=\"panda_link33\"/>");
    assert_error!(
        error_of(&text),
        Error::UnknownName { .. },
        "line",
        "parent",
        "links are panda_link3,"
    );
    let (text, _) = changed("<mimic joint=\"panda_finger_joint1\"/>", "<mimic joint=\"finger\"/>");
    assert_error!(error_of(&text), Error::UnknownName { .. }, "line", "mimics", "`finger`");
    let limits = vec![("lift".to_owned(), LimitOverride::default())];
    let friction = vec![("lift".to_owned(), JointFriction::PANDA[0])];
    let origins = vec![("lift".to_owned(), nalgebra::Isometry3::identity())];
    let locked = vec![("lift".to_owned(), 0.1)];
    let default = Description::default;
    for description in [
        Description { limits, ..default() },
        Description { friction, ..default() },
        Description { origins, ..default() },
        Description { locked, ..default() },
        Description { joints: vec!["lift".into()], ..default() },
    ] {
        assert_error!(
            refused(description),
            Error::UnknownName { .. },
            "lift",
            "joint",
            "panda_joint1"
        );
    }
    for description in [
        Description { tips: vec!["panda_tpc".into()], ..default() },
        Description { root: Some("panda_tpc".into()), ..default() },
    ] {
        assert_error!(refused(description), Error::UnknownName { .. }, "links are panda_tcp,");
    }
}

#[test]
fn trees_that_are_none() {
    let (text, _) = changed("<child link=\"panda_tcp\"/>", "<child link=\"panda_hand\"/>");
    assert_error!(
        error_of(&text),
        Error::Urdf(UrdfError::TwoParents { .. }),
        "panda_hand",
        "panda_tcp_joint",
        "line"
    );
    // The finger carries the world, which carries the finger.
    let (text, _) = changed("<child link=\"panda_leftfinger\"/>", "<child link=\"world\"/>");
    assert_error!(error_of(&text), Error::Urdf(UrdfError::Loop { .. }), "loop", "tree", "line");
    // Links below a loop are not blamed for it.
    let tail = |parent: &str, child: &str| {
        format!(
            "<link name=\"{child}\"/>\n<joint name=\"{parent}_{child}\" type=\"fixed\"><parent \
             link=\"{parent}\"/><child link=\"{child}\"/></joint>"
        )
    };
    let text = format!(
        "<robot><link name=\"top\"/>{}{}{}</robot>",
        tail("b", "c"),
        tail("a", "b"),
        tail("b", "a")
    );
    let message = error_of(&text).to_string();
    assert!(!message.contains("`c`") && message.contains("line"), "{message}");
    let (text, line) =
        changed("<link name=\"panda_tcp\"/>", "<link name=\"panda_tcp\"/><link name=\"alone\"/>");
    let line = line.trim_end_matches(':').to_owned();
    assert_error!(error_of(&text), Error::Urdf(UrdfError::TwoRoots { .. }), "world", "alone", line);
    let elsewhere = Description {
        root: Some("panda_leftfinger".into()),
        tips: vec!["panda_tcp".into()],
        ..Description::default()
    };
    assert_error!(refused(elsewhere), Error::NoPath { .. }, "panda_leftfinger", "another root");
    let still = Description { root: Some("panda_tcp".into()), ..Description::default() };
    assert_error!(refused(still), Error::NoJoints { .. }, "panda_tcp");
    let (text, _) =
        changed("<mimic joint=\"panda_finger_joint1\"/>", "<mimic joint=\"panda_finger_joint2\"/>");
    assert_error!(
        error_of(&text),
        Error::Urdf(UrdfError::MimicLoop { .. }),
        "panda_finger_joint2",
        "line"
    );
}

#[test]
fn joints_that_cannot_be_moved() {
    for kind in ["floating", "planar", "spherical", "wobbly"] {
        let (text, line) = changed(
            "<joint name=\"panda_joint2\" type=\"revolute\"",
            &format!("<joint name=\"panda_joint2\" type=\"{kind}\""),
        );
        assert_error!(
            error_of(&text),
            Error::Urdf(UrdfError::UnsupportedJoint { .. }),
            "panda_joint2",
            kind,
            line
        );
        // Links below such a joint cannot be placed either, even if no tip needs them.
        let (text, _) = changed(
            "name=\"panda_finger_joint1\" type=\"prismatic\"",
            &format!("name=\"panda_finger_joint1\" type=\"{kind}\""),
        );
        let to_the_tool = Description { tips: vec!["panda_tcp".into()], ..Description::default() };
        let error = Model::from_urdf(&text, &to_the_tool).unwrap_err();
        assert_error!(
            error,
            Error::Urdf(UrdfError::UnsupportedJoint { .. }),
            "panda_finger_joint1",
            kind
        );
    }
    let mut joints: Vec<String> = Model::from_urdf(MOCA, &Description::default())
        .unwrap()
        .joints()
        .iter()
        .map(|joint| joint.name.clone())
        .collect();
    let last = joints.pop().unwrap();
    let short = Description { joints: joints.clone(), ..Description::default() };
    assert_error!(refused(short), Error::JointOrder { .. }, last, "hold");
    joints.push(last);
    joints.swap(0, 1);
    let swapped = Description { joints: joints.clone(), ..Description::default() };
    assert_error!(refused(swapped), Error::JointOrder { .. }, "base_x, base_y", "base_y, base_x");
    let locked =
        Description { locked: vec![("base_x".into(), 0.0)], joints, ..Description::default() };
    assert_error!(refused(locked), Error::LockedAndMoving { .. }, "base_x");
    let planar = Description { base: Base::Planar, ..Description::default() };
    assert_error!(refused(planar), Error::DuplicateName { .. }, "base_x");
}

#[test]
fn limits_that_are_missing_or_contradict() {
    let limit = "<limit lower=\"-1.7628\" upper=\"1.7628\" velocity=\"2.175\" effort=\"87\"/>";
    let (text, _) = changed(limit, "");
    assert_error!(
        error_of(&text),
        Error::Urdf(UrdfError::LimitsMissing { .. }),
        "panda_joint2",
        "<limit",
        "line"
    );
    for (from, to, word) in [
        ("lower=\"-1.7628\"", "lower=\"1.8\"", "1.8"),
        ("lower=\"-1.7628\"", "lower=\"nan\"", "NaN"),
        ("lower=\"-1.7628\" upper=\"1.7628\"", "lower=\"0\" upper=\"0\"", "0"),
    ] {
        let (text, _) = changed(from, to);
        assert_error!(
            error_of(&text),
            Error::Limit { what: "upper", .. },
            "panda_joint2",
            word,
            "above the lower limit",
            "line"
        );
    }
    for (from, to, word) in [
        ("velocity=\"2.175\"", "velocity=\"0\"", "velocity"),
        ("velocity=\"2.175\"", "velocity=\"-1\"", "velocity"),
        ("velocity=\"2.175\"", "velocity=\"nan\"", "NaN"),
        ("effort=\"87\"", "effort=\"-1\"", "effort"),
        ("effort=\"87\"", "effort=\"87\" acceleration=\"0\"", "acceleration"),
        ("effort=\"87\"", "effort=\"87\" jerk=\"-3\"", "jerk"),
    ] {
        let (text, _) = changed(from, to);
        assert_error!(error_of(&text), Error::Limit { .. }, "panda_joint1", word, "line");
    }
    let acceleration = LimitOverride { acceleration: Some(f64::NAN), ..LimitOverride::default() };
    let limits = vec![("panda_joint2".to_owned(), acceleration)];
    assert_error!(
        refused(Description { limits, ..Description::default() }),
        Error::Limit { .. },
        "panda_joint2"
    );
}

#[test]
fn numbers_of_a_description_that_are_none() {
    let mut description = Description::default();
    description.gravity.z = f64::NAN;
    assert_error!(refused(description), Error::Value { .. }, "gravity");
    let locked = vec![("panda_finger_joint1".to_owned(), f64::INFINITY)];
    assert_error!(
        refused(Description { locked, ..Description::default() }),
        Error::Value { .. },
        "panda_finger_joint1"
    );
    let origins =
        vec![("arm_mount".to_owned(), nalgebra::Isometry3::translation(f64::NAN, 0.0, 0.0))];
    assert_error!(
        refused(Description { origins, ..Description::default() }),
        Error::Value { .. },
        "arm_mount"
    );
    let missing_acceleration = whole_body::robot::MissingAcceleration::TimeToFullSpeed(0.0);
    assert_error!(
        refused(Description { missing_acceleration, ..Description::default() }),
        Error::Value { .. },
        "full speed"
    );
}

#[test]
fn errors_of_a_file_name_it() {
    let error = Model::from_urdf_file("/nowhere/robot.urdf", &Description::default()).unwrap_err();
    assert_error!(error, Error::File { .. }, "/nowhere/robot.urdf");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let error = Model::from_urdf_file(path, &Description::default()).unwrap_err();
    assert_error!(error, Error::InFile { .. }, "Cargo.toml: line 1:");
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "\\PC{0,200}") {
        let _ = Model::from_urdf(&text, &Description::default());
    }

    #[test]
    fn damaged_urdfs_never_give_infinite_poses(
        start in 0..MOCA.len(), length in 0_usize..40, noise in "[ -~]{0,12}",
    ) {
        let end = (start + length).min(MOCA.len());
        prop_assume!(MOCA.is_char_boundary(start) && MOCA.is_char_boundary(end));
        let text = [&MOCA[..start], &noise, &MOCA[end..]].concat();
        if let Ok(model) = Model::from_urdf(&text, &Description::default()) {
            let mut data = Data::new(&model);
            let posed = data.pose(&model, &vec![0.5; model.position_count()]).unwrap();
            for (frame, _) in model.frames() {
                let pose = posed.world_from(frame).unwrap();
                prop_assert!(pose.translation.vector.iter().all(|value| value.is_finite()));
                prop_assert!((pose.rotation.norm() - 1.0).abs() < 1e-9);
            }
        }
    }
}
