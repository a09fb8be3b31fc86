//! Subspaces by Gram-Schmidt with pivoting and reorthogonalisation.

use nalgebra::{DMatrix, DVector};

/// A vector depends on others when what they leave of it is below this fraction of it \[-\].
pub(super) const DEPENDENT: f64 = 1e-10;

/// An orthonormal basis of the vectors in the span of `free` that are normal to `rows`.
pub(super) fn complement(free: &DMatrix<f64>, rows: &[DVector<f64>]) -> DMatrix<f64> {
    let seen: Vec<_> = rows.iter().map(|row| (free.tr_mul(row), row.norm())).collect();
    let mut basis = independent_directions(seen);
    let decided = basis.len();
    let k = free.ncols();
    // Unit vectors complete the basis; the one that is least covered comes next.
    while basis.len() < k {
        let rest = (0..k)
            .map(|i| {
                let mut unit = DVector::zeros(k);
                unit[i] = 1.0;
                without(&unit, &basis)
            })
            .max_by(|a, b| a.norm().total_cmp(&b.norm()));
        match rest {
            Some(rest) => basis.push(without(&rest, &basis).normalize()),
            None => break,
        }
    }
    let columns = &basis[decided..];
    free * DMatrix::from_fn(k, columns.len(), |i, j| columns[j][i])
}

/// The point of least norm among those that minimise ½‖B y − c‖² + dᵀy, for d in the range
/// of Bᵀ. Whether a row of B depends on others is judged relative to its entry in `sizes`.
pub(super) fn least_squares(
    b: &DMatrix<f64>,
    sizes: &[f64],
    c: &DVector<f64>,
    d: &DVector<f64>,
) -> Option<DVector<f64>> {
    let rows = b.row_iter().zip(sizes).map(|(row, &size)| (row.transpose(), size)).collect();
    let range = independent_directions(rows);
    if range.is_empty() {
        return Some(DVector::zeros(b.ncols()));
    }
    let range = DMatrix::from_columns(&range);
    let factor = (b * &range).qr();
    let r = factor.r();
    let pull = r.tr_solve_upper_triangular(&range.tr_mul(d))?;
    Some(&range * r.solve_upper_triangular(&(factor.q().tr_mul(c) - pull))?)
}

/// Orthonormal directions that span the vectors, given with the sizes they are judged by.
fn independent_directions(mut vectors: Vec<(DVector<f64>, f64)>) -> Vec<DVector<f64>> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    loop {
        let share = |(rest, size): &(DVector<f64>, f64)| {
            if *size > 0.0 { rest.norm() / size } else { 0.0 }
        };
        let best =
            (0..vectors.len()).max_by(|&i, &j| share(&vectors[i]).total_cmp(&share(&vectors[j])));
        let Some(best) = best.filter(|&i| share(&vectors[i]) > DEPENDENT) else { return basis };
        let direction = without(&vectors[best].0.normalize(), &basis).normalize();
        for (rest, _) in &mut vectors {
            for _ in 0..2 {
                let along = direction.dot(rest);
                rest.axpy(-along, &direction, 1.0);
            }
        }
        vectors.swap_remove(best);
        basis.push(direction);
    }
}

fn without(vector: &DVector<f64>, basis: &[DVector<f64>]) -> DVector<f64> {
    let mut rest = vector.clone();
    for _ in 0..2 {
        for direction in basis {
            let along = direction.dot(&rest);
            rest.axpy(-along, direction, 1.0);
        }
    }
    rest
}
