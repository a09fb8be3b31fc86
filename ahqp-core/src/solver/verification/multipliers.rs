//! Multipliers of the active rows, level by level, and what their signs say.

use std::ops::Range;

use super::Verifier;
use crate::linalg::vector::{add_scaled, norm};
use crate::solver::active_set::bound;
use crate::solver::data::RowTable;
use crate::solver::factorisation::{Group, Purpose};
use crate::solver::tolerances::{CLEARLY_THERE, ROUNDING};

/// Which residuals a level's gradient is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Residuals {
    /// Those of the rows at x.
    AtPoint,
    /// Those that balance each other: of heavy rows they may be far below the rounding of a x.
    Balanced,
}

impl Verifier {
    /// The multipliers that are not rounding of one level, or of the least norm behind the last,
    /// at the point that the present active set gives; `x` is that point.
    pub(crate) fn multipliers_of(
        &mut self,
        table: &RowTable,
        level: Option<usize>,
        x: &[f64],
    ) -> Vec<(usize, f64)> {
        self.value[..table.n].copy_from_slice(x);
        table.multiply(table.n..table.len(), x, &mut self.value);
        let minimised = |level: usize| {
            self.factorisation
                .groups
                .iter()
                .position(|group| group.level == level && group.purpose == Purpose::Minimised)
        };
        let pivots = match level {
            None => {
                self.load_norm(x);
                self.factorisation.decided().len()
            }
            Some(level) => {
                let Some(group) = minimised(level) else { return Vec::new() };
                if !self.load_level(table, group, norm(x), Residuals::AtPoint) {
                    return Vec::new();
                }
                self.factorisation.groups[group].first_pivot
            }
        };
        self.balance(table, pivots);
        let counts = |&(id, multiplier): &(usize, f64)| {
            (multiplier * table.norm(id)).abs() > 1e-3 * self.rounding
        };
        self.balancing(pivots).filter(counts).collect()
    }

    /// The rows that balance a gradient, and their multipliers.
    fn balancing(&self, pivots: usize) -> impl Iterator<Item = (usize, f64)> {
        let factorisation = &self.factorisation;
        let ids = factorisation.pivots.iter().map(|&pivot| factorisation.stacked[pivot]);
        let bounds = factorisation.bounded.iter().map(|&id| (id, -self.gradient[id]));
        ids.zip(self.multipliers[..pivots].iter().copied()).chain(bounds)
    }

    /// What the active rows push with against hard rows that stay violated: multipliers times the
    /// norms of their rows.
    pub(crate) fn forces_against(
        &mut self,
        table: &RowTable,
        violated: Range<usize>,
        violation: impl Fn(usize) -> f64,
    ) -> impl Iterator<Item = (usize, f64)> {
        self.factorisation.factorise(table, &self.activity, self.settings.rank_tolerance);
        for id in violated.clone() {
            self.weights[id] = violation(id);
        }
        self.gradient.fill(0.0);
        table.add_rows(violated.clone(), &self.weights[violated], &mut self.gradient);
        let pivots = self.factorisation.decided().len();
        self.factorisation.coordinates(&self.gradient, &mut self.multipliers[..pivots]);
        self.balance(table, pivots);
        self.balancing(pivots).map(|(id, multiplier)| (id, multiplier * table.norm(id)))
    }

    /// Checks the signs that the level of `group`, the rows of its objective, gives.
    pub(super) fn check_level(&mut self, table: &RowTable, group: usize, x_norm: f64) {
        if !self.load_level(table, group, x_norm, Residuals::Balanced) {
            return;
        }
        let Group { start, end, first_pivot, .. } = self.factorisation.groups[group];
        let residuals = self.residual.iter().zip(&self.residual_rounding);
        for (&id, (&residual, &rounding)) in
            self.factorisation.stacked[start..end].iter().zip(residuals)
        {
            self.signs.check(id, self.activity[id], residual, rounding, table.norm(id));
        }
        self.check_multipliers(table, Some(group), first_pivot);
    }

    /// Checks the signs that the final choice of least norm gives.
    pub(super) fn check_least_norm(&mut self, table: &RowTable) {
        let pivots = self.factorisation.decided().len();
        let x = std::mem::take(&mut self.factorisation.x);
        self.load_norm(&x);
        self.factorisation.x = x;
        self.check_multipliers(table, None, pivots);
    }

    /// Loads a level's gradient, and its residuals. Returns false if all of these are rounding.
    ///
    /// Balanced, the residuals of the pivots are those that balance the others along the coordinates
    /// that the level decides; without others there are none.
    fn load_level(
        &mut self,
        table: &RowTable,
        group: usize,
        x_norm: f64,
        residuals: Residuals,
    ) -> bool {
        let factorisation = &self.factorisation;
        let Group { level, start, end, rank, first_pivot, linear_of, .. } =
            factorisation.groups[group];
        let first = if residuals == Residuals::Balanced { rank } else { 0 };
        if linear_of.is_none() && end - start == first {
            return false;
        }
        let residual = &mut self.residual[..end - start];
        let rounding = &mut self.residual_rounding[..end - start];
        let mut any = linear_of.is_some();
        for (i, &id) in factorisation.stacked[start..end].iter().enumerate().skip(first) {
            residual[i] = self.value[id] - bound(table, &self.activity, id);
            rounding[i] = table.rounding(id, x_norm);
            any |= residual[i].abs() > rounding[i];
        }
        if !any {
            return false;
        }
        if residuals == Residuals::Balanced {
            factorisation.balance_group(table, group, residual, rounding);
        }
        (self.size, self.rounding) = (0.0, 0.0);
        let terms = residual.iter().zip(rounding.iter());
        for (&id, (&residual, &rounding)) in factorisation.stacked[start..end].iter().zip(terms) {
            self.size += table.norm(id) * residual.abs();
            self.rounding += table.norm(id) * (rounding + ROUNDING * residual.abs());
        }
        let coordinates = &mut self.multipliers[..first_pivot];
        coordinates.fill(0.0);
        factorisation.add_rows(start..end, residual, coordinates);
        if !factorisation.bounded.is_empty() {
            let objective = table.levels[level].used_objective();
            self.weights[objective.clone()].fill(0.0);
            for (&id, &residual) in factorisation.stacked[start..end].iter().zip(residual.iter()) {
                self.weights[id] = residual;
            }
            self.gradient.fill(0.0);
            table.add_rows(objective.clone(), &self.weights[objective], &mut self.gradient);
        }
        if let Some(level) = linear_of {
            let linear = &table.levels[level].linear;
            factorisation.add_linear(level, coordinates);
            add_scaled(&mut self.gradient, 1.0, linear);
            self.size += norm(linear);
            self.rounding += ROUNDING * norm(linear);
        }
        true
    }

    /// Loads the gradient of the least norm, x itself.
    fn load_norm(&mut self, x: &[f64]) {
        let decided = self.factorisation.decided();
        self.multipliers[..decided.len()].copy_from_slice(decided);
        self.gradient.copy_from_slice(x);
        self.size = norm(x);
        self.rounding = self.settings.optimality_tolerance * self.size;
    }

    /// The multipliers of the first `pivots` pivots that balance the gradient, whose coordinates
    /// stand in `multipliers`; `gradient` keeps what they leave at the variables at a bound.
    fn balance(&mut self, table: &RowTable, pivots: usize) {
        let factorisation = &self.factorisation;
        let multipliers = &mut self.multipliers[..pivots];
        factorisation.balance(multipliers);
        if factorisation.bounded.is_empty() {
            return;
        }
        self.weights.fill(0.0);
        let mut end = table.n;
        for (&multiplier, &pivot) in multipliers.iter().zip(&factorisation.pivots) {
            let id = factorisation.stacked[pivot];
            self.weights[id] = multiplier;
            end = end.max(id + 1);
        }
        // A bound in the stack is one of a variable that counts as free.
        let rows = table.n..end;
        table.add_rows(rows.clone(), &self.weights[rows], &mut self.gradient);
    }

    /// Balances the gradient by the first `pivots` pivots and the bounds, and checks the signs of
    /// those that are inequalities.
    fn check_multipliers(&mut self, table: &RowTable, group: Option<usize>, pivots: usize) {
        self.balance(table, pivots);
        let factorisation = &self.factorisation;
        let ids = factorisation.pivots[..pivots].iter().map(|&pivot| factorisation.stacked[pivot]);
        let forces = ids.clone().zip(&self.multipliers).map(|(id, m)| (m * table.norm(id)).abs());
        let clear = CLEARLY_THERE * (self.size + forces.clone().sum::<f64>());
        let is_clear = |(id, force): (usize, f64)| force > clear || !self.signs.is_open(id);
        let bounds = factorisation.bounded.iter().map(|&id| (id, self.gradient[id].abs()));
        // How much of small multipliers is rounding is only asked where there are any.
        if ids.zip(forces).chain(bounds).all(is_clear) {
            self.multiplier_rounding[..pivots].fill(0.0);
        } else {
            self.set_multiplier_rounding(table, pivots);
        }
        for index in 0..pivots {
            let id = self.factorisation.stacked[self.factorisation.pivots[index]];
            let rounding = self.multiplier_rounding[index];
            let state = self.activity[id];
            self.signs.check(id, state, self.multipliers[index], rounding, table.norm(id));
        }
        for index in 0..self.factorisation.bounded.len() {
            let id = self.factorisation.bounded[index];
            if self.signs.is_open(id) {
                let force = -self.gradient[id];
                let rounding = if force.abs() > clear {
                    0.0
                } else {
                    self.entry_rounding(table, group, pivots, id)
                };
                self.signs.check(id, self.activity[id], force, rounding, 1.0);
            }
        }
    }

    /// The rounding in the first `pivots` multipliers: that of the sums they come from.
    fn set_multiplier_rounding(&mut self, table: &RowTable, pivots: usize) {
        let Self { factorisation, multipliers, multiplier_rounding, .. } = self;
        let rounding = &mut multiplier_rounding[..pivots];
        rounding.fill(self.rounding);
        let norm = |id| table.norm(id);
        factorisation.balance_rounding(&multipliers[..pivots], norm, rounding);
        // Where rows nearly depend on each other, these bounds grow far beyond the real rounding.
        let ids = factorisation.pivots.iter().map(|&pivot| factorisation.stacked[pivot]);
        let forces = multipliers.iter().zip(ids.clone()).map(|(m, id)| m.abs() * table.norm(id));
        let most =
            self.settings.optimality_tolerance * (self.size + forces.take(pivots).sum::<f64>());
        for (rounding, id) in rounding.iter_mut().zip(ids) {
            *rounding = rounding.min(most / table.norm(id));
        }
    }

    /// The rounding in the entry of a level's gradient at a variable, balanced by the pivots.
    fn entry_rounding(
        &self,
        table: &RowTable,
        group: Option<usize>,
        pivots: usize,
        variable: usize,
    ) -> f64 {
        let factorisation = &self.factorisation;
        let entry = |id: usize| {
            if id < table.n { 0.0 } else { table.coefficients(id)[variable].abs() }
        };
        let of_level = match group {
            None => self.rounding,
            Some(group) => {
                let Group { start, end, linear_of, .. } = factorisation.groups[group];
                let terms = self.residual.iter().zip(&self.residual_rounding);
                let rows = factorisation.stacked[start..end].iter().zip(terms);
                let linear = linear_of.map_or(0.0, |l| table.levels[l].linear[variable].abs());
                rows.map(|(&id, (r, rounding))| entry(id) * (rounding + ROUNDING * r.abs()))
                    .sum::<f64>()
                    + ROUNDING * linear
            }
        };
        let terms = self.multipliers[..pivots].iter().zip(&self.multiplier_rounding);
        let balanced = factorisation.pivots.iter().zip(terms).map(|(&pivot, (m, rounding))| {
            entry(factorisation.stacked[pivot]) * (rounding + ROUNDING * m.abs())
        });
        of_level + balanced.sum::<f64>()
    }
}
