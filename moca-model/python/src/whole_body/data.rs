//! Quantities that are computed from a robot's state.

use nalgebra::{DMatrix, Matrix3xX, Matrix6xX};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use whole_body::{Axes, Moving, Posed};

use super::model::Model;
use crate::arrays::{pose_to_array, to_array, to_vector, vector_of, with_slice};
use crate::failure::{Failure, Result};
use crate::shared::Shared;

type Vector<'py> = Bound<'py, PyArray1<f64>>;
type Matrix<'py> = Bound<'py, PyArray2<f64>>;

/// Kinematics and dynamics of a robot at a configuration q and a velocity q̇.
///
/// `Data(model)`; `update(q, v)` sets the state. n is the size of q̇. Poses are homogeneous matrices, (4, 4), in the
/// world. Twists and Jacobians are linear then angular, at a frame's origin. Their axes are parallel to the world's, or
/// the frame's own with `local=True`. Forces are in Nm and N.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct Data(Shared<State>);

#[derive(Debug)]
struct State {
    model: whole_body::Model,
    data: whole_body::Data,
    velocity: Option<Vec<f64>>,
}

impl State {
    fn posed(&mut self) -> Result<Posed<'_>> {
        Ok(self.data.posed(&self.model)?)
    }

    fn moving(&mut self) -> Result<Moving<'_>> {
        let missing = || Failure::value("the data have no velocity yet; call update(q, v) first");
        let velocity = self.velocity.as_deref().ok_or_else(missing)?;
        Ok(self.data.posed(&self.model)?.moving(velocity)?)
    }
}

fn axes(local: bool) -> Axes {
    if local { Axes::Local } else { Axes::World }
}

#[pymethods]
impl Data {
    #[new]
    fn new(model: &Model) -> Self {
        let (model, data) = (model.0.clone(), whole_body::Data::new(&model.0));
        Self(Shared::new("data", State { model, data, velocity: None }))
    }

    /// Sets the configuration q, shape (position_count,), and the velocity v, shape (n,).
    #[pyo3(signature = (q, v=None))]
    fn update(&self, q: &Bound<'_, PyAny>, v: Option<&Bound<'_, PyAny>>) -> Result<()> {
        let mut state = self.0.lock()?;
        let State { model, data, velocity } = &mut *state;
        let q = vector_of("q", q, model.position_count())?;
        let v = v.map(|v| vector_of("v", v, model.velocity_count())).transpose()?;
        let v = v.map(|v| v.as_array().to_vec());
        let posed = with_slice(&q, |q| data.pose(model, q))?;
        if let Some(v) = &v {
            posed.moving(v)?;
        }
        *velocity = v;
        Ok(())
    }

    /// The pose of a frame in the world, (4, 4).
    fn pose<'py>(&self, py: Python<'py>, frame: &str) -> Result<Matrix<'py>> {
        let mut state = self.0.lock()?;
        let frame = state.model.frame_id(frame)?;
        Ok(pose_to_array(py, &state.posed()?.world_from(frame)?))
    }

    /// The Jacobian of a frame, (6, n).
    #[pyo3(signature = (frame, *, local=false))]
    fn jacobian<'py>(&self, py: Python<'py>, frame: &str, local: bool) -> Result<Matrix<'py>> {
        let mut state = self.0.lock()?;
        let frame = state.model.frame_id(frame)?;
        let mut jacobian = Matrix6xX::zeros(state.model.velocity_count());
        state.posed()?.jacobian_into(frame, axes(local), &mut jacobian)?;
        Ok(to_array(py, &jacobian))
    }

    /// J̇ q̇ of a frame, (6,).
    #[pyo3(signature = (frame, *, local=false))]
    fn jacobian_rate_times_velocity<'py>(
        &self,
        py: Python<'py>,
        frame: &str,
        local: bool,
    ) -> Result<Vector<'py>> {
        let mut state = self.0.lock()?;
        let frame = state.model.frame_id(frame)?;
        let rate = state.moving()?.jacobian_rate_times_velocity(frame, axes(local))?;
        Ok(to_vector(py, rate.as_slice()))
    }

    /// The twist of a frame [m/s, rad/s], (6,).
    #[pyo3(signature = (frame, *, local=false))]
    fn twist<'py>(&self, py: Python<'py>, frame: &str, local: bool) -> Result<Vector<'py>> {
        let mut state = self.0.lock()?;
        let frame = state.model.frame_id(frame)?;
        Ok(to_vector(py, state.moving()?.twist(frame, axes(local))?.as_slice()))
    }

    /// The centre of mass of all links that move, in the world [m], (3,).
    fn centre_of_mass<'py>(&self, py: Python<'py>) -> Result<Vector<'py>> {
        let centre = self.0.lock()?.posed()?.centre_of_mass();
        Ok(to_vector(py, centre.coords.as_slice()))
    }

    /// The Jacobian of the centre of mass, (3, n).
    fn centre_of_mass_jacobian<'py>(&self, py: Python<'py>) -> Result<Matrix<'py>> {
        let mut state = self.0.lock()?;
        let mut jacobian = Matrix3xX::zeros(state.model.velocity_count());
        state.posed()?.centre_of_mass_jacobian_into(&mut jacobian)?;
        Ok(to_array(py, &jacobian))
    }

    /// The forces that hold the robot at rest against gravity, (n,).
    fn gravity<'py>(&self, py: Python<'py>) -> Result<Vector<'py>> {
        let mut state = self.0.lock()?;
        let mut out = vec![0.0; state.model.velocity_count()];
        state.posed()?.gravity_into(&mut out)?;
        Ok(to_vector(py, &out))
    }

    /// The mass matrix M(q), (n, n).
    fn mass_matrix<'py>(&self, py: Python<'py>) -> Result<Matrix<'py>> {
        let mut state = self.0.lock()?;
        let n = state.model.velocity_count();
        let mut out = DMatrix::zeros(n, n);
        state.posed()?.mass_matrix_into(&mut out)?;
        Ok(to_array(py, &out))
    }

    /// C(q, q̇) q̇ + g(q), (n,).
    fn bias_forces<'py>(&self, py: Python<'py>) -> Result<Vector<'py>> {
        let mut state = self.0.lock()?;
        let mut out = vec![0.0; state.model.velocity_count()];
        state.moving()?.bias_forces_into(&mut out)?;
        Ok(to_vector(py, &out))
    }

    /// The forces τ = M(q) q̈ + C(q, q̇) q̇ + g(q) of an acceleration q̈, (n,) both.
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        acceleration: &Bound<'py, PyAny>,
    ) -> Result<Vector<'py>> {
        let mut state = self.0.lock()?;
        let n = state.model.velocity_count();
        let acceleration = vector_of("acceleration", acceleration, n)?;
        let (mut out, mut moving) = (vec![0.0; n], state.moving()?);
        with_slice(&acceleration, |acceleration| {
            moving.inverse_dynamics_into(acceleration, &[], &mut out)
        })?;
        Ok(to_vector(py, &out))
    }

    /// The acceleration q̈ that forces τ cause, (n,) both.
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        torque: &Bound<'py, PyAny>,
    ) -> Result<Vector<'py>> {
        let mut state = self.0.lock()?;
        let n = state.model.velocity_count();
        let torque = vector_of("torque", torque, n)?;
        let (mut out, mut moving) = (vec![0.0; n], state.moving()?);
        with_slice(&torque, |torque| moving.forward_dynamics_into(torque, &[], &mut out))?;
        Ok(to_vector(py, &out))
    }

    /// Kinetic energy [J].
    fn kinetic_energy(&self) -> Result<f64> {
        Ok(self.0.lock()?.moving()?.kinetic_energy())
    }

    /// Potential energy [J].
    fn potential_energy(&self) -> Result<f64> {
        Ok(self.0.lock()?.posed()?.potential_energy())
    }
}
