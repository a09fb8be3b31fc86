//! Reflections of many rows at once, for the widest vector units that the machine has.
//!
//! Each kernel is one plain loop, compiled twice: for the baseline of the target, and, on
//! x86-64, for AVX2 with fused multiply-add, chosen at run time. The two differ in rounding, so
//! results are the same to the bit on one machine, not from one to another.

#![allow(unsafe_code)]

/// Rows of a matrix: row i starts at `i * stride`.
#[derive(Debug)]
pub(crate) struct RowsMut<'a> {
    pub(crate) data: &'a mut [f64],
    pub(crate) stride: usize,
}

/// A plane rotation of two neighbouring rows: row i ← c row i + s row i+1, and
/// row i+1 ← c row i+1 − s row i.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rotation {
    /// i.
    pub(crate) first: usize,
    pub(crate) cosine: f64,
    pub(crate) sine: f64,
}

/// Rotates rows of a matrix, one rotation after the other.
pub(crate) fn rotate_rows(rows: &mut RowsMut<'_>, rotations: &[Rotation]) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { rotate_rows_avx2(rows, rotations) };
        return;
    }
    rotate_rows_with::<false>(rows, rotations);
}

/// row ← row (I − τvvᵀ) for every row, on the entries from `start` on; `v` holds those entries.
pub(crate) fn reflect_rows(rows: &mut RowsMut<'_>, start: usize, v: &[f64], tau: f64) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { reflect_rows_avx2(rows, start, v, tau) };
        return;
    }
    reflect_rows_with::<false>(rows, start, v, tau);
}

/// Combines rows: row j ← row j − τ vⱼ Σᵢ vᵢ row i, for as many rows as `v` has entries; `image`
/// is scratch of a row's length.
pub(crate) fn mix_rows(rows: &mut RowsMut<'_>, v: &[f64], tau: f64, image: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { mix_rows_avx2(rows, v, tau, image) };
        return;
    }
    mix_rows_with::<false>(rows, v, tau, image);
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn reflect_rows_avx2(rows: &mut RowsMut<'_>, start: usize, v: &[f64], tau: f64) {
    reflect_rows_with::<true>(rows, start, v, tau);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn mix_rows_avx2(rows: &mut RowsMut<'_>, v: &[f64], tau: f64, image: &mut [f64]) {
    mix_rows_with::<true>(rows, v, tau, image);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn rotate_rows_avx2(rows: &mut RowsMut<'_>, rotations: &[Rotation]) {
    rotate_rows_with::<true>(rows, rotations);
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn rotate_rows_with<const FUSED: bool>(rows: &mut RowsMut<'_>, rotations: &[Rotation]) {
    let stride = rows.stride;
    for &Rotation { first, cosine, sine } in rotations {
        let pair = rows.data.get_mut(first * stride..(first + 2) * stride).unwrap_or_default();
        let (a, b) = pair.split_at_mut(pair.len() / 2);
        for (x, y) in a.iter_mut().zip(b) {
            let (p, q) = (*x, *y);
            *x = multiply_add::<FUSED>(cosine, p, sine * q);
            *y = multiply_add::<FUSED>(cosine, q, -(sine * p));
        }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn reflect_rows_with<const FUSED: bool>(rows: &mut RowsMut<'_>, start: usize, v: &[f64], tau: f64) {
    let end = start + v.len();
    for row in rows.data.chunks_mut(rows.stride) {
        let Some(part) = row.get_mut(start..end) else { continue };
        let weight = -tau * dot::<FUSED>(part, v);
        add_scaled::<FUSED>(part, weight, v);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn mix_rows_with<const FUSED: bool>(
    rows: &mut RowsMut<'_>,
    v: &[f64],
    tau: f64,
    image: &mut [f64],
) {
    image.fill(0.0);
    for (row, &weight) in rows.data.chunks(rows.stride).zip(v) {
        if weight != 0.0 {
            add_scaled::<FUSED>(image, weight, row);
        }
    }
    for (row, &weight) in rows.data.chunks_mut(rows.stride).zip(v) {
        if weight != 0.0 {
            add_scaled::<FUSED>(row, -tau * weight, image);
        }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn dot<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let (a_rest, b_rest) = (a8.remainder(), b8.remainder());
    for (x, y) in a8.zip(b8) {
        for i in 0..8 {
            sum[i] = multiply_add::<FUSED>(x[i], y[i], sum[i]);
        }
    }
    let (a4, b4) = (a_rest.chunks_exact(4), b_rest.chunks_exact(4));
    let (a_rest, b_rest) = (a4.remainder(), b4.remainder());
    for (x, y) in a4.zip(b4) {
        for i in 0..4 {
            sum[i] = multiply_add::<FUSED>(x[i], y[i], sum[i]);
        }
    }
    let mut tail = 0.0;
    for (x, y) in a_rest.iter().zip(b_rest) {
        tail = multiply_add::<FUSED>(*x, *y, tail);
    }
    ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7])) + tail
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn add_scaled<const FUSED: bool>(y: &mut [f64], alpha: f64, x: &[f64]) {
    for (to, from) in y.iter_mut().zip(x) {
        *to = multiply_add::<FUSED>(alpha, *from, *to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rows_of(data: &mut [f64], stride: usize) -> RowsMut<'_> {
        RowsMut { data, stride }
    }

    /// What both kernels are: multiplication by I − τvvᵀ, from the right or from the left.
    fn reflected(matrix: &[f64], columns: usize, v: &[f64], tau: f64, left: bool) -> Vec<f64> {
        let rows = matrix.len() / columns;
        let mut out = matrix.to_vec();
        for i in 0..rows {
            for j in 0..columns {
                let change: f64 = if left {
                    (0..rows).map(|k| v[k] * matrix[k * columns + j]).sum::<f64>() * v[i]
                } else {
                    (0..columns).map(|k| matrix[i * columns + k] * v[k]).sum::<f64>() * v[j]
                };
                out[i * columns + j] -= tau * change;
            }
        }
        out
    }

    proptest! {
        #[test]
        fn both_versions_are_the_plain_product(
            rows in 1_usize..9, columns in 1_usize..23, start in 0_usize..5, tau in 0.0..2.0_f64,
            entries in prop::collection::vec(-1.0..1.0_f64, 9 * 23),
            v in prop::collection::vec(-1.0..1.0_f64, 23),
        ) {
            let start = start.min(columns - 1);
            let matrix = &entries[..rows * columns];
            let mut wide = vec![0.0; columns];
            wide[start..].copy_from_slice(&v[..columns - start]);
            let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-12);

            let expected = reflected(matrix, columns, &wide, tau, false);
            let mut plain = matrix.to_vec();
            reflect_rows_with::<false>(&mut rows_of(&mut plain, columns), start, &wide[start..], tau);
            let mut fast = matrix.to_vec();
            reflect_rows(&mut rows_of(&mut fast, columns), start, &wide[start..], tau);
            prop_assert!(close(&plain, &expected) && close(&fast, &expected));

            let expected = reflected(matrix, columns, &v[..rows], tau, true);
            let mut image = vec![0.0; columns];
            let mut plain = matrix.to_vec();
            mix_rows_with::<false>(&mut rows_of(&mut plain, columns), &v[..rows], tau, &mut image);
            let mut fast = matrix.to_vec();
            mix_rows(&mut rows_of(&mut fast, columns), &v[..rows], tau, &mut image);
            prop_assert!(close(&plain, &expected) && close(&fast, &expected));
        }
    }
}
