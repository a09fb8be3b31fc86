//! Comparison with Pinocchio on the same URDFs (`golden/make.py`).

use approx::assert_abs_diff_eq;
use nalgebra::{DMatrix, Matrix3xX, Matrix6xX, UnitVector3, Vector3};
use serde_json::Value;
use whole_body::{Axes, Base, Data, Description, Model};

const TOLERANCE: f64 = 1e-10;

/// The numbers of an array, or those of the named entries of an object.
fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().map(|value| value.as_f64().unwrap()).collect()
}

fn names(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
}

/// The order of the model's joints in the golden file.
struct Order(Vec<usize>);

impl Order {
    /// The first `base` entries are the same in both.
    fn new(model: &Model, golden: &[&str], base: usize) -> Self {
        let joints = model.joints().iter().map(|joint| joint.name.as_str());
        let places = joints.filter_map(|name| golden.iter().position(|other| *other == name));
        let order: Vec<_> = (0..base).chain(places.map(|place| base + place)).collect();
        assert_eq!(order.len(), model.velocity_count(), "the same joints");
        Self(order)
    }

    fn columns(&self, rows: usize, values: &[f64]) -> DMatrix<f64> {
        let matrix = DMatrix::from_row_slice(rows, self.0.len(), values);
        matrix.select_columns(&self.0)
    }

    fn vector(&self, values: &[f64]) -> Vec<f64> {
        self.0.iter().map(|&place| values[place]).collect()
    }
}

fn check(urdf: &str, golden: &str) {
    let golden: Value = serde_json::from_str(golden).unwrap();
    let (base, base_positions, base_velocities) = match golden["base"].as_str().unwrap() {
        "floating" => (Base::Floating, 7, 6),
        "planar" => (Base::Planar, 3, 3),
        _ => (Base::Fixed, 0, 0),
    };
    let model = Model::from_urdf(urdf, &Description { base, ..Description::default() }).unwrap();
    let n = model.velocity_count();
    let joints = names(&golden["joints"]);
    let order = Order::new(&model, &joints, base_velocities);
    let frames = names(&golden["frames"]);
    let mut data = Data::new(&model);
    let cases = golden["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for case in cases {
        let state = |of: &str, base: usize| {
            let mut entries = numbers(&case["state"][format!("base_{of}")]);
            assert_eq!(entries.len(), base);
            let own =
                model.joints().iter().filter_map(|joint| case["state"][of][&joint.name].as_f64());
            entries.extend(own);
            entries
        };
        let q = state("position", base_positions);
        let (v, a) = (state("velocity", base_velocities), state("acceleration", base_velocities));
        let mut posed = data.pose(&model, &q).unwrap();
        let up = UnitVector3::new_normalize(Vector3::new(1.0, 2.0, -1.0));
        for (name, values) in frames.iter().zip(case["frames"].as_array().unwrap()) {
            let frame = model.frame_id(name).unwrap();
            let pose = posed.placement(frame).unwrap();
            assert_close(pose.translation.vector.as_slice(), &numbers(&values["position"]));
            let rotation = pose.rotation.matrix().transpose();
            assert_close(rotation.as_slice(), &numbers(&values["rotation"]));
            for (axes, key) in [(Axes::World, "jacobian"), (Axes::Local, "jacobian_local")] {
                let mut jacobian = Matrix6xX::zeros(n);
                posed.jacobian_into(frame, axes, &mut jacobian).unwrap();
                let expected = order.columns(6, &numbers(&values[key]));
                assert_close(jacobian.as_slice(), expected.as_slice());
            }
            let mobility = 1.0 / posed.effective_mass(frame, &up).unwrap();
            assert_close(&[mobility], &[values["effective_mobility"].as_f64().unwrap()]);
        }
        let mut out = vec![0.0; n];
        posed.gravity_into(&mut out).unwrap();
        assert_close(&out, &order.vector(&numbers(&case["gravity"])));
        let mut mass = DMatrix::zeros(n, n);
        posed.mass_matrix_into(&mut mass).unwrap();
        let expected = order.columns(n, &numbers(&case["mass_matrix"])).select_rows(&order.0);
        assert_close(mass.as_slice(), expected.as_slice());
        assert_close(posed.centre_of_mass().coords.as_slice(), &numbers(&case["centre_of_mass"]));
        let mut centre = Matrix3xX::zeros(n);
        posed.centre_of_mass_jacobian_into(&mut centre).unwrap();
        let expected = order.columns(3, &numbers(&case["centre_of_mass_jacobian"]));
        assert_close(centre.as_slice(), expected.as_slice());
        assert_close(&[posed.potential_energy()], &[case["potential_energy"].as_f64().unwrap()]);

        let mut moving = posed.moving(&v).unwrap();
        for (name, values) in frames.iter().zip(case["frames"].as_array().unwrap()) {
            let frame = model.frame_id(name).unwrap();
            for (axes, key) in [(Axes::World, "rate"), (Axes::Local, "rate_local")] {
                let rate = moving.jacobian_rate_times_velocity(frame, axes).unwrap();
                assert_close(rate.as_slice(), &numbers(&values[key]));
            }
        }
        moving.inverse_dynamics_into(&a, &[], &mut out).unwrap();
        assert_close(&out, &order.vector(&numbers(&case["inverse_dynamics"])));
        moving.bias_forces_into(&mut out).unwrap();
        assert_close(&out, &order.vector(&numbers(&case["bias"])));
        moving.forward_dynamics_into(&a, &[], &mut out).unwrap();
        assert_close(&out, &order.vector(&numbers(&case["forward_dynamics"])));
        assert_close(&[moving.kinetic_energy()], &[case["kinetic_energy"].as_f64().unwrap()]);
        assert_close(moving.momentum().as_slice(), &numbers(&case["momentum"]));
    }
}

/// Asserts equality to [`TOLERANCE`] of the largest entry, or of 1 if all entries are smaller.
fn assert_close(ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len());
    let size = theirs.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
    for (ours, theirs) in ours.iter().zip(theirs) {
        assert_abs_diff_eq!(*ours, *theirs, epsilon = TOLERANCE * size);
    }
}

#[test]
fn moca_with_a_finger_that_mimics_the_other() {
    check(include_str!("../../examples/urdf/moca.urdf"), include_str!("../golden/moca.json"));
}

#[test]
fn a_humanoid_on_a_floating_base() {
    check(include_str!("../golden/humanoid.urdf"), include_str!("../golden/humanoid.json"));
}

#[test]
fn two_arms_on_a_planar_base() {
    check(include_str!("../golden/two_arms.urdf"), include_str!("../golden/two_arms.json"));
}

#[test]
fn a_random_tree_on_a_floating_base() {
    check(include_str!("../golden/bush.urdf"), include_str!("../golden/bush.json"));
}
