//! Access to the tables: at integer indices, and between them by multilinear interpolation.

use super::smooth::Smooth;
use super::tables::{TABLE_A, TABLE_B, TABLE_C};

/// Returns a cell of a table. Indices count from 1 and are clamped to the table.
fn cell<const N: usize>(row: &[u8; N], index: u8) -> u8 {
    let index = usize::from(index).clamp(1, N) - 1;
    row.get(index).copied().unwrap_or(0)
}

/// Returns a row (or plane) of a table. Indices count from 1 and are clamped to the table.
fn row<T, const N: usize>(table: &[T; N], index: u8) -> Option<&T> {
    table.get(usize::from(index).clamp(1, N) - 1)
}

/// Returns table A at neck, trunk and legs.
pub(super) fn table_a([neck, trunk, legs]: [u8; 3]) -> u8 {
    row(&TABLE_A, neck).and_then(|plane| row(plane, trunk)).map_or(0, |r| cell(r, legs))
}

/// Returns table B at upper arm, lower arm and wrist.
pub(super) fn table_b([upper, lower, wrist]: [u8; 3]) -> u8 {
    row(&TABLE_B, upper).and_then(|plane| row(plane, lower)).map_or(0, |r| cell(r, wrist))
}

/// Returns table C at score A and score B.
pub(super) fn table_c([a, b]: [u8; 2]) -> u8 {
    row(&TABLE_C, a).map_or(0, |r| cell(r, b))
}

/// Interpolates table A between its cells.
pub(super) fn interpolate_a<S: Smooth>(at: [S; 3]) -> S {
    trilinear(at, [3, 5, 4], table_a)
}

/// Interpolates table B between its cells.
pub(super) fn interpolate_b<S: Smooth>(at: [S; 3]) -> S {
    trilinear(at, [6, 2, 3], table_b)
}

/// Interpolates table C between its cells.
pub(super) fn interpolate_c<S: Smooth>([a, b]: [S; 2]) -> S {
    trilinear([a, b, a.chain(1.0, 0.0)], [12, 12, 1], |[a, b, _]| table_c([a, b]))
}

/// Interpolates trilinearly, with partial derivatives. Arguments are clamped to the table.
fn trilinear<S: Smooth>(at: [S; 3], size: [u8; 3], table: impl Fn([u8; 3]) -> u8) -> S {
    let mut base = [1_u8; 3];
    let mut fraction = [0.0; 3];
    let mut moves = [0.0; 3];
    for axis in 0..3 {
        (base[axis], fraction[axis], moves[axis]) = locate(at[axis].value(), size[axis]);
    }
    let mut value = 0.0;
    let mut partials = [0.0; 3];
    for corner in 0..8_u8 {
        let bit = [corner & 1, (corner >> 1) & 1, (corner >> 2) & 1];
        let mut weight = [0.0; 3];
        let mut sign = [0.0; 3];
        for axis in 0..3 {
            let upper = bit[axis] == 1;
            weight[axis] = if upper { fraction[axis] } else { 1.0 - fraction[axis] };
            sign[axis] = if upper { moves[axis] } else { -moves[axis] };
        }
        let cell = f64::from(table([base[0] + bit[0], base[1] + bit[1], base[2] + bit[2]]));
        value += cell * weight[0] * weight[1] * weight[2];
        partials[0] += cell * sign[0] * weight[1] * weight[2];
        partials[1] += cell * weight[0] * sign[1] * weight[2];
        partials[2] += cell * weight[0] * weight[1] * sign[2];
    }
    S::chain3(at, value, partials)
}

/// Returns the index below, the fraction towards the next one, and 1 inside the table (0 if
/// clamped).
fn locate(at: f64, size: u8) -> (u8, f64, f64) {
    let last = size.saturating_sub(1).max(1);
    let inside = at > 1.0 && at < f64::from(size);
    let clamped = at.clamp(1.0, f64::from(size));
    // The value is between 1 and 12 because of the clamp.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let base = (clamped as u8).min(last);
    (base, clamped - f64::from(base), f64::from(u8::from(inside)))
}
