//! What can be wrong with a problem, and how to put it right.

use crate::problem::hierarchy::ConstraintSource;
use crate::stack::LevelId;

/// Misuse of the crate, or a problem that has no solution.
///
/// Levels are counted from 0, highest priority first.
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
        "{what} holds a value that is not finite ({source_of_row}, entry {entry}); replace NaN and infinities before solving"
    )]
    NotFinite {
        /// The offending item.
        what: &'static str,
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// The entry in it.
        entry: usize,
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
        "{source_of_row} holds {value:e}, beyond 1e100, where double precision overflows; change units, or use an infinite bound"
    )]
    TooLarge {
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// The number.
        value: f64,
    },

    /// The solution overflows: the data are sound one by one, but their quotients are not.
    #[error("the solution overflows double precision; bring rows and bounds to comparable sizes")]
    Overflow,

    /// A lower bound lies above its upper bound, or a bound is NaN.
    #[error(
        "{source_of_row}: lower bound {lower} and upper bound {upper} leave nothing between them; order them, or use an infinite bound for a side that is free"
    )]
    EmptyRange {
        /// Where the bounds stand.
        source_of_row: ConstraintSource,
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
    },

    /// A Hessian is not symmetric.
    #[error(
        "the Hessian of level {level} is not symmetric: entries ({row}, {column}) and ({column}, {row}) differ by {difference:e}; pass (H + Hᵀ)/2"
    )]
    AsymmetricHessian {
        /// The level.
        level: usize,
        /// Row of the worst entry.
        row: usize,
        /// Column of the worst entry.
        column: usize,
        /// By how much the two differ.
        difference: f64,
    },

    /// A Hessian has a negative eigenvalue.
    #[error(
        "the Hessian of level {level} is not positive semidefinite (found near variable {variable}: {pivot:e}); project it onto the convex cone first"
    )]
    IndefiniteHessian {
        /// The level.
        level: usize,
        /// The variable at which the factorisation failed.
        variable: usize,
        /// The negative pivot, or the off-diagonal remainder that cannot belong to a PSD matrix.
        pivot: f64,
    },

    /// The hierarchy has another shape than the one that the solver or certificate was made for.
    #[error(
        "level {level} has another shape than when the solver was constructed or the certificate made; build a new solver after adding, removing or resizing levels"
    )]
    ShapeChanged {
        /// The first level that differs (the number of levels, if one has more).
        level: usize,
    },

    /// There is no such level.
    #[error("there is no level {level}: the hierarchy has {levels}")]
    NoSuchLevel {
        /// The level asked for.
        level: usize,
        /// How many there are.
        levels: usize,
    },

    /// A continuous stack has no such level any more.
    #[error("the stack has no {id}: it has been removed; ask for the activation of a level first")]
    UnknownLevel {
        /// The level asked for.
        id: LevelId,
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
        "the hard constraints of level {level} cannot hold together with those above it: {worst} stays violated by {violation:e}; relax what Solver::conflict lists ({members} rows), or make the level's constraints soft"
    )]
    Infeasible {
        /// The level whose constraints cannot be met.
        level: usize,
        /// The constraint that is violated most.
        worst: ConstraintSource,
        /// By how much, in the unit of its bounds.
        violation: f64,
        /// The size of the conflicting subset.
        members: usize,
    },

    /// A quadratic objective falls for ever along a direction that nothing limits.
    #[error(
        "the quadratic objective of level {level} decreases without bound; add constraints, or curvature along its gradient"
    )]
    Unbounded {
        /// The level.
        level: usize,
    },

    /// A certificate was asked for, but there is no optimum to certify.
    #[error(
        "no solve ended at the optimum since the solver was made or told to forget; certify after one with Status::Solved"
    )]
    NotSolved,

    /// A certificate was asked for, or is to be checked, with other data than those of the solve.
    #[error(
        "{source_of_row} has changed since the problem was solved; certify and check with the data of the solve, or solve again"
    )]
    DataChanged {
        /// The first row that differs, its coefficients or its bounds. Of a quadratic objective, a row of its
        /// Hessian or entry of its gradient that the change reaches.
        source_of_row: ConstraintSource,
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
