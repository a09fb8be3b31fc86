//! Second derivatives of what tasks control.

use nalgebra::{DMatrix, Matrix6xX, Vector3};

/// By how much the Jacobians of a level's tasks bend towards what is missing to them: −Σ rₖ ∇²yₖ, n × n
/// for n entries of q̇, y being what the tasks control and r what is missing.
///
/// That is what Gauss and Newton's Hessian Jᵀ J of ½ ‖y_d − y‖² leaves out (Nocedal and Wright,
/// *Numerical Optimization*, 2nd ed., Sec. 10.2). It matters where errors remain.
#[derive(Debug, Clone)]
pub(crate) struct Curvature {
    matrix: DMatrix<f64>,
    is_zero: bool,
}

impl Curvature {
    pub(crate) fn new(velocities: usize) -> Self {
        Self { matrix: DMatrix::zeros(velocities, velocities), is_zero: true }
    }

    pub(crate) fn clear(&mut self) {
        if !self.is_zero {
            self.matrix.fill(0.0);
            self.is_zero = true;
        }
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.is_zero
    }

    pub(crate) fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// dᵀ H d.
    pub(crate) fn along(&self, direction: &[f64]) -> f64 {
        let columns = self.matrix.column_iter().zip(direction);
        columns.map(|(c, d)| d * c.iter().zip(direction).map(|(a, b)| a * b).sum::<f64>()).sum()
    }

    /// (I − s d dᵀ) H (I − s d dᵀ).
    pub(crate) fn project(&mut self, d: &[f64], s: f64, room: &mut [f64]) {
        let n = d.len();
        for i in 0..n {
            room[i] = (0..n).map(|j| self.matrix[(i, j)] * d[j]).sum();
        }
        let along: f64 = room.iter().zip(d).map(|(a, b)| a * b).sum();
        for i in 0..n {
            for j in 0..n {
                self.matrix[(i, j)] += s * s * along * d[i] * d[j] - s * (room[i] * d[j] + d[i] * room[j]);
            }
        }
    }

    pub(crate) fn scale(&mut self, d: &[f64]) {
        for i in 0..d.len() {
            for j in 0..d.len() {
                self.matrix[(i, j)] *= d[i] * d[j];
            }
        }
    }

    pub(crate) fn add_scaled(&mut self, other: &Self, factor: f64) {
        self.is_zero = false;
        self.matrix.iter_mut().zip(other.matrix.iter()).for_each(|(a, b)| *a += factor * b);
    }

    /// Adds that of a frame's position, `missing` \[m\] in the axes of the Jacobian: with joint i before
    /// joint j, ∂²p/∂qᵢ∂qⱼ = J_ω,ᵢ × J_v,ⱼ.
    pub(crate) fn add_position(&mut self, jacobian: &Matrix6xX<f64>, missing: &Vector3<f64>) {
        self.add(jacobian, 0, missing);
    }

    /// Adds that of a frame's orientation, `missing` \[rad\] being a rotation vector: the symmetric part
    /// of ∂J_ω,ⱼ/∂qᵢ = J_ω,ᵢ × J_ω,ⱼ, the other one being that of the rotation vector itself.
    pub(crate) fn add_orientation(&mut self, jacobian: &Matrix6xX<f64>, missing: &Vector3<f64>) {
        self.add(jacobian, 3, &(0.5 * missing));
    }

    /// Adds −r · (J_ω,ᵢ × Jⱼ), Jⱼ being the linear part of a column, or with `part` = 3 the angular one.
    fn add(&mut self, jacobian: &Matrix6xX<f64>, part: usize, missing: &Vector3<f64>) {
        self.is_zero = false;
        for (i, first) in jacobian.column_iter().enumerate() {
            let turn = missing.cross(&first.fixed_rows::<3>(3));
            for (j, second) in jacobian.column_iter().enumerate().skip(i) {
                let value = turn.dot(&second.fixed_rows::<3>(part));
                self.matrix[(i, j)] -= value;
                if i != j {
                    self.matrix[(j, i)] -= value;
                }
            }
        }
    }
}
