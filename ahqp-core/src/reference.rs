//! The same hierarchy by another road: one Clarabel problem a level, with the optimality of the
//! levels above stacked as equalities. Slow and independent; it is there to check the solver.

use std::ops::Range;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus,
    SupportedConeT::{self, NonnegativeConeT, ZeroConeT},
};
use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::hierarchy::{Hierarchy, Objective};
use crate::rows::Rows;

/// Solves `hierarchy` level by level with Clarabel's interior-point method, to about 1e-9.
///
/// ```
/// use ahqp_core::{Hierarchy, Level, Rows, solve_reference};
/// use nalgebra::{dmatrix, dvector};
///
/// let mut hierarchy = Hierarchy::new(2)?;
/// hierarchy.push(Level::least_squares(Rows::equalities(&dmatrix![1.0, 1.0], &dvector![2.0])?))?;
/// let x = solve_reference(&hierarchy)?;
/// assert!((x[0] - 1.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
///
/// # Errors
/// [`Error::Infeasible`]-like outcomes and numerical failures both come as
/// [`Error::Reference`] with Clarabel's status.
pub fn solve_reference(hierarchy: &Hierarchy) -> Result<DVector<f64>, Error> {
    let n = hierarchy.variables();
    let mut held = Held::new(hierarchy);
    let mut x = DVector::zeros(n);
    for (level, data) in hierarchy.levels().iter().enumerate() {
        held.constrain(data.constraints());
        match data.objective() {
            Objective::None => {}
            Objective::LeastSquares(rows) => {
                x = held.minimise_violation(level, rows)?;
                held.hold_violation(rows, &x);
            }
            Objective::Quadratic { hessian, gradient } => {
                x = held.minimise(level, hessian, gradient, &Rows::zeros(0, n))?;
                held.hold_quadratic(hessian, gradient, &x);
            }
        }
    }
    let levels = hierarchy.levels().len();
    if levels == 0 || held.equalities.len() < n {
        x = held.minimise(
            levels,
            &DMatrix::identity(n, n),
            &DVector::zeros(n),
            &Rows::zeros(0, n),
        )?;
    }
    Ok(x)
}

/// Rows that hold from here down.
struct Held {
    n: usize,
    equalities: Vec<(DVector<f64>, f64)>,
    /// a x ≤ b.
    inequalities: Vec<(DVector<f64>, f64)>,
}

impl Held {
    fn new(hierarchy: &Hierarchy) -> Self {
        let n = hierarchy.variables();
        let mut held = Self { n, equalities: Vec::new(), inequalities: Vec::new() };
        for i in 0..n {
            let mut unit = DVector::zeros(n);
            unit[i] = 1.0;
            held.range(&unit, hierarchy.lower()[i], hierarchy.upper()[i]);
        }
        held
    }

    fn range(&mut self, a: &DVector<f64>, lower: f64, upper: f64) {
        if lower == upper {
            self.equalities.push((a.clone(), lower));
            return;
        }
        if upper.is_finite() {
            self.inequalities.push((a.clone(), upper));
        }
        if lower.is_finite() {
            self.inequalities.push((-a, -lower));
        }
    }

    fn constrain(&mut self, rows: &Rows) {
        for (a, lower, upper) in rows.iter() {
            self.range(&DVector::from_row_slice(a), lower, upper);
        }
    }

    /// min ½‖w‖² with lower ≤ A x − w ≤ upper, over [x; w].
    fn minimise_violation(&self, level: usize, rows: &Rows) -> Result<DVector<f64>, Error> {
        let (n, m) = (self.n, rows.len());
        let mut hessian = DMatrix::zeros(n + m, n + m);
        let mut wide = Rows::zeros(m, n + m);
        for (i, (a, lower, upper)) in rows.iter().enumerate() {
            hessian[(n + i, n + i)] = 1.0;
            if let Some(row) = wide.row_mut(i) {
                row[..n].copy_from_slice(a);
                row[n + i] = -1.0;
            }
            wide.lower_mut()[i] = lower;
            wide.upper_mut()[i] = upper;
        }
        let solution = self.minimise(level, &hessian, &DVector::zeros(n + m), &wide)?;
        Ok(solution.rows(0, n).into_owned())
    }

    fn minimise(
        &self,
        level: usize,
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
        extra: &Rows,
    ) -> Result<DVector<f64>, Error> {
        let size = gradient.len();
        let mut all = Held { n: size, equalities: Vec::new(), inequalities: Vec::new() };
        let widen = |a: &DVector<f64>| a.clone().resize_vertically(size, 0.0);
        all.equalities.extend(independent(&self.equalities).iter().map(|(a, b)| (widen(a), *b)));
        all.inequalities.extend(self.inequalities.iter().map(|(a, b)| (widen(a), *b)));
        all.constrain(extra);
        let equalities = 0..all.equalities.len();
        let rows: Vec<_> = all.equalities.into_iter().chain(all.inequalities).collect();
        solve_quadratic(level, hessian, gradient, &rows, equalities)
    }

    /// Rows that are violated keep their value; the others keep their range.
    fn hold_violation(&mut self, rows: &Rows, x: &DVector<f64>) {
        for (a, lower, upper) in rows.iter() {
            let a = DVector::from_row_slice(a);
            let value = a.dot(x);
            let slack = 1e-7 * (1.0 + value.abs() + a.norm());
            if lower == upper || value > upper + slack || value < lower - slack {
                self.equalities.push((a, value));
            } else {
                self.range(&a, lower.min(value), upper.max(value));
            }
        }
    }

    /// {x : H x = H x*, gᵀx = gᵀx*}.
    fn hold_quadratic(
        &mut self,
        hessian: &DMatrix<f64>,
        gradient: &DVector<f64>,
        x: &DVector<f64>,
    ) {
        for i in 0..self.n {
            let row = hessian.row(i).transpose();
            let value = row.dot(x);
            self.equalities.push((row, value));
        }
        self.equalities.push((gradient.clone(), gradient.dot(x)));
    }
}

/// Equalities without those that depend on others (values of a feasible set agree anyway, but
/// an interior-point method loses digits on repeated rows).
fn independent(rows: &[(DVector<f64>, f64)]) -> Vec<(DVector<f64>, f64)> {
    let mut kept: Vec<(DVector<f64>, f64)> = Vec::new();
    let mut directions: Vec<DVector<f64>> = Vec::new();
    for (a, b) in rows {
        let mut rest = a.clone();
        for _ in 0..2 {
            for direction in &directions {
                let along = direction.dot(&rest);
                rest.axpy(-along, direction, 1.0);
            }
        }
        if rest.norm() > 1e-8 * a.norm() {
            directions.push(rest.normalize());
            kept.push((a / a.norm(), b / a.norm()));
        }
    }
    kept
}

fn solve_quadratic(
    level: usize,
    hessian: &DMatrix<f64>,
    gradient: &DVector<f64>,
    rows: &[(DVector<f64>, f64)],
    equalities: Range<usize>,
) -> Result<DVector<f64>, Error> {
    let size = gradient.len();
    let upper = DMatrix::from_fn(size, size, |i, j| if i <= j { hessian[(i, j)] } else { 0.0 });
    let matrix = DMatrix::from_fn(rows.len(), size, |i, j| rows[i].0[j]);
    let bounds: Vec<f64> = rows.iter().map(|(_, b)| *b).collect();
    let cones: Vec<SupportedConeT<f64>> =
        vec![ZeroConeT(equalities.len()), NonnegativeConeT(rows.len() - equalities.len())];
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-12,
        tol_gap_rel: 1e-12,
        tol_feas: 1e-12,
        max_iter: 200,
        ..DefaultSettings::default()
    };
    let failed = |status: String| Error::Reference { level, status };
    let mut solver = DefaultSolver::new(
        &sparse(&upper),
        gradient.as_slice(),
        &sparse(&matrix),
        &bounds,
        &cones,
        settings,
    )
    .map_err(|error| failed(error.to_string()))?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress => {
            Ok(DVector::from_column_slice(&solver.solution.x))
        }
        status => Err(failed(format!("{status:?}"))),
    }
}

fn sparse(matrix: &DMatrix<f64>) -> CscMatrix<f64> {
    let (rows, columns) = matrix.shape();
    let mut pointers = vec![0];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for column in matrix.column_iter() {
        for (i, &value) in column.iter().enumerate() {
            if value != 0.0 {
                indices.push(i);
                values.push(value);
            }
        }
        pointers.push(indices.len());
    }
    CscMatrix::new(rows, columns, pointers, indices, values)
}
