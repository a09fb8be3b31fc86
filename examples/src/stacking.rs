//! The stacking method of programs, and the comparison of both along a run.

use ahqp_core::Stacking;
use clap::{Args, ValueEnum};
use hqp_problems::comparison::{Compared, Comparison};
use moca_model::CollaborationStack;

/// The method by which later levels keep the optimum of a level.
#[derive(Args, Clone, Copy, Debug)]
pub struct StackingOption {
    /// The method by which later levels keep what a level decided. A solve by `equalities` takes a thousand times
    /// as long.
    #[arg(long, value_name = "METHOD", value_enum, default_value_t = Method::Elimination)]
    stacking: Method,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Eliminate the directions that it decided.
    Elimination,
    /// Stack equalities A_k χ = A_k χ*_k, as in the paper, and solve by Clarabel in their nullspace.
    Equalities,
}

impl StackingOption {
    /// The method.
    pub fn method(self) -> Stacking {
        match self.stacking {
            Method::Elimination => Stacking::Elimination,
            Method::Equalities => Stacking::Equalities,
        }
    }
}

/// Compares both methods on the problems of a run.
#[derive(Debug)]
pub struct StackingWatch {
    every: Option<u64>,
    ticks: u64,
    comparison: Comparison,
}

impl StackingWatch {
    /// Creates a comparison of the problem of every `every` ticks; `None` compares nothing.
    pub fn new(every: Option<u64>) -> Self {
        Self { every, ticks: 0, comparison: Comparison::default() }
    }

    /// Compares the solution of a tick, if it is its turn. Failures are counted.
    pub fn see(&mut self, stack: &CollaborationStack) {
        let is_due = self.every.is_some_and(|every| self.ticks.is_multiple_of(every));
        self.ticks += 1;
        let found = stack.solution().filter(|_| is_due).and_then(|found| found.optimum().ok());
        if let Some(x) = found {
            // The result counts problems that a method did not solve.
            let _ = self.comparison.add(stack.hierarchy(), x);
        }
    }

    /// The result so far, if anything is compared.
    pub fn result(&self) -> Option<Compared> {
        self.every.map(|_| self.comparison.result())
    }
}
