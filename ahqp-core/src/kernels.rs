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

/// A plane rotation of two rows: the first ← c first + s second, the second ← c second − s first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rotation {
    pub(crate) first: usize,
    pub(crate) second: usize,
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

/// Combines rows: row j ← row j − τ vⱼ Σᵢ vᵢ row i, for as many rows as `v` has entries.
pub(crate) fn mix_rows(rows: &mut RowsMut<'_>, v: &[f64], tau: f64) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { mix_rows_avx2(rows, v, tau) };
        return;
    }
    mix_rows_with::<false>(rows, v, tau);
}

/// The product of a matrix, whose rows start `stride` apart in `data`, with `x`; as many rows as
/// `out` has entries.
pub(crate) fn multiply_rows(data: &[f64], stride: usize, x: &[f64], out: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { multiply_rows_avx2(data, stride, x, out) };
        return;
    }
    multiply_rows_with::<false>(data, stride, x, out);
}

/// out ← out + Σᵢ weightᵢ row i.
pub(crate) fn add_rows(data: &[f64], stride: usize, weights: &[f64], out: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { add_rows_avx2(data, stride, weights, out) };
        return;
    }
    add_rows_with::<false>(data, stride, weights, out);
}

/// Squares of the norms of rows that start `stride` apart; as many as `out` has entries.
pub(crate) fn square_rows(data: &[f64], stride: usize, out: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { square_rows_avx2(data, stride, out) };
        return;
    }
    square_rows_with::<false>(data, stride, out);
}

/// Four reflections as one, I − V T Vᵀ = H₀ H₁ H₂ H₃ (Schreiber & Van Loan, SIAM Journal on
/// Scientific and Statistical Computing 10, 1989): the columns of V, all of one length, and T,
/// row after row.
#[derive(Debug)]
pub(crate) struct FourReflections<'a> {
    pub(crate) v: [&'a [f64]; 4],
    pub(crate) t: [[f64; 4]; 4],
}

impl<'a> FourReflections<'a> {
    pub(crate) fn new(v: [&'a [f64]; 4], tau: [f64; 4]) -> Self {
        let mut t = [[0.0; 4]; 4];
        for j in 0..4 {
            let mut along = [0.0; 4];
            for (entry, other) in along.iter_mut().zip(&v[..j]) {
                *entry = crate::vector::dot(other, v[j]);
            }
            for i in 0..j {
                t[i][j] = -tau[j] * (i..j).map(|l| t[i][l] * along[l]).sum::<f64>();
            }
            t[j][j] = tau[j];
        }
        Self { v, t }
    }
}

/// row ← row H₀ H₁ H₂ H₃ for every row, on the entries from `start` on.
pub(crate) fn reflect_rows_four(rows: &mut RowsMut<'_>, start: usize, four: &FourReflections<'_>) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { reflect_rows_four_avx2(rows, start, four) };
        return;
    }
    reflect_rows_four_with::<false>(rows, start, four);
}

/// Combines rows by H₃ H₂ H₁ H₀ from the left, for as many rows as the reflections have entries.
pub(crate) fn mix_rows_four(rows: &mut RowsMut<'_>, four: &FourReflections<'_>) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the machine has AVX2 and FMA, as just detected; the function asks no more.
        unsafe { mix_rows_four_avx2(rows, four) };
        return;
    }
    mix_rows_four_with::<false>(rows, four);
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
fn mix_rows_avx2(rows: &mut RowsMut<'_>, v: &[f64], tau: f64) {
    mix_rows_with::<true>(rows, v, tau);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn multiply_rows_avx2(data: &[f64], stride: usize, x: &[f64], out: &mut [f64]) {
    multiply_rows_with::<true>(data, stride, x, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn add_rows_avx2(data: &[f64], stride: usize, weights: &[f64], out: &mut [f64]) {
    add_rows_with::<true>(data, stride, weights, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn square_rows_avx2(data: &[f64], stride: usize, out: &mut [f64]) {
    square_rows_with::<true>(data, stride, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn reflect_rows_four_avx2(rows: &mut RowsMut<'_>, start: usize, four: &FourReflections<'_>) {
    reflect_rows_four_with::<true>(rows, start, four);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn mix_rows_four_avx2(rows: &mut RowsMut<'_>, four: &FourReflections<'_>) {
    mix_rows_four_with::<true>(rows, four);
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
    for &Rotation { first, second, cosine, sine } in rotations {
        let places = [first, second].map(|row| row * stride..(row + 1) * stride);
        let Ok([a, b]) = rows.data.get_disjoint_mut(places) else { continue };
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
    let (stride, end) = (rows.stride, start + v.len());
    let mut four = rows.data.chunks_exact_mut(4 * stride);
    for block in &mut four {
        let (a, rest) = block.split_at_mut(stride);
        let (b, rest) = rest.split_at_mut(stride);
        let (c, d) = rest.split_at_mut(stride);
        let parts =
            [&mut a[start..end], &mut b[start..end], &mut c[start..end], &mut d[start..end]];
        let weights = dots::<FUSED>(parts.each_ref().map(|part| &**part), v);
        for (part, weight) in parts.into_iter().zip(weights) {
            add_scaled::<FUSED>(part, -tau * weight, v);
        }
    }
    for row in four.into_remainder().chunks_mut(stride) {
        let Some(part) = row.get_mut(start..end) else { continue };
        let weight = -tau * dot::<FUSED>(part, v);
        add_scaled::<FUSED>(part, weight, v);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn square_rows_with<const FUSED: bool>(data: &[f64], stride: usize, out: &mut [f64]) {
    for (row, square) in data.chunks_exact(stride).zip(out) {
        *square = dot::<FUSED>(row, row);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn reflect_rows_four_with<const FUSED: bool>(
    rows: &mut RowsMut<'_>,
    start: usize,
    four: &FourReflections<'_>,
) {
    let length = four.v[0].len();
    let [(a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)] = four.v.map(|v| v.as_chunks::<4>());
    for row in rows.data.chunks_mut(rows.stride) {
        let Some(part) = row.get_mut(start..start + length) else { continue };
        let along = dots::<FUSED>(four.v, part);
        let mut weights = [0.0; 4];
        for (i, &along) in along.iter().enumerate() {
            for (weight, &t) in weights.iter_mut().zip(&four.t[i]) {
                *weight -= along * t;
            }
        }
        let (chunks, rest) = part.as_chunks_mut::<4>();
        for ((((x, p), q), r), s) in chunks.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            for i in 0..4 {
                let first = multiply_add::<FUSED>(weights[1], q[i], weights[0] * p[i]);
                let second = multiply_add::<FUSED>(weights[3], s[i], weights[2] * r[i]);
                x[i] += first + second;
            }
        }
        let tails = a_rest.iter().zip(b_rest).zip(c_rest).zip(d_rest);
        for (x, (((p, q), r), s)) in rest.iter_mut().zip(tails) {
            *x += weights[0] * p + weights[1] * q + weights[2] * r + weights[3] * s;
        }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn mix_rows_four_with<const FUSED: bool>(rows: &mut RowsMut<'_>, four: &FourReflections<'_>) {
    let stride = rows.stride;
    let wide = stride - stride % 8;
    for start in (0..wide).step_by(8) {
        mix_columns_four::<FUSED, 8>(rows, start, four);
    }
    let narrow = stride - stride % 4;
    for start in (wide..narrow).step_by(4) {
        mix_columns_four::<FUSED, 4>(rows, start, four);
    }
    for start in narrow..stride {
        mix_columns_four::<FUSED, 1>(rows, start, four);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn mix_columns_four<const FUSED: bool, const W: usize>(
    rows: &mut RowsMut<'_>,
    start: usize,
    four: &FourReflections<'_>,
) {
    let [a, b, c, d] = four.v;
    let weights = || a.iter().zip(b).zip(c).zip(d).map(|(((a, b), c), d)| [*a, *b, *c, *d]);
    let mut images = [[0.0; W]; 4];
    for (row, weights) in rows.data.chunks_exact(rows.stride).zip(weights()) {
        if let Some(part) = row[start..].first_chunk::<W>() {
            for (image, weight) in images.iter_mut().zip(weights) {
                for i in 0..W {
                    image[i] = multiply_add::<FUSED>(weight, part[i], image[i]);
                }
            }
        }
    }
    let mut turned = [[0.0; W]; 4];
    for (image, t) in images.iter().zip(&four.t) {
        for (to, &t) in turned.iter_mut().zip(t) {
            for i in 0..W {
                to[i] = multiply_add::<FUSED>(-t, image[i], to[i]);
            }
        }
    }
    for (row, weights) in rows.data.chunks_exact_mut(rows.stride).zip(weights()) {
        if let Some(part) = row[start..].first_chunk_mut::<W>() {
            for (image, weight) in turned.iter().zip(weights) {
                for i in 0..W {
                    part[i] = multiply_add::<FUSED>(weight, image[i], part[i]);
                }
            }
        }
    }
}

/// Entries of a row that are mixed at a time: their sums stay in registers.
const WIDTH: usize = 16;

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn mix_rows_with<const FUSED: bool>(rows: &mut RowsMut<'_>, v: &[f64], tau: f64) {
    let stride = rows.stride;
    let wide = stride - stride % WIDTH;
    for start in (0..wide).step_by(WIDTH) {
        mix_columns::<FUSED, WIDTH>(rows, start, v, tau);
    }
    let narrow = stride - stride % 4;
    for start in (wide..narrow).step_by(4) {
        mix_columns::<FUSED, 4>(rows, start, v, tau);
    }
    for start in narrow..stride {
        mix_columns::<FUSED, 1>(rows, start, v, tau);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn mix_columns<const FUSED: bool, const W: usize>(
    rows: &mut RowsMut<'_>,
    start: usize,
    v: &[f64],
    tau: f64,
) {
    let mut image = [0.0; W];
    for (row, &weight) in rows.data.chunks_exact(rows.stride).zip(v) {
        if let Some(part) = row[start..].first_chunk::<W>() {
            for i in 0..W {
                image[i] = multiply_add::<FUSED>(weight, part[i], image[i]);
            }
        }
    }
    for (row, &weight) in rows.data.chunks_exact_mut(rows.stride).zip(v) {
        let weight = -tau * weight;
        if let Some(part) = row[start..].first_chunk_mut::<W>() {
            for i in 0..W {
                part[i] = multiply_add::<FUSED>(weight, image[i], part[i]);
            }
        }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The products of four rows with one vector.
#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn dots<const FUSED: bool>(rows: [&[f64]; 4], v: &[f64]) -> [f64; 4] {
    let mut sums = [[0.0; 4]; 4];
    let (chunks, rest) = v.as_chunks::<4>();
    let [a, b, c, d] = rows.map(|row| row.as_chunks::<4>().0);
    for ((((x, p), q), r), s) in chunks.iter().zip(a).zip(b).zip(c).zip(d) {
        for i in 0..4 {
            sums[0][i] = multiply_add::<FUSED>(x[i], p[i], sums[0][i]);
            sums[1][i] = multiply_add::<FUSED>(x[i], q[i], sums[1][i]);
            sums[2][i] = multiply_add::<FUSED>(x[i], r[i], sums[2][i]);
            sums[3][i] = multiply_add::<FUSED>(x[i], s[i], sums[3][i]);
        }
    }
    let mut total = sums.map(|sum| (sum[0] + sum[2]) + (sum[1] + sum[3]));
    let done = v.len() - rest.len();
    for (i, x) in rest.iter().enumerate() {
        for (sum, row) in total.iter_mut().zip(rows) {
            *sum = multiply_add::<FUSED>(*x, row[done + i], *sum);
        }
    }
    total
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

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn multiply_rows_with<const FUSED: bool>(data: &[f64], stride: usize, x: &[f64], out: &mut [f64]) {
    let mut four = data.chunks_exact(4 * stride);
    let mut results = out.chunks_exact_mut(4);
    for (block, result) in (&mut four).zip(&mut results) {
        let row = |i: usize| &block[i * stride..i * stride + x.len()];
        result.copy_from_slice(&dots::<FUSED>([row(0), row(1), row(2), row(3)], x));
    }
    let done = (data.len() / stride / 4 * 4).min(out.len() / 4 * 4);
    for (row, result) in data[done * stride..].chunks_exact(stride).zip(&mut out[done..]) {
        *result = dot::<FUSED>(&row[..x.len()], x);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn add_rows_with<const FUSED: bool>(data: &[f64], stride: usize, weights: &[f64], out: &mut [f64]) {
    let wide = stride - stride % WIDTH;
    for start in (0..wide).step_by(WIDTH) {
        add_columns::<FUSED, WIDTH>(data, stride, start, weights, out);
    }
    let narrow = stride - stride % 4;
    for start in (wide..narrow).step_by(4) {
        add_columns::<FUSED, 4>(data, stride, start, weights, out);
    }
    for start in narrow..stride {
        add_columns::<FUSED, 1>(data, stride, start, weights, out);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "takes the vector units of the function around it")]
fn add_columns<const FUSED: bool, const W: usize>(
    data: &[f64],
    stride: usize,
    start: usize,
    weights: &[f64],
    out: &mut [f64],
) {
    let mut sum = [0.0; W];
    for (row, &weight) in data.chunks_exact(stride).zip(weights) {
        if let Some(part) = row[start..].first_chunk::<W>() {
            for i in 0..W {
                sum[i] = multiply_add::<FUSED>(weight, part[i], sum[i]);
            }
        }
    }
    for (to, from) in out[start..].iter_mut().zip(sum) {
        *to += from;
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
            let mut plain = matrix.to_vec();
            mix_rows_with::<false>(&mut rows_of(&mut plain, columns), &v[..rows], tau);
            let mut fast = matrix.to_vec();
            mix_rows(&mut rows_of(&mut fast, columns), &v[..rows], tau);
            prop_assert!(close(&plain, &expected) && close(&fast, &expected));

            let x = &wide[..columns];
            let expected: Vec<f64> = matrix
                .chunks(columns)
                .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
                .collect();
            let (mut plain, mut fast) = (vec![0.0; rows], vec![0.0; rows]);
            multiply_rows_with::<false>(matrix, columns, x, &mut plain);
            multiply_rows(matrix, columns, x, &mut fast);
            prop_assert!(close(&plain, &expected) && close(&fast, &expected));

            let expected: Vec<f64> = (0..columns)
                .map(|j| 1.0 + (0..rows).map(|i| v[i] * matrix[i * columns + j]).sum::<f64>())
                .collect();
            let (mut plain, mut fast) = (vec![1.0; columns], vec![1.0; columns]);
            add_rows_with::<false>(matrix, columns, &v[..rows], &mut plain);
            add_rows(matrix, columns, &v[..rows], &mut fast);
            prop_assert!(close(&plain, &expected) && close(&fast, &expected));
        }

        #[test]
        fn four_reflections_at_once_are_one_after_the_other(
            rows in 4_usize..9, columns in 5_usize..23, start in 0_usize..4,
            entries in prop::collection::vec(-1.0..1.0_f64, 9 * 23),
            vectors in prop::collection::vec(-1.0..1.0_f64, 4 * 23),
        ) {
            let matrix = &entries[..rows * columns];
            let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-10);
            for (length, left) in [(columns - start, false), (rows, true)] {
                let v: [&[f64]; 4] = std::array::from_fn(|i| &vectors[i * 23..i * 23 + length]);
                let tau = v.map(|v| 2.0 / v.iter().map(|x| x * x).sum::<f64>());
                let four = FourReflections::new(v, tau);
                let mut expected = matrix.to_vec();
                let (mut plain, mut fast) = (matrix.to_vec(), matrix.to_vec());
                for (v, tau) in v.into_iter().zip(tau) {
                    let mut rows = rows_of(&mut expected, columns);
                    if left {
                        mix_rows(&mut rows, v, tau);
                    } else {
                        reflect_rows(&mut rows, start, v, tau);
                    }
                }
                if left {
                    mix_rows_four_with::<false>(&mut rows_of(&mut plain, columns), &four);
                    mix_rows_four(&mut rows_of(&mut fast, columns), &four);
                } else {
                    reflect_rows_four_with::<false>(&mut rows_of(&mut plain, columns), start, &four);
                    reflect_rows_four(&mut rows_of(&mut fast, columns), start, &four);
                }
                prop_assert!(close(&plain, &expected) && close(&fast, &expected));
            }
        }

        #[test]
        fn a_chain_of_rotations_is_one_after_the_other(
            rows in 2_usize..9, columns in 1_usize..23,
            entries in prop::collection::vec(-1.0..1.0_f64, 9 * 23),
            chain in prop::collection::vec((0_usize..8, 0.0..6.3_f64), 1..12),
        ) {
            let matrix = &entries[..rows * columns];
            let rotations: Vec<_> = chain
                .iter()
                .map(|&(first, angle)| Rotation {
                    first: first % rows,
                    second: (first + 1) % rows,
                    cosine: angle.cos(),
                    sine: angle.sin(),
                })
                .collect();
            let mut expected = matrix.to_vec();
            for &Rotation { first, second, cosine, sine } in &rotations {
                for j in 0..columns {
                    let (p, q) = (expected[first * columns + j], expected[second * columns + j]);
                    expected[first * columns + j] = cosine * p + sine * q;
                    expected[second * columns + j] = cosine * q - sine * p;
                }
            }
            let mut plain = matrix.to_vec();
            rotate_rows_with::<false>(&mut rows_of(&mut plain, columns), &rotations);
            let mut fast = matrix.to_vec();
            rotate_rows(&mut rows_of(&mut fast, columns), &rotations);
            let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-12);
            prop_assert!(close(&plain, &expected) && close(&fast, &expected));
        }
    }
}
