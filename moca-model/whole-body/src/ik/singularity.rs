//! Damping of targets near singular configurations.

mod curvature_rows;
mod directions;
#[cfg(test)]
mod tests;

use std::ops::Range;

use ahqp_core::Rows;

use self::curvature_rows::CurvatureRows;
use self::directions::Directions;
use crate::eigen::eigenvectors;
use crate::error::Error;
use crate::tasks::curvature::Curvature;
use crate::tasks::feedback::Feedback;
use crate::vector::{dot, subtract};

/// Damps the targets of levels that are reachable only by very large velocities. Directions that a level loses are left
/// to the levels below.
///
/// Levels are treated one by one, highest priority first. Their rows are scaled to norm one (small rows to less) and
/// projected on what the rows above leave, which gives P. The eigenvalues of G = P Pᵀ are the squared singular values
/// σ², and p² = 1/tr G⁻¹ is a lower bound of the least. A level with p above the threshold σ₀ is left as it is. The
/// others are damped with these quantities:
///
/// - W are the weights of the scaled rows over the largest;
/// - uₖ, σₖ² and vₖ are the eigenvectors and eigenvalues of W^½ G W^½ and the matching directions of the joints;
/// - rₖ is the residual of the targets along uₖ;
/// - y is what the rows control, and cₖ = −uₖ · y″(vₖ, vₖ) sign rₖ.
///
/// Along each uₖ alone the joints move at up to
///
/// > min(5 rad/s, 100 |rₖ|) / (1 − σₖ²/σ₀²)
///
/// where they leave the singular configuration (cₖ ≤ 0). The rest of rₖ is given up.
///
/// Where they come to the end of the reach (cₖ > 0), 100 |rₖ| is replaced by a speed. It is the speed from which they
/// can stop within σₖ/cₖ, at 20 1/s and 5 rad/s². There the rest gₖ is not given up. Instead rows √λ dᵀ q̇ = 0 are
/// added. The pairs λ, d are the positive eigenvalues and the eigenvectors of −Σ gₖ uₖ · y″ / (20 1/s). Directions of
/// this level and those above are removed from them. That is Newton's step towards the least distance, at which the
/// level rests without oscillating.
///
/// Where y″ is not known, the part (μ²/(σₖ² + μ²))³ of rₖ is given up. This is damped least squares (Nakamura and
/// Hanafusa, Journal of Dynamic Systems, Measurement and Control 108, 1986), iterated twice. Well-conditioned
/// directions then keep all but (μ/σ)⁶ of their targets (King and Chillingworth, Numerical Functional Analysis and
/// Optimization 1(5), 1979). The damping is
///
/// > μ² = ((σ₀/12)² + ((‖r‖/2v)² + ‖r‖/κ) max(0, 1 − v²/s²)) (1 − p²/σ₀²).
///
/// Here r is the residual of the scaled targets, s = ‖L⁻¹r‖ the speed that they need, v = 1 rad/s and κ = 5 1/s. Rows
/// that contradict each other keep their weighted compromise.
///
/// A level that keeps a direction as an equality down to σ = 0 would release it abruptly there. It would take the
/// direction back as soon as the levels below have moved, and the robot would tremble. So where p < 3σ₀/10, the rows
/// are rotated to the uₖ, which keeps the weighted squares. Rows with σₖ < σ₀/10 become ranges. Within them the levels
/// below move at up to v_f (1 − 10 σₖ/σ₀) min(1, (9 − 100 p²/σ₀²)/8), v_f = 0.05 rad/s. The damping has no memory of
/// earlier steps.
///
/// Levels stay rows with other targets, so that priorities and limits are not affected.
#[derive(Debug, Clone)]
pub(super) struct SingularityDamping {
    threshold: f64,
    directions: Directions,
    /// p²/σ₀² of the present level, below one where it is singular.
    closeness: f64,
    /// The largest weight of the level's scaled rows.
    heaviest: f64,
    /// √(weight · norm² over the largest) of each row.
    scales: Vec<f64>,
    gram: Vec<f64>,
    given_up: Vec<f64>,
    /// Coordinates of each direction uₖ along the rows.
    vectors: Vec<f64>,
    /// σₖ of each direction uₖ, and its direction vₖ of the joints.
    sigmas: Vec<f64>,
    joints: Vec<f64>,
    columns: usize,
    /// The missing part along each uₖ, and the share of it that is given up.
    parts: Vec<f64>,
    given_up_parts: Vec<f64>,
    had: Vec<f64>,
    /// Curvature of what the rows control: along one direction, and the rows of all.
    curvature: Curvature,
    bent: CurvatureRows,
    /// Rows rotated to the directions uₖ, and their targets.
    turned: Vec<f64>,
    turned_targets: Vec<f64>,
    /// Weights of rotated rows, which contain the original weights.
    unit_weights: Vec<f64>,
}

/// Smallest weight over the largest one that a row counts with here.
const LIGHTEST: f64 = 1e-12;
/// Norm of velocities above which a singular level is damped more than the least \[rad/s, m/s\].
const SPEED: f64 = 1.0;
/// Rate at which a singular direction may come and go \[1/s\]; with an order of 3, three times this rate.
const RATE: f64 = 5.0;
/// Least damping of a singular level over the threshold.
const LEAST: f64 = 1.0 / 12.0;
/// Number of times that the damping is applied.
const ORDER: i32 = 3;
/// Largest speed of joints that leave a singular configuration \[rad/s, m/s\].
const SPEED_AWAY: f64 = 5.0;
/// Largest speed over the residual \[1/s\], so that a small residual does not cause fast joints.
const QUICKNESS: f64 = 100.0;
/// Feedback by which joints come to rest at the end of the reach.
const END: Feedback = Feedback { gain: 20.0, deceleration: 5.0 };
/// Singular values below which the way out is not known, and below which there is none.
const UNKNOWN: f64 = 1e-6;
const NONE: f64 = 1e-12;
/// Singular value over the threshold below which a direction is left to the levels below.
const HANDOVER: f64 = 0.1;
/// Value of p over that singular value at which rows begin to be rotated.
const GATE: f64 = 3.0;
/// Distance to the end of its range within which a joint counts as at the end \[rad, m\].
const AT_END: f64 = 1e-4;
/// Largest speed of the levels below along a direction that is lost \[rad/s, m/s\].
const FREE_SPEED: f64 = 0.05;

impl SingularityDamping {
    /// Creates the damping for levels of these numbers of rows over `columns` variables.
    pub(super) fn new(threshold: f64, levels: &[usize], columns: usize, velocities: usize) -> Self {
        let (total, most): (usize, _) =
            (levels.iter().sum(), levels.iter().copied().max().unwrap_or(0));
        Self {
            threshold,
            directions: Directions::new(total + 2 * velocities * levels.len(), most, columns),
            closeness: f64::INFINITY,
            heaviest: 1.0,
            scales: vec![1.0; most],
            gram: vec![0.0; most * most],
            given_up: vec![0.0; most],
            vectors: vec![0.0; most * most],
            sigmas: vec![1.0; most],
            joints: vec![0.0; most * columns],
            columns,
            parts: vec![0.0; most],
            given_up_parts: vec![0.0; most],
            had: vec![1.0; most],
            curvature: Curvature::new(velocities),
            bent: CurvatureRows::new(velocities),
            turned: vec![0.0; most * columns],
            turned_targets: vec![0.0; most],
            // A level has at most as many further rows as there are variables.
            unit_weights: vec![1.0; most + columns],
        }
    }

    /// Forgets all levels.
    pub(super) fn begin(&mut self) {
        self.directions.clear();
        self.bent.curvature.clear();
    }

    /// Loads the next level, highest priority first, with its first `m` rows. Returns their places among the rows of
    /// all levels. A level with ranges gets no places and is left as it is.
    pub(super) fn load(&mut self, rows: &Rows, m: usize) -> Range<usize> {
        let fits = self.threshold > 0.0 && m <= self.scales.len() && m <= rows.len();
        let equalities = rows.lower().iter().zip(rows.upper()).take(m).all(|(l, u)| l == u);
        self.directions.push(rows, if fits && equalities { m } else { 0 })
    }

    /// Computes what each level determines, after all are loaded.
    pub(super) fn factorise(&mut self) {
        self.directions.factorise();
    }

    /// Holds joints at the ends of their ranges where the next level, at these places, would move them further. The
    /// level then counts the clamp as a decision above it. `room` is the distance of each joint to its lower and upper
    /// limit. Returns how many joints are held.
    pub(super) fn clamp_ends(
        &mut self,
        span: &Range<usize>,
        rows: &Rows,
        room: impl Iterator<Item = [f64; 2]> + Clone,
        mut clamp: impl FnMut(usize),
    ) -> usize {
        let is_near = |room: f64| room < AT_END;
        if !room.clone().flatten().any(is_near) {
            return 0;
        }
        let residual = self.directions.residual(span).iter().zip(self.directions.norms(span));
        for (row, (factor, (residual, norm))) in self.given_up.iter_mut().zip(residual).enumerate()
        {
            *factor = rows.weight(row) * norm * norm * residual;
        }
        let pulls = &mut self.turned[..self.columns];
        self.directions.combine(span, &self.given_up[..span.len()], pulls);
        let mut held = 0;
        for (entry, ([below, above], pull)) in room.zip(&*pulls).enumerate() {
            let is_end = is_near(if *pull > 0.0 { above } else { below }) && *pull != 0.0;
            if is_end && self.directions.insert(span.start, |row| row[entry] = 1.0) {
                clamp(entry);
                held += 1;
            }
        }
        if held > 0 {
            self.directions.find_coordinates();
        }
        held
    }

    /// Releases `count` joints that are held for the level at these places.
    pub(super) fn release(&mut self, span: &Range<usize>, count: usize) {
        if count > 0 {
            self.directions.remove(span.start - count..span.start);
            self.directions.find_coordinates();
        }
    }

    /// Examines the next level, highest priority first, at these places. Returns true if it is singular.
    pub(super) fn examine(&mut self, span: &Range<usize>, rows: &Rows) -> bool {
        let trace = self.directions.inverse_trace(span);
        self.closeness = 1.0 / (trace * self.threshold * self.threshold);
        if self.closeness >= 1.0 {
            return false;
        }
        let m = span.len();
        self.directions.gram_into(span, &mut self.gram[..m * m]);
        self.heaviest = self.weight_gram(span, rows);
        eigenvectors(&mut self.gram[..m * m], m, &mut self.vectors[..m * m]);
        for k in 0..m {
            let vector = &self.vectors[k * m..][..m];
            let factors = self.given_up.iter_mut().zip(vector).zip(&self.scales);
            factors.for_each(|((factor, part), scale)| *factor = part * scale);
            let joints = &mut self.joints[k * self.columns..][..self.columns];
            self.directions.combine(span, &self.given_up[..m], joints);
            // The norm is more exact than the root of the eigenvalue.
            let norm = dot(joints, joints).sqrt();
            self.sigmas[k] = norm;
            let scale = if norm > NONE { 1.0 / norm } else { 0.0 };
            for part in joints {
                *part *= scale;
            }
        }
        true
    }

    /// The residual along uₖ of a level that was [examined](Self::examine).
    fn missing(&self, span: &Range<usize>, k: usize) -> f64 {
        let vector = &self.vectors[k * span.len()..][..span.len()];
        let weighted = vector.iter().zip(self.directions.residual(span)).zip(&self.scales);
        weighted.map(|((u, r), scale)| u * r * scale).sum()
    }

    /// Damps a singular level in all directions alike.
    pub(super) fn damp(&mut self, span: &Range<usize>) {
        let square = self.damping(span) * (1.0 - self.closeness);
        for k in 0..span.len() {
            let share = square / (square + self.sigmas[k] * self.sigmas[k]);
            let part = self.missing(span, k) * share.powi(ORDER);
            (self.parts[k], self.given_up_parts[k]) = (part, part);
        }
    }

    /// Bounds the speed of a singular level in each direction by its curvature, which `add_curvature` adds for given
    /// factors of its rows.
    pub(super) fn bound(
        &mut self,
        span: &Range<usize>,
        mut add_curvature: impl FnMut(&[f64], &mut Curvature) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let m = span.len();
        for k in 0..m {
            let (sigma, missing) = (self.sigmas[k], self.missing(span, k));
            let share = 1.0 - (sigma / self.threshold).powi(2);
            (self.parts[k], self.given_up_parts[k], self.had[k]) = (0.0, 0.0, 1.0);
            if share <= 0.0 {
                continue;
            }
            if missing == 0.0 {
                self.had[k] = (QUICKNESS * sigma).min(1.0);
                continue;
            }
            let vector = self.vectors[k * m..][..m].iter().zip(&self.scales);
            let factors = self.given_up.iter_mut().zip(vector);
            for ((factor, (u, scale)), norm) in factors.zip(self.directions.norms(span)) {
                *factor = u * scale / norm;
            }
            self.curvature.clear();
            add_curvature(&self.given_up[..m], &mut self.curvature)?;
            let joints = &self.joints[k * self.columns..][..self.columns];
            let towards = self.curvature.along(joints) * missing.signum();
            let most = if towards > 0.0 {
                SPEED_AWAY.min(END.speed(sigma / towards))
            } else {
                SPEED_AWAY.min(QUICKNESS * missing.abs())
            };
            let most = most / share;
            let speed = if sigma > UNKNOWN { most } else { 0.0 };
            let part = (missing.abs() - speed * sigma).max(0.0);
            self.parts[k] = part.copysign(missing);
            self.had[k] = 1.0 - part / missing.abs();
            // The share that rows of curvature hold is not given up.
            let held = part * towards.max(0.0) / END.gain;
            let had = if sigma > UNKNOWN { most * (sigma + held / sigma) } else { 0.0 };
            self.given_up_parts[k] = (missing.abs() - had).max(0.0).copysign(missing);
            if towards <= 0.0 && sigma > UNKNOWN {
                continue;
            }
            let factor = self.parts[k] * self.heaviest / END.gain;
            self.bent.curvature.add_scaled(&self.curvature, factor);
        }
        Ok(())
    }

    /// Writes the damped targets of a singular level that was [examined](Self::examine).
    pub(super) fn give_up(&mut self, span: &Range<usize>, rows: &mut Rows) {
        let m = span.len();
        self.sum(span, false);
        subtract(self.directions.residual_mut(span), 1.0, &self.given_up[..m]);
        self.sum(span, true);
        let given_up = &mut self.given_up[..m];
        given_up.iter_mut().zip(self.directions.norms(span)).for_each(|(part, norm)| *part *= norm);
        subtract(&mut rows.lower_mut()[..m], 1.0, given_up);
        subtract(&mut rows.upper_mut()[..m], 1.0, given_up);
        let lost = self.closeness / (GATE * HANDOVER).powi(2);
        if lost < 1.0 && (0..m).all(|row| rows.weight(row) > 0.0) {
            let share = (1.0 - lost) * GATE * GATE / (GATE * GATE - 1.0);
            self.hand_over(span, self.heaviest, share.min(1.0), rows);
        }
    }

    /// Sums by scaled row what is missing, or the share of it that is given up.
    fn sum(&mut self, span: &Range<usize>, is_given_up: bool) {
        let m = span.len();
        let parts = if is_given_up { &self.given_up_parts } else { &self.parts };
        let given_up = &mut self.given_up[..m];
        given_up.fill(0.0);
        for (part, vector) in parts.iter().zip(self.vectors[..m * m].chunks_exact(m.max(1))) {
            subtract(given_up, -part, vector);
        }
        given_up.iter_mut().zip(&self.scales).for_each(|(part, scale)| *part /= scale);
    }

    /// Writes the rows of curvature of the level that was examined last, from row `first` on. Returns how many were
    /// added behind the level.
    pub(super) fn write_curvature(
        &mut self,
        span: &Range<usize>,
        rows: &mut Rows,
        first: usize,
    ) -> usize {
        if self.bent.curvature.is_zero() {
            self.bent.write(rows, first, 0.0);
            return 0;
        }
        let size = self.bent.curvature.size();
        // Directions that the rows determine are theirs. Where a direction is lost exactly, their share in it is not
        // known.
        if self.sigmas[..first].iter().all(|sigma| *sigma > UNKNOWN) {
            for (joints, had) in self.joints.chunks_exact(self.columns).zip(&self.had[..first]) {
                self.bent.curvature.take_out(joints, *had);
            }
        }
        for above in 0..span.start {
            let direction = &mut self.joints[..self.columns];
            if self.directions.direction_into(above, direction) {
                self.bent.curvature.take_out(direction, 1.0);
            }
        }
        self.bent.write(rows, first, size);
        self.bent.curvature.clear();
        let mut added = 0;
        for index in first..rows.len() {
            let row = rows.row(index).unwrap_or_default();
            let is_there = row.iter().any(|entry| *entry != 0.0);
            let add = |to: &mut [f64]| to.copy_from_slice(row);
            added += usize::from(is_there && self.directions.insert(span.end, add));
        }
        if added > 0 {
            self.directions.find_coordinates();
        }
        added
    }

    /// Subtracts what a level does by itself from the targets below.
    pub(super) fn take(&mut self, span: &Range<usize>) {
        self.directions.take(span);
    }

    /// μ² of a singular level.
    fn damping(&mut self, span: &Range<usize>) -> f64 {
        // (s/v)², where s is the norm of the velocities that the targets need.
        let room = &mut self.given_up[..span.len()];
        let excess = self.directions.square_of_speed(span, room) / (SPEED * SPEED);
        let residual = self.directions.residual(span);
        let square = dot(residual, residual);
        let bound = 0.25 * square / (SPEED * SPEED) + square.sqrt() / RATE;
        let least = LEAST * self.threshold;
        least * least + bound * (1.0 - 1.0 / excess.max(1.0))
    }

    /// Rotates the rows to the directions uₖ. Rows of lost directions become ranges whose width is proportional to
    /// `share`.
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
            if sigma <= NONE {
                rows.row_mut(k).unwrap_or_default().fill(0.0);
                target = 0.0;
            }
            (rows.lower_mut()[k], rows.upper_mut()[k]) = (target - room, target + room);
        }
        // The size is that of the rows and the weights are positive, so no error is possible.
        let _ = rows.set_weights(&self.unit_weights[..rows.len()]);
    }

    /// Weights G, and returns the largest weight of a scaled row.
    fn weight_gram(&mut self, span: &Range<usize>, rows: &Rows) -> f64 {
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
