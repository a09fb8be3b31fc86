//! Finds the maxima of the joints' maps.

use ndarray::{ArrayView2, ArrayView3, Axis};

/// Largest number of maxima per joint, more than the people who can be distinguished in an image.
const MOST: usize = 64;

/// A maximum of a joint's map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak {
    /// Column and row, between cells.
    pub(super) at: [f64; 2],
    pub(super) height: f64,
}

/// Returns the maxima of the eighteen joints, the highest first.
pub(super) fn find(joints: &ArrayView3<'_, f32>, least: f64) -> Vec<Vec<Peak>> {
    joints.axis_iter(Axis(0)).take(18).map(|map| find_in(&map, least)).collect()
}

fn find_in(map: &ArrayView2<'_, f32>, least: f64) -> Vec<Peak> {
    let mut peaks: Vec<Peak> = map
        .indexed_iter()
        .filter(|&(at, &height)| f64::from(height) > least && is_highest(map, at, height))
        .map(|(at, &height)| Peak { at: refine(map, at), height: f64::from(height) })
        .collect();
    peaks.sort_by(|one, other| other.height.total_cmp(&one.height));
    peaks.truncate(MOST);
    peaks
}

/// Returns true if no neighbour is higher. The first of equal neighbours is the maximum.
fn is_highest(map: &ArrayView2<'_, f32>, (row, column): (usize, usize), height: f32) -> bool {
    let near = |at: usize| at.saturating_sub(1)..=at + 1;
    near(row).all(|y| {
        near(column).all(|x| match map.get((y, x)) {
            Some(&other) if (y, x) < (row, column) => other < height,
            Some(&other) => other <= height,
            None => true,
        })
    })
}

/// Returns the position of the maximum between cells: that of the Gaussian through it and its two
/// neighbours, along each axis.
fn refine(map: &ArrayView2<'_, f32>, (row, column): (usize, usize)) -> [f64; 2] {
    let logarithm = |y: Option<usize>, x: Option<usize>| {
        let value = f64::from(*map.get((y?, x?))?);
        let height = f64::from(map[(row, column)]);
        // A value far below the maximum gives little information.
        Some(value.max(1e-3 * height).ln())
    };
    let centre = f64::from(map[(row, column)]).ln();
    let offset = |before: Option<f64>, after: Option<f64>| match (before, after) {
        (Some(before), Some(after)) if before + after < 2.0 * centre => {
            (0.5 * (before - after) / (before - 2.0 * centre + after)).clamp(-0.5, 0.5)
        }
        _ => 0.0,
    };
    let (x, y) = (Some(column), Some(row));
    let across = offset(logarithm(y, column.checked_sub(1)), logarithm(y, Some(column + 1)));
    let down = offset(logarithm(row.checked_sub(1), x), logarithm(Some(row + 1), x));
    [column as f64 + across, row as f64 + down]
}
