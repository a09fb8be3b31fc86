//! Values of independent implementations: Pinocchio on the same URDF
//! (`golden/make_golden.py`), and the arm alone from the makers' parameters.

use approx::assert_abs_diff_eq;
use moca_model::{
    MOCA_HOME, MOCA_URDF, RobotData, RobotDescription, RobotModel, forward_kinematics, gravity,
    jacobian, world_from_link,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use serde_json::Value;

fn numbers(case: &Value, key: &str) -> Vec<f64> {
    let values = case[key].as_array().unwrap();
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn pose_jacobian_and_gravity_are_pinocchios() {
    let golden: Value = serde_json::from_str(include_str!("../golden/moca.json")).unwrap();
    let cases = golden["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 50);

    let model = RobotModel::moca().unwrap();
    let mut data = RobotData::new(&model);
    for case in cases {
        forward_kinematics(&model, &mut data, &numbers(case, "q")).unwrap();
        jacobian(&model, &mut data).unwrap();
        gravity(&model, &mut data).unwrap();

        let pose = data.world_from_tool();
        let position = Vector3::from_column_slice(&numbers(case, "position"));
        let rotation = Matrix3::from_row_slice(&numbers(case, "rotation"));
        let jacobian = DMatrix::from_row_slice(6, 10, &numbers(case, "jacobian"));
        let gravity = DVector::from_vec(numbers(case, "gravity"));
        assert_abs_diff_eq!(pose.translation.vector, position, epsilon = 1e-10);
        let own = pose.rotation.to_rotation_matrix();
        assert_abs_diff_eq!(own.matrix(), &rotation, epsilon = 1e-10);
        assert_abs_diff_eq!(data.jacobian(), &jacobian, epsilon = 1e-10);
        assert_abs_diff_eq!(data.gravity(), &gravity, epsilon = 1e-10);
    }
}

/// The arm alone, standing at the world's origin.
struct Arm {
    model: RobotModel,
    data: RobotData,
}

impl Arm {
    fn new(tool: &str, urdf: &str) -> Self {
        let description =
            RobotDescription { root: Some("panda_link0".into()), ..RobotDescription::new(tool) };
        let model = RobotModel::from_urdf(urdf, &description).unwrap();
        assert_eq!(model.joint_count(), 7);
        let data = RobotData::new(&model);
        Self { model, data }
    }

    fn at(mut self, q: &[f64]) -> Self {
        forward_kinematics(&self.model, &mut self.data, q).unwrap();
        gravity(&self.model, &mut self.data).unwrap();
        self
    }
}

/// The URDF with one part's mass set to zero.
fn without_mass(urdf: &str, mass: &str, count: usize) -> String {
    let tag = format!("<mass value=\"{mass}\"/>");
    assert_eq!(urdf.matches(&tag).count(), count);
    urdf.replace(&tag, "<mass value=\"0\"/>")
}

/// q, flange position, gravity torques without hand, with hand; neither with fingers.
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
fn the_flange_of_the_arm_alone_is_where_its_parameters_put_it() {
    for (q, flange, _, _) in arm_cases() {
        let arm = Arm::new("panda_link8", MOCA_URDF).at(&q);
        let position = arm.data.world_from_tool().translation.vector;
        assert_abs_diff_eq!(position, Vector3::from(flange), epsilon = 1e-6);
        let link = arm.model.link("panda_link8").unwrap();
        let same = world_from_link(&arm.model, &arm.data, link).unwrap();
        assert_abs_diff_eq!(same, *arm.data.world_from_tool(), epsilon = 1e-12);
    }
}

#[test]
fn gravity_of_the_arm_alone_counts_what_it_carries() {
    let bare = without_mass(MOCA_URDF, "0.015", 2);
    let handless = without_mass(&bare, "0.73", 1);
    for (q, _, without_hand, with_hand) in arm_cases() {
        for (urdf, expected) in [(&handless, without_hand), (&bare, with_hand)] {
            let arm = Arm::new("panda_tcp", urdf).at(&q);
            let expected = DVector::from_row_slice(&expected);
            assert_abs_diff_eq!(arm.data.gravity(), &expected, epsilon = 2e-6);
        }
    }
}

#[test]
fn at_home_the_tool_points_down() {
    let arm = Arm::new("panda_tcp", MOCA_URDF).at(&MOCA_HOME[3..]);
    let pose = arm.data.world_from_tool();
    let expected = Vector3::new(0.306891, 0.0, 0.486882);
    assert_abs_diff_eq!(pose.translation.vector, expected, epsilon = 1e-6);
    let rotation = pose.rotation.to_rotation_matrix();
    let down = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    assert_abs_diff_eq!(rotation.matrix(), &down, epsilon = 1e-12);
}

#[test]
fn the_arm_stands_where_its_mount_says() {
    let model = RobotModel::moca().unwrap();
    let data = RobotData::new(&model);
    let link = model.link("panda_link0").unwrap();
    let pose = world_from_link(&model, &data, link).unwrap();
    assert_abs_diff_eq!(pose.translation.vector, Vector3::new(0.0, 0.0, 0.509), epsilon = 1e-12);
}
