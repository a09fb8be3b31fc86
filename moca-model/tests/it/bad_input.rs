//! Bad input gives an error that names the place and the remedy.
//!
//! Errors of URDFs, descriptions, configurations and foreign ids are tested in `whole-body`, which refuses them.

use ergo_map::ErgonomicsQuadratic;
use hrsw_safety::Capsule;
use hrsw_safety::LinkCapsule;
use moca_model::whole_body::{self, Base, Description, Model};
use moca_model::{
    Controller, ControllerSettings, Error, Kinematics, MOCA_HOME, MOCA_TOOL, MOCA_URDF,
    SimulatedRobot, moca_description, moca_safety,
};
use nalgebra::{Matrix3, Vector3};

use crate::shared::MOCA;

/// Checks the variant, and that the message contains all of `said`.
macro_rules! assert_error {
    ($error:expr, $pattern:pat, $($said:expr),+) => {{
        let error = $error;
        assert!(matches!(error, $pattern), "{error:?}");
        let message = error.to_string();
        $(assert!(message.contains($said), "`{}` is not in: {message}", $said);)+
    }};
}

fn ball(link: &str) -> LinkCapsule {
    let capsule = Capsule::sphere(Vector3::zeros(), 0.1).unwrap();
    LinkCapsule { link: link.to_owned(), capsule }
}

fn refused(model: &Model, tool: &str, bodies: &[LinkCapsule]) -> Error {
    let q = vec![0.0; model.position_count()];
    Kinematics::new(model.clone(), tool, bodies, &q).unwrap_err()
}

#[test]
fn unknown_tools_and_bodies_are_named() {
    let error = refused(&MOCA, "gripper", &[]);
    assert_error!(error, Error::Robot(whole_body::Error::UnknownName { .. }), "gripper");
    let error = refused(&MOCA, MOCA_TOOL, &[ball("panda_hand"), ball("tail")]);
    assert_error!(error, Error::Robot(whole_body::Error::UnknownName { .. }), "tail");
    let ergonomics =
        ergo_map::ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let settings = ControllerSettings { tool: "panda_tpc".into(), ..ControllerSettings::default() };
    let error = Controller::new(MOCA.clone(), ergonomics, settings, &MOCA_HOME).unwrap_err();
    assert_error!(
        error,
        Error::Robot(whole_body::Error::UnknownName { .. }),
        "`panda_tpc`",
        "panda_tcp"
    );
}

#[test]
fn bodies_of_which_the_tools_jacobian_says_nothing() {
    let read = |description: Description| Model::from_urdf(MOCA_URDF, &description).unwrap();
    // The finger moves on its own.
    let fingers = read(Description { tips: vec![], joints: vec![], ..moca_description() });
    let error = refused(&fingers, MOCA_TOOL, &[ball("panda_hand"), ball("panda_leftfinger")]);
    assert_error!(error, Error::BodyBesideTheWay { .. }, "panda_leftfinger", MOCA_TOOL, "hold");
    // The elbow is the tool. Links behind it move by joints that do not move it.
    let error = refused(&MOCA, "panda_link4", &[ball("panda_link4"), ball("panda_link5")]);
    assert_error!(error, Error::BodyBesideTheWay { .. }, "panda_link5", "panda_link4");
    // One joint moves two fingers, but the Jacobian of one is not that of the other.
    let error = refused(&fingers, "panda_rightfinger", &[ball("panda_leftfinger")]);
    assert_error!(error, Error::BodyBesideTheWay { .. }, "panda_leftfinger");
}

#[test]
fn floating_bases() {
    let root = Some("base_link".to_owned());
    let description = Description { base: Base::Floating, root, ..Description::default() };
    let model = Model::from_urdf(MOCA_URDF, &description).unwrap();
    assert_error!(refused(&model, MOCA_TOOL, &[]), Error::FloatingBase { .. }, "moca", "planar");
    let error = SimulatedRobot::new(&model, &model.neutral()).unwrap_err();
    assert_error!(error, Error::FloatingBase { .. }, "moca");
}

#[test]
fn configurations_that_are_none() {
    let mut robot =
        Kinematics::new(MOCA.clone(), MOCA_TOOL, &[ball("panda_hand")], &MOCA_HOME).unwrap();
    let before = robot.clone();
    let error = robot.update(&MOCA_HOME[1..]).unwrap_err();
    assert_error!(error, Error::Robot(whole_body::Error::Size { .. }), "q", "9", "10");
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
        let mut q = MOCA_HOME;
        q[6] = bad;
        let error = robot.update(&q).unwrap_err();
        assert_error!(
            error,
            Error::Robot(whole_body::Error::Value { .. }),
            "panda_joint4",
            "finite"
        );
        assert!(!MOCA.is_configuration(&q));
    }
    assert_eq!(robot.world_from_tool(), before.world_from_tool());
    assert_eq!(robot.jacobian(), before.jacobian());
    assert_eq!(robot.bodies(), before.bodies());
}

#[test]
fn invalid_space_and_following_error_are_named() {
    let model = MOCA.clone();
    let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0).unwrap();
    let mut named = Vec::new();
    let mut check = |change: &dyn Fn(&mut ControllerSettings), name: &'static str| {
        let mut settings =
            ControllerSettings { safety: moca_safety().off(), ..ControllerSettings::default() };
        change(&mut settings);
        let error = Controller::new(model.clone(), ergonomics, settings, &MOCA_HOME).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        named.push(name);
    };
    check(&|s| s.following_error.prismatic = 0.0, "following_error.prismatic");
    check(&|s| s.following_error.revolute = f64::INFINITY, "following_error.revolute");
    check(&|s| s.space.lead = -0.1, "space.lead");
    check(&|s| s.space.margin = -1e-3, "space.margin");
    check(&|s| s.space.margin = f64::NAN, "space.margin");
    check(&|s| s.space.turn.y = 0.01, "space.margin");
    assert_eq!(named.len(), 6);
}
