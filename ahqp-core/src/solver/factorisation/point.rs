//! The point of a factorisation, and the multipliers that balance a gradient.

use std::ops::Range;

use super::{Factorisation, Group, Purpose};
use crate::linalg::kernels::add_rows;
use crate::linalg::vector::{add_scaled, dot, norm};
use crate::solver::activity::Activity;
use crate::solver::data::{ProblemData, active_bound};
use crate::solver::tolerances::ROUNDING;

/// Treatment of coordinates that no group decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FreeCoordinates {
    /// Values are kept.
    Kept,
    /// Values become zero, which gives the least norm.
    Zero,
}

/// A step to the point that the groups decide.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    /// False if a linear term has no minimum. The step is then a direction in which it decreases.
    pub(crate) has_minimum: bool,
    /// The first group that the step moves.
    pub(crate) moving: usize,
    /// Length of the step in the coordinates of an objective before the last group.
    pub(crate) of_objectives_above: f64,
}

/// Copies the entries of a vector at the free variables, padded with zeros.
fn gather(free: &[usize], vector: &[f64], out: &mut [f64]) {
    for (entry, &variable) in out.iter_mut().zip(free) {
        *entry = vector[variable];
    }
    out[free.len()..].fill(0.0);
}

impl Factorisation {
    /// Computes the decided coordinates and x, with all free coordinates zero: the point of least
    /// norm. Returns false if a linear term decreases without bound along a free direction.
    pub(crate) fn set_point(&mut self, data: &ProblemData) -> bool {
        if !(self.decided..self.groups.len()).all(|group| self.decide(data, group, 0)) {
            return false;
        }
        self.decided = self.groups.len();
        let rank = self.pivots.len();
        self.orthogonal.turn_part_back(&self.y[..rank], 0, &mut self.gathered);
        for (&variable, &value) in self.free.iter().zip(&self.gathered) {
            self.x[variable] = value;
        }
        true
    }

    /// Sets variables of bounds in the stack exactly to their bounds, without rounding.
    pub(crate) fn set_bounds(&mut self, data: &ProblemData, activity: &[Activity]) {
        let first = self.groups.first().map_or(0, |group| group.end);
        for &id in self.stacked[..first].iter().filter(|&&id| id < self.n) {
            self.x[id] = active_bound(data, activity, id);
        }
    }

    /// Computes the step from `x` to the point that the groups decide. `gap` is the bound of an
    /// active row minus aᵢx, or zero where a row is held where it is.
    ///
    /// The first `attained` groups need no step: they have not changed since x was where they
    /// decide.
    pub(crate) fn step_from(
        &mut self,
        data: &ProblemData,
        (x, attained): (&[f64], usize),
        gap: impl FnMut(usize, Purpose) -> f64,
        free: FreeCoordinates,
        step: &mut [f64],
    ) -> Step {
        let (rank, k) = (self.pivots.len(), self.free.len());
        let mut moving = self.first_to_move(attained, gap);
        let first = self.groups.get(moving).map_or(rank, |group| group.first_pivot);
        let mut groups = moving..self.groups.len();
        let has_minimum = groups.all(|group| self.decide(data, group, first));
        let of_objectives_above = self.step_of_objectives_above(moving);
        let mut z = std::mem::take(&mut self.turned);
        if has_minimum {
            z[first..rank].copy_from_slice(&self.y[first..rank]);
            if free == FreeCoordinates::Zero {
                gather(&self.free, x, &mut self.gathered);
                self.orthogonal.turn_part(&self.gathered, rank, &mut z[rank..k]);
                z[rank..k].iter_mut().for_each(|z| *z = -*z);
            }
        } else {
            let level = self.groups.last().and_then(|group| group.linear_of).unwrap_or(0);
            let linear = &self.linear[level * self.n + rank..level * self.n + k];
            z[first..rank].fill(0.0);
            moving = self.groups.len();
            for (z, linear) in z[rank..].iter_mut().zip(linear) {
                *z = -linear;
            }
        }
        let moves_free = !has_minimum || free == FreeCoordinates::Zero;
        let end = if moves_free { k } else { rank };
        self.orthogonal.turn_part_back(&z[first..end], first, &mut self.gathered);
        self.turned = z;
        if self.bounded.is_empty() && self.moved.is_empty() {
            step.copy_from_slice(&self.gathered[..self.n]);
        } else {
            step.fill(0.0);
            for (&variable, &value) in self.free.iter().zip(&self.gathered) {
                step[variable] = value;
            }
        }
        Step { has_minimum, moving, of_objectives_above }
    }

    /// Returns the longest step in the coordinates of an objective before the last group.
    fn step_of_objectives_above(&self, moving: usize) -> f64 {
        let last = self.groups.len().saturating_sub(1);
        let moved = self.groups[..last].iter().skip(moving);
        let objectives = moved.filter(|group| group.purpose == Purpose::Minimised);
        let steps = objectives
            .map(|group| norm(&self.y[group.first_pivot..group.first_pivot + group.rank]));
        steps.fold(0.0, f64::max)
    }

    /// Returns the first group from `attained` on that has a step to make. Computes the targets of
    /// its rows and of the later ones. Hard rows that are where they are held have none.
    fn first_to_move(
        &mut self,
        attained: usize,
        mut gap: impl FnMut(usize, Purpose) -> f64,
    ) -> usize {
        let mut first = self.groups.len();
        for index in attained..self.groups.len() {
            let Group { start, end, rank, purpose, .. } = self.groups[index];
            for (target, &id) in self.target[start..end].iter_mut().zip(&self.stacked[start..end]) {
                *target = gap(id, purpose);
            }
            let mut pivots = self.target[start..start + rank].iter();
            if purpose == Purpose::Minimised || pivots.any(|&target| target != 0.0) {
                first = first.min(index);
            }
        }
        first
    }

    /// Iterates over the active hard rows that a step moves from group `moving` on, with their changes. Pivots move
    /// to where they are held, dependent rows by `product`, which is aᵢ times the step.
    pub(crate) fn steps_of_held(
        &self,
        moving: usize,
        product: impl Fn(usize) -> f64,
    ) -> impl Iterator<Item = (usize, f64)> {
        let moved = self.groups.iter().skip(moving);
        let held = moved.filter(|group| group.purpose == Purpose::Held);
        let rows = held.flat_map(|group| {
            (group.start..group.end).map(|at| (at, at < group.start + group.rank))
        });
        rows.map(move |(at, is_pivot)| {
            let id = self.stacked[at];
            (id, if is_pivot { self.target[at] } else { product(id) })
        })
    }

    /// Computes the coordinates that the group decides, with those before `first` taken as zero.
    /// Returns false if its linear term has no minimum.
    fn decide(&mut self, data: &ProblemData, group: usize, first: usize) -> bool {
        let n = self.stride;
        let Group { purpose, start, end, rank, first_pivot, linear_of, .. } = self.groups[group];
        if let Some(level) = linear_of {
            let decided = first_pivot + rank;
            let size = self.turn_linear(data, level);
            let open = &self.linear[level * self.n + decided..level * self.n + self.free.len()];
            if norm(open) > self.tolerances.dependent * size {
                return false;
            }
        }
        if linear_of.is_some() || (purpose == Purpose::Minimised && rank < end - start) {
            self.decide_least_squares(data, group, first);
            return true;
        }
        for (pivot, at) in (first_pivot..).zip(start..start + rank) {
            let row = &self.rows[at * n..(at + 1) * n];
            let known = dot(&row[first..pivot], &self.y[first..pivot]);
            self.y[pivot] = (self.target[at] - known) / row[pivot];
        }
        true
    }

    /// Transforms a level's linear term into the coordinates y. Returns its size.
    fn turn_linear(&mut self, data: &ProblemData, level: usize) -> f64 {
        let (n, k) = (self.n, self.free.len());
        let source = &data.levels[level].linear;
        let mut linear = std::mem::take(&mut self.linear);
        self.coordinates(source, &mut linear[level * n..level * n + k]);
        self.linear = linear;
        norm(source)
    }

    /// Computes the multipliers μ of the first pivots that balance a gradient given by
    /// `coordinates`: Σ μᵢ Lᵢ = −coordinates. Overwrites `coordinates` with μ.
    pub(crate) fn balance(&self, coordinates: &mut [f64]) {
        let n = self.stride;
        for pivot in (0..coordinates.len()).rev() {
            let at = self.pivots[pivot];
            let row = &self.rows[at * n..(at + 1) * n];
            let multiplier = -coordinates[pivot] / row[pivot];
            add_scaled(&mut coordinates[..pivot], multiplier, &row[..pivot]);
            coordinates[pivot] = multiplier;
        }
    }

    /// Computes the rounding in the multipliers of [`balance`](Self::balance), given the rounding
    /// in the coordinates, which it replaces. `norm` returns the norm of a row.
    pub(crate) fn balance_rounding(
        &self,
        multipliers: &[f64],
        norm: impl Fn(usize) -> f64,
        rounding: &mut [f64],
    ) {
        let n = self.stride;
        for pivot in (0..multipliers.len()).rev() {
            let at = self.pivots[pivot];
            let row = &self.rows[at * n..at * n + pivot];
            let size = ROUNDING * multipliers[pivot].abs();
            let turned = size * norm(self.stacked[at]);
            let of_pivot = rounding[pivot] / self.rows[at * n + pivot].abs() + size;
            rounding[pivot] = of_pivot;
            for (rounding, entry) in rounding[..pivot].iter_mut().zip(row) {
                *rounding += of_pivot * entry.abs() + turned;
            }
        }
    }

    /// Returns true if a dependent row of the group has a force near the rank threshold, after the pivots are
    /// subtracted. The force is along an earlier coordinate or along a variable at a bound. If
    /// other bounds are active, the rank tolerance may neglect it.
    pub(crate) fn has_multipliers_near_threshold(
        &mut self,
        data: &ProblemData,
        group: usize,
        residuals: impl Iterator<Item = f64>,
    ) -> bool {
        let n = self.stride;
        let Group { start, end, rank, first_pivot, .. } = self.groups[group];
        let mut remainder = std::mem::take(&mut self.turned);
        let mut left = std::mem::take(&mut self.left);
        let dependent = (start..end).zip(residuals).skip(rank);
        let any = dependent.filter(|&(_, residual)| residual != 0.0).any(|(at, _)| {
            let id = self.stacked[at];
            remainder.copy_from_slice(&self.rows[at * n..(at + 1) * n]);
            left.copy_from_slice(data.coefficients(id));
            for index in (0..rank).rev() {
                let (coordinate, pivot) = (first_pivot + index, start + index);
                let row = &self.rows[pivot * n..(pivot + 1) * n];
                let part = -remainder[coordinate] / row[coordinate];
                add_scaled(&mut remainder[..coordinate], part, &row[..coordinate]);
                add_scaled(&mut left, part, data.coefficients(self.stacked[pivot]));
            }
            let size = data.norm(id);
            let near_threshold =
                self.tolerances.nothing * size..self.tolerances.near_threshold * size;
            let of_bounds = self.bounded.iter().map(|&i| left[i]);
            let mut parts = remainder[..first_pivot].iter().copied().chain(of_bounds);
            parts.any(|part| near_threshold.contains(&part.abs()))
        });
        (self.turned, self.left) = (remainder, left);
        any
    }

    /// Replaces residuals of a group's pivots by those that balance the other rows and the linear
    /// term, as at the minimum.
    ///
    /// The balance is along the coordinates that the group decides. A residual is replaced where
    /// the balance is more accurate, since a heavy row's residual may be far below the rounding of
    /// its own terms. `rounding` contains the rounding in the residuals. Both are in the order of
    /// the stack. `sums` and `sums_rounding` have room for one number for each coordinate.
    pub(crate) fn balance_group(
        &self,
        data: &ProblemData,
        group: usize,
        has_scale_disparity: bool,
        (residual, rounding): (&mut [f64], &mut [f64]),
        (sums, sums_rounding): (&mut [f64], &mut [f64]),
    ) {
        let Group { start, rank, first_pivot, linear_of, .. } = self.groups[group];
        let (sums, sums_rounding) = (&mut sums[..rank], &mut sums_rounding[..rank]);
        match linear_of {
            None => sums.fill(0.0),
            Some(level) => {
                let first = level * self.n + first_pivot;
                sums.copy_from_slice(&self.linear[first..first + rank]);
            }
        }
        for (rounding, sum) in sums_rounding.iter_mut().zip(sums.iter()) {
            *rounding = ROUNDING * sum.abs();
        }
        // Each entry has the rounding of its whole row.
        let mut of_entries = 0.0;
        // In this order, the sum along a pivot's coordinate covers the later rows.
        for index in (0..residual.len()).rev() {
            let at = start + index;
            let place = at * self.stride + first_pivot;
            let row = &self.rows[place..place + rank.min(index + 1)];
            if let Some(own) = row.get(index) {
                let (sum, sum_rounding) = (sums[index], sums_rounding[index] + of_entries);
                // If rows nearly depend on each other, the residual at x is more accurate.
                if sum_rounding < rounding[index] * own.abs() {
                    residual[index] = -sum / own;
                    rounding[index] = sum_rounding / own.abs();
                }
            }
            let (residual, rounding, id) = (residual[index], rounding[index], self.stacked[at]);
            for ((sum, of_sum), entry) in sums.iter_mut().zip(sums_rounding.iter_mut()).zip(row) {
                *sum += entry * residual;
                *of_sum += entry.abs() * rounding;
            }
            let norm = self.norm_of_entries(data, id, has_scale_disparity);
            of_entries += data.relative_rounding(id) * norm * residual.abs();
        }
    }

    /// Computes the first coordinates of a vector over all variables.
    pub(crate) fn coordinates(&mut self, vector: &[f64], out: &mut [f64]) {
        let mut turned = std::mem::take(&mut self.turned);
        gather(&self.free, vector, &mut turned);
        self.orthogonal.turn_part(&turned, 0, out);
        self.turned = turned;
    }

    /// Adds the first coordinates of stacked rows, multiplied by their weights.
    pub(crate) fn add_rows(&self, rows: Range<usize>, weights: &[f64], coordinates: &mut [f64]) {
        add_rows(&self.rows[rows.start * self.stride..], self.stride, weights, coordinates);
    }

    /// Adds the sizes of the first coordinates of stacked rows, multiplied by their weights.
    pub(crate) fn add_sizes(&self, rows: Range<usize>, weights: &[f64], coordinates: &mut [f64]) {
        let n = self.stride;
        for (row, weight) in self.rows[rows.start * n..rows.end * n].chunks_exact(n).zip(weights) {
            for (coordinate, entry) in coordinates.iter_mut().zip(row) {
                *coordinate += weight * entry.abs();
            }
        }
    }

    /// Adds the first coordinates of a level's linear term.
    pub(crate) fn add_linear(&self, level: usize, coordinates: &mut [f64]) {
        let linear = &self.linear[level * self.n..level * self.n + coordinates.len()];
        add_scaled(coordinates, 1.0, linear);
    }
}
