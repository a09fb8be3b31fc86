//! The minimum of one level.

use super::State;
use super::factors::{Factors, Minimum};
use super::row::{Difference, Kind, Row, Sign};

/// Number of repairs of a guessed active set after which exact arithmetic decides.
const REPAIRS: usize = 20;
/// A gap of a guess below this part of its terms counts as zero, up to the errors of the guess.
const NEAR: f64 = 1e-8;

/// Indices of hard rows that are kept at their bounds, and of soft rows with a force.
struct Active {
    kept: Vec<usize>,
    pulling: Vec<usize>,
}

/// Verdict on an active set.
enum Check {
    Optimal,
    Kept(usize),
    Pulling(usize),
    NotPulling(usize),
    NotKept(usize),
}

impl State {
    /// Moves to a minimum of the level in the directions that the levels above left free, and keeps
    /// what it reaches.
    pub(super) fn minimise(&mut self, soft: Vec<Row>) -> Option<()> {
        if self.fixed.len() == self.x.len() {
            // All directions are decided.
            return self.hard.iter().all(|row| is_held(row, row.gap(&self.x))).then_some(());
        }
        let is_active = |row: &Row, far: fn(Difference) -> bool| {
            row.kind == Kind::Equality || !far(row.gap(&self.x))
        };
        let active_ones = |rows: &[Row], far: fn(Difference) -> bool| -> Vec<usize> {
            (0..rows.len()).filter(|&i| is_active(&rows[i], far)).collect()
        };
        let mut active = Active {
            kept: active_ones(&self.hard, |gap| gap.value.0.abs() > NEAR * gap.terms),
            pulling: active_ones(&soft, |gap| gap.value.0 < -NEAR * gap.terms),
        };
        for _ in 0..REPAIRS {
            let kept = active.kept.iter().map(|&i| &self.hard[i]);
            let rows: Vec<&Row> = kept.chain(active.pulling.iter().map(|&i| &soft[i])).collect();
            let factors = Factors::new(&self.fixed, &rows, active.kept.len())?;
            let minimum = factors.minimum(&self.fixed, &self.x)?;
            match self.check(&active, &soft, &minimum)? {
                Check::Optimal => return self.fix(&active, soft, minimum),
                Check::Kept(i) => active.kept.push(i),
                Check::Pulling(i) => active.pulling.push(i),
                Check::NotPulling(i) => active.pulling.retain(|&j| j != i),
                Check::NotKept(i) => active.kept.retain(|&j| j != i),
            }
        }
        None
    }

    /// Checks an active set. None if a sign is in doubt, or if the active set contradicts itself.
    fn check(&self, active: &Active, soft: &[Row], minimum: &Minimum) -> Option<Check> {
        let (kept_forces, soft_forces) = minimum.forces.split_at(active.kept.len());
        for (i, row) in self.hard.iter().enumerate() {
            let gap = row.gap(&minimum.x);
            let sign = gap.sign()?;
            let place = active.kept.iter().position(|&j| j == i);
            if !is_held(row, gap) {
                return place.is_none().then_some(Check::Kept(i));
            }
            if place.is_some_and(|k| kept_forces[k] != Sign::Zero) && sign != Sign::Zero {
                return None;
            }
        }
        for (i, row) in soft.iter().enumerate() {
            let mut gap = row.gap(&minimum.x);
            if let Some(place) = active.pulling.iter().position(|&j| j == i) {
                gap.value -= minimum.gaps[active.kept.len() + place];
                if gap.sign()? != Sign::Zero {
                    return None;
                }
            } else if gap.sign()? == Sign::Positive {
                return Some(Check::Pulling(i));
            }
        }
        let wrong = |rows: &[Row], active: &[usize], forces: &[Sign]| {
            let mut forces = active.iter().copied().zip(forces);
            let is_wrong = |(i, force): &(usize, &Sign)| {
                rows[*i].kind == Kind::Inequality && **force == Sign::Negative
            };
            forces.find(is_wrong).map(|(i, _)| i)
        };
        if let Some(i) = wrong(soft, &active.pulling, soft_forces) {
            return Some(Check::NotPulling(i));
        }
        if let Some(i) = wrong(&self.hard, &active.kept, kept_forces) {
            return Some(Check::NotKept(i));
        }
        Some(Check::Optimal)
    }

    /// Keeps what the minimum has reached. A row with a positive multiplier is an equality at every
    /// minimum. An inequality without a multiplier stays an inequality.
    fn fix(&mut self, active: &Active, soft: Vec<Row>, minimum: Minimum) -> Option<()> {
        let (kept_forces, soft_forces) = minimum.forces.split_at(active.kept.len());
        let hard = std::mem::take(&mut self.hard);
        let sides = [(hard, &active.kept, kept_forces), (soft, &active.pulling, soft_forces)];
        for (rows, active, forces) in sides {
            let force = |i| active.iter().position(|&j| j == i).map_or(Sign::Zero, |k| forces[k]);
            for (i, row) in rows.into_iter().enumerate() {
                if row.kind == Kind::Equality || force(i) == Sign::Positive {
                    self.fixed.extend(&row.a)?;
                } else {
                    self.hard.push(row);
                }
            }
        }
        self.x = minimum.x;
        Some(())
    }
}

/// Returns true if a hard row with this gap clearly holds.
fn is_held(row: &Row, gap: Difference) -> bool {
    match row.kind {
        Kind::Equality => gap.sign() == Some(Sign::Zero),
        Kind::Inequality => matches!(gap.sign(), Some(Sign::Zero | Sign::Negative)),
    }
}
