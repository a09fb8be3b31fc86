//! Second derivatives of controlled quantities.

use nalgebra::{DMatrix, Matrix6xX, Vector3};

/// The curvature of a level's tasks for given residuals: −Σ rₖ ∇²yₖ, n × n for n entries of q̇. The tasks control y,
/// and r is the residual.
///
/// It is the part of the Hessian of ½ ‖y_d − y‖² that the Gauss-Newton approximation Jᵀ J leaves out. It matters where
/// errors remain (Nocedal and Wright, *Numerical Optimization*, 2nd ed., Sec. 10.2).
#[derive(Debug, Clone)]
pub struct Curvature {
    matrix: DMatrix<f64>,
    is_zero: bool,
    /// Products of the matrix and a direction.
    products: Vec<f64>,
}

impl Curvature {
    pub(crate) fn new(velocities: usize) -> Self {
        let products = vec![0.0; velocities];
        Self { matrix: DMatrix::zeros(velocities, velocities), is_zero: true, products }
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

    /// The largest entry.
    pub(crate) fn size(&self) -> f64 {
        self.matrix.amax()
    }

    /// dᵀ H d of a direction d of the joints.
    pub(crate) fn along(&self, direction: &[f64]) -> f64 {
        let columns = self.matrix.column_iter().zip(direction);
        columns.map(|(c, d)| d * c.iter().zip(direction).map(|(h, d)| h * d).sum::<f64>()).sum()
    }

    /// Removes a share s of a direction d of the joints: (I − s d dᵀ) H (I − s d dᵀ).
    pub(crate) fn take_out(&mut self, direction: &[f64], share: f64) {
        let products = self.matrix.column_iter().zip(&mut self.products);
        for (column, product) in products {
            *product = column.iter().zip(direction).map(|(h, d)| h * d).sum();
        }
        let along: f64 = self.products.iter().zip(direction).map(|(p, d)| p * d).sum();
        let columns = self.matrix.column_iter_mut().zip(direction.iter().zip(&self.products));
        for (mut column, (own, own_product)) in columns {
            let entries = column.iter_mut().zip(direction.iter().zip(&self.products));
            for (entry, (d, product)) in entries {
                *entry -= share * (d * own_product + product * own - share * along * d * own);
            }
        }
    }

    /// Adds another curvature times `factor`.
    pub(crate) fn add_scaled(&mut self, other: &Self, factor: f64) {
        self.is_zero = false;
        self.matrix.iter_mut().zip(&other.matrix).for_each(|(own, other)| *own += factor * other);
    }

    /// Adds the curvature of a frame's position, with `missing` \[m\] in the axes of the Jacobian. If joint i comes
    /// before joint j, ∂²p/∂qᵢ∂qⱼ = J_ω,ᵢ × J_v,ⱼ.
    pub fn add_position(&mut self, jacobian: &Matrix6xX<f64>, missing: &Vector3<f64>) {
        self.add(jacobian, 0, missing);
    }

    /// Adds the curvature of a frame's orientation, with the rotation vector `missing` \[rad\]. It is the symmetric
    /// part of ∂J_ω,ⱼ/∂qᵢ = J_ω,ᵢ × J_ω,ⱼ; the other part is that of the rotation vector itself.
    pub fn add_orientation(&mut self, jacobian: &Matrix6xX<f64>, missing: &Vector3<f64>) {
        self.add(jacobian, 3, &(0.5 * missing));
    }

    /// Adds −r · (J_ω,ᵢ × Jⱼ), where Jⱼ is the linear part of a column, or the angular one for `part` = 3.
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
