//! Forces, inertias, energies and momentum, for every tree, base and state.

use approx::assert_abs_diff_eq;
use nalgebra::{
    DMatrix, DVector, Matrix3, Matrix3xX, Matrix6xX, Point3, UnitVector3, Vector3, Vector6,
};
use proptest::prelude::*;
use whole_body::state::{ExternalWrench, Payload};
use whole_body::{Axes, Base, Data, Model};

use crate::support::{Robot, State, after, last_frame, robots, robots_with_states, states};

const STEP: f64 = 1e-5;

fn mass_matrix(model: &Model, q: &[f64]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(model.velocity_count(), model.velocity_count());
    Data::new(model).pose(model, q).unwrap().mass_matrix_into(&mut out).unwrap();
    out
}

fn torque(model: &Model, state: &State, external: &[ExternalWrench]) -> DVector<f64> {
    let mut out = vec![0.0; model.velocity_count()];
    let mut data = Data::new(model);
    let mut moving = data.pose(model, &state.q).unwrap().moving(&state.v).unwrap();
    moving.inverse_dynamics_into(&state.a, external, &mut out).unwrap();
    out.into()
}

fn size(values: &DVector<f64>) -> f64 {
    values.amax().max(1.0)
}

/// The state after `time`, also negative, with constant q̈ in the coordinates of q̇.
fn moved(model: &Model, state: &State, time: f64) -> State {
    let rates = state.v.iter().zip(&state.a);
    let mean: Vec<_> = rates.clone().map(|(v, a)| v + 0.5 * a * time).collect();
    State {
        q: after(model, &state.q, &mean, time),
        v: rates.map(|(v, a)| v + a * time).collect(),
        a: state.a.clone(),
    }
}

fn floating() -> impl Strategy<Value = (Robot, State)> {
    robots().prop_map(|robot| robot.on(Base::Floating)).prop_flat_map(states)
}

proptest! {
    #[test]
    fn the_mass_matrix_is_symmetric_and_positive_definite((robot, state) in robots_with_states()) {
        let mass = mass_matrix(&robot.model(), &state.q);
        prop_assert_eq!(mass.transpose(), mass.clone());
        let values = mass.symmetric_eigenvalues();
        prop_assert!(values.min() > -1e-12 * values.max());
    }

    #[test]
    fn mass_matrix_gives_the_kinetic_energy((robot, state) in robots_with_states()) {
        let model = robot.model();
        let v = DVector::from_column_slice(&state.v);
        let expected = 0.5 * v.dot(&(mass_matrix(&model, &state.q) * &v));
        let mut data = Data::new(&model);
        let moving = data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap();
        let energy = moving.kinetic_energy();
        assert_abs_diff_eq!(energy, expected, epsilon = 1e-11 * expected.max(1.0));
    }

    #[test]
    fn mass_matrix_maps_acceleration_to_force((robot, state) in robots_with_states()) {
        let model = robot.model();
        let a = DVector::from_column_slice(&state.a);
        let still = State { a: vec![0.0; state.a.len()], ..state.clone() };
        let bias = torque(&model, &still, &[]);
        let expected = mass_matrix(&model, &state.q) * a + &bias;
        let found = torque(&model, &state, &[]);
        assert_abs_diff_eq!(found, expected, epsilon = 1e-11 * size(&expected));
        let mut out = vec![0.0; model.velocity_count()];
        let mut data = Data::new(&model);
        data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap().bias_forces_into(&mut out).unwrap();
        assert_abs_diff_eq!(DVector::from_vec(out), bias, epsilon = 1e-12 * size(&bias));
    }

    #[test]
    fn forward_dynamics_undo_inverse_dynamics((robot, state) in robots_with_states(), push in prop::array::uniform6(-20.0..20.0)) {
        let model = robot.model();
        let values = mass_matrix(&model, &state.q).symmetric_eigenvalues();
        prop_assume!(values.min() > 1e-6 * values.max());
        let external = [ExternalWrench { frame: last_frame(&model), wrench: Vector6::from(push) }];
        let torque = torque(&model, &state, &external);
        let mut out = vec![0.0; model.velocity_count()];
        let mut data = Data::new(&model);
        let mut moving = data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap();
        moving.forward_dynamics_into(torque.as_slice(), &external, &mut out).unwrap();
        let (found, expected) = (DVector::from_vec(out), DVector::from_vec(state.a));
        assert_abs_diff_eq!(found, expected, epsilon = 1e-15 * size(&torque) / values.min() + 1e-9);
    }

    #[test]
    fn gravity_is_the_gradient_of_potential_energy((robot, state) in robots_with_states()) {
        let model = robot.model();
        let mut gravity = vec![0.0; model.velocity_count()];
        Data::new(&model).pose(&model, &state.q).unwrap().gravity_into(&mut gravity).unwrap();
        for (column, torque) in gravity.iter().enumerate() {
            let mut v = vec![0.0; model.velocity_count()];
            v[column] = 1.0;
            let [before, later] = [-STEP, STEP].map(|time| {
                let q = after(&model, &state.q, &v, time);
                Data::new(&model).pose(&model, &q).unwrap().potential_energy()
            });
            assert_abs_diff_eq!(*torque, (later - before) / (2.0 * STEP), epsilon = 1e-5);
        }
        let rest = State { v: vec![0.0; state.v.len()], a: vec![0.0; state.v.len()], q: state.q };
        let expected = torque(&model, &rest, &[]);
        assert_abs_diff_eq!(DVector::from_vec(gravity), expected, epsilon = 1e-11 * size(&expected));
    }

    #[test]
    fn rate_of_energy_is_motor_power((robot, state) in robots_with_states()) {
        let model = robot.model();
        let [before, later] = [-STEP, STEP].map(|time| {
            let State { q, v, .. } = moved(&model, &state, time);
            let mut data = Data::new(&model);
            let moving = data.pose(&model, &q).unwrap().moving(&v).unwrap();
            moving.kinetic_energy() + moving.posed().potential_energy()
        });
        let power = torque(&model, &state, &[]).dot(&DVector::from_column_slice(&state.v));
        let scale = before.abs().max(power.abs()).max(1.0);
        assert_abs_diff_eq!((later - before) / (2.0 * STEP), power, epsilon = 1e-6 * scale);
    }

    #[test]
    fn rate_of_momentum_is_the_base_force((robot, state) in floating()) {
        let model = robot.model();
        let at = |time: f64| {
            let State { q, v, .. } = moved(&model, &state, time);
            let mut data = Data::new(&model);
            let moving = data.pose(&model, &q).unwrap().moving(&v).unwrap();
            (moving.momentum(), moving.posed().centre_of_mass())
        };
        let rate = (at(STEP).0 - at(-STEP).0) / (2.0 * STEP);
        let torque = torque(&model, &state, &[]);
        let force = torque.fixed_rows::<3>(0) + model.mass() * model.gravity();
        let origin = Point3::new(state.q[0], state.q[1], state.q[2]);
        let (_, centre) = at(0.0);
        let moment = torque.fixed_rows::<3>(3) - (centre - origin).cross(&torque.fixed_rows::<3>(0));
        let scale = 1e-6 * size(&torque);
        assert_abs_diff_eq!(rate.fixed_rows::<3>(0).into_owned(), force, epsilon = scale);
        assert_abs_diff_eq!(rate.fixed_rows::<3>(3).into_owned(), moment, epsilon = scale);
    }

    #[test]
    fn the_centre_of_mass_moves_by_its_jacobian((robot, state) in robots_with_states()) {
        let model = robot.model();
        let v = DVector::from_column_slice(&state.v);
        let mut jacobian = Matrix3xX::zeros(model.velocity_count());
        let mut data = Data::new(&model);
        let mut posed = data.pose(&model, &state.q).unwrap();
        posed.centre_of_mass_jacobian_into(&mut jacobian).unwrap();
        let velocity = jacobian * v;
        let momentum = posed.moving(&state.v).unwrap().momentum();
        assert_abs_diff_eq!(velocity * model.mass(), momentum.fixed_rows::<3>(0).into_owned(), epsilon = 1e-10);
        let [before, later] = [-STEP, STEP].map(|time| {
            let q = after(&model, &state.q, &state.v, time);
            Data::new(&model).pose(&model, &q).unwrap().centre_of_mass()
        });
        assert_abs_diff_eq!(velocity, (later - before) / (2.0 * STEP), epsilon = 1e-7);
    }

    #[test]
    fn an_external_wrench_acts_by_the_transposed_jacobian(
        (robot, state) in robots_with_states(), push in prop::array::uniform6(-20.0..20.0),
    ) {
        let model = robot.model();
        let (frame, wrench) = (last_frame(&model), Vector6::from(push));
        let mut jacobian = Matrix6xX::zeros(model.velocity_count());
        let mut data = Data::new(&model);
        data.pose(&model, &state.q).unwrap().jacobian_into(frame, Axes::World, &mut jacobian).unwrap();
        let found = torque(&model, &state, &[ExternalWrench { frame, wrench }]);
        let expected = torque(&model, &state, &[]) - jacobian.transpose() * wrench;
        assert_abs_diff_eq!(found, expected, epsilon = 1e-10 * size(&expected));
    }

    #[test]
    fn the_effective_mass_is_that_of_the_definition(
        (robot, state) in robots_with_states(), direction in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let model = robot.model();
        let mass = mass_matrix(&model, &state.q);
        let values = mass.clone().symmetric_eigenvalues();
        prop_assume!(values.min() > 1e-6 * values.max() && Vector3::from(direction).norm() > 0.1);
        let direction = UnitVector3::new_normalize(Vector3::from(direction));
        let frame = last_frame(&model);
        let mut jacobian = Matrix6xX::zeros(model.velocity_count());
        let mut data = Data::new(&model);
        let mut posed = data.pose(&model, &state.q).unwrap();
        posed.jacobian_into(frame, Axes::World, &mut jacobian).unwrap();
        let row = jacobian.fixed_rows::<3>(0).transpose() * *direction;
        let mobility = row.dot(&mass.cholesky().unwrap().solve(&row));
        let found = 1.0 / posed.effective_mass(frame, &direction).unwrap();
        assert_abs_diff_eq!(found, mobility, epsilon = 1e-9 * mobility.max(1.0));
    }

    #[test]
    fn payload_counts_until_it_is_detached((robot, state) in robots_with_states()) {
        let model = robot.model();
        let frame = last_frame(&model);
        let mut data = Data::new(&model);
        let energies = |data: &mut Data| {
            let moving = data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap();
            (moving.kinetic_energy(), moving.posed().potential_energy())
        };
        let without = energies(&mut data);
        let payload = Payload {
            frame,
            mass: 2.0,
            centre: Point3::new(0.1, -0.2, 0.3),
            inertia: Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)),
        };
        let attached = data.attach(&model, &payload).unwrap();
        let with = energies(&mut data);
        let moving = data.pose(&model, &state.q).unwrap().moving(&state.v).unwrap();
        let twist = moving.twist(frame, Axes::World).unwrap();
        let pose = moving.posed().world_from(frame).unwrap();
        let turning = twist.fixed_rows::<3>(3).into_owned();
        let velocity = twist.fixed_rows::<3>(0) + turning.cross(&(pose.rotation * payload.centre.coords));
        let own = pose.rotation.inverse() * turning;
        let kinetic = 0.5 * (2.0 * velocity.norm_squared() + own.dot(&(payload.inertia * own)));
        let potential = -2.0 * model.gravity().dot(&(pose * payload.centre).coords);
        // Payloads on the world do not count.
        let moves = model.base() == Base::Floating || model.moved_by(frame).unwrap().next().is_some();
        let share = if moves { 1.0 } else { 0.0 };
        assert_abs_diff_eq!(with.0 - without.0, share * kinetic, epsilon = 1e-9 * with.0.max(1.0));
        assert_abs_diff_eq!(with.1 - without.1, share * potential, epsilon = 1e-9 * with.1.abs().max(1.0));
        data.detach(&model, attached).unwrap();
        prop_assert_eq!(energies(&mut data), without);
        prop_assert!(data.detach(&model, attached).is_err());
    }
}
