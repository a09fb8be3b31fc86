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
    /// A matrix, vector or buffer does not fit.
    #[error("{what} has size {got}, but {wanted} was expected")]
    Size {
        /// The offending item.
        what: &'static str,
        /// Its size.
        got: usize,
        /// The size that fits.
        wanted: usize,
    },

    /// A setting, a parameter or a count is out of its range.
    #[error("{what}{} is {got}; it must be {wanted}", index.map(|i| format!(" {i}")).unwrap_or_default())]
    Value {
        /// What it is.
        what: &'static str,
        /// Which of several.
        index: Option<usize>,
        /// Its value.
        got: f64,
        /// The range it must lie in.
        wanted: &'static str,
    },

    /// A number of a problem is NaN, infinite where only finite numbers make sense, or so large that its
    /// square overflows.
    #[error(
        "{}{}: {what} is {got:e}; {wanted}",
        .names.label(*.source_of_row),
        entry.map(|i| format!(", entry {i}")).unwrap_or_default()
    )]
    Datum {
        /// The offending item.
        what: &'static str,
        /// Where it stands.
        source_of_row: ConstraintSource,
        /// The entry in it, if it has several.
        entry: Option<usize>,
        /// The number.
        got: f64,
        /// What would be right.
        wanted: &'static str,
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

    /// A Hessian is not symmetric, or has a negative eigenvalue.
    #[error(
        "the Hessian of {} is not {wanted} (entry ({row}, {column}): {got:e})",
        .names.label_of_level(*.level)
    )]
    Hessian {
        /// The level.
        level: LevelId,
        /// What it must be, and how to make it so.
        wanted: &'static str,
        /// Row of the worst entry, or the variable at which the factorisation failed.
        row: usize,
        /// Column of it.
        column: usize,
        /// The difference to the mirrored entry, the negative pivot, or the off-diagonal remainder that cannot
        /// belong to a PSD matrix.
        got: f64,
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

    /// A level minimises something else.
    #[error(
        "{} minimises {got}, not {wanted}; see Level::objective, and constraints_mut for what must hold",
        .names.label_of_level(*.level)
    )]
    OtherObjective {
        /// The level, if it is known.
        level: Option<LevelId>,
        /// What there is.
        got: &'static str,
        /// What was asked for.
        wanted: &'static str,
        /// What it is called.
        names: Names,
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

    /// The row or the level that the error speaks of, and what they are called.
    pub(crate) fn spot_mut(&mut self) -> Option<Spot<'_>> {
        match self {
            Self::Datum { source_of_row, names, .. }
            | Self::EmptyRange { source_of_row, names, .. }
            | Self::Inaccurate { source_of_row, names, .. }
            | Self::DataChanged { source_of_row, names }
            | Self::Infeasible { worst: source_of_row, names, .. } => {
                Some(Spot::Row(source_of_row, names))
            }
            Self::Hessian { level, names, .. }
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
