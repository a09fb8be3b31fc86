//! Weighted least squares in the directions that a span leaves free.

use super::double_double::DoubleDouble;
use super::row::Row;
use super::span::{Span, add_scaled, dot, length, take_off};
use crate::certificate::tolerances::DEPENDENT;

/// Returns the step of least norm, orthogonal to `span`, that minimises ½ Σ w (a d + r)² + cᵀd.
///
/// The sum is over rows with residuals r. If the objective is unbounded below, returns a direction
/// along which it falls. Rows may [depend](DEPENDENT) on heavier ones.
pub(super) fn step(
    span: &Span,
    rows: &[(&Row, DoubleDouble)],
    linear: &[DoubleDouble],
) -> Vec<DoubleDouble> {
    let (system, units) = project(span, rows);
    let mut falling: Vec<DoubleDouble> = linear.iter().map(|&entry| -entry).collect();
    for unit in span.units.iter().chain(&units).chain(&span.units).chain(&units) {
        take_off(&mut falling, unit);
    }
    if length(&falling) > DEPENDENT * length(linear) {
        return falling;
    }
    let linear = units.iter().map(|unit| dot(unit, linear)).collect();
    let mut step = vec![DoubleDouble::ZERO; falling.len()];
    for (y, unit) in solve(system, linear).iter().zip(&units) {
        add_scaled(&mut step, *y, unit);
    }
    step
}

/// Returns the rows in coordinates orthogonal to the span, each followed by its residual: √w (a Q,
/// r). Heavy rows come first.
///
/// The coordinates are built from the heaviest independent rows, so that light rows keep their
/// digits (Powell and Reid, IFIP 68, 1969; Higham, Accuracy and Stability, Sec. 20.4).
fn project(
    span: &Span,
    rows: &[(&Row, DoubleDouble)],
) -> (Vec<Vec<DoubleDouble>>, Vec<Vec<DoubleDouble>>) {
    let mut basis = span.clone();
    let mut outside: Vec<Vec<DoubleDouble>> = rows.iter().map(|(row, _)| row.a.clone()).collect();
    for unit in span.units.iter().chain(&span.units) {
        for rest in &mut outside {
            take_off(rest, unit);
        }
    }
    let mut parts = vec![Vec::new(); rows.len()];
    let mut left: Vec<usize> = (0..rows.len()).collect();
    let mut order = Vec::with_capacity(rows.len());
    loop {
        let size = |i: usize| (length(&outside[i]), rows[i].0);
        left.retain(|&i| {
            let (size, row) = size(i);
            let is_there = size > DEPENDENT * row.norm;
            if !is_there {
                order.push(i);
            }
            is_there
        });
        let force = |i: usize| {
            let (size, row) = size(i);
            row.weight * size * size
        };
        let Some(&pivot) = left.iter().max_by(|&&i, &&j| force(i).total_cmp(&force(j))) else {
            break;
        };
        let mut direction = std::mem::take(&mut outside[pivot]);
        for unit in &basis.units {
            take_off(&mut direction, unit);
        }
        parts[pivot].push(basis.push_direction(direction));
        let unit = &basis.units[basis.len() - 1];
        left.retain(|&i| i != pivot);
        order.push(pivot);
        for &i in &left {
            parts[i].push(take_off(&mut outside[i], unit));
        }
    }
    let units = basis.units.split_off(span.len());
    let weighted = |i: usize| {
        let (row, residual) = rows[i];
        let root = DoubleDouble::from(row.weight).sqrt();
        let mut row_of_parts = std::mem::take(&mut parts[i]);
        row_of_parts.resize(units.len(), DoubleDouble::ZERO);
        row_of_parts.push(residual);
        for entry in &mut row_of_parts {
            *entry = *entry * root;
        }
        row_of_parts
    };
    let mut system: Vec<_> = order.into_iter().map(weighted).collect();
    system.sort_by(|a, b| length(&b[..units.len()]).total_cmp(&length(&a[..units.len()])));
    (system, units)
}

/// Returns the y that minimises ½‖M y + r‖² + cᵀy, where r is the last column, by Householder
/// reflections.
fn solve(mut system: Vec<Vec<DoubleDouble>>, linear: Vec<DoubleDouble>) -> Vec<DoubleDouble> {
    let columns = linear.len();
    for column in 0..columns {
        let mut v: Vec<DoubleDouble> = system[column..].iter().map(|row| row[column]).collect();
        let norm = dot(&v, &v).sqrt();
        let image = if v[0].is_positive() { -norm } else { norm };
        v[0] -= image;
        let square = dot(&v, &v);
        for entry in column + 1..=columns {
            let along = system[column..].iter().zip(&v);
            let product = along.fold(DoubleDouble::ZERO, |sum, (row, &v)| sum + row[entry] * v);
            let factor = (product + product) / square;
            for (row, &v) in system[column..].iter_mut().zip(&v) {
                row[entry] -= factor * v;
            }
        }
        system[column][column] = image;
    }
    // R y = −r − R⁻ᵀ c.
    let mut y = linear;
    for i in 0..columns {
        let known = (0..i).fold(DoubleDouble::ZERO, |sum, j| sum + system[j][i] * y[j]);
        y[i] = (y[i] - known) / system[i][i];
    }
    for i in (0..columns).rev() {
        let known = dot(&system[i][i + 1..columns], &y[i + 1..]);
        y[i] = -(system[i][columns] + y[i] + known) / system[i][i];
    }
    y
}
