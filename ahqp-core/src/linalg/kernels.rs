//! Products and reflections of many rows at once, for the machine's vector units.
//!
//! Each kernel is written once, over four numbers at a time, and compiled twice: for every machine,
//! and on x86-64 for AVX2 with fused multiply-add. The choice is made at run time. The two differ
//! in rounding. Results are identical to the bit on one machine, but not between machines.

mod lanes;
mod loops;

use crate::linalg::vector::dot;
use lanes::Portable;
use loops as with;
pub(crate) use loops::{rows, rows_mut};

/// Rows of a matrix. Row i starts at `i * stride`.
#[derive(Debug)]
pub(crate) struct RowsMut<'a> {
    pub(crate) data: &'a mut [f64],
    pub(crate) stride: usize,
}

/// A plane rotation of two rows: the first ← c first + s second, the second ← c second − s first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rotation {
    pub(crate) first: usize,
    pub(crate) second: usize,
    pub(crate) cosine: f64,
    pub(crate) sine: f64,
}

/// Rows that move along a direction: aᵢx at its start and its end, and their bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingRows<'a> {
    pub(crate) value: &'a [f64],
    pub(crate) slope: &'a [f64],
    /// Parts of the values that fall to zero on the way.
    pub(crate) residual: &'a [f64],
    pub(crate) lower: &'a [f64],
    pub(crate) upper: &'a [f64],
}

/// Four reflections in one, I − V T Vᵀ (compact WY form: Schreiber, Van Loan, SIAM Journal on
/// Scientific and Statistical Computing 10, 1989).
#[derive(Debug)]
pub(crate) struct FourReflections<'a> {
    /// The columns of V, of one length.
    v: [&'a [f64]; 4],
    t: BlockFactor,
}

/// The triangular T of four reflections.
pub(crate) type BlockFactor = [[f64; 4]; 4];

impl<'a> FourReflections<'a> {
    /// Returns T of H₀ H₁ H₂ H₃ with Hᵢ = I − τᵢvᵢvᵢᵀ.
    pub(crate) fn factor(v: [&[f64]; 4], tau: &[f64]) -> BlockFactor {
        let mut t = [[0.0; 4]; 4];
        for (j, &tau) in tau.iter().enumerate().take(4) {
            let along: [f64; 4] =
                std::array::from_fn(|i| if i < j { dot(v[i], v[j]) } else { 0.0 });
            for (i, row) in t.iter_mut().enumerate().take(j) {
                let sum: f64 = (i..j).map(|l| row[l] * along[l]).sum();
                row[j] = -tau * sum;
            }
            t[j][j] = tau;
        }
        t
    }

    /// Creates H₀ H₁ H₂ H₃, which applies H₀ to a row first.
    pub(crate) fn forward(v: [&'a [f64]; 4], factor: &BlockFactor) -> Self {
        Self { v, t: *factor }
    }

    /// Creates H₃ H₂ H₁ H₀.
    pub(crate) fn backward(v: [&'a [f64]; 4], factor: &BlockFactor) -> Self {
        Self { v, t: std::array::from_fn(|i| std::array::from_fn(|j| factor[j][i])) }
    }
}

/// Compiles a loop of [`loops`] for both kinds of machine, and chooses at run time.
macro_rules! kernel {
    ($(#[$doc:meta])* $name:ident($($argument:ident: $kind:ty),*)) => {
        $(#[$doc])*
        #[allow(unsafe_code)]
        pub(crate) fn $name($($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma")]
                fn avx2($($argument: $kind),*) {
                    with::$name::<lanes::Avx2>($($argument),*);
                }
                if std::arch::is_x86_feature_detected!("avx2")
                    && std::arch::is_x86_feature_detected!("fma")
                {
                    // SAFETY: the machine has AVX2 and FMA, as just detected. Nothing else is
                    // required.
                    unsafe { avx2($($argument),*) };
                    return;
                }
            }
            with::$name::<Portable>($($argument),*);
        }
    };
}

kernel! {
    /// Rotates rows of a matrix, one rotation after the other.
    rotate_rows(rows: &mut RowsMut<'_>, rotations: &[Rotation])
}

kernel! {
    /// row ← row (I − τvvᵀ) for every row, on the entries from `start` on; `v` holds those entries.
    reflect_rows(rows: &mut RowsMut<'_>, start: usize, v: &[f64], tau: f64)
}

kernel! {
    /// row ← row (I − V T Vᵀ) for every row, on the entries from `start` on; V has those entries.
    reflect_rows_four(rows: &mut RowsMut<'_>, start: usize, four: &FourReflections<'_>)
}

kernel! {
    /// Combines rows: row j ← row j − τ vⱼ Σᵢ vᵢ row i, for the first rows, one for each entry of
    /// `v`. Only the first `width` entries of each row change.
    mix_rows(rows: &mut RowsMut<'_>, width: usize, v: &[f64], tau: f64)
}

kernel! {
    /// Reflects dependent rows into lower triangular pivots, from the last column to the first.
    ///
    /// Each row begins with its target; the columns follow. Row 0 of `stack` is working memory, and
    /// the dependent rows follow it. `column` has an entry for each row of the stack. The target of
    /// a pivot becomes zero where the forces of rows balance each other: they sum up to less than
    /// `rounding` of their terms, and to less than those of a target of `least`.
    triangularise(
        stack: &mut RowsMut<'_>,
        pivots: &mut [f64],
        column: &mut [f64],
        least: f64,
        rounding: f64
    )
}

kernel! {
    /// Multiplies the rows of a matrix, which start `stride` apart in `data`, by `x`. Computes one
    /// product for each entry of `out`.
    multiply_rows(data: &[f64], stride: usize, x: &[f64], out: &mut [f64])
}

kernel! {
    /// Finds which of up to 64 rows are outside their bounds after a step of this length. Each row
    /// is one bit of `out`.
    rows_outside(rows: MovingRows<'_>, length: f64, out: &mut u64)
}

kernel! {
    /// out ← out + Σᵢ weightᵢ row i, in the first entries of the rows.
    add_rows(data: &[f64], stride: usize, weights: &[f64], out: &mut [f64])
}

kernel! {
    /// Computes the squared norms of rows that start `stride` apart, one for each entry of `out`.
    square_rows(data: &[f64], stride: usize, out: &mut [f64])
}

/// Σ aᵢ².
pub(crate) fn square(entries: &[f64]) -> f64 {
    let mut square = [0.0];
    if !entries.is_empty() {
        square_rows(entries, entries.len(), &mut square);
    }
    square[0]
}

#[cfg(test)]
mod tests;
