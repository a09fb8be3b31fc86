//! Plain hierarchies whose solutions a continuous stack blends.

use super::data::Data;
use super::plan::Plan;
use crate::certificate::Certificate;
use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::source::ConstraintSource;
use crate::solver::solution::Solution;

/// One of the plain hierarchies whose solutions are blended.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    plan: &'a Plan,
}

impl<'a> Part<'a> {
    pub(super) fn new(plan: &'a Plan) -> Self {
        Self { plan }
    }

    /// Weight of its solution, above 0. All weights sum to 1.
    pub fn weight(&self) -> f64 {
        self.plan.weight
    }

    /// The ids of its levels, highest priority first.
    pub fn ids(&self) -> impl Iterator<Item = LevelId> + 'a {
        self.plan.levels()
    }

    /// Solution of the part, with its status.
    pub fn solution(&self) -> &'a Solution {
        self.plan.solution()
    }

    /// Iterates over the rows that cannot hold together after [`Error::Infeasible`], and nothing
    /// otherwise. [`ContinuousStack::describe`](super::ContinuousStack::describe) describes a row
    /// in words.
    pub fn conflict(&self) -> impl Iterator<Item = ConstraintSource> + 'a {
        self.plan.conflict()
    }
}

/// One of the plain hierarchies whose solutions are blended, with the proof of its solution. Its
/// levels are numbered from 0.
///
/// ```
/// use ahqp_core::{ContinuousStack, Hierarchy, Settings};
///
/// let mut stack = ContinuousStack::new(&Hierarchy::new(2)?, Settings::default())?;
/// stack.solve(1e-3)?;
/// for part in stack.certified_parts()? {
///     assert!(part.certificate.residuals(&part.hierarchy, &part.x)?.worst() < 1e-9);
/// }
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CertifiedPart {
    /// Weight of its solution.
    pub weight: f64,
    /// The problem.
    pub hierarchy: Hierarchy,
    /// Solution of the part.
    pub x: Vec<f64>,
    /// The proof that the solution is optimal.
    pub certificate: Certificate,
}

impl CertifiedPart {
    pub(super) fn new(plan: &mut Plan, data: &mut Data) -> Result<Self, Error> {
        let (hierarchy, certificate) = plan.certify(data)?;
        let x = plan.solution().x.clone();
        Ok(Self { weight: plan.weight, hierarchy, x, certificate })
    }
}
