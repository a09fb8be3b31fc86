//! The active set of the whole hierarchy, and its point.
//!
//! Two methods find the optimal active set, on one factorisation. [`repair`] corrects a predicted
//! active set a few rows at a time, as long as that makes progress. [`level_search`] is the primal
//! active-set method, level by level.

mod broken_rows;
mod fix;
mod goal;
mod level_search;
mod ratio_test;
mod repair;
mod signs;

use std::ops::Range;

use super::activity::Activity;
use super::budget::{Budget, RemainingBudget};
use super::data::ProblemData;
use super::factorisation::{Factorisation, Group, Purpose, RankTolerances};
use super::multipliers::{Multipliers, Residuals};
use super::settings::Settings;
use crate::linalg::list::List;
use crate::linalg::vector::norm;
use crate::problem::source::ConstraintSource;
use ratio_test::Candidate;
use signs::Signs;

pub(crate) use goal::Goal;
pub(crate) use level_search::End;

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    pub(crate) data: ProblemData,
    pub(crate) factorisation: Factorisation,
    /// Activity of every row.
    pub(crate) activity: Vec<Activity>,
    /// Predicted active set, from which a search starts.
    pub(crate) predicted: Vec<Activity>,
    pub(crate) x: Vec<f64>,
    /// Values aᵢx.
    pub(crate) value: Vec<f64>,
    pub(crate) iterations: usize,
    pub(crate) remaining: RemainingBudget,
    pub(super) multipliers: Multipliers,

    /// Repair: the order of signs, the violated rows, and aᵢx at the last point.
    signs: Signs,
    violated: List<(usize, Activity)>,
    reached: Vec<f64>,

    /// True if a search starts from a predicted optimum, and gives up where that takes long.
    pub(crate) is_predicted: bool,

    /// Search: active rows that a level has fixed for all levels below.
    fixed: Vec<bool>,
    /// Number of groups of the factorisation that x attains: it is where they decide.
    attained: usize,
    /// True if a held row is not exactly at its bound, but within its tolerance.
    pub(crate) has_gaps: bool,
    /// True if the goal had a gradient beyond rounding at the end of its search.
    has_gradient: bool,
    /// Ranges of rows whose inactive rows must stay within their bounds, and whose values a step
    /// moves.
    monitored: List<Range<usize>>,
    /// Remaining violation of inactive rows of the objective, which falls to zero during the
    /// search.
    residual: Vec<f64>,
    direction: Vec<f64>,
    slope: Vec<f64>,
    candidates: List<Candidate>,
    /// Rows that stay active in the current search, since objectives above need them.
    tabu: List<usize>,
    /// Rows of a finished objective that were made inactive, with their former activity.
    released: List<(usize, Activity)>,
    /// Largest ‖x‖ of this solve.
    pub(crate) max_norm: f64,
    settings: Settings,
}

impl ActiveSet {
    pub(crate) fn new(data: ProblemData, settings: Settings) -> Self {
        let (n, count) = (data.n, data.len());
        let tolerances = RankTolerances::new(settings.rank_tolerance);
        Self {
            factorisation: Factorisation::new(&data, tolerances),
            activity: vec![Activity::Inactive; count],
            predicted: vec![Activity::Inactive; count],
            x: vec![0.0; n],
            value: vec![0.0; count],
            iterations: 0,
            remaining: RemainingBudget::new(Budget::default(), settings.max_iterations),
            multipliers: Multipliers::new(&data, settings.optimality_tolerance),
            signs: Signs::new(count),
            violated: List::with_capacity(count),
            reached: vec![0.0; count],
            is_predicted: false,
            fixed: vec![false; count],
            attained: 0,
            has_gaps: false,
            has_gradient: false,
            monitored: List::with_capacity(2 * data.levels.len() + 1),
            residual: vec![0.0; count],
            direction: vec![0.0; n],
            slope: vec![0.0; count],
            candidates: List::with_capacity(count),
            tabu: List::with_capacity(count),
            released: List::with_capacity(count),
            max_norm: 0.0,
            data,
            settings,
        }
    }

    pub(crate) fn change_settings(&mut self, settings: Settings) {
        self.factorisation.tolerances = RankTolerances::new(settings.rank_tolerance);
        self.multipliers.tolerance = settings.optimality_tolerance;
        self.settings = settings;
    }

    /// Adapts an active set to the data. Equalities become active, and sides without a bound
    /// inactive.
    #[expect(clippy::needless_bitwise_bool, reason = "no branches")]
    pub(crate) fn fit(&mut self) {
        let bounds = self.data.lower.iter().zip(&self.data.upper);
        for (activity, (&lower, &upper)) in self.activity.iter_mut().zip(bounds) {
            let fits = (*activity == Activity::Lower) & (lower > f64::NEG_INFINITY)
                | (*activity == Activity::Upper) & (upper < f64::INFINITY);
            let otherwise = if fits { *activity } else { Activity::Inactive };
            *activity = if lower == upper { Activity::Equal } else { otherwise };
        }
    }

    /// Starts a search near `start`, which is clamped to its bounds. Only the bounds are monitored.
    /// Predicted bounds are active from the start.
    pub(crate) fn begin_search(&mut self, start: &[f64]) {
        self.activity.fill(Activity::Inactive);
        self.fixed.fill(false);
        self.monitored.clear();
        self.monitored.push(0..self.data.n);
        for (i, near) in start.iter().enumerate() {
            let (lower, upper) = (self.data.lower[i], self.data.upper[i]);
            self.activity[i] = match self.predicted[i] {
                predicted @ (Activity::Lower | Activity::Upper) => predicted,
                _ => Activity::Inactive,
            };
            self.x[i] = match self.activity[i] {
                Activity::Lower => lower,
                Activity::Upper => upper,
                _ => near.clamp(lower, upper),
            };
            self.value[i] = self.x[i];
            self.residual[i] = 0.0;
        }
        self.max_norm = norm(&self.x);
        self.attained = 0;
        self.has_gaps = false;
        self.multipliers.has_multipliers_near_threshold = false;
        self.factorisation.begin(&self.data, &self.activity);
    }

    /// Adds rows to those that are monitored. Ranges that follow each other become one.
    pub(crate) fn monitor(&mut self, rows: Range<usize>) {
        match self.monitored.last_mut() {
            Some(last) if last.end == rows.start => last.end = rows.end,
            _ => self.monitored.push(rows),
        }
    }

    /// Returns aᵢx − bound: positive above the upper bound, negative below the lower, otherwise
    /// zero.
    pub(crate) fn violation(&self, id: usize) -> f64 {
        let value = self.value[id];
        (value - self.data.upper[id]).max(0.0) + (value - self.data.lower[id]).min(0.0)
    }

    /// Returns the largest gap between row `id` and its bound that counts as zero.
    fn tolerance(&self, id: usize) -> f64 {
        let part = self.settings.feasibility_tolerance;
        self.data.tolerance(id, &self.x, self.max_norm, part)
    }

    /// Returns the violation of row `id` in units of the largest with which it holds.
    pub(crate) fn relative_violation(&self, id: usize) -> f64 {
        match self.violation(id).abs() {
            0.0 => 0.0,
            violation => violation / self.tolerance(id),
        }
    }

    /// Returns true if row `id` holds.
    pub(crate) fn holds(&self, id: usize) -> bool {
        self.relative_violation(id) <= 1.0
    }

    /// Monitors soft rows, in a group of their own: rows of an objective, or hard rows
    /// whose violation is minimised.
    pub(crate) fn place_soft(&mut self, level: usize, rows: Range<usize>) {
        self.data.multiply(rows.clone(), &self.x, &mut self.value);
        for id in rows.clone() {
            self.residual[id] = 0.0;
            let violation = self.violation(id);
            self.activity[id] = if self.data.is_equality(id) {
                Activity::Equal
            } else if violation > 0.0 {
                Activity::Upper
            } else if violation < 0.0 {
                Activity::Lower
            } else {
                Activity::Inactive
            };
        }
        let is_objective = self.data.levels[level].objective.start == rows.start;
        let linear_of = (is_objective && self.data.levels[level].has_linear).then_some(level);
        self.factorisation.push_group(level, Purpose::Minimised, linear_of);
        self.factorisation.push_active(&self.data, &self.activity, rows);
        self.factorisation.eliminate_last();
    }

    /// Determines which rows of an objective are violated, if no direction is left to change that.
    pub(crate) fn classify_rows(&mut self, rows: Range<usize>) {
        self.data.multiply(rows.clone(), &self.x, &mut self.value);
        for id in rows {
            let violation = self.violation(id);
            self.activity[id] = if self.data.is_equality(id) {
                Activity::Equal
            } else if self.holds(id) {
                Activity::Inactive
            } else if violation > 0.0 {
                Activity::Upper
            } else {
                Activity::Lower
            };
        }
    }

    /// Removes the last group, whose violation was minimised.
    pub(crate) fn remove_soft(&mut self, rows: Range<usize>) {
        self.factorisation.pop_group();
        self.attained = self.attained.min(self.factorisation.groups.len());
        self.activity[rows].fill(Activity::Inactive);
    }

    /// Returns true if forces of rows of one objective differ so much that the rounding of one may
    /// hide another.
    pub(crate) fn has_scale_disparity(&self) -> bool {
        let (data, x_norm) = (&self.data, norm(&self.x));
        data.levels.iter().any(|level| data.have_scale_disparity(level.used_objective(), x_norm))
    }

    /// Computes aᵢx of these rows from the data. The values that a search sums up contain the
    /// rounding of all its steps.
    pub(crate) fn compute_values(&mut self, rows: Range<usize>) {
        self.data.multiply(rows, &self.x, &mut self.value);
    }

    /// Returns true if all these rows hold.
    pub(crate) fn all_hold(&mut self, rows: Range<usize>) -> bool {
        self.compute_values(rows.clone());
        rows.into_iter().all(|id| self.holds(id))
    }

    /// Opens a group for hard rows that become active from here on.
    pub(crate) fn open_held(&mut self, level: usize) {
        self.factorisation.push_group(level, Purpose::Held, None);
    }

    /// Monitors hard rows that hold at x. Equalities are active from the start. So are
    /// independent rows at their predicted bounds.
    pub(crate) fn place_hard(&mut self, level: usize, rows: Range<usize>) {
        if rows.is_empty() {
            return;
        }
        self.data.multiply(rows.clone(), &self.x, &mut self.value);
        for id in rows.clone() {
            self.residual[id] = 0.0;
            let predicted = self.predicted[id];
            let gap = match predicted {
                Activity::Lower => self.value[id] - self.data.lower[id],
                Activity::Upper => self.value[id] - self.data.upper[id],
                _ => f64::INFINITY,
            };
            self.activity[id] = if self.data.is_equality(id) {
                Activity::Equal
            } else if gap.abs() <= self.tolerance(id) {
                predicted
            } else {
                Activity::Inactive
            };
        }
        self.monitor(rows.clone());
        self.open_held(level);
        self.factorisation.push_active(&self.data, &self.activity, rows);
        self.factorisation.eliminate_last();
        let Some(group) = self.factorisation.groups.last().cloned() else { return };
        for at in (group.start + group.rank..group.end).rev() {
            let id = self.factorisation.stacked[at];
            if self.activity[id] != Activity::Equal {
                self.activity[id] = Activity::Inactive;
                self.take_out(id, self.factorisation.groups.len() - 1);
            }
        }
    }

    /// Adds an active row to a group of the factorisation.
    fn add_row(&mut self, id: usize, group: usize) {
        self.attained = self.attained.min(group);
        self.factorisation.add(&self.data, &self.activity, id, group);
    }

    /// Removes a row that has become inactive from its group of the factorisation.
    fn take_out(&mut self, id: usize, group: usize) {
        self.attained = self.attained.min(group);
        self.factorisation.take_out(&self.data, &self.activity, id);
    }

    /// Adds rows to the conflict that push against the violated rows, which the last group
    /// contains. Their force, the multiplier times the norm of the row, must exceed `threshold`.
    pub(crate) fn add_conflict_multipliers(
        &mut self,
        threshold: f64,
        conflict: &mut List<ConstraintSource>,
    ) {
        let Self { data, factorisation, multipliers, value, activity, x, .. } = self;
        let group = factorisation.groups.len() - 1;
        value[..data.n].copy_from_slice(x);
        let of = (group, Residuals::AtPoint);
        if multipliers.balance_level(data, factorisation, value, activity, of) {
            let pushing = multipliers
                .pairs(factorisation)
                .filter(|&(id, multiplier)| (multiplier * data.norm(id)).abs() > threshold);
            conflict.extend(pushing.map(|(id, _)| data.sources[id]));
        }
    }

    /// Factors the current active set and computes its point.
    pub(crate) fn factorise(&mut self) {
        self.factorisation.factorise(&self.data, &self.activity);
    }

    /// Returns the multipliers beyond rounding at `x` of one level, or of the least norm after the
    /// last. The present factorisation must be that of all levels.
    pub(crate) fn multipliers_of(&mut self, level: Option<usize>, x: &[f64]) -> Vec<(usize, f64)> {
        let Self { data, factorisation, multipliers, value, activity, .. } = self;
        value[..data.n].copy_from_slice(x);
        data.multiply_all(x, value);
        let is_of = |level| {
            move |group: &Group| group.level == level && group.purpose == Purpose::Minimised
        };
        let is_there = match level {
            None => {
                multipliers.balance_norm(data, factorisation, x);
                true
            }
            Some(level) => {
                factorisation.groups.iter().position(is_of(level)).is_some_and(|group| {
                    let of = (group, Residuals::AtPoint);
                    multipliers.balance_level(data, factorisation, value, activity, of)
                })
            }
        };
        if !is_there {
            return Vec::new();
        }
        let negligible = multipliers.negligible(data, factorisation);
        multipliers
            .pairs(factorisation)
            .filter(|&(id, multiplier)| (multiplier * data.norm(id)).abs() > negligible)
            .collect()
    }

    /// Returns true if the levels have decided all directions of x.
    pub(crate) fn is_decided(&self) -> bool {
        let Factorisation { free, stacked, bounded, .. } = &self.factorisation;
        let mut active = stacked.iter().chain(bounded);
        self.factorisation.rank() == free.len() && active.all(|&id| self.fixed[id])
    }

    /// Returns true if another active set may be optimal too, since the rank tolerance neglects
    /// small parts of rows.
    pub(crate) fn is_rank_in_doubt(&self) -> bool {
        self.factorisation.has_rows_near_threshold()
            || self.multipliers.has_multipliers_near_threshold
    }
}
