//! Multipliers of the active rows, level by level, and what their signs say.

use std::ops::Range;

use super::Verifier;
use crate::active_set::{BALANCE_NOISE, NOISE, bound};
use crate::factorisation::Purpose;
use crate::table::RowTable;
use crate::vector::{add_scaled, norm};

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
        let (pivots, threshold) = match level {
            None => {
                self.load_norm(x);
                (self.factorisation.decided().len(), 0.0)
            }
            Some(level) => {
                let Some(group) = minimised(level) else { return Vec::new() };
                let Some(threshold) = self.load_level(table, group, norm(x)) else {
                    return Vec::new();
                };
                (self.factorisation.groups[group].first_pivot, threshold)
            }
        };
        self.balance(table, pivots);
        let counts = |&(id, multiplier): &(usize, f64)| {
            (multiplier * table.norm(id)).abs() > 1e-3 * threshold
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
        let Some(threshold) = self.load_level(table, group, x_norm) else { return };
        let group = &self.factorisation.groups[group];
        let pivots = group.first_pivot;
        for &id in &self.factorisation.stacked[group.start..group.end] {
            let force = self.weights[id] * table.norm(id);
            self.signs.check(id, self.activity[id], force, threshold);
        }
        self.check_multipliers(table, pivots, threshold);
    }

    /// Checks the signs that the final choice of least norm gives.
    pub(super) fn check_least_norm(&mut self, table: &RowTable, x_norm: f64) {
        let pivots = self.factorisation.decided().len();
        let x = std::mem::take(&mut self.factorisation.x);
        self.load_norm(&x);
        self.factorisation.x = x;
        self.check_multipliers(table, pivots, self.settings.optimality_tolerance * x_norm);
    }

    /// Loads a level's gradient, and its residuals into `weights`; the size above which a
    /// multiplier times its row's norm counts, or none if the gradient itself is rounding.
    fn load_level(&mut self, table: &RowTable, group: usize, x_norm: f64) -> Option<f64> {
        let factorisation = &self.factorisation;
        let group = &factorisation.groups[group];
        let (mut size, mut noise) = (0.0, 0.0);
        for id in table.levels[group.level].used_objective() {
            self.weights[id] = 0.0;
            if self.activity[id].is_active() {
                let residual = self.value[id] - bound(table, &self.activity, id);
                self.weights[id] = residual;
                size += table.norm(id) * residual.abs();
                noise += table.norm(id) * table.magnitude(id, x_norm);
            }
        }
        let linear = group.linear_of.map(|level| &table.levels[level].linear);
        size += linear.map_or(0.0, |linear| norm(linear));
        if size <= 10.0 * NOISE * noise {
            return None;
        }
        let coordinates = &mut self.multipliers[..group.first_pivot];
        coordinates.fill(0.0);
        let rows = group.start..group.end;
        let residuals = &mut self.of_stack[..rows.len()];
        for (residual, &id) in residuals.iter_mut().zip(&factorisation.stacked[rows.clone()]) {
            *residual = self.weights[id];
        }
        factorisation.add_rows(rows, residuals, coordinates);
        if !factorisation.bounded.is_empty() {
            self.gradient.fill(0.0);
            let objective = table.levels[group.level].used_objective();
            table.add_rows(objective.clone(), &self.weights[objective], &mut self.gradient);
        }
        if let (Some(level), Some(linear)) = (group.linear_of, linear) {
            factorisation.add_linear(level, coordinates);
            add_scaled(&mut self.gradient, 1.0, linear);
        }
        Some(self.settings.optimality_tolerance * size + NOISE * noise)
    }

    /// Loads the gradient of the least norm, x itself.
    fn load_norm(&mut self, x: &[f64]) {
        let decided = self.factorisation.decided();
        self.multipliers[..decided.len()].copy_from_slice(decided);
        self.gradient.copy_from_slice(x);
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
    fn check_multipliers(&mut self, table: &RowTable, pivots: usize, threshold: f64) {
        self.balance(table, pivots);
        let factorisation = &self.factorisation;
        let mut size = 0.0;
        for (force, &pivot) in self.multipliers[..pivots].iter_mut().zip(&factorisation.pivots) {
            *force *= table.norm(factorisation.stacked[pivot]);
            size += force.abs();
        }
        let threshold = threshold + BALANCE_NOISE * size;
        for (&force, &pivot) in self.multipliers[..pivots].iter().zip(&factorisation.pivots) {
            let id = factorisation.stacked[pivot];
            self.signs.check(id, self.activity[id], force, threshold);
        }
        for &id in &factorisation.bounded {
            self.signs.check(id, self.activity[id], -self.gradient[id], threshold);
        }
    }
}
