//! States, sizes and ids that do not fit are errors.

use nalgebra::{DMatrix, IsometryMatrix3, Matrix3, Matrix3xX, Matrix6xX, Point3, Vector3, Vector6};
use whole_body::state::{ExternalWrench, Payload};
use whole_body::{Axes, Base, Data, Description, Error, JointId, Model, Posed};

const HUMANOID: &str = include_str!("../golden/humanoid.urdf");

fn humanoid() -> Model {
    let description = Description { base: Base::Floating, ..Description::default() };
    Model::from_urdf(HUMANOID, &description).unwrap()
}

#[expect(clippy::needless_pass_by_value, reason = "errors come by value")]
fn expect(error: Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "no `{word}` in: {message}");
    }
}

#[test]
fn configurations_and_velocities_that_are_none() {
    let model = humanoid();
    let mut data = Data::new(&model);
    let (q, v) = (model.neutral(), vec![0.0; model.velocity_count()]);
    assert!(model.is_configuration(&q) && !model.is_configuration(&q[1..]));
    expect(data.pose(&model, &q[1..]).unwrap_err(), &["q has 37 elements", "38"]);
    let knee = model.joint(model.joint_id("left_knee").unwrap()).unwrap().clone();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let mut wrong = q.clone();
        wrong[knee.position_index] = bad;
        expect(data.pose(&model, &wrong).unwrap_err(), &["left_knee", "finite"]);
        assert!(!model.is_configuration(&wrong));
        assert!(model.integrate(&mut wrong.clone(), &v).is_err());
        assert!(model.difference(&q, &wrong, &mut v.clone()).is_err());
        let mut wrong = v.clone();
        wrong[knee.velocity_index] = bad;
        let posed = data.pose(&model, &q).unwrap();
        expect(posed.moving(&wrong).unwrap_err(), &["left_knee", "finite"]);
        let mut same = q.clone();
        assert!(model.integrate(&mut same, &wrong).is_err());
        assert_eq!(same, q, "a refused step changes nothing");
    }
    let mut wrong = q.clone();
    wrong[6] = 1.1;
    assert!(!model.is_configuration(&wrong));
    let error = data.pose(&model, &wrong).unwrap_err();
    assert!(matches!(error, Error::Value { got: norm, .. } if (norm - 1.1).abs() < 1e-12));
    wrong[6] = 0.0;
    assert!(matches!(data.pose(&model, &wrong), Err(Error::Value { .. })));
}

#[test]
fn room_of_the_wrong_size() {
    let model = humanoid();
    let n = model.velocity_count();
    let mut data = Data::new(&model);
    let frame = model.frame_id("left_palm").unwrap();
    let (q, v) = (model.neutral(), vec![0.0; n]);
    let size = |outcome: Result<(), Error>| {
        assert!(matches!(outcome, Err(Error::Size { .. })), "{outcome:?}");
    };
    let mut posed = data.pose(&model, &q).unwrap();
    size(posed.jacobian_into(frame, Axes::World, &mut Matrix6xX::zeros(n - 1)));
    size(posed.relative_jacobian_into(frame, frame, &mut Matrix6xX::zeros(0)));
    size(posed.placements_into(&mut [IsometryMatrix3::identity()]));
    size(posed.gravity_into(&mut [0.0]));
    size(posed.centre_of_mass_jacobian_into(&mut Matrix3xX::zeros(1)));
    size(posed.mass_matrix_into(&mut DMatrix::zeros(n, n + 1)));
    size(posed.mass_matrix_into(&mut DMatrix::zeros(n + 1, n)));
    let mut moving = posed.moving(&v).unwrap();
    size(moving.inverse_dynamics_into(&v[1..], &[], &mut vec![0.0; n]));
    size(moving.inverse_dynamics_into(&v, &[], &mut [0.0]));
    size(moving.forward_dynamics_into(&v, &[], &mut [0.0]));
    size(moving.bias_forces_into(&mut []));
    size(moving.friction_into(&mut []));
    let wrench = Vector6::new(0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0);
    let pushed = [ExternalWrench { frame, wrench }];
    expect(moving.inverse_dynamics_into(&v, &pushed, &mut vec![0.0; n]).unwrap_err(), &["wrench"]);
}

#[test]
fn data_and_ids_of_another_robot() {
    // Models of the same URDF and size are still different robots.
    let (model, other) = (humanoid(), humanoid());
    let mut data = Data::new(&other);
    let q = model.neutral();
    expect(data.pose(&model, &q).unwrap_err(), &["another model", "Data::new"]);
    let frame = other.frame_id("left_palm").unwrap();
    let joint: JointId = other.joint_id("left_knee").unwrap();
    expect(model.joint(joint).unwrap_err(), &["joint", "another model"]);
    expect(model.frame_name(frame).unwrap_err(), &["frame", "another model"]);
    let mut data = Data::new(&model);
    let posed: Posed = data.pose(&model, &q).unwrap();
    assert!(matches!(posed.world_from(frame), Err(Error::ForeignId { .. })));
    // A clone is the same robot.
    let clone = model.clone();
    assert!(
        data.pose(&clone, &q).unwrap().world_from(model.frame_id("left_palm").unwrap()).is_ok()
    );
    expect(model.frame_id("left_plam").unwrap_err(), &["frames are left_palm,", "humanoid"]);
    expect(model.joint_id("left_nkee").unwrap_err(), &["joints are left_knee,"]);
}

#[test]
fn payloads_that_are_none() {
    let model = humanoid();
    let mut data = Data::new(&model);
    let frame = model.frame_id("left_palm").unwrap();
    let payload =
        Payload { frame, mass: 1.0, centre: Point3::origin(), inertia: Matrix3::identity() };
    let negative = Payload { mass: -1.0, ..payload };
    expect(
        data.attach(&model, &negative).unwrap_err(),
        &["payload", "-1; it must be zero or positive [kg]"],
    );
    let nowhere = Payload { centre: Point3::new(f64::NAN, 0.0, 0.0), ..payload };
    expect(data.attach(&model, &nowhere).unwrap_err(), &["payload", "finite"]);
    for _ in 0..8 {
        data.attach(&model, &payload).unwrap();
    }
    expect(data.attach(&model, &payload).unwrap_err(), &["8 payloads"]);
}

#[test]
fn a_joint_that_moves_nothing_has_no_acceleration() {
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"/>
<joint name="idle" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#;
    let model = Model::from_urdf(urdf, &Description::default()).unwrap();
    assert!(model.warnings()[0].to_string().contains("`idle`"));
    let mut data = Data::new(&model);
    let mut moving = data.pose(&model, &[0.0]).unwrap().moving(&[0.0]).unwrap();
    let error = moving.forward_dynamics_into(&[1.0], &[], &mut [0.0]).unwrap_err();
    assert!(matches!(error, Error::NoInertia { joint } if joint == "idle"));
    let frame = model.frame_id("b").unwrap();
    assert!(moving.posed_mut().effective_mass(frame, &Vector3::x_axis()).is_err());
}
