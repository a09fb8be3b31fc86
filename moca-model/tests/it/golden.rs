//! Comparison with Pinocchio on the same URDF (`golden/make_golden.py`), and with the manufacturer's parameters of the
//! arm.

use approx::assert_abs_diff_eq;
use moca_model::whole_body::{Data, Description, Model};
use moca_model::{Kinematics, MOCA_HOME, MOCA_TOOL, MOCA_URDF};
use nalgebra::{Isometry3, Matrix3, Matrix6xX, Vector3};
use serde_json::Value;

use crate::shared::MOCA;

fn numbers(case: &Value, key: &str) -> Vec<f64> {
    let values = case[key].as_array().unwrap();
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn pose_jacobian_and_gravity_are_pinocchios() {
    let golden: Value = serde_json::from_str(include_str!("../golden/moca.json")).unwrap();
    let cases = golden["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 50);

    let mut robot = Kinematics::new(MOCA.clone(), MOCA_TOOL, &[], &MOCA_HOME).unwrap();
    let mut data = Data::new(&MOCA);
    for case in cases {
        let q = numbers(case, "q");
        robot.update(&q).unwrap();
        let mut torques = [0.0; 10];
        data.pose(&MOCA, &q).unwrap().gravity_into(&mut torques).unwrap();

        let pose = robot.world_from_tool();
        let position = Vector3::from_column_slice(&numbers(case, "position"));
        let rotation = Matrix3::from_row_slice(&numbers(case, "rotation"));
        let jacobian = Matrix6xX::from_row_slice(&numbers(case, "jacobian"));
        assert_abs_diff_eq!(pose.translation.vector, position, epsilon = 1e-10);
        let own = pose.rotation.to_rotation_matrix();
        assert_abs_diff_eq!(own.matrix(), &rotation, epsilon = 1e-10);
        assert_abs_diff_eq!(robot.jacobian(), &jacobian, epsilon = 1e-10);
        assert_abs_diff_eq!(torques[..], numbers(case, "gravity")[..], epsilon = 1e-10);
    }
}

/// The arm alone at the world's origin: the pose of its tool, and its gravity torques.
fn arm(tool: &str, urdf: &str, q: &[f64]) -> (Isometry3<f64>, [f64; 7]) {
    let description = Description {
        root: Some("panda_link0".into()),
        tips: vec![tool.to_owned()],
        ..Description::default()
    };
    let model = Model::from_urdf(urdf, &description).unwrap();
    let mut data = Data::new(&model);
    let mut torques = [0.0; 7];
    let mut posed = data.pose(&model, q).unwrap();
    posed.gravity_into(&mut torques).unwrap();
    (posed.world_from(model.frame_id(tool).unwrap()).unwrap(), torques)
}

/// The URDF with one part's mass set to zero.
fn without_mass(urdf: &str, mass: &str, count: usize) -> String {
    let tag = format!("<mass value=\"{mass}\"/>");
    assert_eq!(urdf.matches(&tag).count(), count);
    urdf.replace(&tag, "<mass value=\"0\"/>")
}

/// q, flange position, gravity torques without and with the hand; neither with fingers.
type ArmCase = ([f64; 7], [f64; 3], [f64; 7], [f64; 7]);

const OFF_HOME: [f64; 7] = [0.3, 0.5, -0.4, -1.2, 0.7, 1.9, -0.6];

fn arm_cases() -> [ArmCase; 2] {
    [
        (
            MOCA_HOME[3..].try_into().unwrap(),
            [0.306891, 0.0, 0.590282],
            [0.0, -1.771376, -0.644, 18.57359, 0.633846, 1.693685, 0.0],
            [0.0, -3.897498, -0.644, 21.882111, 0.633846, 2.252266, 0.0],
        ),
        (
            OFF_HOME,
            [0.721633, 0.048109, 0.544394],
            [0.0, -38.414027, -3.784729, 18.757957, 0.616523, 1.546966, -0.008976],
            [0.0, -43.501549, -4.347556, 22.327307, 0.910567, 2.261087, -0.016069],
        ),
    ]
}

#[test]
fn flange_is_where_manufacturer_parameters_put_it() {
    for (q, flange, _, _) in arm_cases() {
        let (pose, _) = arm("panda_link8", MOCA_URDF, &q);
        assert_abs_diff_eq!(pose.translation.vector, Vector3::from(flange), epsilon = 1e-6);
    }
}

#[test]
fn gravity_of_arm_includes_its_hand() {
    let bare = without_mass(MOCA_URDF, "0.015", 2);
    let handless = without_mass(&bare, "0.73", 1);
    for (q, _, without_hand, with_hand) in arm_cases() {
        for (urdf, expected) in [(&handless, without_hand), (&bare, with_hand)] {
            let (_, torques) = arm("panda_tcp", urdf, &q);
            assert_abs_diff_eq!(torques[..], expected[..], epsilon = 2e-6);
        }
    }
}

#[test]
fn at_home_the_tool_points_down() {
    let (pose, _) = arm("panda_tcp", MOCA_URDF, &MOCA_HOME[3..]);
    let expected = Vector3::new(0.306891, 0.0, 0.486882);
    assert_abs_diff_eq!(pose.translation.vector, expected, epsilon = 1e-6);
    let rotation = pose.rotation.to_rotation_matrix();
    let down = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    assert_abs_diff_eq!(rotation.matrix(), &down, epsilon = 1e-12);
}

#[test]
fn the_arm_stands_where_its_mount_says() {
    let link = MOCA.frame_id("panda_link0").unwrap();
    let pose = Data::new(&MOCA).pose(&MOCA, &[0.0; 10]).unwrap().world_from(link).unwrap();
    assert_abs_diff_eq!(pose.translation.vector, Vector3::new(0.0, 0.0, 0.509), epsilon = 1e-12);
}
