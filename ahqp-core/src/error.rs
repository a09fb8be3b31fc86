//! What can be wrong with a problem, and how to put it right.

use crate::problem::ids::LevelId;
use crate::problem::source::{ConstraintSource, Names};
use crate::solver::status::Status;

/// Misuse of the crate, or a problem that has no solution.
///
/// Errors of a problem say where it is wrong, with the [names](Names) of level, row or variable, if
/// they have any.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A hierarchy needs at least one variable.
    #[error("the hierarchy has no variables; give it at least one")]
    NoVariables,

    /// A matrix, vector or buffer does not fit.
    #[error("{what} has size {found}, but {expected} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Its size.
        found: usize,
        /// The size that fits.
        expected: usize,
    },

    /// A datum is NaN, or infinite where only finite numbers make sense.
    #[error(
        "{what} holds a value that is not finite ({}, entry {entry}); replace NaN and infinities before solving",
        .names.label(*.source_of_row)
    )]
    NotFinite {
        /// The offending item.
        what: &'static str,
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// The entry in it.
        entry: usize,
        /// What they are called.
        names: Names,
    },

    /// Only equalities can be damped.
    #[error(
        "row {row} of the damped level has the bounds {lower} and {upper}; damp levels of equalities only"
    )]
    NotAnEquality {
        /// The row.
        row: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },

    /// A row that is to be damped is not finite, or overflows.
    #[error("row {row} of the damped level is not finite; replace NaN and infinities first")]
    NotFiniteDamping {
        /// The row.
        row: usize,
    },

    /// A number is so large that its square overflows.
    #[error(
        "{} holds {value:e}, beyond 1e100, where double precision overflows; change units, or use an infinite bound",
        .names.label(*.source_of_row)
    )]
    TooLarge {
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// The number.
        value: f64,
        /// What they are called.
        names: Names,
    },

    /// The solution overflows: the data are sound one by one, but their quotients are not.
    #[error("the solution overflows double precision; bring rows and bounds to comparable sizes")]
    Overflow,

    /// A hard constraint does not hold where the search ended: the numbers of the problem are of too
    /// different sizes for double precision.
    #[error(
        "{} is violated by {violation:e} where the solve ended, as the numbers of the problem differ too much in size; bring rows, weights and bounds to comparable sizes",
        .names.label(*.source_of_row)
    )]
    Inaccurate {
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// By how much it is violated, in its own unit.
        violation: f64,
        /// What they are called.
        names: Names,
    },

    /// A bound is NaN.
    #[error(
        "{}: {what} is NaN; give a number, or an infinite bound for a side that is free",
        .names.label(*.source_of_row)
    )]
    NanBound {
        /// The offending bound.
        what: &'static str,
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// What they are called.
        names: Names,
    },

    /// A lower bound lies above its upper bound, or both are the same infinity.
    #[error(
        "{}: lower bound {lower} and upper bound {upper} leave nothing between them; order them, or use an infinite bound for a side that is free",
        .names.label(*.source_of_row)
    )]
    EmptyRange {
        /// Where the bounds stand.
        source_of_row: ConstraintSource,
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
        /// What they are called.
        names: Names,
    },

    /// A Hessian is not symmetric.
    #[error(
        "the Hessian of {} is not symmetric: entries ({row}, {column}) and ({column}, {row}) differ by {difference:e}; pass (H + Hᵀ)/2",
        .names.label_of_level(*.level)
    )]
    AsymmetricHessian {
        /// The level.
        level: LevelId,
        /// Row of the worst entry.
        row: usize,
        /// Column of the worst entry.
        column: usize,
        /// By how much the two differ.
        difference: f64,
        /// What it is called.
        names: Names,
    },

    /// A Hessian has a negative eigenvalue.
    #[error(
        "the Hessian of {} is not positive semidefinite (found near variable {variable}: {pivot:e}); project it onto the convex cone first",
        .names.label_of_level(*.level)
    )]
    IndefiniteHessian {
        /// The level.
        level: LevelId,
        /// The variable at which the factorisation failed.
        variable: usize,
        /// The negative pivot, or the off-diagonal remainder that cannot belong to a PSD matrix.
        pivot: f64,
        /// What it is called.
        names: Names,
    },

    /// The hierarchy has another shape than the one that the solver or certificate was made for.
    #[error(
        "{} has another shape than when the solver was constructed or the certificate made; build a new solver after adding, removing or resizing levels",
        .names.label_of_level(*.level)
    )]
    ShapeChanged {
        /// The first level that differs (the number of levels, if one has more).
        level: LevelId,
        /// What it is called.
        names: Names,
    },

    /// There is no such level.
    #[error(
        "there is no {level}: it belongs to another problem, or has been removed; take the id that push or insert returned"
    )]
    NoSuchLevel {
        /// The level asked for.
        level: LevelId,
    },

    /// A block has no such row.
    #[error("there is no row {row}: the block has {rows}, counted from 0")]
    NoSuchRow {
        /// The row asked for.
        row: usize,
        /// How many there are.
        rows: usize,
    },

    /// A level minimises something else.
    #[error(
        "{} minimises {found}, not {expected}; see Level::objective, and constraints_mut for what must hold",
        .names.label_of_level(*.level)
    )]
    OtherObjective {
        /// The level, if it is known.
        level: Option<LevelId>,
        /// What was asked for.
        expected: &'static str,
        /// What there is.
        found: &'static str,
        /// What it is called.
        names: Names,
    },

    /// A weight of a row is NaN, negative, infinite, or so far from 1 that it would overflow.
    #[error(
        "the weight of row {row} is {weight:e}; it must be from 1e-100 to 1e100, or zero to leave the row out"
    )]
    Weight {
        /// The row.
        row: usize,
        /// Its weight.
        weight: f64,
    },

    /// A change of a continuous stack was asked for while too many are under way.
    #[error("{limit} changes of the stack are under way; wait until one is over")]
    TooManyChanges {
        /// The most that there can be.
        limit: usize,
    },

    /// The hard constraints of a level contradict each other or those above.
    ///
    /// [`Solver::conflict`](crate::Solver::conflict) lists a subset that cannot hold together.
    #[error(
        "the hard constraints of {} cannot hold together with those above it: {} stays violated by {violation:e}; relax what Solver::conflict lists ({members} rows), or make the level's constraints soft",
        .names.label_of_level(*.level),
        .names.label(*.worst)
    )]
    Infeasible {
        /// The level whose constraints cannot be met.
        level: LevelId,
        /// The constraint that is violated most.
        worst: ConstraintSource,
        /// By how much, in the unit of its bounds.
        violation: f64,
        /// The size of the conflicting subset.
        members: usize,
        /// What level and constraint are called.
        names: Names,
    },

    /// A quadratic objective falls for ever along a direction that nothing limits.
    #[error(
        "the quadratic objective of {} decreases without bound; add constraints, or curvature along its gradient",
        .names.label_of_level(*.level)
    )]
    Unbounded {
        /// The level.
        level: LevelId,
        /// What it is called.
        names: Names,
    },

    /// A solve ended before it reached the optimum.
    #[error(
        "{status}; take Solution::best for how far it came, solve again to go on from there, or raise the budget"
    )]
    Unfinished {
        /// How it ended.
        status: Status,
    },

    /// A certificate was asked for, but there is no optimum to certify.
    #[error(
        "no solve ended at the optimum since the solver was made or told to forget; certify after one with Status::Solved"
    )]
    NotSolved,

    /// A certificate was asked for, or is to be checked, with other data than those of the solve.
    #[error(
        "{} has changed since the problem was solved; certify and check with the data of the solve, or solve again",
        .names.label(*.source_of_row)
    )]
    DataChanged {
        /// The first row that differs, its coefficients or its bounds. Of a quadratic objective, a row of its
        /// Hessian or entry of its gradient that the change reaches.
        source_of_row: ConstraintSource,
        /// What it is called.
        names: Names,
    },

    /// A setting is out of its range.
    #[error("setting {name} is {value}; it must be {expected}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        expected: &'static str,
    },

    /// A physical parameter is out of its range.
    #[error("{name} is {value}; it must be {expected}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        expected: &'static str,
    },

    /// The reference solver stopped without an answer.
    #[cfg(feature = "reference")]
    #[error("the reference solver ended level {level} with status {status}")]
    Reference {
        /// The level.
        level: usize,
        /// Clarabel's status.
        status: String,
    },
}

impl Error {
    /// The row or the level that the error speaks of, and what they are called.
    pub(crate) fn spot_mut(&mut self) -> Option<Spot<'_>> {
        match self {
            Self::NotFinite { source_of_row, names, .. }
            | Self::TooLarge { source_of_row, names, .. }
            | Self::NanBound { source_of_row, names, .. }
            | Self::EmptyRange { source_of_row, names, .. }
            | Self::Inaccurate { source_of_row, names, .. }
            | Self::DataChanged { source_of_row, names }
            | Self::Infeasible { worst: source_of_row, names, .. } => {
                Some(Spot::Row(source_of_row, names))
            }
            Self::AsymmetricHessian { level, names, .. }
            | Self::IndefiniteHessian { level, names, .. }
            | Self::ShapeChanged { level, names }
            | Self::Unbounded { level, names } => Some(Spot::Level(level, names)),
            _ => None,
        }
    }

    /// The same error where levels have other ids.
    pub(crate) fn renamed(mut self, rename: impl Fn(LevelId) -> LevelId) -> Self {
        if let Self::Infeasible { level, .. } = &mut self {
            *level = rename(*level);
        }
        match self.spot_mut() {
            Some(Spot::Row(row, _)) => *row = row.renamed(rename),
            Some(Spot::Level(level, _)) => *level = rename(*level),
            None => {}
        }
        self
    }
}

/// What an error speaks of.
pub(crate) enum Spot<'a> {
    Row(&'a mut ConstraintSource, &'a mut Names),
    Level(&'a mut LevelId, &'a mut Names),
}
