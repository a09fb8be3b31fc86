//! Least squares of rows of any weights, by elimination.
//!
//! The heaviest independent rows determine x, and the others are combinations of them (Peters &
//! Wilkinson, The Computer Journal 13, 1970). Rows have unit size, and weights enter only at the
//! end, so that light rows keep all their digits.

use qd::Quad;

use super::row::{Difference, Row, Sign};

/// A row is independent if its part outside the span of others is larger.
const INDEPENDENT: f64 = 1e-8;
/// A row is dependent if that part is smaller. Between the two it is in doubt.
const DEPENDENT: f64 = 1e-22;
/// Smaller coefficients of a combination are rounding.
const NO_SHARE: f64 = 1e-20;
/// Larger coefficients of a combination are accurate.
const SHARE: f64 = 1e-10;

const ZERO: Quad = Quad::ZERO;

fn dot(a: &[Quad], b: &[Quad]) -> Quad {
    a.iter().zip(b).fold(ZERO, |sum, (a, b)| sum + a * b)
}

/// Subtracts from `v` its component along the unit vector `q`, and returns that component.
fn take_off(v: &mut [Quad], q: &[Quad]) -> Quad {
    let part = dot(v, q);
    for (v, q) in v.iter_mut().zip(q) {
        *v -= part * q;
    }
    part
}

fn length(v: &[Quad]) -> Quad {
    dot(v, v).sqrt()
}

/// Returns the length in double precision, for comparisons.
fn rough_length(v: &[Quad]) -> f64 {
    v.iter().map(|v| v.0 * v.0).sum::<f64>().sqrt()
}

fn quads(row: &[f64]) -> Vec<Quad> {
    row.iter().map(|&a| Quad::from(a)).collect()
}

/// An orthonormal basis.
#[derive(Debug, Default)]
pub(super) struct Basis(Vec<Vec<Quad>>);

impl Basis {
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the row without its part in the span. Two passes are enough.
    fn outside(&self, row: &[f64]) -> Vec<Quad> {
        let mut v = quads(row);
        for q in self.0.iter().chain(&self.0) {
            take_off(&mut v, q);
        }
        v
    }

    /// Adds the row to the span. None if its independence is in doubt.
    pub(super) fn extend(&mut self, row: &[f64]) -> Option<()> {
        let mut v = self.outside(row);
        let size = rough_length(&v);
        if size > INDEPENDENT {
            for q in &self.0 {
                take_off(&mut v, q);
            }
            let size = length(&v);
            self.0.push(v.iter().map(|v| v / size).collect());
            return Some(());
        }
        (size < DEPENDENT).then_some(())
    }
}

/// A choice of independent rows outside a fixed subspace, and the other rows as combinations of
/// them. Kept rows come first, then weighted rows by weight.
pub(super) struct Factors<'a> {
    rows: &'a [&'a Row],
    /// Number of kept rows, which come first. The other rows have weights.
    kept: usize,
    /// Independent rows, each with its own unit vector.
    pivots: Vec<usize>,
    units: Vec<Vec<Quad>>,
    /// Components of each row along these vectors, without those added after the row.
    parts: Vec<Vec<Quad>>,
}

/// Minimum of ½ Σ weight² (a x − b)² over weighted rows, subject to a x = b for kept rows.
pub(super) struct Minimum {
    pub(super) x: Vec<Quad>,
    /// Sign of each row's multiplier, which is weight² (a x − b) for weighted rows.
    pub(super) forces: Vec<Sign>,
    /// Value of a x − b of each row by the multipliers.
    pub(super) gaps: Vec<Quad>,
}

impl<'a> Factors<'a> {
    pub(super) fn new(fixed: &Basis, rows: &'a [&'a Row], kept: usize) -> Option<Self> {
        let mut outside: Vec<_> = rows.iter().map(|row| fixed.outside(&row.a)).collect();
        let mut factors = Self {
            rows,
            kept,
            pivots: Vec::new(),
            units: Vec::new(),
            parts: vec![Vec::new(); rows.len()],
        };
        let mut left: Vec<usize> = (0..rows.len()).collect();
        loop {
            left.retain(|&i| rough_length(&outside[i]) > DEPENDENT);
            let size = |i: usize| {
                let is_kept = i < kept;
                (is_kept, if is_kept { 1.0 } else { rows[i].weight } * rough_length(&outside[i]))
            };
            let heaviest = left.iter().copied().max_by(|&i, &j| {
                let (i, j) = (size(i), size(j));
                i.0.cmp(&j.0).then(i.1.total_cmp(&j.1))
            });
            let Some(pivot) = heaviest else { break };
            let mut q = std::mem::take(&mut outside[pivot]);
            if rough_length(&q) < INDEPENDENT {
                return None;
            }
            for q_fixed in &fixed.0 {
                take_off(&mut q, q_fixed);
            }
            for (unit, part) in factors.units.iter().zip(&mut factors.parts[pivot]) {
                *part += take_off(&mut q, unit);
            }
            let size = length(&q);
            for entry in &mut q {
                *entry /= size;
            }
            factors.parts[pivot].push(size);
            left.retain(|&i| i != pivot);
            for &i in &left {
                factors.parts[i].push(take_off(&mut outside[i], &q));
            }
            factors.pivots.push(pivot);
            factors.units.push(q);
        }
        Some(factors)
    }

    /// Returns the minimum nearest to `from`, outside the fixed subspace. None if a sign is in
    /// doubt.
    pub(super) fn minimum(&self, fixed: &Basis, from: &[Quad]) -> Option<Minimum> {
        let dependents: Vec<usize> =
            (self.kept..self.rows.len()).filter(|i| !self.pivots.contains(i)).collect();
        let mut gaps = vec![ZERO; self.rows.len()];
        // Remainders of the dependent rows at the point that the pivots determine.
        let reached = self.step(from, &gaps);
        let mut shares = Vec::with_capacity(dependents.len());
        let mut rests = Vec::with_capacity(dependents.len());
        for &i in &dependents {
            let share = self.share(i)?;
            self.check_share(fixed, i, &share)?;
            shares.push(share);
            let gap = self.rows[i].gap(from);
            let mut rest = gap;
            for (part, y) in self.parts[i].iter().zip(&reached) {
                let part = part * y;
                rest.value += part;
                rest.terms += part.0.abs();
            }
            rests.push(if rest.sign()? == Sign::Zero { ZERO } else { rest.value });
        }
        let mut forces = vec![Sign::Zero; self.rows.len()];
        let pulls = self.pulls(&dependents, &shares, &rests);
        let mut multipliers = vec![ZERO; dependents.len()];
        for (k, &i) in dependents.iter().enumerate() {
            let weight = Quad::from(self.rows[i].weight);
            forces[i] = pulls[k].sign()?;
            gaps[i] = pulls[k].value / weight;
            multipliers[k] = pulls[k].value * weight;
        }
        for (p, &i) in self.pivots.iter().enumerate() {
            let mut force = Difference { value: ZERO, terms: 0.0 };
            for (share, multiplier) in shares.iter().zip(&multipliers) {
                let term = share[p] * multiplier;
                force.value -= term;
                force.terms += term.0.abs();
            }
            forces[i] = force.sign()?;
            if i >= self.kept {
                let weight = Quad::from(self.rows[i].weight);
                gaps[i] = force.value / weight / weight;
            }
        }
        let mut x = from.to_vec();
        for (y, unit) in self.step(from, &gaps).iter().zip(&self.units) {
            for (x, q) in x.iter_mut().zip(unit) {
                *x += y * q;
            }
        }
        Some(Minimum { x, forces, gaps })
    }

    /// Returns the step, along the unit vectors, to the point at which the pivots have these gaps.
    fn step(&self, from: &[Quad], gaps: &[Quad]) -> Vec<Quad> {
        let mut step: Vec<Quad> = Vec::with_capacity(self.pivots.len());
        for &i in &self.pivots {
            let parts = &self.parts[i];
            let rest = gaps[i] - self.rows[i].gap(from).value - dot(parts, &step);
            step.push(rest / parts[step.len()]);
        }
        step
    }

    /// Returns the row as a combination of the pivots. None if a coefficient is in doubt.
    fn share(&self, row: usize) -> Option<Vec<Quad>> {
        let mut share = self.parts[row].clone();
        share.resize(self.pivots.len(), ZERO);
        for p in (0..share.len()).rev() {
            let parts = &self.parts[self.pivots[p]];
            share[p] /= parts[p];
            if share[p].0.abs() < NO_SHARE {
                share[p] = ZERO;
            } else if share[p].0.abs() < SHARE {
                return None;
            }
            for j in 0..p {
                let taken = share[p] * parts[j];
                share[j] -= taken;
            }
        }
        Some(share)
    }

    /// Checks the combination. None if it does not equal the row.
    fn check_share(&self, fixed: &Basis, row: usize, share: &[Quad]) -> Option<()> {
        let mut rest = quads(&self.rows[row].a);
        for (&i, share) in self.pivots.iter().zip(share) {
            for (rest, &a) in rest.iter_mut().zip(&self.rows[i].a) {
                *rest -= share * Quad::from(a);
            }
        }
        for q in &fixed.0 {
            take_off(&mut rest, q);
        }
        let size = share.iter().fold(1.0_f64, |size, share| size.max(share.0.abs()));
        (rough_length(&rest) < DEPENDENT * size).then_some(())
    }

    /// Returns weight · (a x − b) for the dependent rows.
    ///
    /// Let φ be the multipliers of dependent rows D = L P. Those of the pivots are −Lᵀφ, and each
    /// row gives way by φ/weight²: (W_D⁻² + L W_P⁻² Lᵀ) φ = rest. This is (I + M Mᵀ) pull = W_D
    /// rest for pull = φ/W_D and M = W_D L W_P⁻¹. The entries of M are small, since heavy rows were
    /// made pivots first.
    fn pulls(&self, dependents: &[usize], shares: &[Vec<Quad>], rests: &[Quad]) -> Vec<Difference> {
        let count = dependents.len();
        let weight = |i: usize| Quad::from(self.rows[i].weight);
        let scaled = |k: usize| -> Vec<Quad> {
            let entries = self.pivots.iter().zip(&shares[k]);
            let soft = entries.filter(|(i, _)| **i >= self.kept);
            soft.map(|(&i, share)| share * weight(dependents[k]) / weight(i)).collect()
        };
        let scaled: Vec<Vec<Quad>> = (0..count).map(scaled).collect();
        let product = |k: usize, l: usize| dot(&scaled[k], &scaled[l]);
        let products: Vec<Vec<Quad>> =
            (0..count).map(|k| (0..count).map(|l| product(k, l)).collect()).collect();
        let right: Vec<Quad> =
            dependents.iter().zip(rests).map(|(&i, rest)| weight(i) * rest).collect();
        // Cholesky factorisation.
        let mut lower = products.clone();
        let mut pulls = right.clone();
        for k in 0..count {
            lower[k][k] += Quad::ONE;
            for j in 0..=k {
                let above = dot(&lower[k][..j], &lower[j][..j]);
                let rest = lower[k][j] - above;
                lower[k][j] = if j == k { rest.sqrt() } else { rest / lower[j][j] };
            }
            pulls[k] = (pulls[k] - dot(&lower[k][..k], &pulls[..k])) / lower[k][k];
        }
        for k in (0..count).rev() {
            pulls[k] /= lower[k][k];
            for j in 0..k {
                let taken = lower[k][j] * pulls[k];
                pulls[j] -= taken;
            }
        }
        let terms = |k: usize| {
            let others = products[k].iter().zip(&pulls).map(|(m, pull)| (m * pull).0.abs());
            right[k].0.abs() + others.sum::<f64>()
        };
        (0..count).map(|k| Difference { value: pulls[k], terms: terms(k) }).collect()
    }
}
