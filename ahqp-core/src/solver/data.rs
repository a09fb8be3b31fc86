//! Rows of a hierarchy in one flat table, checked and copied once for each solve.

mod rounding;
mod unchanged;

use std::ops::Range;

use crate::error::Error;
use crate::linalg::kernels::{multiply_rows, square, square_rows};
use crate::linalg::vector::{norm, norm_max};
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::Objective;
use crate::problem::rows::Rows;
use crate::problem::source::{ConstraintSource, Names};
use crate::solver::activity::Activity;
use crate::solver::quadratic_factor::QuadraticFactor;
use crate::solver::tolerances::{MODERATE, MODERATE_SQUARE, NEAR_ONE, ROUNDING};

/// A row as seen by linear algebra: a unit vector for a bound, otherwise coefficients.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowView<'a> {
    coefficients: Coefficients<'a>,
    norm: f64,
}

/// Coefficients of a row.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Coefficients<'a> {
    /// One in this column, zero elsewhere.
    Unit(usize),
    Dense(&'a [f64]),
}

impl<'a> RowView<'a> {
    pub(crate) fn unit(variable: usize) -> Self {
        Self { coefficients: Coefficients::Unit(variable), norm: 1.0 }
    }

    pub(crate) fn dense(coefficients: &'a [f64], norm: f64) -> Self {
        Self { coefficients: Coefficients::Dense(coefficients), norm }
    }

    pub(crate) fn coefficients(self) -> Coefficients<'a> {
        self.coefficients
    }

    pub(crate) fn dot(self, x: &[f64]) -> f64 {
        match self.coefficients {
            Coefficients::Unit(variable) => x[variable],
            Coefficients::Dense(coefficients) => {
                let mut product = [0.0];
                multiply_rows(coefficients, coefficients.len(), x, &mut product);
                product[0]
            }
        }
    }

    pub(crate) fn norm(self) -> f64 {
        self.norm
    }

    /// Computes y ← y + αa.
    pub(crate) fn add_to(self, y: &mut [f64], alpha: f64) {
        match self.coefficients {
            Coefficients::Unit(variable) => y[variable] += alpha,
            Coefficients::Dense(coefficients) => {
                crate::linalg::vector::add_scaled(y, alpha, coefficients);
            }
        }
    }
}

/// Ranges of a level's rows in the table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LevelRows {
    pub(crate) constraints: Range<usize>,
    pub(crate) objective: Range<usize>,
    /// Number of rows of the objective in use. This is the rank of the Hessian if the objective is
    /// quadratic. Otherwise the rows up to the last one that bounds something are in use. The
    /// remaining rows are zero and bound nothing.
    pub(crate) used: usize,
    /// True if any row of the objective was multiplied by a weight.
    weighted: bool,
    pub(crate) quadratic: bool,
    /// True if a part of the gradient lies outside the range of the Hessian.
    pub(crate) has_linear: bool,
    /// The part of the gradient outside the range of the Hessian.
    pub(crate) linear: Vec<f64>,
}

impl LevelRows {
    pub(crate) fn used_objective(&self) -> Range<usize> {
        self.objective.start..self.objective.start + self.used
    }
}

/// Rows of all kinds: first the bounds of the n variables, then each level's constraints and objective.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProblemData {
    pub(crate) n: usize,
    coefficients: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    norms: Vec<f64>,
    /// Relative rounding of rows, and rounding of their bounds. It exceeds the rounding of one
    /// operation for the rows of a quadratic's factor.
    relative_rounding: Vec<f64>,
    bound_rounding: Vec<f64>,
    /// Factors that rows were multiplied by.
    ///
    /// Those of hard constraints are powers of two. The units of constraints have no meaning, but
    /// large ones would hide small ones when several are made to hold together. Those of objectives
    /// are the roots of the weights.
    scales: Vec<f64>,
    /// True if any constraint was multiplied.
    scaled: bool,
    pub(crate) sources: Vec<ConstraintSource>,
    pub(crate) levels: Vec<LevelRows>,
    factor: QuadraticFactor,
}

impl ProblemData {
    /// Sizes the table for hierarchies of this shape.
    pub(crate) fn new(hierarchy: &Hierarchy) -> Self {
        let n = hierarchy.variables();
        let mut sources: Vec<_> =
            (0..n).map(|variable| ConstraintSource::Bound { variable }).collect();
        let mut levels = Vec::with_capacity(hierarchy.levels().len());
        for (level, data) in hierarchy.levels().iter().enumerate() {
            let (start, level) = (sources.len(), LevelId::new(level));
            sources.extend(
                (0..data.constraints().len())
                    .map(|row| ConstraintSource::Constraint { level, row }),
            );
            let middle = sources.len();
            let quadratic = matches!(data.objective(), Objective::Quadratic { .. });
            let rows = objective_rows(data.objective(), n);
            sources.extend((0..rows).map(|row| ConstraintSource::Objective { level, row }));
            levels.push(LevelRows {
                constraints: start..middle,
                objective: middle..middle + rows,
                used: rows,
                weighted: false,
                quadratic,
                has_linear: false,
                linear: vec![0.0; if quadratic { n } else { 0 }],
            });
        }
        let count = sources.len();
        Self {
            n,
            coefficients: vec![0.0; (count - n) * n],
            lower: vec![0.0; count],
            upper: vec![0.0; count],
            norms: vec![1.0; count],
            relative_rounding: vec![ROUNDING; count],
            bound_rounding: vec![0.0; count],
            scales: vec![1.0; count],
            scaled: false,
            sources,
            levels,
            factor: QuadraticFactor::new(n),
        }
    }

    /// Checks the data of a hierarchy.
    pub(crate) fn validate(hierarchy: &Hierarchy) -> Result<(), Error> {
        Self::new(hierarchy).load(hierarchy).map_err(|error| hierarchy.named(error))
    }

    pub(crate) fn len(&self) -> usize {
        self.sources.len()
    }

    pub(crate) fn row(&self, id: usize) -> RowView<'_> {
        if id < self.n {
            RowView::unit(id)
        } else {
            let start = (id - self.n) * self.n;
            RowView::dense(&self.coefficients[start..start + self.n], self.norms[id])
        }
    }

    /// The norm of row `id`.
    pub(crate) fn norm(&self, id: usize) -> f64 {
        self.norms[id]
    }

    /// Returns the coefficients of row `id`, which is no bound.
    pub(crate) fn coefficients(&self, id: usize) -> &[f64] {
        let start = (id - self.n) * self.n;
        &self.coefficients[start..start + self.n]
    }

    /// Computes aᵢx for the rows in `ids`, none of them a bound, into the same places of `out`.
    pub(crate) fn multiply(&self, ids: Range<usize>, x: &[f64], out: &mut [f64]) {
        if !ids.is_empty() {
            let data = &self.coefficients[(ids.start - self.n) * self.n..];
            multiply_rows(data, self.n, x, &mut out[ids]);
        }
    }

    /// Computes aᵢx for all rows in use.
    pub(crate) fn multiply_all(&self, x: &[f64], out: &mut [f64]) {
        let mut start = self.n;
        for LevelRows { objective, used, .. } in &self.levels {
            if *used < objective.len() {
                self.multiply(start..objective.start + used, x, out);
                start = objective.end;
            }
        }
        self.multiply(start..self.len(), x, out);
    }

    pub(crate) fn is_equality(&self, id: usize) -> bool {
        self.lower[id] == self.upper[id]
    }

    /// Copies and checks the data of a hierarchy of the same shape.
    pub(crate) fn load(&mut self, hierarchy: &Hierarchy) -> Result<(), Error> {
        self.check_shape(hierarchy)?;
        self.lower[..self.n].copy_from_slice(hierarchy.lower());
        self.upper[..self.n].copy_from_slice(hierarchy.upper());
        self.check_ranges(0..self.n)?;
        for (level, data) in hierarchy.levels().iter().enumerate() {
            let (start, rows) = (self.levels[level].constraints.start, data.constraints());
            if !rows.is_empty() {
                self.load_rows(start, rows, rows.len())?;
                self.scale_rows(start..start + rows.len())?;
            }
            let start = self.levels[level].objective.start;
            match data.objective() {
                Objective::None => {}
                Objective::LeastSquares(rows) => {
                    let used = used_rows(rows);
                    self.leave_out_behind(level, used);
                    self.load_rows(start, rows, used)?;
                    self.scale_by_weights(level, rows)?;
                }
                Objective::Quadratic { hessian, gradient } => {
                    self.factor.factorise(level, hessian, gradient)?;
                    self.take_factor(level);
                }
            }
        }
        Ok(())
    }

    /// Converts multipliers of a quadratic level's rows in the table to multipliers of its
    /// Hessian's rows.
    pub(crate) fn hessian_multipliers(
        &mut self,
        level: usize,
        objective: &Objective,
        multipliers: &[f64],
    ) -> Result<Vec<(usize, f64)>, Error> {
        let Objective::Quadratic { hessian, gradient } = objective else { return Ok(Vec::new()) };
        self.factor.factorise(level, hessian, gradient)?;
        Ok(self.factor.to_hessian_rows(multipliers))
    }

    fn check_shape(&self, hierarchy: &Hierarchy) -> Result<(), Error> {
        let levels = hierarchy.levels();
        if hierarchy.variables() != self.n || levels.len() != self.levels.len() {
            return Err(shape_changed(self.levels.len().min(levels.len())));
        }
        for (level, (data, rows)) in levels.iter().zip(&self.levels).enumerate() {
            let quadratic = matches!(data.objective(), Objective::Quadratic { .. });
            let is_narrow = |rows: &Rows| !rows.is_empty() && rows.columns() != self.n;
            if data.constraints().len() != rows.constraints.len()
                || is_narrow(data.constraints())
                || matches!(data.objective(), Objective::LeastSquares(rows) if is_narrow(rows))
                || quadratic != rows.quadratic
                || objective_rows(data.objective(), self.n) != rows.objective.len()
            {
                return Err(shape_changed(level));
            }
        }
        Ok(())
    }

    /// Leaves out all rows of an objective except the first `used`, by setting them to zero.
    fn leave_out_behind(&mut self, level: usize, used: usize) {
        let (n, entry) = (self.n, &mut self.levels[level]);
        let before = std::mem::replace(&mut entry.used, used);
        if used < before {
            let left_out = entry.objective.start + used..entry.objective.start + before;
            self.coefficients[(left_out.start - n) * n..(left_out.end - n) * n].fill(0.0);
            self.norms[left_out].fill(0.0);
        }
    }

    /// Copies the first `used` rows and all bounds, and checks them.
    fn load_rows(&mut self, start: usize, rows: &Rows, used: usize) -> Result<(), Error> {
        let (all, ids) = (start..start + rows.len(), start..start + used);
        let first = (start - self.n) * self.n;
        let (coefficients, rest) = rows.coefficients().split_at(used * self.n);
        let block = &mut self.coefficients[first..first + used * self.n];
        block.copy_from_slice(coefficients);
        square_rows(block, self.n, &mut self.norms[ids.clone()]);
        self.lower[all.clone()].copy_from_slice(rows.lower());
        self.upper[all.clone()].copy_from_slice(rows.upper());
        self.check_ranges(all)?;
        for id in ids.clone() {
            let square = self.norms[id];
            let is_moderate = square < MODERATE_SQUARE;
            if !is_moderate {
                self.check_row(id, self.coefficients(id))?;
            }
            self.norms[id] = square.sqrt();
        }
        let are_moderate = square(rest) < MODERATE_SQUARE;
        if !are_moderate {
            let mut left_out = (ids.end..).zip(rest.chunks_exact(self.n));
            left_out.try_for_each(|(id, row)| self.check_row(id, row))?;
        }
        Ok(())
    }

    /// Multiplies rows of an objective, and their bounds, by the roots of their weights.
    fn scale_by_weights(&mut self, level: usize, rows: &Rows) -> Result<(), Error> {
        let LevelRows { objective, weighted, .. } = &mut self.levels[level];
        if rows.weights().is_none() && !*weighted {
            return Ok(());
        }
        *weighted = true;
        for (index, id) in objective.clone().enumerate() {
            let scale = rows.weight(index).sqrt();
            self.scale_row(id, scale);
            if scale == 0.0 {
                (self.lower[id], self.upper[id]) = (f64::NEG_INFINITY, f64::INFINITY);
            }
            // Rows that are not scaled were checked when they were loaded.
            if scale != 1.0 {
                self.check_row(id, self.coefficients(id))?;
                self.check_range(id)?;
            }
        }
        Ok(())
    }

    /// Multiplies a row and its bounds.
    fn scale_row(&mut self, id: usize, scale: f64) {
        self.scales[id] = scale;
        if scale != 1.0 {
            let start = (id - self.n) * self.n;
            for entry in &mut self.coefficients[start..start + self.n] {
                *entry *= scale;
            }
            self.norms[id] *= scale;
            self.lower[id] *= scale;
            self.upper[id] *= scale;
        }
    }

    /// Scales rows whose norms are far from 1 to near 1, without rounding.
    fn scale_rows(&mut self, ids: Range<usize>) -> Result<(), Error> {
        let norms = self.norms[ids.clone()].iter();
        let fine = norms.fold(true, |fine, &norm| fine & NEAR_ONE.contains(&norm));
        if fine && !self.scaled {
            return Ok(());
        }
        self.scaled = true;
        for id in ids {
            self.scale_row(id, to_near_one(self.norms[id]));
            self.expect_moderate_bounds(id)?;
        }
        Ok(())
    }

    /// Returns the factor that row `id` was multiplied by.
    pub(crate) fn scale(&self, id: usize) -> f64 {
        self.scales[id]
    }

    /// Returns an error if an entry of a row is not finite or very large.
    fn check_row(&self, id: usize, row: &[f64]) -> Result<(), Error> {
        if let Some(entry) = row.iter().position(|value| !value.is_finite()) {
            let source_of_row = self.sources[id];
            return Err(Error::not_finite("the matrix", source_of_row, entry, row[entry]));
        }
        self.expect_moderate(id, norm_max(row))
    }

    fn expect_moderate(&self, id: usize, value: f64) -> Result<(), Error> {
        if value.abs() <= MODERATE {
            Ok(())
        } else {
            Err(Error::too_large(self.sources[id], value))
        }
    }

    /// Checks the bound nearer to zero. A distant bound only means that its side is free.
    fn expect_moderate_bounds(&self, id: usize) -> Result<(), Error> {
        let (lower, upper) = (self.lower[id], self.upper[id]);
        self.expect_moderate(id, if lower > 0.0 { lower } else { upper.min(0.0) })
    }

    #[expect(clippy::needless_bitwise_bool, reason = "no branches while all are valid")]
    fn check_ranges(&self, ids: Range<usize>) -> Result<(), Error> {
        let bounds = self.lower[ids.clone()].iter().zip(&self.upper[ids.clone()]);
        let fine = bounds.fold(true, |fine, (&lower, &upper)| {
            fine & (lower <= upper) & (lower <= MODERATE) & (upper >= -MODERATE)
        });
        if fine { Ok(()) } else { ids.into_iter().try_for_each(|id| self.check_range(id)) }
    }

    fn check_range(&self, id: usize) -> Result<(), Error> {
        let (lower, upper) = (self.lower[id], self.upper[id]);
        // This form is false for NaN. An equality with an infinite bound is invalid.
        if lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY {
            self.expect_moderate_bounds(id)
        } else {
            let source_of_row = self.sources[id];
            Err(if lower.is_nan() {
                Error::nan_bound("the lower bound", source_of_row)
            } else if upper.is_nan() {
                Error::nan_bound("the upper bound", source_of_row)
            } else {
                Error::EmptyRange { source_of_row, lower, upper, names: Names::default() }
            })
        }
    }

    /// Writes ½xᵀHx + gᵀx as ½‖Rx − b‖² + linearᵀx + constant, from the current factorisation.
    fn take_factor(&mut self, level: usize) {
        let (n, rank) = (self.n, self.factor.rank());
        let entry = &mut self.levels[level];
        entry.used = rank;
        entry.has_linear = self.factor.linear(&mut entry.linear);
        for offset in 0..rank {
            let id = entry.objective.start + offset;
            let at = (id - n) * n;
            let (row, target) = self.factor.row(offset);
            self.coefficients[at..at + n].copy_from_slice(row);
            self.norms[id] = norm(row);
            let (amplification, bound_rounding) = self.factor.rounding(offset);
            self.relative_rounding[id] = ROUNDING * amplification;
            self.bound_rounding[id] = bound_rounding;
            (self.lower[id], self.upper[id]) = (target, target);
        }
        let unused = entry.used_objective().end..entry.objective.end;
        self.lower[unused.clone()].fill(f64::NEG_INFINITY);
        self.upper[unused].fill(f64::INFINITY);
    }
}

/// Returns the bound at which an active row is held, or towards which it is pulled.
pub(crate) fn active_bound(data: &ProblemData, activity: &[Activity], id: usize) -> f64 {
    match activity[id] {
        Activity::Lower => data.lower[id],
        _ => data.upper[id],
    }
}

/// Returns the power of two that brings a number to between 1 and 2. It is 1 for zero, and for
/// numbers near one.
fn to_near_one(number: f64) -> f64 {
    const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;
    const BIAS: u64 = 1023;
    // The bits of a positive number are its exponent and its fraction.
    let exponent = number.to_bits() >> FRACTION;
    if exponent == 0 || NEAR_ONE.contains(&number) {
        1.0
    } else {
        f64::from_bits((2 * BIAS).saturating_sub(exponent) << FRACTION)
    }
}

fn shape_changed(level: usize) -> Error {
    Error::ShapeChanged { level: LevelId::new(level), names: Names::default() }
}

/// Returns the number of rows of an objective up to the last one that bounds something.
fn used_rows(rows: &Rows) -> usize {
    let bounds = rows.lower().iter().zip(rows.upper()).enumerate();
    let is_used = |(index, (&lower, &upper)): (usize, (&f64, &f64))| {
        (lower != f64::NEG_INFINITY || upper != f64::INFINITY) && rows.weight(index) != 0.0
    };
    bounds.rev().find(|&row| is_used(row)).map_or(0, |(index, _)| index + 1)
}

fn objective_rows(objective: &Objective, variables: usize) -> usize {
    match objective {
        Objective::None => 0,
        Objective::LeastSquares(rows) => rows.len(),
        Objective::Quadratic { .. } => variables,
    }
}
