//! Least squares with a tall matrix of full column rank, in place.

use crate::linalg::kernels::{RowsMut, reflect_rows};
use crate::linalg::vector::{add_scaled, dot, reflector};

/// Minimise ½‖L t − c‖² + dᵀt by R of L = Q'R: Rᵀ(R t − Q'ᵀc) = −d.
///
/// `columns` holds the columns of L, of size m each, one after the other; `target` is c, of size
/// m; t comes in `out`, whose size is the number of columns. All but `out` are overwritten.
pub(crate) fn solve_tall(
    columns: &mut [f64],
    target: &mut [f64],
    linear: Option<&mut [f64]>,
    out: &mut [f64],
) {
    let (m, rank) = (target.len(), out.len());
    for column in 0..rank {
        let (left, right) = columns.split_at_mut((column + 1) * m);
        let v = &mut left[column * m + column..];
        let (tau, image) = reflector(v);
        let data = &mut right[..(rank - column - 1) * m];
        reflect_rows(&mut RowsMut { data, stride: m }, column, v, tau);
        reflect(&mut target[column..], v, tau);
        v[0] = image;
    }
    if let Some(linear) = linear {
        for i in 0..rank {
            let known: f64 = (0..i).map(|j| columns[i * m + j] * linear[j]).sum();
            linear[i] = (linear[i] - known) / columns[i * m + i];
            target[i] -= linear[i];
        }
    }
    for i in (0..rank).rev() {
        let known: f64 = (i + 1..rank).map(|j| columns[j * m + i] * out[j]).sum();
        out[i] = (target[i] - known) / columns[i * m + i];
    }
}

fn reflect(part: &mut [f64], v: &[f64], tau: f64) {
    let weight = tau * dot(part, v);
    add_scaled(part, -weight, v);
}
