//! The exact minimum of one level.

use num_traits::{Signed, Zero};

use super::elimination::{independent, solve};
use super::{Exact, Held, double, exact};

/// A row a and a number b.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    pub(super) a: Vec<Exact>,
    pub(super) b: Exact,
}

impl Linear {
    /// Creates the row and its bound, multiplied by `sign`.
    pub(super) fn new(row: &[f64], bound: f64, sign: f64) -> Self {
        Self { a: row.iter().map(|&a| exact(sign * a)).collect(), b: exact(sign * bound) }
    }

    /// Returns a x − b.
    pub(super) fn gap(&self, x: &[Exact]) -> Exact {
        self.a.iter().zip(x).map(|(a, x)| a * x).sum::<Exact>() - &self.b
    }

    /// Returns true if a x equals b at `x`, up to rounding.
    fn is_near(&self, x: &[Exact]) -> bool {
        let terms: f64 = self.a.iter().zip(x).map(|(a, x)| double(&(a * x)).abs()).sum();
        double(&self.gap(x)).abs() <= 1e-9 * (terms + double(&self.b).abs())
    }
}

/// The objective ½xᵀHx + gᵀx + ½Σ (a x − b)² over equalities + ½Σ max(a x − b, 0)² over
/// inequalities.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub(super) hessian: Vec<Vec<Exact>>,
    pub(super) gradient: Vec<Exact>,
    pub(super) equalities: Vec<Linear>,
    pub(super) inequalities: Vec<Linear>,
}

impl Minimum {
    pub(super) fn new(n: usize) -> Self {
        Self {
            hessian: vec![vec![Exact::zero(); n]; n],
            gradient: vec![Exact::zero(); n],
            equalities: Vec::new(),
            inequalities: Vec::new(),
        }
    }
}

/// Number of repairs of a guessed active set after which the search begins at the start.
const REPAIRS: usize = 20;

/// Indices of violated inequalities of the objective, and of inequalities of the constraints that
/// are kept at their bounds.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Active {
    violated: Vec<usize>,
    kept: Vec<usize>,
}

/// Returns a point that minimises the objective within the constraints. `start` satisfies them, and
/// `guess` may be near the minimum.
pub(super) fn minimise(
    objective: &Minimum,
    held: &Held,
    start: &[Exact],
    guess: &[Exact],
) -> Vec<Exact> {
    let problem = Problem { objective, held, guess };
    problem.repair().unwrap_or_else(|| problem.search(start))
}

/// Returns the minimum by trying all active sets. None if the constraints contradict each other.
pub(super) fn enumerate(objective: &Minimum, held: &Held, guess: &[Exact]) -> Option<Vec<Exact>> {
    Problem { objective, held, guess }.enumerate()
}

struct Problem<'a> {
    objective: &'a Minimum,
    held: &'a Held,
    guess: &'a [Exact],
}

/// Verdict on an active set.
enum Check {
    Optimal,
    Violated(usize),
    Kept(usize),
    NotViolated(usize),
    NotKept(usize),
}

impl Problem<'_> {
    /// Changes the active set at the guess, one row at a time, until it is optimal.
    fn repair(&self) -> Option<Vec<Exact>> {
        let near = |row: &Linear| row.is_near(self.guess);
        let rows = &self.objective.inequalities;
        let is_violated = |row: &Linear| !near(row) && row.gap(self.guess).is_positive();
        let mut active = Active {
            violated: (0..rows.len()).filter(|&i| is_violated(&rows[i])).collect(),
            kept: (0..self.held.inequalities.len())
                .filter(|&i| near(&self.held.inequalities[i]))
                .collect(),
        };
        active.kept = self.independent(&active.kept);
        for _ in 0..REPAIRS {
            let (x, forces) = self.equality_minimum(&active, self.guess)?;
            match self.check(&active, &x, &forces) {
                Check::Optimal => return Some(x),
                Check::Violated(i) => active.violated.push(i),
                Check::NotViolated(i) => active.violated.retain(|&j| j != i),
                Check::NotKept(i) => active.kept.retain(|&j| j != i),
                Check::Kept(i) => {
                    active.kept.push(i);
                    let independent = self.independent(&active.kept);
                    if independent.len() < active.kept.len() {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// Runs the primal active-set method (Nocedal & Wright, Numerical Optimization, algorithm 16.3)
    /// from a point within the constraints, with rows by least index (Bland). A violation is a
    /// variable of its own. A row that is not kept may have a larger violation than it needs.
    fn search(&self, start: &[Exact]) -> Vec<Exact> {
        let (soft, hard) = (&self.objective.inequalities, &self.held.inequalities);
        let mut x = start.to_vec();
        let zero = Exact::zero();
        let mut violation: Vec<Exact> =
            soft.iter().map(|row| row.gap(&x).max(zero.clone())).collect();
        let mut active = Active {
            violated: (0..soft.len()).filter(|&i| violation[i].is_positive()).collect(),
            kept: Vec::new(),
        };
        loop {
            let (goal, forces) = self.equality_minimum(&active, &x).expect("a feasible start");
            let goal_violation: Vec<Exact> =
                (0..soft.len())
                    .map(|i| {
                        if active.violated.contains(&i) { soft[i].gap(&goal) } else { zero.clone() }
                    })
                    .collect();
            let mut length = exact(1.0);
            let mut stopped = None;
            let mut stop = |room: Exact, slope: Exact, row: (bool, usize)| {
                if slope.is_positive() && &room / &slope < length {
                    length = room / slope;
                    stopped = Some(row);
                }
            };
            for (i, row) in hard.iter().enumerate().filter(|(i, _)| !active.kept.contains(i)) {
                let (from, to) = (row.gap(&x), row.gap(&goal));
                stop(-&from, to - from, (true, i));
            }
            for (i, row) in soft.iter().enumerate().filter(|(i, _)| !active.violated.contains(i)) {
                let (from, to) = (row.gap(&x) - &violation[i], row.gap(&goal));
                stop(-&from, to - from, (false, i));
            }
            let towards = |from: &Exact, to: &Exact| from + &length * (to - from);
            x = x.iter().zip(&goal).map(|(from, to)| towards(from, to)).collect();
            violation =
                violation.iter().zip(&goal_violation).map(|(from, to)| towards(from, to)).collect();
            match stopped {
                Some((true, i)) => active.kept.push(i),
                Some((false, i)) => active.violated.push(i),
                None => {
                    let kept = active.kept.iter().zip(&forces);
                    let wrong_kept = kept.filter(|(_, f)| f.is_negative()).map(|(&i, _)| i).min();
                    let violated = active.violated.iter().copied();
                    let wrong = violated.filter(|&i| violation[i].is_negative()).min();
                    match (wrong_kept, wrong) {
                        (Some(i), _) => active.kept.retain(|&j| j != i),
                        (None, Some(i)) => active.violated.retain(|&j| j != i),
                        (None, None) => return x,
                    }
                }
            }
        }
    }

    /// Tries all active sets.
    fn enumerate(&self) -> Option<Vec<Exact>> {
        let soft = self.objective.inequalities.len();
        let hard = self.held.inequalities.len();
        for violated in 0..1_usize << soft {
            let violated: Vec<usize> = (0..soft).filter(|i| violated >> i & 1 == 1).collect();
            let mut kept = Vec::new();
            if let Some(x) = self.enumerate_kept(&violated, &mut kept, 0, hard) {
                return Some(x);
            }
        }
        None
    }

    fn enumerate_kept(
        &self,
        violated: &[usize],
        kept: &mut Vec<usize>,
        first: usize,
        count: usize,
    ) -> Option<Vec<Exact>> {
        let active = Active { violated: violated.to_vec(), kept: kept.clone() };
        if self.independent(kept).len() < kept.len() {
            return None;
        }
        if let Some((x, forces)) = self.equality_minimum(&active, self.guess)
            && matches!(self.check(&active, &x, &forces), Check::Optimal)
        {
            return Some(x);
        }
        for i in first..count {
            kept.push(i);
            let found = self.enumerate_kept(violated, kept, i + 1, count);
            kept.pop();
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// Returns the rows that are independent of the equalities and of earlier rows.
    fn independent(&self, kept: &[usize]) -> Vec<usize> {
        let given: Vec<&[Exact]> = self.held.equalities.iter().map(|row| &row.a[..]).collect();
        let candidates: Vec<&[Exact]> =
            kept.iter().map(|&i| &self.held.inequalities[i].a[..]).collect();
        let is_independent = independent(&given, &candidates);
        kept.iter().zip(is_independent).filter(|(_, is)| *is).map(|(&i, _)| i).collect()
    }

    /// Returns the minimum with the active rows as equalities, and the multipliers of the kept
    /// rows. Undetermined directions stay as in `near`.
    fn equality_minimum(
        &self,
        active: &Active,
        near: &[Exact],
    ) -> Option<(Vec<Exact>, Vec<Exact>)> {
        let n = near.len();
        let violated = active.violated.iter().map(|&i| &self.objective.inequalities[i]);
        let soft: Vec<&Linear> = self.objective.equalities.iter().chain(violated).collect();
        let kept = active.kept.iter().map(|&i| &self.held.inequalities[i]);
        let hard: Vec<&Linear> = self.held.equalities.iter().chain(kept).collect();
        // The system for p = x − near is (H + AᵀA) p + Bᵀλ = −(H near + g + Aᵀ(A near − b)) and B p
        // = −gap.
        let width = n + hard.len() + 1;
        let mut equations = vec![vec![Exact::zero(); width]; n + hard.len()];
        let gaps: Vec<Exact> = soft.iter().map(|row| row.gap(near)).collect();
        for i in 0..n {
            let hessian = &self.objective.hessian[i];
            let slope: Exact = hessian.iter().zip(near).map(|(h, x)| h * x).sum();
            let mut rest = slope + &self.objective.gradient[i];
            equations[i][..n].clone_from_slice(hessian);
            for (row, gap) in soft.iter().zip(&gaps).filter(|(row, _)| !row.a[i].is_zero()) {
                rest += &row.a[i] * gap;
                for j in 0..n {
                    equations[i][j] += &row.a[i] * &row.a[j];
                }
            }
            equations[i][width - 1] = -rest;
            for (k, row) in hard.iter().enumerate() {
                equations[i][n + k] = row.a[i].clone();
                equations[n + k][i] = row.a[i].clone();
            }
        }
        for (k, row) in hard.iter().enumerate() {
            equations[n + k][width - 1] = -row.gap(near);
        }
        let solution = solve(&equations)?;
        let x = solution[..n].iter().zip(near).map(|(p, x)| p + x).collect();
        Some((x, solution[n + self.held.equalities.len()..].to_vec()))
    }

    fn check(&self, active: &Active, x: &[Exact], forces: &[Exact]) -> Check {
        for (i, row) in self.held.inequalities.iter().enumerate() {
            if !active.kept.contains(&i) && row.gap(x).is_positive() {
                return Check::Kept(i);
            }
        }
        for (i, row) in self.objective.inequalities.iter().enumerate() {
            let is_violated = active.violated.contains(&i);
            let gap = row.gap(x);
            if !is_violated && gap.is_positive() {
                return Check::Violated(i);
            }
            if is_violated && gap.is_negative() {
                return Check::NotViolated(i);
            }
        }
        let wrong = active.kept.iter().zip(forces).filter(|(_, force)| force.is_negative());
        let worst = wrong.min_by(|a, b| a.1.cmp(b.1));
        worst.map_or(Check::Optimal, |(&i, _)| Check::NotKept(i))
    }
}
