//! Distance from a point to the optimum where doubles cannot represent the multipliers.
//!
//! Forces of rows of one level may differ by more than the 16 digits of a double. Multipliers in
//! doubles then hide the light rows, and balance at points far from the optimum. In this case the
//! hierarchy is solved again in numbers of 32 digits, level by level, starting from x. The distance
//! moved is the error.

mod double_double;
mod least_squares;
mod level;
mod quadratic;
mod row;
mod span;

use std::iter::once;

use super::tolerances::{
    DEPENDENT, FEASIBLE, INDEPENDENT, NEAR, NOTHING, PRODUCT, SCALE_DISPARITY,
};
use crate::linalg::vector::{norm, norm_max};
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Objective;
use crate::problem::rows::Rows;
use double_double::DoubleDouble;
use level::{Search, Side};
use row::{Row, nearer};
use span::{Span, add_scaled, dot, length};

/// Returns true if the forces of rows of one level may differ so much at x that doubles do not show
/// all of them.
pub(super) fn is_needed(hierarchy: &Hierarchy, x: &[f64]) -> bool {
    let x_norm = norm(x);
    hierarchy.levels().iter().any(|level| {
        let Objective::LeastSquares(rows) = level.objective() else { return false };
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for (index, (row, lower, upper)) in rows.iter().enumerate() {
            let norm = norm(row);
            let pull = rows.weight(index) * norm;
            if pull > 0.0 {
                least = least.min(pull * norm * x_norm);
                most = most.max(pull * (nearer(lower, upper) + norm * x_norm));
            }
        }
        most > SCALE_DISPARITY * least
    })
}

/// Returns the distance from x to the optimum near it, relative to the longer of the two. Infinite
/// if none was found.
pub(super) fn distance(hierarchy: &Hierarchy, x: &[f64]) -> f64 {
    let refinement = Refinement::new(hierarchy, x);
    let rounding = PRODUCT * refinement.reach;
    let Some(step) = refinement.step(hierarchy) else { return f64::INFINITY };
    let step: Vec<f64> = step.iter().map(|p| p.rounded()).collect();
    let optimum: Vec<f64> = x.iter().zip(&step).map(|(x, p)| x + p).collect();
    let moved = norm_max(&step);
    if moved <= rounding { 0.0 } else { moved / norm_max(x).max(norm_max(&optimum)) }
}

/// A point that is optimal for the levels so far, and the conditions that the next levels must
/// keep.
struct Refinement {
    x: Vec<DoubleDouble>,
    /// Step from x.
    p: Vec<DoubleDouble>,
    /// Directions in which no later level may move.
    decided: Span,
    /// Rows that must hold.
    hard: Vec<Row>,
    /// Length of vectors, which rounding is relative to.
    reach: f64,
}

impl Refinement {
    fn new(hierarchy: &Hierarchy, x: &[f64]) -> Self {
        let n = x.len();
        let reach = reach(hierarchy, x);
        let x: Vec<DoubleDouble> = x.iter().map(|&x| x.into()).collect();
        let bounds = hierarchy.lower().iter().zip(hierarchy.upper()).enumerate();
        let hard = bounds.map(|(i, (&lower, &upper))| {
            Row::new(unit(n, i), [lower.into(), upper.into()], 1.0, (&x, reach))
        });
        let (hard, p) = (hard.collect(), vec![DoubleDouble::ZERO; n]);
        let decided = Span::default();
        Self { x, p, decided, hard, reach }
    }

    /// Returns the step from x to the optimum.
    fn step(mut self, hierarchy: &Hierarchy) -> Option<Vec<DoubleDouble>> {
        let n = self.x.len();
        let none = vec![DoubleDouble::ZERO; n];
        let fixed: Vec<Row> = self.hard.extract_if(.., |row| row.is_equality()).collect();
        self.constrain(fixed)?;
        for level in hierarchy.levels() {
            self.constrain(self.rows(level.constraints()))?;
            match level.objective() {
                Objective::None => {}
                Objective::LeastSquares(rows) => self.minimise(self.rows(rows), &none)?,
                Objective::Quadratic { hessian, gradient } => {
                    let (rows, linear) = quadratic::objective(hessian, gradient, self.from());
                    self.minimise(rows, &linear)?;
                }
            }
        }
        let zero = [DoubleDouble::ZERO; 2];
        let norm = (0..n).map(|i| Row::new(unit(n, i), zero, 1.0, self.from())).collect();
        self.minimise(norm, &none)?;
        Some(self.p)
    }

    /// Returns the point from which rows are seen, and the length of vectors.
    fn from(&self) -> (&[DoubleDouble], f64) {
        (&self.x, self.reach)
    }

    fn rows(&self, rows: &Rows) -> Vec<Row> {
        let row = |(index, (a, lower, upper)): (usize, (&[f64], f64, f64))| {
            let a = a.iter().map(|&a| a.into()).collect();
            Row::new(a, [lower.into(), upper.into()], rows.weight(index), self.from())
        };
        rows.iter().enumerate().map(row).filter(|row| row.norm > 0.0 && row.weight > 0.0).collect()
    }

    /// Moves to a point at which the hard rows of a level hold, and keeps them.
    fn constrain(&mut self, mut rows: Vec<Row>) -> Option<()> {
        let old = self.hard.len();
        self.hard.extend(rows.iter().cloned());
        let holds = self.snap().is_some();
        self.hard.truncate(old);
        if !holds {
            for row in &mut rows {
                row.weight = row.norm.powi(-2);
            }
            self.search(&rows, &vec![DoubleDouble::ZERO; self.x.len()])?;
        }
        for mut row in rows {
            let value = dot(&row.a, &self.p);
            if row.violation(value).abs().rounded() > FEASIBLE * row.size {
                return None;
            }
            if row.is_equality() {
                self.decided.extend(&row.a, NOTHING * row.norm);
            } else {
                row.admit(value);
                self.hard.push(row);
            }
        }
        Some(())
    }

    /// Minimises the violation of rows plus a linear term, and keeps what that decides.
    fn minimise(&mut self, soft: Vec<Row>, linear: &[DoubleDouble]) -> Option<()> {
        if self.decided.len() == self.x.len() {
            return Some(());
        }
        let pushing = self.search(&soft, linear)?;
        self.decided.extend(linear, DEPENDENT * length(linear));
        for &id in &pushing.hard {
            let row = &self.hard[id];
            self.decided.extend(&row.a, NOTHING * row.norm);
        }
        let mut index = 0..;
        self.hard.retain(|_| index.next().is_some_and(|id| !pushing.hard.contains(&id)));
        for (id, mut row) in soft.into_iter().enumerate() {
            if pushing.soft.contains(&id) {
                self.decided.extend(&row.a, DEPENDENT * row.norm);
            } else {
                row.admit(dot(&row.a, &self.p));
                self.hard.push(row);
            }
        }
        Some(())
    }

    /// Goes to the minimum of a level.
    fn search(&mut self, soft: &[Row], linear: &[DoubleDouble]) -> Option<level::Pushing> {
        let working = self.snap().unwrap_or_default();
        let mut search = Search {
            decided: &self.decided,
            hard: &self.hard,
            soft,
            linear,
            p: std::mem::take(&mut self.p),
            working,
            reach: self.reach,
        };
        let pushing = search.minimise();
        self.p = search.p;
        pushing
    }

    /// Moves onto the bounds of hard rows that are near their bounds at x, and returns these rows.
    /// None if other hard rows do not hold there.
    fn snap(&mut self) -> Option<Vec<(usize, Side)>> {
        let (mut span, mut working) = (self.decided.clone(), Vec::new());
        let mut step = vec![DoubleDouble::ZERO; self.x.len()];
        for (id, row) in self.hard.iter().enumerate() {
            let value = dot(&row.a, &self.p);
            let gap = |side: Side| side.bound(row).map(|bound| (side, bound - value));
            let sides = gap(Side::Lower).into_iter().chain(gap(Side::Upper));
            let near = sides.filter(|(_, gap)| gap.abs().rounded() <= NEAR * row.size);
            let Some((side, gap)) =
                near.min_by(|a, b| a.1.abs().rounded().total_cmp(&b.1.abs().rounded()))
            else {
                continue;
            };
            if let Some(parts) = span.extend(&row.a, INDEPENDENT * row.norm)
                && let (Some(unit), Some(&last)) = (span.units.last(), parts.last())
            {
                let missing = gap - dot(&row.a, &step);
                add_scaled(&mut step, missing / last, unit);
                working.push((id, side));
            }
        }
        let p: Vec<DoubleDouble> = self.p.iter().zip(&step).map(|(&p, &step)| p + step).collect();
        if !self.hard.iter().all(|row| row.holds(dot(&row.a, &p))) {
            return None;
        }
        self.p = p;
        Some(working)
    }
}

/// Returns ‖x‖, or the length of the shortest nonzero vector that a row demands if that is longer.
fn reach(hierarchy: &Hierarchy, x: &[f64]) -> f64 {
    let bounds = hierarchy.lower().iter().zip(hierarchy.upper());
    let bounds = bounds.map(|(&lower, &upper)| nearer(lower, upper));
    let rows = hierarchy.levels().iter().flat_map(|level| {
        let objective = match level.objective() {
            Objective::LeastSquares(rows) => Some(rows),
            _ => None,
        };
        objective.into_iter().chain(once(level.constraints())).flat_map(Rows::iter)
    });
    let rows = rows.map(|(row, lower, upper)| nearer(lower, upper) / norm(row));
    let asked = bounds.chain(rows).filter(|&length| length > 0.0).fold(f64::INFINITY, f64::min);
    norm(x).max(if asked.is_finite() { asked } else { 0.0 })
}

fn unit(n: usize, i: usize) -> Vec<DoubleDouble> {
    let zeros = std::iter::repeat_n(DoubleDouble::ZERO, i);
    let behind = std::iter::repeat_n(DoubleDouble::ZERO, n - i - 1);
    zeros.chain(once(DoubleDouble::ONE)).chain(behind).collect()
}
