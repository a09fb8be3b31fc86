//! Inequalities that no remaining point satisfies with slack.

use super::program::Program;
use super::{AT_BOUND, Cascade};
use crate::error::Error;

/// Returns the inequalities that are active at every point that satisfies all of them.
///
/// Solves, among those at their bounds: maximise Σ tᵢ with gᵢ y + tᵢ ≤ 0 and −1 ≤ tᵢ ≤ 1. A row
/// that can be slack reaches t = 1, since y may be scaled. At least one of the other rows does not.
/// See Freund, Roundy and Todd, "Identifying the set of always-active constraints in a system of
/// linear inequalities by a single linear program", 1985.
pub(super) fn always_active(cascade: &Cascade) -> Result<Vec<usize>, Error> {
    let (g, h) = cascade.reduced_inequalities(&cascade.x);
    let k = g.ncols();
    let candidates: Vec<usize> = (0..h.nrows()).filter(|&i| h[i] < AT_BOUND).collect();
    let count = candidates.len();
    if k == 0 || count < 2 {
        return Ok(Vec::new());
    }
    let linear = (0..k + count).map(|i| if i < k { 0.0 } else { -1.0 }).collect();
    let mut program = Program::new(vec![0.0; k + count], linear);
    for (position, &i) in candidates.iter().enumerate() {
        let mut row: Vec<f64> = g.row(i).iter().copied().collect();
        row.resize(k + count, 0.0);
        row[k + position] = 1.0;
        program.limit(row, 0.0);
        let mut unit = vec![0.0; k + count];
        unit[k + position] = 1.0;
        program.range(unit, -1.0, 1.0);
    }
    let slacks = program.minimise(cascade.level)?.v.split_off(k);
    Ok(candidates.into_iter().zip(slacks).filter(|(_, t)| *t < 0.5).map(|(i, _)| i).collect())
}
