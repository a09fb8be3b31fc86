//! Multipliers of the active rows for one level, or for the least norm after the last. Each has a
//! bound of its rounding, that of its own sum, term by term.

use super::activity::Activity;
use super::data::{ProblemData, active_bound};
use super::factorisation::{Factorisation, Group};
use super::tolerances::{CLEARLY_THERE, NEGLIGIBLE, ROUNDING};
use crate::linalg::vector::norm;

/// Residuals that form a level's gradient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Residuals {
    /// Residuals of the rows at x.
    AtPoint,
    /// Residuals that balance each other, where these are more accurate than those at x. The
    /// residuals of heavy rows may be far below the rounding of a x.
    Balanced,
}

/// The gradient of a level and the multipliers that balance it. All memory is allocated once.
#[derive(Debug, Clone)]
pub(crate) struct Multipliers {
    /// Multipliers of the pivots before those of the level, and their rounding.
    of_pivots: Vec<f64>,
    rounding_of_pivots: Vec<f64>,
    rounding_of_bounds: Vec<f64>,
    /// Number of pivots that balance the gradient.
    pivots: usize,
    /// The level's group, if it has one.
    group: Option<usize>,
    /// Residuals of the rows of the level, in the order of the stack, and their rounding.
    residual: Vec<f64>,
    residual_rounding: Vec<f64>,
    /// Remainder of the gradient at the variables at a bound, after the multipliers of the pivots.
    gradient: Vec<f64>,
    /// Size of the forces that balance each other, and the rounding in each coordinate that does
    /// not come from rows.
    size: f64,
    rounding: f64,
    /// True if forces of rows of the level differ so much that the rounding of one may hide
    /// another.
    has_scale_disparity: bool,
    /// True if small multipliers come from parts of rows that the rank tolerance may neglect.
    pub(crate) has_multipliers_near_threshold: bool,
    /// Upper bound of what counts as rounding, relative to the forces.
    pub(crate) tolerance: f64,
    /// True if coefficients count as exact, however small they are beside their row.
    pub(crate) trusts_coefficients: bool,
}

impl Multipliers {
    pub(crate) fn new(data: &ProblemData, tolerance: f64) -> Self {
        Self {
            of_pivots: vec![0.0; data.n],
            rounding_of_pivots: vec![0.0; data.n],
            rounding_of_bounds: vec![0.0; data.n],
            pivots: 0,
            group: None,
            residual: vec![0.0; data.len()],
            residual_rounding: vec![0.0; data.len()],
            gradient: vec![0.0; data.n],
            size: 0.0,
            rounding: 0.0,
            has_scale_disparity: false,
            has_multipliers_near_threshold: false,
            tolerance,
            trusts_coefficients: false,
        }
    }

    /// Balances the gradient of the level whose rows are `group`. `value` is aᵢx. Returns false if
    /// the gradient is rounding only.
    pub(crate) fn balance_level(
        &mut self,
        data: &ProblemData,
        factorisation: &mut Factorisation,
        value: &[f64],
        activity: &[Activity],
        (group, residuals): (usize, Residuals),
    ) -> bool {
        let Group { start, end, rank, first_pivot, linear_of, .. } = factorisation.groups[group];
        (self.group, self.pivots) = (Some(group), first_pivot);
        // If there are only pivots, they are all satisfied.
        if residuals == Residuals::Balanced && linear_of.is_none() && end - start == rank {
            return false;
        }
        let x_norm = norm(&value[..data.n]);
        let residual = &mut self.residual[..end - start];
        let rounding = &mut self.residual_rounding[..end - start];
        let mut any = linear_of.is_some();
        for i in 0..end - start {
            let id = factorisation.stacked[start + i];
            let bound = active_bound(data, activity, id);
            residual[i] = value[id] - bound;
            rounding[i] = data.rounding(id, x_norm);
            if residual[i].abs() <= rounding[i] {
                let x = &value[..data.n];
                residual[i] = data.row(id).dot(x) - bound;
                rounding[i] = data.rounding_beside_bounds(id, x, x_norm, activity);
            }
            // The rounding is only computed where it may explain the residual, since it costs more
            // than the rest.
            let is_small = || residual[i].abs() < CLEARLY_THERE * data.magnitude(id, x_norm);
            if end - start > rank && residual[i].abs() > rounding[i] && is_small() {
                rounding[i] += factorisation.rounding_of_point(data, group, start + i, x_norm);
            }
            any |= residual[i].abs() > rounding[i];
        }
        if !any {
            return false;
        }
        self.has_scale_disparity =
            data.have_scale_disparity(&factorisation.stacked[start..end], x_norm);
        if residuals == Residuals::Balanced {
            let room = (&mut self.of_pivots[..], &mut self.rounding_of_pivots[..]);
            let residuals = (&mut *residual, &mut *rounding);
            factorisation.balance_group(data, group, self.has_scale_disparity, residuals, room);
        }
        let rows = factorisation.stacked[start..end].iter().zip(residual.iter());
        self.size = rows.map(|(&id, residual)| data.norm(id) * residual.abs()).sum();
        self.rounding = 0.0;
        let coordinates = &mut self.of_pivots[..first_pivot];
        coordinates.fill(0.0);
        factorisation.add_rows(start..end, residual, coordinates);
        if let Some(level) = linear_of {
            let linear = &data.levels[level].linear;
            factorisation.add_linear(level, coordinates);
            self.gradient.copy_from_slice(linear);
            self.size += norm(linear);
            self.rounding += ROUNDING * norm(linear);
        } else {
            self.gradient.fill(0.0);
        }
        let rows = factorisation.stacked[start..end].iter().zip(residual.iter());
        add_at_bounds(data, &factorisation.bounded, rows, &mut self.gradient);
        self.balance(data, factorisation);
        true
    }

    /// Balances the gradient of the least norm, which is x itself.
    pub(crate) fn balance_norm(
        &mut self,
        data: &ProblemData,
        factorisation: &mut Factorisation,
        x: &[f64],
    ) {
        (self.group, self.pivots) = (None, factorisation.rank());
        factorisation.coordinates(x, &mut self.of_pivots[..self.pivots]);
        self.gradient.copy_from_slice(x);
        self.has_scale_disparity = false;
        self.size = norm(x);
        self.rounding = self.tolerance * self.size;
        self.balance(data, factorisation);
    }

    /// Computes the multipliers of the pivots for the gradient whose coordinates are in their
    /// place. `gradient` keeps the remainder at the variables at a bound.
    fn balance(&mut self, data: &ProblemData, factorisation: &Factorisation) {
        factorisation.balance(&mut self.of_pivots[..self.pivots]);
        let multipliers = &self.of_pivots[..self.pivots];
        let ids =
            factorisation.pivots[..self.pivots].iter().map(|&pivot| &factorisation.stacked[pivot]);
        let rows = ids.clone().zip(multipliers);
        add_at_bounds(data, &factorisation.bounded, rows, &mut self.gradient);
        let forces = multipliers.iter().zip(ids).map(|(m, &id)| m.abs() * data.norm(id));
        self.size += forces.sum::<f64>();
    }

    /// Returns the rounding in each coordinate of the gradient.
    fn rounding_of_coordinates(&self, data: &ProblemData, factorisation: &Factorisation) -> f64 {
        let rows = self.residuals(factorisation).map(|(id, residual, rounding)| {
            factorisation.norm_of_entries(data, id, self.has_scale_disparity)
                * (rounding + ROUNDING * residual.abs())
        });
        self.rounding + rows.sum::<f64>()
    }

    /// Computes the rounding of each coordinate of the gradient by itself, in the place of the pivots.
    /// A residual passes its rounding on by the row's part in the coordinate. The rotation of the row
    /// adds that of the whole row.
    fn set_rounding_of_coordinates(&mut self, data: &ProblemData, factorisation: &Factorisation) {
        let rotated = self.residuals(factorisation).map(|(id, residual, rounding)| {
            let norm = factorisation.norm_of_entries(data, id, self.has_scale_disparity);
            ROUNDING * norm * (residual.abs() + rounding)
        });
        let of_all = self.rounding + rotated.sum::<f64>();
        let coordinates = &mut self.rounding_of_pivots[..self.pivots];
        coordinates.fill(of_all);
        if let Some(group) = self.group {
            let Group { start, end, .. } = factorisation.groups[group];
            let rounding = &self.residual_rounding[..end - start];
            factorisation.add_sizes(start..end, rounding, coordinates);
        }
    }

    /// Returns a force that certainly exceeds rounding, also if all residuals are near theirs.
    pub(crate) fn clear_force(&self, data: &ProblemData, factorisation: &Factorisation) -> f64 {
        let part = CLEARLY_THERE.max(factorisation.tolerances.near_threshold);
        (part * self.size).max(self.rounding_of_coordinates(data, factorisation))
    }

    /// Iterates over the rows of the level with their residuals and the rounding of these.
    pub(crate) fn residuals<'a>(
        &'a self,
        factorisation: &'a Factorisation,
    ) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
        let (start, end) = self.group.map_or((0, 0), |group| {
            let Group { start, end, .. } = factorisation.groups[group];
            (start, end)
        });
        let terms = self.residual.iter().zip(&self.residual_rounding);
        let rows = factorisation.stacked[start..end].iter().zip(terms);
        rows.map(|(&id, (&residual, &rounding))| (id, residual, rounding))
    }

    /// Iterates over the rows that balance the gradient, with their multipliers: pivots first, in
    /// order.
    pub(crate) fn pairs<'a>(
        &'a self,
        factorisation: &'a Factorisation,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let pivots = &factorisation.pivots[..self.pivots];
        let ids = pivots.iter().map(|&pivot| factorisation.stacked[pivot]);
        let of_pivots = ids.zip(self.of_pivots[..self.pivots].iter().copied());
        of_pivots.chain(factorisation.bounded.iter().map(|&id| (id, -self.gradient[id])))
    }

    /// Computes the rounding in the multipliers, which is that of their sums.
    pub(crate) fn set_rounding(&mut self, data: &ProblemData, factorisation: &mut Factorisation) {
        let end = self.pivots;
        let in_coordinates = self.rounding_of_coordinates(data, factorisation);
        self.rounding_of_pivots[..end].fill(in_coordinates);
        if self.trusts_coefficients {
            self.set_rounding_of_coordinates(data, factorisation);
        }
        let has_scale_disparity = self.has_scale_disparity;
        let norm = |id| factorisation.norm_of_entries(data, id, has_scale_disparity);
        let (multipliers, rounding) = (&self.of_pivots[..end], &mut self.rounding_of_pivots[..end]);
        factorisation.balance_rounding(multipliers, norm, rounding);
        // If rows nearly depend on each other, these bounds far exceed the actual rounding. If all
        // forces are rounding, a part of them means nothing.
        let pivots = &factorisation.pivots[..self.pivots];
        let ids = pivots.iter().map(|&pivot| factorisation.stacked[pivot]);
        let most = in_coordinates.max(self.tolerance * self.size);
        for (rounding, id) in rounding[..self.pivots].iter_mut().zip(ids) {
            *rounding = rounding.min(most / data.norm(id));
        }
        if let Some(group) = self.group {
            let residuals = self.residual.iter().copied();
            self.has_multipliers_near_threshold |=
                factorisation.has_multipliers_near_threshold(data, group, residuals);
        }
        for index in 0..factorisation.bounded.len() {
            let id = factorisation.bounded[index];
            self.rounding_of_bounds[index] = self.entry_rounding(data, factorisation, id);
        }
    }

    /// Iterates over the rows of [`pairs`](Self::pairs) with their multipliers and rounding, after
    /// [`set_rounding`](Self::set_rounding).
    pub(crate) fn with_rounding<'a>(
        &'a self,
        factorisation: &'a Factorisation,
    ) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
        let rounding = self.rounding_of_pivots[..self.pivots].iter();
        self.pairs(factorisation)
            .zip(rounding.chain(&self.rounding_of_bounds))
            .map(|((id, multiplier), &rounding)| (id, multiplier, rounding))
    }

    /// Returns the rounding in the gradient's entry at a variable at a bound, after the pivots
    /// balance it. A coefficient below the rounding of its row is all rounding.
    fn entry_rounding(
        &self,
        data: &ProblemData,
        factorisation: &Factorisation,
        variable: usize,
    ) -> f64 {
        let term = |id: usize, factor: f64, rounding: f64| {
            if id < data.n {
                return 0.0;
            }
            let entry = data.coefficients(id)[variable].abs();
            let is_rounding = entry <= data.relative_rounding(id) * data.norm(id);
            let part = if is_rounding { 1.0 } else { ROUNDING };
            entry * (rounding + part * factor.abs())
        };
        let of_level = match self.group {
            None => self.rounding,
            Some(group) => {
                let linear_of = factorisation.groups[group].linear_of;
                let linear = linear_of.map_or(0.0, |l| data.levels[l].linear[variable].abs());
                let rows = self.residuals(factorisation);
                rows.map(|(id, r, rounding)| term(id, r, rounding)).sum::<f64>() + ROUNDING * linear
            }
        };
        let rounding = &self.rounding_of_pivots[..self.pivots];
        let terms = self.of_pivots[..self.pivots].iter().zip(rounding);
        let pivots = &factorisation.pivots[..self.pivots];
        let balanced = pivots
            .iter()
            .zip(terms)
            .map(|(&pivot, (&m, &rounding))| term(factorisation.stacked[pivot], m, rounding));
        of_level + balanced.sum::<f64>()
    }

    /// Returns the force below which multipliers mean nothing for certificates. A force is a
    /// multiplier times the norm of its row.
    pub(crate) fn negligible(&self, data: &ProblemData, factorisation: &Factorisation) -> f64 {
        NEGLIGIBLE * self.rounding_of_coordinates(data, factorisation)
    }
}

/// Adds weighted rows to a gradient, at the variables at a bound. A bound in the stack belongs to
/// another variable.
fn add_at_bounds<'a>(
    data: &ProblemData,
    bounded: &[usize],
    rows: impl Iterator<Item = (&'a usize, &'a f64)>,
    gradient: &mut [f64],
) {
    if bounded.is_empty() {
        return;
    }
    for (&id, &weight) in rows.filter(|&(&id, _)| id >= data.n) {
        let row = data.coefficients(id);
        for &variable in bounded {
            gradient[variable] += weight * row[variable];
        }
    }
}
