//! Errors of problems and settings, with the way to correct each.

use crate::problem::ids::LevelId;
use crate::problem::source::{ConstraintSource, Names};
use crate::solver::status::Status;

/// Misuse of the crate, or a problem that has no solution.
///
/// Errors of a problem name the level, row or variable concerned by its [name](Names), if it has
/// one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A matrix, vector or buffer does not fit.
    #[error("{what} has size {got}, but {wanted} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Size it has.
        got: usize,
        /// The size that fits.
        wanted: usize,
    },

    /// A setting, a parameter or a count is out of its range.
    #[error("{what}{} is {got}; it must be {wanted}", index.map(|i| format!(" {i}")).unwrap_or_default())]
    Value {
        /// Name of the setting, parameter or count.
        what: &'static str,
        /// Index, if there are several.
        index: Option<usize>,
        /// The value.
        got: f64,
        /// The allowed range.
        wanted: &'static str,
    },

    /// A number of a problem is NaN, is infinite where it must be finite, or is so large that its
    /// square overflows.
    #[error(
        "{}{}: {what} is {got:e}; {wanted}",
        .names.label(*.source_of_row),
        entry.map(|i| format!(", entry {i}")).unwrap_or_default()
    )]
    Datum {
        /// Name of the offending item.
        what: &'static str,
        /// The row or bound that contains it.
        source_of_row: ConstraintSource,
        /// Index of the entry, if the item has several.
        entry: Option<usize>,
        /// The number.
        got: f64,
        /// The allowed values.
        wanted: &'static str,
        /// Names of the level and the row.
        names: Names,
    },

    /// A lower bound lies above its upper bound, or both are the same infinity.
    #[error(
        "{}: lower bound {lower} and upper bound {upper} leave nothing between them; order them, or use an infinite bound for a side that is free",
        .names.label(*.source_of_row)
    )]
    EmptyRange {
        /// The row or variable of the bounds.
        source_of_row: ConstraintSource,
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
        /// Names of the level and the row.
        names: Names,
    },

    /// The solution overflows. Each number of the problem is valid, but their quotients are too
    /// large.
    #[error("the solution overflows double precision; bring rows and bounds to comparable sizes")]
    Overflow,

    /// A hard constraint is violated at the end of the search. The numbers of the problem differ
    /// too much in size for double precision.
    #[error(
        "{} is violated by {violation:e} where the solve ended, as the numbers of the problem differ too much in size; bring rows, weights and bounds to comparable sizes",
        .names.label(*.source_of_row)
    )]
    Inaccurate {
        /// The violated row or bound.
        source_of_row: ConstraintSource,
        /// Size of the violation, in the row's own unit.
        violation: f64,
        /// Names of the level and the row.
        names: Names,
    },

    /// A Hessian is not symmetric, or has a negative eigenvalue.
    #[error(
        "the Hessian of {} is not {wanted} (entry ({row}, {column}): {got:e})",
        .names.label_of_level(*.level)
    )]
    Hessian {
        /// The level.
        level: LevelId,
        /// Required property, and how to achieve it.
        wanted: &'static str,
        /// Row of the worst entry, or the variable at which the factorisation failed.
        row: usize,
        /// Column of the worst entry.
        column: usize,
        /// Difference from the mirrored entry, the negative pivot, or the off-diagonal remainder
        /// that no positive semidefinite matrix can have.
        got: f64,
        /// Name of the level.
        names: Names,
    },

    /// The shape of the hierarchy differs from that for which the solver or certificate was made.
    #[error(
        "{} has another shape than when the solver was constructed or the certificate made; build a new solver after adding, removing or resizing levels",
        .names.label_of_level(*.level)
    )]
    ShapeChanged {
        /// The first level that differs, or the number of levels if one hierarchy has more.
        level: LevelId,
        /// Name of the level.
        names: Names,
    },

    /// The hierarchy has no such level.
    #[error("there is no {level}: it belongs to another problem; take the id that push returned")]
    NoSuchLevel {
        /// The requested level.
        level: LevelId,
    },

    /// The level has another kind of objective.
    #[error(
        "{} minimises {got}, not {wanted}; see Level::objective, and constraints_mut for what must hold",
        .names.label_of_level(*.level)
    )]
    OtherObjective {
        /// The level, if it is known.
        level: Option<LevelId>,
        /// The kind of objective that the level has.
        got: &'static str,
        /// The kind of objective that was requested.
        wanted: &'static str,
        /// Name of the level.
        names: Names,
    },

    /// The hard constraints of a level contradict each other or those of levels above.
    ///
    /// [`Solver::conflict`](crate::Solver::conflict) lists a subset that cannot hold together.
    #[error(
        "the hard constraints of {} cannot hold together with those above it: {} stays violated by {violation:e}; relax what Solver::conflict lists ({members} rows), or make the level's constraints soft",
        .names.label_of_level(*.level),
        .names.label(*.worst)
    )]
    Infeasible {
        /// The level whose constraints cannot be satisfied.
        level: LevelId,
        /// The constraint that is violated most.
        worst: ConstraintSource,
        /// Size of the violation, in the unit of the constraint's bounds.
        violation: f64,
        /// Number of constraints in the conflicting subset.
        members: usize,
        /// Names of the level and the constraint.
        names: Names,
    },

    /// A quadratic objective decreases without bound along a direction that no constraint limits.
    #[error(
        "the quadratic objective of {} decreases without bound; add constraints, or curvature along its gradient",
        .names.label_of_level(*.level)
    )]
    Unbounded {
        /// The level.
        level: LevelId,
        /// Name of the level.
        names: Names,
    },

    /// A solve ended before it reached the optimum.
    #[error(
        "{status}; take Solution::best for how far it came, solve again to go on from there, or raise the budget"
    )]
    Unfinished {
        /// Ending of the solve.
        status: Status,
    },

    /// A certificate was requested, but there is no optimum to certify.
    #[error(
        "no solve ended at the optimum since the solver was made or told to forget; certify after one with Status::Solved"
    )]
    NotSolved,

    /// A certificate was requested or checked with other data than those of the solve.
    #[error(
        "{} has changed since the problem was solved; certify and check with the data of the solve, or solve again",
        .names.label(*.source_of_row)
    )]
    DataChanged {
        /// The first row whose coefficients or bounds differ. If the objective is quadratic, it is
        /// a row of the Hessian or an entry of the gradient that the change affects.
        source_of_row: ConstraintSource,
        /// Names of the level and the row.
        names: Names,
    },

    /// The reference solver stopped without a solution.
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
    pub(crate) fn value(what: &'static str, got: f64, wanted: &'static str) -> Self {
        Self::Value { what, index: None, got, wanted }
    }

    pub(crate) fn not_finite(
        what: &'static str,
        source_of_row: ConstraintSource,
        entry: usize,
        got: f64,
    ) -> Self {
        let wanted = "it is not finite: replace NaN and infinities before solving";
        let (entry, names) = (Some(entry), Names::default());
        Self::Datum { what, source_of_row, entry, got, wanted, names }
    }

    pub(crate) fn too_large(source_of_row: ConstraintSource, got: f64) -> Self {
        let wanted =
            "beyond 1e100 double precision overflows: change units, or use an infinite bound";
        let (what, names) = ("its largest number", Names::default());
        Self::Datum { what, source_of_row, entry: None, got, wanted, names }
    }

    pub(crate) fn nan_bound(what: &'static str, source_of_row: ConstraintSource) -> Self {
        let wanted = "give a number, or an infinite bound for a side that is free";
        let (got, names) = (f64::NAN, Names::default());
        Self::Datum { what, source_of_row, entry: None, got, wanted, names }
    }

    /// Returns the row or the level that the error is about, with its names.
    pub(crate) fn spot_mut(&mut self) -> Option<Spot<'_>> {
        match self {
            Self::Datum { source_of_row, names, .. }
            | Self::EmptyRange { source_of_row, names, .. }
            | Self::Inaccurate { source_of_row, names, .. }
            | Self::DataChanged { source_of_row, names }
            | Self::Infeasible { worst: source_of_row, names, .. } => {
                Some(Spot::Row(*source_of_row, names))
            }
            Self::Hessian { level, names, .. }
            | Self::ShapeChanged { level, names }
            | Self::Unbounded { level, names } => Some(Spot::Level(*level, names)),
            _ => None,
        }
    }
}

/// Subject of an error.
pub(crate) enum Spot<'a> {
    Row(ConstraintSource, &'a mut Names),
    Level(LevelId, &'a mut Names),
}
