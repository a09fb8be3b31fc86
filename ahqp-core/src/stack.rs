//! Stacks of levels that change without a jump of the solution.

mod blend;
mod change;
mod data;
mod output;
mod part;
mod plan;
mod ramp;

use std::fmt;
use std::time::Instant;

use nalgebra::{DMatrix, DVector};

pub use part::{CertifiedPart, Part};

use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::{Level, names_of, of_level};
use crate::problem::rows::Rows;
use crate::problem::source::ConstraintSource;
use crate::solver::budget::Budget;
use crate::solver::settings::Settings;
use crate::solver::solution::Solution;
use crate::solver::status::Status;
use blend::Blend;
use change::{Change, Difference, End};
use data::{Bounds, Data};
use output::Output;
use ramp::Ramp;

/// Place at which a level is inserted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Priority above all others.
    Top,
    /// Priority below all others.
    Bottom,
    /// Directly above this level.
    Above(LevelId),
    /// Directly below this level.
    Below(LevelId),
}

/// A hierarchy whose levels are inserted, removed and exchanged over a chosen time, without a jump
/// of its solution.
///
/// Every level has an activation from 0 to 1. The solution is the mean χ = ∫₀¹ χ(θ) dθ of the
/// solutions χ(θ) of plain hierarchies. At threshold θ, the plain hierarchy contains the levels
/// whose activation is at least θ. Their order includes the exchanges whose share is at least θ.
/// During m changes these are at most m + 1 different hierarchies, each with its own solver. If
/// activations move by Δh₁, …, Δhₘ in a tick, this follows:
///
/// - **Continuity.** ‖χ(t + Δt) − χ(t)‖ ≤ L Δt + D (|Δh₁| + … + |Δhₘ|). L bounds the rates of
///   change of the plain hierarchies' solutions, and D their distances from each other. The second
///   term is at most D · [`rate`](Self::rate) · Δt. A plain hierarchy that jumps by itself, for
///   instance at a singularity, has no finite L. Bounds of the output
///   ([`output_bounds_mut`](Self::output_bounds_mut)) hold even then.
/// - **Constraints.** The bounds, and the hard constraints of all fully active levels, hold at
///   every tick. Those of a level with activation h are violated by at most 1 − h times the
///   violation without the level.
/// - **Priorities.** Levels above all changes keep their optimum throughout. The objective of any
///   other level is at most the mean of its values in the plain hierarchies. When no change is in
///   progress, the solution is that of the plain hierarchy.
///
/// The data of the levels and the bounds are rewritten in place from tick to tick. Calls that start
/// a change allocate, and [`solve`](Self::solve) does not. It solves at most m + 1 hierarchies, and
/// one more small problem if the output is at its bounds. Each stays within the iterations that the
/// [`Settings`] allow.
///
/// ```
/// use ahqp_core::{ContinuousStack, Hierarchy, Level, Place, Rows, Settings};
/// use nalgebra::{dmatrix, dvector};
///
/// let near = |target: f64| {
///     Ok::<_, ahqp_core::Error>(Level::least_squares(Rows::equalities(
///         &dmatrix![1.0], &dvector![target])?))
/// };
/// let mut hierarchy = Hierarchy::new(1)?;
/// hierarchy.push(near(0.0)?)?;
/// let mut stack = ContinuousStack::new(&hierarchy, Settings::default())?;
///
/// // Half a second from x = 0 to x = 1, at 1 kHz.
/// stack.insert(near(1.0)?, Place::Top, 0.5)?;
/// let mut before = 0.0;
/// for _ in 0..500 {
///     let bound = stack.rate() * 1e-3 * 1.0;
///     let x = stack.solve(1e-3)?.optimum()?[0];
///     assert!((x - before).abs() <= bound + 1e-12);
///     before = x;
/// }
/// assert_eq!(before, 1.0);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContinuousStack {
    data: Data,
    blend: Blend,
    output: Output,
    /// The last solution, and whether there is one.
    solution: Solution,
    is_solved: bool,
    failed: Option<usize>,
    /// The solution that is being computed.
    next: Solution,
    /// Number of levels that were ever added.
    came: usize,
    settings: Settings,
}

impl ContinuousStack {
    /// Largest number of changes at a time.
    pub const MAX_CHANGES: usize = Blend::MAX_CHANGES;

    /// Creates a stack of the levels of `hierarchy`, all active. They keep their ids.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is out of range.
    pub fn new(hierarchy: &Hierarchy, settings: Settings) -> Result<Self, Error> {
        let variables = hierarchy.variables();
        let (lower, upper) = (hierarchy.lower().to_vec(), hierarchy.upper().to_vec());
        let data = Data {
            bounds: Bounds { lower, upper },
            output: Bounds::none(variables),
            ids: hierarchy.ids().collect(),
            levels: hierarchy.levels().to_vec(),
            variable_names: hierarchy.variable_names().to_vec(),
        };
        let solution = Solution { x: vec![0.0; variables], status: Status::Solved, iterations: 0 };
        Ok(Self {
            blend: Blend::new(&data, settings)?,
            output: Output::new(&data, settings)?,
            failed: None,
            next: solution.clone(),
            solution,
            is_solved: false,
            came: data.levels.len(),
            data,
            settings,
        })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings. If tolerances change, the next solve is a cold start.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is out of range. The settings are then unchanged.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.validate()?;
        self.blend.set_settings(settings)?;
        self.output.set_settings(settings)?;
        self.settings = settings;
        Ok(())
    }

    /// The ids of the levels, highest priority first, in their order after all changes. Levels with
    /// an activation of zero are included.
    pub fn ids(&self) -> impl Iterator<Item = LevelId> + '_ {
        let leaves = |id| self.blend.changes.iter().any(|change| change.removes(id));
        let order = self.blend.final_order().iter();
        order.map(|entry| entry.id).filter(move |&id| !leaves(id))
    }

    /// Level `id`.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the level has been removed.
    pub fn level(&self, id: LevelId) -> Result<&Level, Error> {
        self.expect_level(id)?;
        self.data.level(id).ok_or(Error::NoSuchLevel { level: id })
    }

    /// Level `id`, to rewrite its data in place (not to resize).
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the level has been removed.
    pub fn level_mut(&mut self, id: LevelId) -> Result<&mut Level, Error> {
        self.expect_level(id)?;
        self.data.level_mut(id).ok_or(Error::NoSuchLevel { level: id })
    }

    /// The rows that level `id` minimises, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::OtherObjective`] if the level minimises a quadratic, or nothing.
    /// [`Error::NoSuchLevel`] if it has been removed.
    pub fn rows_mut(&mut self, id: LevelId) -> Result<&mut Rows, Error> {
        of_level(id, self.level_mut(id)?.rows_mut())
    }

    /// The hard constraints of level `id`, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the level has been removed.
    pub fn constraints_mut(&mut self, id: LevelId) -> Result<&mut Rows, Error> {
        Ok(self.level_mut(id)?.constraints_mut())
    }

    /// The Hessian and gradient that level `id` minimises, to rewrite in place (not to resize).
    ///
    /// # Errors
    /// [`Error::OtherObjective`] if the level minimises rows, or nothing. [`Error::NoSuchLevel`] if
    /// it has been removed.
    pub fn quadratic_mut(
        &mut self,
        id: LevelId,
    ) -> Result<(&mut DMatrix<f64>, &mut DVector<f64>), Error> {
        of_level(id, self.level_mut(id)?.quadratic_mut())
    }

    /// Describes a row in words, with the names of its level, row or variable.
    pub fn describe(&self, row: ConstraintSource) -> impl fmt::Display + use<> {
        let level = row.level().and_then(|id| self.data.level(id));
        names_of(row, level, &self.data.variable_names).label(row)
    }

    /// The bounds of the variables, to rewrite in place: `(lower, upper)`.
    pub fn bounds_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.data.bounds.lower, &mut self.data.bounds.upper)
    }

    /// The bounds of the output, to rewrite in place: `(lower, upper)`. They are infinite at first.
    ///
    /// The solution obeys them, but the plain hierarchies do not while a change is in progress.
    /// Bounds close to the last solution, such as those of [`Limits`](crate::Limits), therefore do
    /// not force the plain solutions together. If the bounds of the output and of the variables
    /// exclude each other, those of the output hold.
    pub fn output_bounds_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.data.output.lower, &mut self.data.output.upper)
    }

    /// The activation of level `id`, from 0 to 1.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the level has been removed.
    pub fn activation(&self, id: LevelId) -> Result<f64, Error> {
        self.expect_level(id)?;
        self.blend.activation(id).ok_or(Error::NoSuchLevel { level: id })
    }

    /// Returns true if a change is in progress.
    pub fn is_changing(&self) -> bool {
        self.blend.changes.iter().any(|change| !change.share.is_over())
    }

    /// Returns an upper bound of the rate at which all activations together move, until the next
    /// change \[1/s\].
    ///
    /// It is 15/8 · |difference| / duration for each change in progress, the peak slope of the
    /// minimum-jerk polynomial of the change. Activations that the caller sets at once are not
    /// included.
    pub fn rate(&self) -> f64 {
        self.blend.changes.iter().map(|change| change.share.rate()).sum()
    }

    /// Inserts a level. Its activation rises from 0 to 1 over `duration` seconds.
    ///
    /// # Errors
    /// [`Error::Size`] if its rows do not cover the variables. [`Error::NoSuchLevel`] if the place
    /// is next to a level that has been removed. [`Error::Value`] if the duration is negative or
    /// not finite, or too many changes are in progress. The stack is then unchanged.
    pub fn insert(&mut self, level: Level, place: Place, duration: f64) -> Result<LevelId, Error> {
        let share = Ramp::new(0.0, 1.0, duration)?;
        self.settle();
        self.expect_room()?;
        if let Place::Above(neighbour) | Place::Below(neighbour) = place {
            self.expect_level(neighbour)?;
        }
        level.expect_columns(self.solution.x.len())?;
        let id = LevelId::new(self.came);
        self.came += 1;
        self.data.push(id, level);
        self.blend.insert(id, place);
        self.begin(Difference::Activation(id), share, End::Settles)?;
        Ok(id)
    }

    /// Removes a level. Its activation falls to 0 over `duration` seconds.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the level has been removed already. [`Error::Value`] if the
    /// duration is negative or not finite, or too many changes are in progress. The stack is then
    /// unchanged.
    pub fn remove(&mut self, id: LevelId, duration: f64) -> Result<(), Error> {
        self.move_activation(id, 0.0, duration, End::Removes)
    }

    /// Moves the activation of a level from its current value to `activation` over `duration`
    /// seconds. Cancels a removal in progress.
    ///
    /// A `duration` of zero sets the activation at once, so that continuity is up to the caller.
    /// The level then counts as a change in progress until it is moved with a duration. Setting it
    /// again does not allocate.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if the level has been removed. [`Error::Value`] if the activation is
    /// outside \[0, 1\], the duration is negative or not finite, or too many changes are in
    /// progress. The stack is then unchanged.
    pub fn activate(&mut self, id: LevelId, activation: f64, duration: f64) -> Result<(), Error> {
        if !(0.0..=1.0).contains(&activation) {
            let expected = "from 0 to 1";
            return Err(Error::value("the activation", activation, expected));
        }
        let end = if duration == 0.0 { End::Waits } else { End::Settles };
        self.move_activation(id, activation, duration, end)
    }

    /// Exchanges the places of two levels over `duration` seconds. A second call before another
    /// change starts moves them back from where they are.
    ///
    /// # Errors
    /// [`Error::NoSuchLevel`] if a level has been removed. [`Error::Value`] if the duration is
    /// negative or not finite, or too many changes are in progress. The stack is then unchanged.
    pub fn swap(&mut self, a: LevelId, b: LevelId, duration: f64) -> Result<(), Error> {
        let share = Ramp::new(0.0, 1.0, duration)?;
        self.settle();
        self.expect_level(a)?;
        self.expect_level(b)?;
        if a == b {
            return Ok(());
        }
        if let Some(last) = self.blend.changes.last_mut()
            && last.difference.is_exchange_of(a, b)
        {
            last.share = Ramp::new(last.share.value(), 1.0 - last.share.target(), duration)?;
            return Ok(());
        }
        self.expect_room()?;
        self.begin(Difference::Exchange(a, b), share, End::Settles)
    }

    /// Computes the solution `period` seconds after the last one. Its status is [`Status::Solved`]
    /// if all [parts](Self::parts) were solved. Otherwise it is that of the first part that was
    /// not.
    ///
    /// # Errors
    /// Those of [`Solver::solve`](crate::Solver::solve) for the part that
    /// [`failed_part`](Self::failed_part) returns. [`Error::Value`] if the period is negative or
    /// not finite.
    pub fn solve(&mut self, period: f64) -> Result<&Solution, Error> {
        self.solve_within(period, Budget::default())
    }

    /// Computes the solution `period` seconds after the last one within a budget. The iterations
    /// are for each of the [parts](Self::parts), the time for all of them together.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    pub fn solve_within(&mut self, period: f64, budget: Budget) -> Result<&Solution, Error> {
        if !(period >= 0.0 && period.is_finite()) {
            let expected = "finite and not negative [s]";
            return Err(Error::value("the period", period, expected));
        }
        let begin = budget.time.map(|time| (Instant::now(), time));
        let left = || Budget {
            time: begin.map(|(begin, time)| time.saturating_sub(begin.elapsed())),
            ..budget
        };
        self.blend.changes.iter_mut().for_each(|change| change.share.advance(period));
        self.blend.set_weights();
        self.failed = None;
        (self.next.status, self.next.iterations) = (Status::Solved, 0);
        self.next.x.fill(0.0);
        let alone = self.blend.plans.iter().any(|plan| plan.weight == 1.0);
        let plans = self.blend.plans.iter_mut().enumerate();
        for (index, plan) in plans.filter(|(_, plan)| plan.weight > 0.0) {
            let weight = plan.weight;
            let solution = plan.solve(&mut self.data, alone, left()).inspect_err(|_| {
                self.failed = Some(index);
            })?;
            self.next.x.iter_mut().zip(&solution.x).for_each(|(to, x)| *to += weight * x);
            self.next.iterations += solution.iterations;
            if self.next.status == Status::Solved {
                self.next.status = solution.status;
            }
        }
        if !alone {
            self.obey_output(left())?;
        }
        std::mem::swap(&mut self.solution, &mut self.next);
        self.is_solved = true;
        Ok(&self.solution)
    }

    /// Removes the rounding of the mean of points within the bounds. Moves the result to where the
    /// output's bounds hold.
    fn obey_output(&mut self, budget: Budget) -> Result<(), Error> {
        let Bounds { lower, upper } = &self.data.bounds;
        for (x, (lower, upper)) in self.next.x.iter_mut().zip(lower.iter().zip(upper)) {
            *x = x.max(*lower).min(*upper);
        }
        if self.data.output.hold(&self.next.x) {
            return Ok(());
        }
        let solved = self.blend.plans.iter().filter(|plan| plan.weight > 0.0);
        let binds = |id| solved.clone().all(|plan| plan.levels().any(|other| other == id));
        self.output.project(&self.data, binds, &mut self.next, budget)
    }

    /// Returns the last solution. None before the first solve.
    pub fn solution(&self) -> Option<&Solution> {
        self.is_solved.then_some(&self.solution)
    }

    /// Iterates over the plain hierarchies that were solved last.
    pub fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        self.blend.plans.iter().filter(|plan| plan.weight > 0.0).map(Part::new)
    }

    /// Returns the plain hierarchy that had no solution, after an error of [`solve`](Self::solve).
    pub fn failed_part(&self) -> Option<Part<'_>> {
        self.failed.and_then(|index| self.blend.plans.get(index)).map(Part::new)
    }

    /// Returns the plain hierarchies that were solved last, each with the proof of its solution.
    /// Allocates, so it is for debugging and tests, not for the control loop.
    ///
    /// # Errors
    /// Those of [`Solver::certificate`](crate::Solver::certificate).
    pub fn certified_parts(&mut self) -> Result<Vec<CertifiedPart>, Error> {
        let solved = self.blend.plans.iter_mut().filter(|plan| plan.weight > 0.0);
        solved.map(|plan| CertifiedPart::new(plan, &mut self.data)).collect()
    }

    fn move_activation(
        &mut self,
        id: LevelId,
        target: f64,
        duration: f64,
        end: End,
    ) -> Result<(), Error> {
        let difference = Difference::Activation(id);
        let share = Ramp::new(self.activation(id)?, target, duration)?;
        let mut running = self.blend.changes.iter_mut();
        if let Some(change) = running.find(|change| change.difference == difference) {
            (change.share, change.end) = (share, end);
            return Ok(());
        }
        self.settle();
        self.expect_room()?;
        self.begin(difference, share, end)
    }

    fn begin(&mut self, difference: Difference, share: Ramp, end: End) -> Result<(), Error> {
        self.failed = None;
        self.output = Output::new(&self.data, self.settings)?;
        self.blend.begin(Change { difference, share, end }, &self.data)
    }

    fn settle(&mut self) {
        self.failed = None;
        self.blend.settle(|removed| self.data.remove(removed));
    }

    /// Returns true if level `id` exists, from its insertion until its removal is complete.
    fn has(&self, id: LevelId) -> bool {
        let is_over = |change: &Change| change.removes(id) && change.outcome() == Some(false);
        self.data.level(id).is_some() && !self.blend.changes.iter().any(is_over)
    }

    fn expect_level(&self, id: LevelId) -> Result<(), Error> {
        if self.has(id) { Ok(()) } else { Err(Error::NoSuchLevel { level: id }) }
    }

    fn expect_room(&self) -> Result<(), Error> {
        if self.blend.changes.len() < Self::MAX_CHANGES {
            Ok(())
        } else {
            let wanted = "below ContinuousStack::MAX_CHANGES; wait until one is over";
            Err(Error::value(
                "the number of changes under way",
                self.blend.changes.len() as f64,
                wanted,
            ))
        }
    }
}
