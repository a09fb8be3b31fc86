//! Eigenvectors of small symmetric matrices.

/// Largest number of sweeps. Six suffice for matrices of ten rows.
const SWEEPS: usize = 20;
/// Share of the diagonal below which an entry beside it counts as rounding.
const ROUNDING: f64 = 1e-15;

/// Diagonalises a symmetric matrix by Jacobi's rotations (Golub and Van Loan, *Matrix Computations*, 4th ed., Sec.
/// 8.5.3). Eigenvalues are left on its diagonal, eigenvectors are written one a row.
pub(crate) fn eigenvectors(matrix: &mut [f64], m: usize, vectors: &mut [f64]) {
    vectors.fill(0.0);
    vectors.iter_mut().step_by(m + 1).for_each(|entry| *entry = 1.0);
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..m {
            for q in p + 1..m {
                let (pp, qq, pq) = (matrix[p * m + p], matrix[q * m + q], matrix[p * m + q]);
                if pq.abs() <= ROUNDING * (pp.abs() + qq.abs()) {
                    continue;
                }
                rotated = true;
                let ratio = 0.5 * (qq - pp) / pq;
                let tangent =
                    1.0_f64.copysign(ratio) / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
                let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                let turn = Turn { cosine, sine: tangent * cosine };
                for row in matrix.chunks_exact_mut(m) {
                    (row[p], row[q]) = turn.apply(row[p], row[q]);
                }
                turn.rows(matrix, m, p, q);
                turn.rows(vectors, m, p, q);
            }
        }
        if !rotated {
            return;
        }
    }
}

struct Turn {
    cosine: f64,
    sine: f64,
}

impl Turn {
    fn apply(&self, a: f64, b: f64) -> (f64, f64) {
        (self.cosine * a - self.sine * b, self.sine * a + self.cosine * b)
    }

    /// Rotates rows p and q, where p < q.
    fn rows(&self, matrix: &mut [f64], m: usize, p: usize, q: usize) {
        let (above, below) = matrix.split_at_mut(q * m);
        for (a, b) in above[p * m..(p + 1) * m].iter_mut().zip(&mut below[..m]) {
            (*a, *b) = self.apply(*a, *b);
        }
    }
}
