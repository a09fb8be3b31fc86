//! Bad input gets an error that names the place and the remedy.

use moca_model::{
    Error, LimitOverride, MOCA_HOME, MOCA_URDF, RobotData, RobotDescription, RobotModel,
    forward_kinematics, gravity, jacobian, world_from_link,
};
use proptest::prelude::*;

/// The error of MOCA's URDF after one replacement, which must find its text.
fn error_with(from: &str, to: &str) -> Error {
    assert!(MOCA_URDF.contains(from), "nothing to replace: {from}");
    RobotModel::from_urdf(&MOCA_URDF.replacen(from, to, 1), &RobotDescription::moca()).unwrap_err()
}

/// The error of MOCA's URDF read with another description.
fn error_of(description: &RobotDescription) -> Error {
    RobotModel::from_urdf(MOCA_URDF, description).unwrap_err()
}

/// Checks the variant, and that the message says all of `said`.
macro_rules! assert_error {
    ($error:expr, $pattern:pat, $($said:expr),+) => {{
        let error = $error;
        assert!(matches!(error, $pattern), "{error:?}");
        let message = error.to_string();
        $(assert!(message.contains($said), "`{}` is not in: {message}", $said);)+
    }};
}

#[test]
fn text_that_is_no_urdf() {
    for text in ["", "robot", "<robot", "<robot name=\"x\"><link/></robot>", "<a/><b/>"] {
        let error = RobotModel::from_urdf(text, &RobotDescription::moca()).unwrap_err();
        assert!(matches!(error, Error::Urdf { .. } | Error::UnknownJoint { .. }), "{error:?}");
    }
    let cut = &MOCA_URDF[..MOCA_URDF.len() / 2];
    let error = RobotModel::from_urdf(cut, &RobotDescription::moca()).unwrap_err();
    assert_error!(error, Error::Urdf { .. }, "cannot be read", "well-formed");
}

#[test]
fn a_missing_joint() {
    let start = MOCA_URDF.find("<joint name=\"panda_joint4\"").unwrap();
    let end = start + MOCA_URDF[start..].find("</joint>").unwrap() + "</joint>".len();
    let text = [&MOCA_URDF[..start], &MOCA_URDF[end..]].concat();
    let error = RobotModel::from_urdf(&text, &RobotDescription::moca()).unwrap_err();
    assert_error!(error, Error::UnknownJoint { .. }, "panda_joint4", "`joints`", "panda_joint5");

    let description =
        RobotDescription { root: Some("world".into()), ..RobotDescription::new("panda_tcp") };
    let error = RobotModel::from_urdf(&text, &description).unwrap_err();
    assert_error!(error, Error::NoPath { .. }, "world", "panda_tcp", "panda_link4", "add the");
}

#[test]
fn names_that_the_urdf_does_not_have() {
    let tool = RobotDescription::new("gripper");
    assert_error!(error_of(&tool), Error::UnknownLink { .. }, "gripper", "the tool", "panda_tcp");
    let root = RobotDescription { root: Some("map".into()), ..RobotDescription::moca() };
    assert_error!(error_of(&root), Error::UnknownLink { .. }, "map", "the root", "world");
    let held = RobotDescription { held: vec![("lift".into(), 0.1)], ..RobotDescription::moca() };
    assert_error!(error_of(&held), Error::UnknownJoint { .. }, "lift", "held");
    let origins = vec![("lift".into(), nalgebra::Isometry3::identity())];
    let origins = RobotDescription { origins, ..RobotDescription::moca() };
    assert_error!(error_of(&origins), Error::UnknownJoint { .. }, "lift", "origins");
    let limits = vec![("lift".into(), LimitOverride::default())];
    let limits = RobotDescription { limits, ..RobotDescription::moca() };
    assert_error!(error_of(&limits), Error::UnknownJoint { .. }, "lift", "limits");
    let error = error_with("<parent link=\"panda_link3\"/>", "<parent link=\"panda_elbow\"/>");
    assert_error!(error, Error::UnknownLink { .. }, "panda_elbow", "parent");
}

#[test]
fn a_tree_that_is_none() {
    let error = error_with("<link name=\"panda_tcp\"/>", "<link name=\"panda_link8\"/>");
    assert_error!(error, Error::DuplicateName { .. }, "link", "panda_link8", "unique");
    let error = error_with("joint name=\"base_y\"", "joint name=\"base_x\"");
    assert_error!(error, Error::DuplicateName { .. }, "joint", "base_x");
    let error = error_with("<child link=\"panda_tcp\"/>", "<child link=\"panda_hand\"/>");
    assert_error!(error, Error::TwoParents { .. }, "panda_hand", "panda_tcp_joint");
    // The finger carries the world, which carries the finger.
    let error = error_with("<child link=\"panda_leftfinger\"/>", "<child link=\"world\"/>");
    assert_error!(error, Error::Loop { .. }, "loop", "tree");
    let elsewhere =
        RobotDescription { root: Some("panda_leftfinger".into()), ..RobotDescription::moca() };
    assert_error!(error_of(&elsewhere), Error::NoPath { .. }, "panda_leftfinger", "another root");
}

#[test]
fn joints_that_cannot_be_part_of_the_chain() {
    for kind in ["floating", "planar"] {
        let to = format!("name=\"panda_joint2\" type=\"{kind}\"");
        let error = error_with("name=\"panda_joint2\" type=\"revolute\"", &to);
        assert_error!(error, Error::UnsupportedJoint { .. }, "panda_joint2", kind, "prismatic");
        // Nor can what hangs on one off the way be placed.
        let to = format!("name=\"panda_finger_joint1\" type=\"{kind}\"");
        let error = error_with("name=\"panda_finger_joint1\" type=\"prismatic\"", &to);
        assert_error!(error, Error::UnsupportedJoint { .. }, "panda_finger_joint1", kind);
    }
    let finger = RobotDescription::new("panda_rightfinger");
    assert_error!(error_of(&finger), Error::UnsupportedJoint { .. }, "finger_joint2", "mimic");
    let fixed =
        RobotDescription { root: Some("panda_link7".into()), ..RobotDescription::new("panda_tcp") };
    assert_error!(error_of(&fixed), Error::NoJoints { .. }, "panda_link7", "panda_tcp");
}

#[test]
fn joints_listed_otherwise_than_they_are() {
    let mut swapped = RobotDescription::moca();
    swapped.joints.swap(0, 1);
    assert_error!(error_of(&swapped), Error::JointOrder { .. }, "base_x, base_y", "base_y, base_x");
    let mut short = RobotDescription::moca();
    short.joints.pop();
    assert_error!(error_of(&short), Error::JointOrder { .. }, "panda_joint7", "hold");
    let mut held = RobotDescription::moca();
    held.held.push(("panda_joint3".into(), 0.0));
    assert_error!(error_of(&held), Error::HeldAndMoving { .. }, "panda_joint3");
}

#[test]
fn an_axis_without_direction() {
    let error = error_with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>");
    assert_error!(error, Error::ZeroAxis { .. }, "base_y", "direction");
    let error = error_with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 nan 0\"/>");
    assert_error!(error, Error::NotFinite { .. }, "axis", "base_y", "NaN");
}

#[test]
fn numbers_that_are_none() {
    let cases = [
        (
            "<origin xyz=\"0 0 0.333\"/>",
            "<origin xyz=\"0 0 nan\"/>",
            "origin of joint `panda_joint1`",
        ),
        ("<mass value=\"0.73\"/>", "<mass value=\"inf\"/>", "mass of link `panda_hand`"),
        ("xyz=\"-0.01 0 0.03\"", "xyz=\"-0.01 0 -inf\"", "inertia of link `panda_hand`"),
        ("ixx=\"0.001\"", "ixx=\"NaN\"", "inertia of link `panda_hand`"),
    ];
    for (from, to, place) in cases {
        assert_error!(error_with(from, to), Error::NotFinite { .. }, place, "finite");
    }
    let error = error_with("<mass value=\"0.73\"/>", "<mass value=\"heavy\"/>");
    assert_error!(error, Error::Urdf { .. }, "read");

    let mut description = RobotDescription::moca();
    description.gravity.z = f64::NAN;
    assert_error!(error_of(&description), Error::NotFinite { .. }, "gravity");
    let held = vec![("panda_finger_joint1".into(), f64::INFINITY)];
    let description = RobotDescription { held, ..RobotDescription::moca() };
    assert_error!(error_of(&description), Error::NotFinite { .. }, "panda_finger_joint1");
    let mount = nalgebra::Isometry3::translation(f64::NAN, 0.0, 0.0);
    let description = RobotDescription::moca().with_arm_mount(mount);
    assert_error!(error_of(&description), Error::NotFinite { .. }, "arm_mount");
}

#[test]
fn a_negative_mass() {
    let error = error_with("<mass value=\"0.735522\"/>", "<mass value=\"-0.735522\"/>");
    assert_error!(error, Error::NegativeMass { .. }, "panda_link7", "-0.735522 kg");
}

#[test]
fn limits_that_are_missing_or_contradict() {
    let limit = "<limit lower=\"-1.7628\" upper=\"1.7628\" velocity=\"2.175\" effort=\"87\"/>";
    assert_error!(error_with(limit, ""), Error::LimitsMissing { .. }, "panda_joint2", "<limit");
    let error = error_with("lower=\"-1.7628\"", "lower=\"1.8\"");
    assert_error!(error, Error::PositionLimits { .. }, "panda_joint2", "1.8", "1.7628", "below");
    let error = error_with("lower=\"-1.7628\"", "lower=\"nan\"");
    assert_error!(error, Error::PositionLimits { .. }, "panda_joint2", "NaN");
    let error = error_with("velocity=\"2.175\"", "velocity=\"0\"");
    assert_error!(error, Error::NotPositive { .. }, "velocity", "panda_joint1");
    let error = error_with("effort=\"87\"", "effort=\"-1\"");
    assert_error!(error, Error::Negative { .. }, "effort", "panda_joint1");
    let mut description = RobotDescription::moca();
    description.limits[4].1.acceleration = Some(f64::NAN);
    assert_error!(
        error_of(&description),
        Error::NotPositive { .. },
        "acceleration",
        "panda_joint2"
    );
}

#[test]
fn limits_missing_in_the_urdf_may_come_from_the_description() {
    let limit = "<limit lower=\"-1.7628\" upper=\"1.7628\" velocity=\"2.175\" effort=\"87\"/>";
    let mut description = RobotDescription::moca();
    description.limits[4].1 = LimitOverride {
        position: Some((-1.0, 1.0)),
        velocity: Some(2.0),
        effort: Some(50.0),
        ..LimitOverride::default()
    };
    let model = RobotModel::from_urdf(&MOCA_URDF.replacen(limit, "", 1), &description).unwrap();
    assert_eq!((model.limits()[4].lower, model.limits()[4].effort), (-1.0, 50.0));
}

#[test]
fn configurations_that_are_none() {
    let model = RobotModel::moca().unwrap();
    let mut data = RobotData::new(&model);
    forward_kinematics(&model, &mut data, &MOCA_HOME).unwrap();
    let before = *data.world_from_tool();

    let error = forward_kinematics(&model, &mut data, &MOCA_HOME[1..]).unwrap_err();
    assert_error!(error, Error::WrongSize { .. }, "q", "9", "10");
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut q = MOCA_HOME;
        q[6] = bad;
        let error = forward_kinematics(&model, &mut data, &q).unwrap_err();
        assert_error!(error, Error::NotFinite { .. }, "panda_joint4", "finite");
    }
    assert_eq!(before, *data.world_from_tool());
}

#[test]
fn data_and_links_of_another_robot() {
    let moca = RobotModel::moca().unwrap();
    let description = RobotDescription {
        root: Some("panda_link0".into()),
        ..RobotDescription::new("panda_link8")
    };
    let arm = RobotModel::from_urdf(MOCA_URDF, &description).unwrap();
    let mut data = RobotData::new(&arm);
    for error in [
        forward_kinematics(&moca, &mut data, &MOCA_HOME).unwrap_err(),
        jacobian(&moca, &mut data).unwrap_err(),
        gravity(&moca, &mut data).unwrap_err(),
    ] {
        assert_error!(error, Error::ForeignData { .. }, "7", "10", "RobotData::new");
    }
    let last = moca.links().last().unwrap().0;
    let error = world_from_link(&arm, &data, last).unwrap_err();
    assert_error!(error, Error::ForeignLink { .. }, "this model's");
    assert_error!(arm.link("world").unwrap_err(), Error::UnknownLink { .. }, "world");
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "\\PC{0,200}") {
        let _ = RobotModel::from_urdf(&text, &RobotDescription::moca());
    }

    #[test]
    fn no_damage_to_a_urdf_makes_the_reader_panic(
        start in 0..MOCA_URDF.len(), length in 0_usize..40, noise in "[ -~]{0,12}",
    ) {
        let end = (start + length).min(MOCA_URDF.len());
        let text = [&MOCA_URDF[..start], &noise, &MOCA_URDF[end..]].concat(); // all ASCII
        if let Ok(model) = RobotModel::from_urdf(&text, &RobotDescription::moca()) {
            let mut data = RobotData::new(&model);
            forward_kinematics(&model, &mut data, &MOCA_HOME).unwrap();
            let pose = data.world_from_tool();
            prop_assert!(pose.translation.vector.iter().all(|value| value.is_finite()));
        }
    }
}
