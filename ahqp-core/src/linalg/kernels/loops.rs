//! The loops of the kernels.

#![expect(clippy::inline_always, reason = "takes the features of the function around it")]

use super::lanes::Lanes;
use super::{FourReflections, MovingRows, Rotation, RowsMut};

/// Iterates over whole rows of a matrix. Unlike `chunks_exact` it needs no division, which takes as
/// long as a short row.
#[derive(Debug)]
pub(crate) struct Rows<'a> {
    data: &'a [f64],
    stride: usize,
}

impl<'a> Iterator for Rows<'a> {
    type Item = &'a [f64];

    #[inline(always)]
    fn next(&mut self) -> Option<&'a [f64]> {
        let (row, rest) = self.data.split_at_checked(self.stride)?;
        self.data = rest;
        Some(row)
    }
}

#[inline(always)]
pub(crate) fn rows(data: &[f64], stride: usize) -> Rows<'_> {
    Rows { data, stride }
}

/// The same for rows that change.
#[derive(Debug)]
pub(crate) struct RowsToChange<'a> {
    data: &'a mut [f64],
    stride: usize,
}

impl<'a> Iterator for RowsToChange<'a> {
    type Item = &'a mut [f64];

    #[inline(always)]
    fn next(&mut self) -> Option<&'a mut [f64]> {
        let (row, rest) = std::mem::take(&mut self.data).split_at_mut_checked(self.stride)?;
        self.data = rest;
        Some(row)
    }
}

#[inline(always)]
pub(crate) fn rows_mut(data: &mut [f64], stride: usize) -> RowsToChange<'_> {
    RowsToChange { data, stride }
}

#[inline(always)]
pub(super) fn rotate_rows<L: Lanes>(rows: &mut RowsMut<'_>, rotations: &[Rotation]) {
    let stride = rows.stride;
    for &Rotation { first, second, cosine, sine } in rotations {
        let places = [first, second].map(|row| row * stride..(row + 1) * stride);
        let Ok([a, b]) = rows.data.get_disjoint_mut(places) else { continue };
        let ((a, a_rest), (b, b_rest)) = (a.as_chunks_mut::<4>(), b.as_chunks_mut::<4>());
        let (c, s, minus) = (L::splat(cosine), L::splat(sine), L::splat(-sine));
        let zero = L::splat(0.0);
        for (x, y) in a.iter_mut().zip(b) {
            let (p, q) = (L::load(x), L::load(y));
            c.multiply_add(p, s.multiply_add(q, zero)).store(x);
            c.multiply_add(q, minus.multiply_add(p, zero)).store(y);
        }
        for (x, y) in a_rest.iter_mut().zip(b_rest) {
            (*x, *y) = (cosine * *x + sine * *y, cosine * *y - sine * *x);
        }
    }
}

#[inline(always)]
pub(super) fn reflect_rows<L: Lanes>(rows: &mut RowsMut<'_>, start: usize, v: &[f64], tau: f64) {
    let (stride, end) = (rows.stride, start + v.len());
    let mut rest = &mut *rows.data;
    while rest.len() >= 4 * stride {
        let (block, behind) = rest.split_at_mut(4 * stride);
        rest = behind;
        let row = |i: usize| i * stride + start..i * stride + end;
        let Ok(parts) = block.get_disjoint_mut([row(0), row(1), row(2), row(3)]) else { continue };
        let along = dots::<L>(parts.each_ref().map(|part| &**part), v);
        for (part, along) in parts.into_iter().zip(along) {
            add_scaled::<L>(part, -tau * along, v);
        }
    }
    for row in rows_mut(rest, stride) {
        let Some(part) = row.get_mut(start..end) else { continue };
        let along = dot::<L>(part, v);
        add_scaled::<L>(part, -tau * along, v);
    }
}

#[inline(always)]
pub(super) fn reflect_rows_four<L: Lanes>(
    rows: &mut RowsMut<'_>,
    start: usize,
    four: &FourReflections<'_>,
) {
    let end = start + four.v[0].len();
    let [(a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)] = four.v.map(|v| v.as_chunks::<4>());
    for row in rows_mut(rows.data, rows.stride) {
        let Some(part) = row.get_mut(start..end) else { continue };
        let mut weights = [0.0; 4];
        for (along, t) in dots::<L>(four.v, part).into_iter().zip(&four.t) {
            for (weight, t) in weights.iter_mut().zip(t) {
                *weight -= along * t;
            }
        }
        let [p, q, r, s] = weights.map(L::splat);
        let (chunks, rest) = part.as_chunks_mut::<4>();
        for ((((x, a), b), c), d) in chunks.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            let two = q.multiply_add(L::load(b), p.multiply_add(L::load(a), L::load(x)));
            s.multiply_add(L::load(d), r.multiply_add(L::load(c), two)).store(x);
        }
        let ends = a_rest.iter().zip(b_rest).zip(c_rest).zip(d_rest);
        for (x, (((a, b), c), d)) in rest.iter_mut().zip(ends) {
            *x += weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
        }
    }
}

#[inline(always)]
pub(super) fn mix_rows<L: Lanes>(rows: &mut RowsMut<'_>, width: usize, v: &[f64], tau: f64) {
    let (stride, whole) = (rows.stride, width - width % 4);
    let mut start = 0;
    while start < whole {
        // Handles as many columns at once as are left and the registers can hold.
        match (whole - start) / 4 {
            1 => mix_columns::<L, 1>(rows, start, v, tau),
            2 => mix_columns::<L, 2>(rows, start, v, tau),
            3 => mix_columns::<L, 3>(rows, start, v, tau),
            _ => mix_columns::<L, 4>(rows, start, v, tau),
        }
        start += 16;
    }
    for start in whole..width {
        let column = |data: &[f64], row: usize| data.get(row * stride + start).copied();
        let image: f64 =
            v.iter().enumerate().filter_map(|(i, v)| Some(v * column(rows.data, i)?)).sum();
        for (row, v) in rows_mut(rows.data, stride).zip(v) {
            row[start] -= tau * v * image;
        }
    }
}

/// Mixes `B` times four columns, whose sums stay in registers.
#[inline(always)]
fn mix_columns<L: Lanes, const B: usize>(
    rows: &mut RowsMut<'_>,
    start: usize,
    v: &[f64],
    tau: f64,
) {
    let mut image = [L::splat(0.0); B];
    for (row, &weight) in self::rows(rows.data, rows.stride).zip(v) {
        let weight = L::splat(weight);
        for (image, part) in image.iter_mut().zip(row[start..start + 4 * B].as_chunks::<4>().0) {
            *image = weight.multiply_add(L::load(part), *image);
        }
    }
    for (row, &weight) in rows_mut(rows.data, rows.stride).zip(v) {
        let weight = L::splat(-tau * weight);
        for (image, part) in image.iter().zip(row[start..start + 4 * B].as_chunks_mut::<4>().0) {
            weight.multiply_add(*image, L::load(part)).store(part);
        }
    }
}

#[inline(always)]
pub(super) fn triangularise<L: Lanes>(
    stack: &mut RowsMut<'_>,
    pivots: &mut [f64],
    column: &mut [f64],
    least: f64,
    rounding: f64,
) {
    let stride = stack.stride;
    let mut before = pivots;
    // The last of the columns, one more for each pivot.
    let mut place = before.len() / stride;
    while let Some(length) = before.len().checked_sub(stride) {
        let (earlier, pivot) = before.split_at_mut(length);
        before = earlier;
        if let Some(row) = stack.data.get_mut(..stride) {
            row.copy_from_slice(pivot);
        }
        let (mut square, mut sum, mut size) = (0.0, 0.0, 0.0);
        for (v, row) in column.iter_mut().zip(rows(stack.data, stride)) {
            let force = row[place] * row[0];
            *v = row[place];
            square += *v * *v;
            sum += force;
            size += force.abs();
        }
        let own = column[0];
        let length = square.sqrt();
        let image = if own > 0.0 { -length } else { length };
        column[0] = own - image;
        let tau = if square > 0.0 { 1.0 / (-image * column[0]) } else { 0.0 };
        mix_rows::<L>(stack, place.next_multiple_of(4), column, tau);
        pivot[..place].copy_from_slice(&stack.data[..place]);
        pivot[place] = image;
        if sum * sum <= least * least * square && sum.abs() <= rounding * size {
            pivot[0] = 0.0;
        }
        place -= 1;
    }
}

#[inline(always)]
pub(super) fn multiply_rows<L: Lanes>(data: &[f64], stride: usize, x: &[f64], out: &mut [f64]) {
    let mut rest = data;
    let (fours, ones) = out.as_chunks_mut::<4>();
    for result in fours {
        // Every row is whole.
        let Some((block, behind)) = rest.split_at_checked(4 * stride) else { return };
        let row = |i: usize| &block[i * stride..i * stride + x.len()];
        *result = dots::<L>([row(0), row(1), row(2), row(3)], x);
        rest = behind;
    }
    for (row, result) in rows(rest, stride).zip(ones) {
        *result = dot::<L>(&row[..x.len()], x);
    }
}

#[inline(always)]
pub(super) fn rows_outside<L: Lanes>(rows: MovingRows<'_>, length: f64, out: &mut u64) {
    let MovingRows { value, slope, residual, lower, upper } = rows;
    let (length, minus) = (L::splat(length), L::splat(-1.0));
    let one = L::splat(1.0);
    let outside = |[value, slope, residual, lower, upper]: [L; 5]| {
        let start = minus.multiply_add(residual, value);
        length.multiply_add(one.multiply_add(slope, residual), start).outside(lower, upper)
    };
    let rows = [value, slope, residual, lower, upper].map(|of_rows| of_rows.as_chunks::<4>());
    let [value, slope, residual, lower, upper] = rows.map(|(four, _)| four);
    let fours = value.iter().zip(slope).zip(residual).zip(lower.iter().zip(upper));
    let mut bits = 0;
    let mut first = 0;
    for (((value, slope), residual), (lower, upper)) in fours {
        bits |= outside([value, slope, residual, lower, upper].map(L::load)) << first;
        first += 4;
    }
    let rest = rows.map(|(_, rest)| rest);
    if !rest[0].is_empty() {
        bits |= outside(rest.map(L::load_part)) << first;
    }
    *out = bits;
}

#[inline(always)]
pub(super) fn add_rows<L: Lanes>(data: &[f64], stride: usize, weights: &[f64], out: &mut [f64]) {
    let whole = out.len() - out.len() % 4;
    let mut start = 0;
    while start < whole {
        // Handles as many columns at once as are left and the registers can hold.
        match (whole - start) / 4 {
            1 => add_columns::<L, 1>(data, stride, start, weights, out),
            2 => add_columns::<L, 2>(data, stride, start, weights, out),
            3 => add_columns::<L, 3>(data, stride, start, weights, out),
            4 => add_columns::<L, 4>(data, stride, start, weights, out),
            5 => add_columns::<L, 5>(data, stride, start, weights, out),
            6 => add_columns::<L, 6>(data, stride, start, weights, out),
            7 => add_columns::<L, 7>(data, stride, start, weights, out),
            _ => add_columns::<L, 8>(data, stride, start, weights, out),
        }
        start += 32;
    }
    for start in whole..out.len() {
        let sum: f64 = rows(data, stride).zip(weights).map(|(row, w)| row[start] * w).sum();
        out[start] += sum;
    }
}

#[inline(always)]
fn add_columns<L: Lanes, const B: usize>(
    data: &[f64],
    stride: usize,
    start: usize,
    weights: &[f64],
    out: &mut [f64],
) {
    let mut sums = [L::splat(0.0); B];
    for (row, &weight) in rows(data, stride).zip(weights) {
        let weight = L::splat(weight);
        for (sum, part) in sums.iter_mut().zip(row[start..start + 4 * B].as_chunks::<4>().0) {
            *sum = weight.multiply_add(L::load(part), *sum);
        }
    }
    let one = L::splat(1.0);
    for (sum, part) in sums.into_iter().zip(out[start..start + 4 * B].as_chunks_mut::<4>().0) {
        one.multiply_add(sum, L::load(part)).store(part);
    }
}

#[inline(always)]
pub(super) fn square_rows<L: Lanes>(data: &[f64], stride: usize, out: &mut [f64]) {
    for (row, square) in rows(data, stride).zip(out) {
        *square = dot::<L>(row, row);
    }
}

/// Returns the products of four rows with one vector.
#[inline(always)]
fn dots<L: Lanes>(rows: [&[f64]; 4], v: &[f64]) -> [f64; 4] {
    let (chunks, rest) = v.as_chunks::<4>();
    let [a, b, c, d] = rows.map(|row| row.as_chunks::<4>().0);
    let (mut sa, mut sb, mut sc, mut sd) =
        (L::splat(0.0), L::splat(0.0), L::splat(0.0), L::splat(0.0));
    for ((((x, p), q), r), s) in chunks.iter().zip(a).zip(b).zip(c).zip(d) {
        let x = L::load(x);
        sa = x.multiply_add(L::load(p), sa);
        sb = x.multiply_add(L::load(q), sb);
        sc = x.multiply_add(L::load(r), sc);
        sd = x.multiply_add(L::load(s), sd);
    }
    if !rest.is_empty() {
        let [p, q, r, s] = rows.map(|row| &row[v.len() - rest.len()..v.len()]);
        let x = L::load_part(rest);
        sa = x.multiply_add(L::load_part(p), sa);
        sb = x.multiply_add(L::load_part(q), sb);
        sc = x.multiply_add(L::load_part(r), sc);
        sd = x.multiply_add(L::load_part(s), sd);
    }
    L::sums([sa, sb, sc, sd])
}

#[inline(always)]
fn dot<L: Lanes>(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let ((a2, a1), (b2, b1)) = (a.as_chunks::<2>(), b.as_chunks::<2>());
    let (mut first, mut second) = (L::splat(0.0), L::splat(0.0));
    for ([p, q], [r, s]) in a2.iter().zip(b2) {
        first = L::load(p).multiply_add(L::load(r), first);
        second = L::load(q).multiply_add(L::load(s), second);
    }
    for (p, r) in a1.iter().zip(b1) {
        first = L::load(p).multiply_add(L::load(r), first);
    }
    if !a_rest.is_empty() {
        second = L::load_part(a_rest).multiply_add(L::load_part(b_rest), second);
    }
    first.sum() + second.sum()
}

#[inline(always)]
fn add_scaled<L: Lanes>(y: &mut [f64], alpha: f64, x: &[f64]) {
    let ((y, y_rest), (x, x_rest)) = (y.as_chunks_mut::<4>(), x.as_chunks::<4>());
    let weight = L::splat(alpha);
    for (to, from) in y.iter_mut().zip(x) {
        weight.multiply_add(L::load(from), L::load(to)).store(to);
    }
    for (to, from) in y_rest.iter_mut().zip(x_rest) {
        *to += alpha * from;
    }
}
