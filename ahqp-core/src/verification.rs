//! Whether a point is the lexicographic optimum, seen from its active set alone.
//!
//! A level's Lagrangian has the gradient Aᵀr of its residuals r, balanced by multipliers of all
//! rows above it: hard rows, rows of higher objectives (held, of either sign) and bounds. x is
//! optimal when every row that is not active holds and, for every active inequality, the first
//! level at which its multiplier differs from zero gives it the right sign (Dimitrov, Sherikov,
//! Wieber; Escande, Mansard, Wieber, IJRR 33, 2014).

use std::ops::Range;

use crate::active_set::{BALANCE_NOISE, NOISE, RowState, bound};
use crate::factorisation::{Factorisation, Purpose};
use crate::settings::Settings;
use crate::table::RowTable;
use crate::vector::{add_scaled, norm};

/// Up to one change in so many variables, a factorisation is updated and not made anew.
const UPDATED: usize = 4;

/// An active set of the whole hierarchy, its factorisation, and the check; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Verifier {
    pub(crate) factorisation: Factorisation,
    /// Of every row of the table: inside, or active at a bound.
    pub(crate) activity: Vec<RowState>,
    /// aᵢx.
    value: Vec<f64>,
    signs: Signs,
    /// Whether the last active set asked for was far from the right one.
    pub(crate) far: bool,
    multipliers: Vec<f64>,
    /// Entries of a level's gradient: those of the variables at a bound, the rest is not needed.
    gradient: Vec<f64>,
    settings: Settings,
}

/// What a check found, and mended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Repairs {
    /// Rows that were violated and are active now.
    pub(crate) taken: usize,
    /// Rows with a multiplier of the wrong sign, inside now.
    pub(crate) released: usize,
}

impl Verifier {
    pub(crate) fn new(table: &RowTable, settings: Settings) -> Self {
        Self {
            factorisation: Factorisation::new(table),
            activity: vec![RowState::Inside; table.len()],
            value: vec![0.0; table.len()],
            signs: Signs::new(table.len()),
            far: false,
            multipliers: vec![0.0; table.n],
            gradient: vec![0.0; table.n],
            settings,
        }
    }

    /// Solves from the present active set, which fits the data, mending it for up to `rounds`
    /// rounds; how many it took, or none if it did not come to an end.
    pub(crate) fn solve(&mut self, table: &RowTable, rounds: usize) -> Option<usize> {
        self.far = true;
        let mut before = usize::MAX;
        for round in 1..=rounds {
            if !self.follow(table, round == 1) {
                return None;
            }
            let repairs = self.repair(table)?;
            if repairs == (Repairs { taken: 0, released: 0 }) {
                return Some(round);
            }
            // Mending that does not shrink goes round in circles.
            let changes = repairs.taken + repairs.released;
            if round == 1 {
                self.far = changes > table.n / 6 + 1;
            }
            if self.far || (changes > before && round > 2) {
                return None;
            }
            before = changes;
        }
        None
    }

    /// Brings the factorisation to the present active set; false if that gives no point.
    fn follow(&mut self, table: &RowTable, anew: bool) -> bool {
        let tolerance = self.settings.rank_tolerance;
        let few = !anew && self.signs.changed.len() <= table.n / UPDATED;
        let (factorisation, activity) = (&mut self.factorisation, &self.activity);
        let updated = few && factorisation.update(table, activity, &self.signs.changed, tolerance);
        updated || factorisation.factorise(table, activity, tolerance)
    }

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
        let (pivots, threshold) = match level {
            None => {
                self.load_norm(x);
                (self.factorisation.decided().len(), 0.0)
            }
            Some(level) => {
                let group =
                    self.factorisation.groups.iter().position(|group| {
                        group.level == level && group.purpose == Purpose::Minimised
                    });
                let Some(group) = group else { return Vec::new() };
                let Some(threshold) = self.load_level(table, group, norm(x)) else {
                    return Vec::new();
                };
                (self.factorisation.groups[group].first_pivot, threshold)
            }
        };
        let factorisation = &self.factorisation;
        let coordinates = &mut self.multipliers[..pivots];
        factorisation.balance(coordinates);
        let mut all = Vec::new();
        for (pivot, &multiplier) in coordinates.iter().enumerate() {
            let id = factorisation.stacked[factorisation.pivots[pivot]];
            factorisation.add_at_bounds(table.row(id), multiplier, &mut self.gradient);
            all.push((id, multiplier));
        }
        all.extend(factorisation.bounded.iter().map(|&id| (id, -self.gradient[id])));
        all.retain(|&(id, multiplier)| {
            (multiplier * table.row(id).norm()).abs() > 1e-3 * threshold
        });
        all
    }

    /// Makes the active set fit the data: equalities are active, sides without a bound are not.
    pub(crate) fn fit(&mut self, table: &RowTable) {
        for (id, state) in self.activity.iter_mut().enumerate() {
            let fits = match *state {
                RowState::Lower => table.lower[id].is_finite(),
                RowState::Upper => table.upper[id].is_finite(),
                _ => false,
            };
            if table.is_equality(id) {
                *state = RowState::Equal;
            } else if !fits {
                *state = RowState::Inside;
            }
        }
    }

    /// Checks x, and mends the active set where it is wrong; none where that cannot help.
    fn repair(&mut self, table: &RowTable) -> Option<Repairs> {
        let x_norm = norm(&self.factorisation.x);
        if !x_norm.is_finite() {
            return None;
        }
        self.signs.begin(&self.activity);
        let taken = self.take_violated(table, x_norm)?;
        for group in 0..self.factorisation.groups.len() {
            if self.signs.unsettled == 0 {
                return Some(Repairs { taken, released: 0 });
            }
            if self.factorisation.groups[group].purpose == Purpose::Minimised {
                let released = self.check_level(table, group, x_norm);
                // Signs below a level that is not at its optimum yet mean nothing.
                if released > 0 {
                    return Some(Repairs { taken, released });
                }
            }
        }
        let released = self.check_least_norm(table, x_norm);
        Some(Repairs { taken, released })
    }

    fn tolerance(&self, table: &RowTable, id: usize, x_norm: f64) -> f64 {
        self.settings.feasibility_tolerance * table.magnitude(id, x_norm)
    }

    /// Every row that is violated becomes active; none if a row that should hold does not.
    fn take_violated(&mut self, table: &RowTable, x_norm: f64) -> Option<usize> {
        let mut taken = 0;
        let n = table.n;
        self.value[..n].copy_from_slice(&self.factorisation.x);
        table.multiply(n..table.len(), &self.factorisation.x, &mut self.value);
        if self.factorisation.bounds_in_stack().any(|id| self.is_missed(table, id, x_norm)) {
            return None;
        }
        taken += self.take_violated_among(table, 0..n, x_norm);
        for level in &table.levels {
            let mut constraints = level.constraints.clone();
            if constraints.any(|id| self.is_missed(table, id, x_norm)) {
                return None;
            }
            taken += self.take_violated_among(table, level.constraints.clone(), x_norm);
            taken += self.take_violated_among(table, level.used_objective(), x_norm);
        }
        Some(taken)
    }

    /// Whether a row is active, but x is not at its bound.
    fn is_missed(&self, table: &RowTable, id: usize, x_norm: f64) -> bool {
        let gap = || self.value[id] - bound(table, &self.activity, id);
        self.activity[id].is_active() && gap().abs() > self.tolerance(table, id, x_norm)
    }

    fn take_violated_among(&mut self, table: &RowTable, rows: Range<usize>, x_norm: f64) -> usize {
        let mut taken = 0;
        let [value, lower, upper] =
            [&self.value, &table.lower, &table.upper].map(|of_rows| &of_rows[rows.clone()]);
        for (((id, &value), &lower), &upper) in rows.clone().zip(value).zip(lower).zip(upper) {
            let outside = value > upper || value < lower;
            if outside && self.activity[id] == RowState::Inside {
                let tolerance = self.tolerance(table, id, x_norm);
                if value > upper + tolerance {
                    self.activity[id] = RowState::Upper;
                } else if value < lower - tolerance {
                    self.activity[id] = RowState::Lower;
                } else {
                    continue;
                }
                self.signs.changed.push(id);
                taken += 1;
            }
        }
        taken
    }

    /// Checks the signs that the level of `group`, the rows of its objective, gives.
    fn check_level(&mut self, table: &RowTable, group: usize, x_norm: f64) -> usize {
        let Some(threshold) = self.load_level(table, group, x_norm) else { return 0 };
        let factorisation = &self.factorisation;
        let group = &factorisation.groups[group];
        let mut released = 0;
        for at in group.start..group.end {
            let id = factorisation.stacked[at];
            // Each row is asked before it may change.
            let force = (self.value[id] - bound(table, &self.activity, id)) * table.row(id).norm();
            released += usize::from(self.signs.check(&mut self.activity, id, force, threshold));
        }
        let pivots = group.first_pivot;
        released + self.check_multipliers(table, pivots, threshold)
    }

    /// Loads a level's gradient; the size above which a multiplier times its row's norm counts,
    /// or none if the gradient itself is rounding.
    fn load_level(&mut self, table: &RowTable, group: usize, x_norm: f64) -> Option<f64> {
        let factorisation = &self.factorisation;
        let group = &factorisation.groups[group];
        let coordinates = &mut self.multipliers[..group.first_pivot];
        coordinates.fill(0.0);
        self.gradient.fill(0.0);
        let (mut size, mut noise) = (0.0, 0.0);
        for at in group.start..group.end {
            let id = factorisation.stacked[at];
            let row = table.row(id);
            let residual = self.value[id] - bound(table, &self.activity, id);
            size += row.norm() * residual.abs();
            noise += row.norm() * table.magnitude(id, x_norm);
            factorisation.add_row(at, residual, coordinates);
            factorisation.add_at_bounds(table.row(id), residual, &mut self.gradient);
        }
        if let Some(level) = group.linear_of {
            let linear = &table.levels[level].linear;
            factorisation.add_linear(level, coordinates);
            add_scaled(&mut self.gradient, 1.0, linear);
            size += norm(linear);
        }
        let matters = size > 10.0 * NOISE * noise;
        matters.then_some(self.settings.optimality_tolerance * size + NOISE * noise)
    }

    /// Loads the gradient of the least norm, x itself.
    fn load_norm(&mut self, x: &[f64]) {
        let decided = self.factorisation.decided();
        self.multipliers[..decided.len()].copy_from_slice(decided);
        self.gradient.copy_from_slice(x);
    }

    /// Checks the signs that the final choice of least norm gives.
    fn check_least_norm(&mut self, table: &RowTable, x_norm: f64) -> usize {
        let pivots = self.factorisation.decided().len();
        let x = std::mem::take(&mut self.factorisation.x);
        self.load_norm(&x);
        self.factorisation.x = x;
        self.check_multipliers(table, pivots, self.settings.optimality_tolerance * x_norm)
    }

    /// Balances `gradient`, whose coordinates stand in `multipliers`, by the first `pivots`
    /// pivots and the bounds, and checks the signs of those that are inequalities.
    fn check_multipliers(&mut self, table: &RowTable, pivots: usize, threshold: f64) -> usize {
        let factorisation = &self.factorisation;
        let coordinates = &mut self.multipliers[..pivots];
        factorisation.balance(coordinates);
        let (mut released, mut size) = (0, 0.0);
        for (force, &pivot) in coordinates.iter_mut().zip(&factorisation.pivots) {
            let row = table.row(factorisation.stacked[pivot]);
            factorisation.add_at_bounds(row, *force, &mut self.gradient);
            *force *= row.norm();
            size += force.abs();
        }
        let threshold = threshold + BALANCE_NOISE * size;
        for (&force, &pivot) in coordinates.iter().zip(&factorisation.pivots) {
            let id = factorisation.stacked[pivot];
            released += usize::from(self.signs.check(&mut self.activity, id, force, threshold));
        }
        for &id in &factorisation.bounded {
            let force = -self.gradient[id];
            released += usize::from(self.signs.check(&mut self.activity, id, force, threshold));
        }
        released
    }
}

/// Which active inequalities have shown that their sign is right: the first multiplier that
/// differs from zero decides.
#[derive(Debug, Clone)]
struct Signs {
    /// All rows but the active inequalities whose sign has yet to be seen.
    settled: Vec<bool>,
    /// How many those are.
    unsettled: usize,
    /// Rows whose activity the check at hand has changed.
    changed: Vec<usize>,
}

impl Signs {
    fn new(rows: usize) -> Self {
        Self { settled: vec![false; rows], unsettled: 0, changed: Vec::with_capacity(rows) }
    }

    fn begin(&mut self, activity: &[RowState]) {
        self.changed.clear();
        self.unsettled = 0;
        for (settled, &state) in self.settled.iter_mut().zip(activity) {
            *settled = !matches!(state, RowState::Lower | RowState::Upper);
            self.unsettled += usize::from(!*settled);
        }
    }

    /// Looks at a multiplier times its row's norm. A wrong one lets its row go; whether it did.
    fn check(&mut self, activity: &mut [RowState], id: usize, force: f64, threshold: f64) -> bool {
        if self.settled[id] || force.abs() <= threshold {
            return false;
        }
        self.settled[id] = true;
        self.unsettled -= 1;
        let wrong = activity[id].is_wrong(force, threshold);
        if wrong {
            activity[id] = RowState::Inside;
            self.changed.push(id);
        }
        wrong
    }
}
