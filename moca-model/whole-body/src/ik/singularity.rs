//! Damping of targets near singular configurations.

mod curvature_rows;
mod directions;
#[cfg(test)]
mod tests;

use std::ops::Range;

use ahqp_core::Rows;

use self::curvature_rows::CurvatureRows;
use self::directions::Directions;
use crate::error::Error;
use crate::tasks::curvature::Curvature;
use crate::vector::p;
use crate::eigen::eigenvectors;
use crate::vector::{dot, subtract};

/// Takes from the targets of levels what their rows reach only by very large velocities, and hands
/// directions that a level loses over to the levels below.
///
/// Level by level, highest priority first, the rows are scaled to norm one and freed of what the
/// rows above determine; G = P Pᵀ then has the squared singular values σ² of what is left to the
/// level, and p² = 1/tr G⁻¹ is a lower bound of the least. Where p is above the threshold σ₀ nothing
/// changes. Below, with W the weights of the scaled rows over the largest and uₖ, σₖ² the eigenvectors
/// and eigenvalues of W^½ G W^½, of what is missing to the targets along uₖ the part
/// (μ²/(σₖ² + μ²))³ is given up: damped least squares (Nakamura and Hanafusa, Journal of Dynamic
/// Systems, Measurement and Control 108, 1986), iterated twice so that well-conditioned directions
/// keep all but (μ/σ)⁶ of their targets (King and Chillingworth, Numerical Functional Analysis and
/// Optimization 1(5), 1979), and
///
/// > μ² = ((σ₀/12)² + ((‖r‖/2v)² + ‖r‖/κ) max(0, 1 − v²/s²)) (1 − p²/σ₀²),
///
/// r being what is missing to the scaled targets, s = ‖L⁻¹r‖ the speed that they take and v = 1
/// rad/s: near a singular configuration a fast target is given up to where joints need not go
/// faster than about v, and κ = 5 1/s bounds how fast their velocities change with the configuration,
/// so that they can stop there. Rows that contradict each other keep their weighted compromise.
///
/// A level that keeps a direction as an equality up to σ = 0 would let go of it at once there, and
/// take it back as soon as the levels below have moved: the robot trembles. So where p < 3σ₀/10 the
/// rows are turned along the uₖ, which leaves the weighted squares as they are, and those of σₖ < σ₀/10
/// become ranges, within which the levels below move at up to v_f (1 − 10 σₖ/σ₀), v_f = 0.05 rad/s,
/// times min(1, (9 − 100 p²/σ₀²)/8). All is continuous in the configuration.
///
/// The levels stay rows with other targets: priorities and limits are not touched.
#[derive(Debug, Clone)]
pub(super) struct SingularityDamping {
    threshold: f64,
    directions: Directions,
    /// p²/σ₀² of the level at hand: below one where it is singular.
    closeness: f64,
    /// The largest weight of its scaled rows.
    heaviest: f64,
    /// √(weight · norm² over the largest).
    scales: Vec<f64>,
    gram: Vec<f64>,
    given_up: Vec<f64>,
    /// By direction uₖ: its coordinates along the rows.
    vectors: Vec<f64>,
    /// By direction: σₖ, and the direction vₖ of the joints that belongs to it.
    sigmas: Vec<f64>,
    joints: Vec<f64>,
    /// By direction: what is given up along uₖ.
    parts: Vec<f64>,
    /// The same without what the rows of curvature take.
    reductions: Vec<f64>,
    /// That of one direction, and the rows of what takes the place of damping.
    curvature: Curvature,
    newton: CurvatureRows,
    velocities: usize,
    room: Vec<f64>,
    columns: usize,
    /// The rows along the directions uₖ, and their targets.
    turned: Vec<f64>,
    turned_targets: Vec<f64>,
    /// Weights of turned rows: theirs are in the rows.
    unit_weights: Vec<f64>,
}

/// Of the largest weight, what the others count as at least here.
const LIGHTEST: f64 = 1e-12;
/// Norm of velocities above which a singular level is damped more than it must be at least
/// \[rad/s, m/s\].
const SPEED: f64 = 1.0;
/// How fast a singular direction may come and go \[1/s\]; with an order of 3, three times as fast.
const RATE: f64 = 5.0;
/// Of the threshold, the least damping of a singular level.
const LEAST: f64 = 1.0 / 12.0;
/// How often the damping is applied.
const ORDER: i32 = 3;
/// How fast the joints leave a singular configuration at most \[rad/s, m/s\].
const SPEED_AWAY: f64 = 5.0;
/// The same over what is missing: what is nearly there does not make joints race.
const QUICKNESS: f64 = 100.0;
/// By how much σₖ falls along vₖ, where the end of the reach is in full.
const BEND: f64 = 0.1;
/// A direction with a smaller singular value is rounding.
const ROUNDING: f64 = 1e-12;
/// Of the threshold, the singular value below which a direction is handed over.
const HANDOVER: f64 = 0.1;
/// Of that, where p is when rows begin to be turned.
const GATE: f64 = 3.0;
/// How fast levels below may move along a direction that is lost \[rad/s, m/s\].
const FREE_SPEED: f64 = 0.05;

impl SingularityDamping {
    /// For levels of so many rows each, over so many variables.
    pub(super) fn new(threshold: f64, levels: &[usize], columns: usize, velocities: usize) -> Self {
        let total = levels.iter().sum::<usize>() + levels.len() * velocities;
        let (total, most) = (total, levels.iter().copied().max().unwrap_or(0));
        Self {
            threshold,
            directions: Directions::new(total, most, columns),
            closeness: f64::INFINITY,
            heaviest: 1.0,
            scales: vec![1.0; most],
            gram: vec![0.0; most * most],
            given_up: vec![0.0; most],
            vectors: vec![0.0; most * most],
            sigmas: vec![1.0; most],
            joints: vec![0.0; most * columns],
            parts: vec![0.0; most],
            reductions: vec![0.0; most],
            curvature: Curvature::new(velocities),
            newton: CurvatureRows::new(velocities),
            velocities,
            room: vec![0.0; velocities],
            columns,
            turned: vec![0.0; most * columns],
            turned_targets: vec![0.0; most],
            // A level has at most as many further rows as there are variables.
            unit_weights: vec![1.0; most + columns],
        }
    }

    /// Forgets all levels.
    pub(super) fn begin(&mut self) {
        self.directions.clear();
    }

    /// Takes the next level, highest priority first, of whose rows the first `m` count; returns their
    /// places among the rows of all levels. A level with ranges has none, and is left as it is.
    pub(super) fn load(&mut self, rows: &Rows, m: usize, free: &[f64]) -> Range<usize> {
        let fits = self.threshold > 0.0 && m <= self.scales.len() && m <= rows.len();
        let equalities = rows.lower().iter().zip(rows.upper()).take(m).all(|(l, u)| l == u);
        let extra = rows.len().saturating_sub(m);
        if !(fits && equalities) {
            return self.directions.push(rows, 0, 0, free);
        }
        self.directions.push(rows, m, extra, free)
    }

    /// Finds out what each level determines, when all are loaded.
    pub(super) fn factorise(&mut self) {
        self.directions.scale();
    }

    /// Looks at the next level, whose rows have these places, and returns true if it is singular.
    pub(super) fn examine(&mut self, span: &Range<usize>, rows: &Rows) -> bool {
        self.directions.factorise(span);
        let trace = self.directions.inverse_trace(span);
        self.closeness = 1.0 / (trace * self.threshold * self.threshold);
        if self.closeness >= 1.0 {
            return false;
        }
        let m = span.len();
        self.directions.gram_into(span, &mut self.gram[..m * m]);
        self.heaviest = self.weigh(span, rows);
        eigenvectors(&mut self.gram[..m * m], m, &mut self.vectors[..m * m]);
        for k in 0..m {
            let vector = &self.vectors[k * m..][..m];
            let factors = self.given_up.iter_mut().zip(vector).zip(&self.scales);
            factors.for_each(|((factor, part), scale)| *factor = part * scale);
            let joints = &mut self.joints[k * self.columns..][..self.columns];
            self.directions.combine(span, &self.given_up[..m], joints);
            // More exact than the root of the eigenvalue.
            let norm = dot(joints, joints).sqrt();
            self.sigmas[k] = norm;
            let scale = if norm > ROUNDING { 1.0 / norm } else { 0.0 };
            joints.iter_mut().for_each(|part| *part *= scale);
        }
        true
    }

    /// Finds what is to be given up of the targets of a singular level.
    pub(super) fn bound(
        &mut self,
        span: &Range<usize>,
        has_room: bool,
        free: &[f64],
        mut add_curvature: impl FnMut(&[f64], &mut Curvature) -> Result<bool, Error>,
    ) -> Result<(), Error> {
        let m = span.len();
        let square = self.damping(span) * (1.0 - self.closeness);
        self.newton.curvature.clear();
        for k in 0..m {
            let sigma = self.sigmas[k];
            let vector = &self.vectors[k * m..][..m];
            let weighted = vector.iter().zip(self.directions.residual(span)).zip(&self.scales);
            let missing: f64 = weighted.map(|((u, r), scale)| u * r * scale).sum();
            let share = 1.0 - (sigma / self.threshold).powi(2);
            (self.parts[k], self.reductions[k]) = (0.0, 0.0);
            if share <= 0.0 || missing == 0.0 {
                continue;
            }
            let factors = self.given_up.iter_mut().zip(vector).zip(&self.scales);
            for (((factor, u), scale), norm) in factors.zip(self.directions.norms(span)) {
                *factor = u * scale / norm;
            }
            self.curvature.clear();
            if !add_curvature(&self.given_up[..m], &mut self.curvature)? {
                let part = missing * (square / (square + sigma * sigma)).powi(ORDER);
                (self.parts[k], self.reductions[k]) = (part, part);
                continue;
            }
            let most = SPEED_AWAY.min(QUICKNESS * missing.abs()) / share;
            let joints = &self.joints[k * self.columns..][..self.velocities];
            let towards = self.curvature.along(joints) * missing.signum();
            if sigma > crate::vector::p(14, 1e-12) && towards <= 0.0 {
                let part = missing - missing.max(-most * sigma).min(most * sigma);
                (self.parts[k], self.reductions[k]) = (part, part);
                continue;
            }
            if sigma <= crate::vector::p(14, 1e-12) && !has_room {
                (self.parts[k], self.reductions[k]) = (missing, missing);
                continue;
            }
            let time = 1.0 / p(1, 10.0);
            let (speed, rate) = if sigma > crate::vector::p(14, 1e-12) {
                let distance = sigma / towards;
                let speed = 2.0 * distance / (time + (time * time + 2.0 * distance / p(2, 5.0)).sqrt());
                let speed = most.min(speed / share);
                (speed, speed / distance)
            } else { (0.0, 1.0 / time) };
            let part = missing - missing.max(-speed * sigma).min(speed * sigma);
            self.parts[k] = part;
            if has_room && p(0, 1.0) > 0.0 {
                let rate = if p(3, 1.0) > 0.0 { 1.0 / time } else { rate };
                self.newton.curvature.add_scaled(&self.curvature, part * self.heaviest / rate);
            } else {
                self.reductions[k] = part;
            }
        }
        if crate::vector::trace() { eprintln!("  level at {} free {:?}", span.start, free.iter().map(|f| (f*100.0).round()/100.0).collect::<Vec<_>>());
            for k in 0..m { let joints = &self.joints[k * self.columns..][..self.velocities];
              eprintln!("   k {k} sigma {:.2e} part {:.3} red {:.3} Hvv {:.3} v {:.2?}", self.sigmas[k], self.parts[k], self.reductions[k], self.newton.curvature.along(joints), joints); } }
        self.newton.curvature.scale(free);
        if p(4, 0.0) > 0.0 && !self.newton.curvature.is_zero() {
            for k in 0..m {
                let kept = (self.sigmas[k] / self.threshold).powi(2).min(1.0);
                let joints = &self.joints[k * self.columns..][..self.velocities];
                self.newton.curvature.project(joints, kept, &mut self.room);
            }
        }
        Ok(())
    }

    /// Damps the targets of a level that was [examined](Self::examine), whose rows have these places. Returns true
    /// if that changed them; what was asked is in `asked`, rows of the same size, then.
    pub(super) fn damp(
        &mut self,
        span: &Range<usize>,
        is_singular: bool,
        rows: &mut Rows,
        asked: &mut Rows,
        free: &[f64],
    ) -> bool {
        let is_singular = is_singular && asked.copy_from(rows).is_ok();
        if is_singular {
            self.give_up(span, rows);
        }
        if span.len() < rows.len() {
            if !is_singular { self.newton.curvature.clear(); }
            let count = self.newton.write(rows, span.len());
            let end = span.end + rows.len() - span.len();
            let written = (span.len()..).take(count).filter_map(|index| rows.row(index));
            if crate::vector::p(16, 1.0) > 0.0 { self.directions.append(span.end, written, free); }
            let count = if crate::vector::p(16, 1.0) > 0.0 { count } else { 0 }; self.directions.factorise(&(span.end + count..end));
        }
        self.directions.take(span);
        is_singular
    }

    /// μ² of a level that is singular.
    fn damping(&mut self, span: &Range<usize>) -> f64 {
        // (s/v)², s being the norm of the velocities that the targets take.
        let room = &mut self.given_up[..span.len()];
        let excess = self.directions.square_of_speed(span, room) / (SPEED * SPEED);
        let residual = self.directions.residual(span);
        let square = dot(residual, residual);
        let bound = 0.25 * square / (SPEED * SPEED) + square.sqrt() / RATE;
        let least = LEAST * self.threshold;
        least * least + bound * (1.0 - 1.0 / excess.max(1.0))
    }

    /// Gives up what takes large velocities.
    fn give_up(&mut self, span: &Range<usize>, rows: &mut Rows) {
        let m = span.len();
        for all in [true, false] {
            let parts = if all { &self.parts } else { &self.reductions };
            self.given_up[..m].fill(0.0);
            for (k, part) in parts.iter().enumerate().take(m) {
                subtract(&mut self.given_up[..m], -part, &self.vectors[k * m..][..m]);
            }
            let given_up = &mut self.given_up[..m];
            given_up.iter_mut().zip(&self.scales).for_each(|(part, scale)| *part /= scale);
            if all {
                subtract(self.directions.residual_mut(span), 1.0, given_up);
                continue;
            }
            given_up.iter_mut().zip(self.directions.norms(span)).for_each(|(part, norm)| *part *= norm);
            subtract(&mut rows.lower_mut()[..m], 1.0, given_up);
            subtract(&mut rows.upper_mut()[..m], 1.0, given_up);
        }
        let lost = self.closeness / (GATE * HANDOVER).powi(2);
        if lost < 1.0 && (0..m).all(|row| rows.weight(row) > 0.0) {
            let share = (1.0 - lost) * GATE * GATE / (GATE * GATE - 1.0);
            self.hand_over(span, self.heaviest, share.min(1.0), rows);
        }
    }

    /// Turns the rows along the directions, and makes ranges of those that are lost, so wide as a
    /// `share` says.
    fn hand_over(&mut self, span: &Range<usize>, heaviest: f64, share: f64, rows: &mut Rows) {
        let (m, columns, root) = (span.len(), rows.columns(), heaviest.sqrt());
        let norms = self.directions.norms(span);
        self.turned[..m * columns].fill(0.0);
        for (vector, (turned, target)) in self
            .vectors
            .chunks_exact(m)
            .zip(self.turned.chunks_exact_mut(columns).zip(&mut self.turned_targets))
        {
            *target = 0.0;
            for (i, (row, own, _)) in rows.iter().enumerate().take(m) {
                let factor = root * vector[i] * self.scales[i] / norms[i];
                subtract(turned, -factor, row);
                *target += factor * own;
            }
        }
        let handover = HANDOVER * self.threshold;
        for k in 0..m {
            let sigma = self.sigmas[k];
            let room = root * FREE_SPEED * share * (1.0 - sigma / handover).max(0.0) * sigma;
            if let Ok(row) = rows.row_mut(k) {
                row.copy_from_slice(&self.turned[k * columns..][..columns]);
            }
            let mut target = self.turned_targets[k];
            if sigma <= crate::vector::p(14, 1e-12) {
                rows.row_mut(k).unwrap_or_default().fill(0.0);
                target = 0.0;
            }
            (rows.lower_mut()[k], rows.upper_mut()[k]) = (target - room, target + room);
        }
        // Of the size of the rows, and positive: no error is possible.
        let _ = rows.set_weights(&self.unit_weights[..rows.len()]);
    }

    /// Weighs G, and returns the largest weight of a scaled row.
    fn weigh(&mut self, span: &Range<usize>, rows: &Rows) -> f64 {
        let (m, norms) = (span.len(), self.directions.norms(span));
        let heaviness = |row: usize| rows.weight(row) * norms[row] * norms[row];
        let largest = (0..m).map(heaviness).fold(0.0, f64::max);
        for row in 0..m {
            let part = if largest > 0.0 { heaviness(row) / largest } else { 1.0 };
            self.scales[row] = part.max(LIGHTEST).sqrt();
        }
        for i in 0..m {
            for j in 0..m {
                self.gram[i * m + j] *= self.scales[i] * self.scales[j];
            }
        }
        largest
    }
}
