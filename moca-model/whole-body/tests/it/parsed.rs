//! Models of robots that `urdf-rs` has read are the same robots.

use nalgebra::Matrix6xX;
use proptest::prelude::*;
use whole_body::robot::UrdfError;
use whole_body::{Axes, Data, Error, Model};

use crate::support::robots;

proptest! {
    #[test]
    fn both_readers_give_the_same_robot(robot in robots()) {
        let description = robot.description();
        let ours = Model::from_urdf(&robot.urdf(), &description).unwrap();
        let parsed = urdf_rs::read_from_string(&robot.urdf()).unwrap();
        let theirs = Model::from_parsed(&parsed, &description).unwrap();
        prop_assert_eq!(ours.name(), theirs.name());
        let joints = |model: &Model| -> Vec<_> {
            model.joints().iter().map(|joint| (joint.name.clone(), joint.kind)).collect()
        };
        prop_assert_eq!(joints(&ours), joints(&theirs));
        prop_assert_eq!(ours.limits(), theirs.limits());

        let (mut data, mut other) = (Data::new(&ours), Data::new(&theirs));
        let q = ours.neutral();
        let (mut posed, mut twin) = (data.pose(&ours, &q).unwrap(), other.pose(&theirs, &q).unwrap());
        let n = ours.velocity_count();
        let mut jacobians = [Matrix6xX::zeros(n), Matrix6xX::zeros(n)];
        for piece in 0..robot.pieces.len() {
            let link = format!("link{}", piece + 1);
            let (a, b) = (ours.frame_id(&link).unwrap(), theirs.frame_id(&link).unwrap());
            posed.jacobian_into(a, Axes::World, &mut jacobians[0]).unwrap();
            twin.jacobian_into(b, Axes::World, &mut jacobians[1]).unwrap();
            prop_assert_eq!(&jacobians[0], &jacobians[1]);
        }
        let (mut gravity, mut of_twin) = (vec![0.0; n], vec![0.0; n]);
        posed.gravity_into(&mut gravity).unwrap();
        twin.gravity_into(&mut of_twin).unwrap();
        prop_assert_eq!(gravity, of_twin);
    }
}

#[test]
fn invalid_parsed_robot_is_an_error() {
    let text = r#"<robot name="loop">
      <link name="a"/> <link name="b"/>
      <joint name="j" type="floating"><parent link="a"/><child link="b"/></joint>
    </robot>"#;
    let parsed = urdf_rs::read_from_string(text).unwrap();
    let error = Model::from_parsed(&parsed, &whole_body::Description::default()).unwrap_err();
    assert!(matches!(error, Error::Urdf(UrdfError::UnsupportedJoint { .. })), "{error}");
    assert!(error.to_string().contains("`j`"), "{error}");
}
