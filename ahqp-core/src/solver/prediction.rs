//! Prediction of the next active set.
//!
//! The prediction for a smooth motion is the last active set. If the data are noisy, rows near
//! their bounds come and go, and the usual activity of a row is a better guess. As in branch
//! prediction (`McFarling`, Combining Branch Predictors, 1993) both guesses are kept. The one that
//! was wrong in fewer recent rows is used.

use super::activity::Activity;
use super::tolerances::{JUMP, NEWEST, NEWEST_SCORE};

/// Activity of the rows of a problem in the last solves.
#[derive(Debug, Clone)]
pub(crate) struct Prediction {
    /// Last side of every row: −1 at its lower bound, 1 at its upper bound, otherwise 0.
    last: Vec<f32>,
    /// Mean side of every row.
    mean: Vec<f32>,
    /// Number of solves in the means.
    solves: u16,
    /// Average number of rows in which each guess was wrong.
    last_wrong: f64,
    mean_wrong: f64,
    variables: usize,
}

impl Prediction {
    pub(crate) fn new(rows: usize, variables: usize) -> Self {
        Self {
            last: vec![0.0; rows],
            mean: vec![0.0; rows],
            solves: 0,
            last_wrong: 0.0,
            mean_wrong: 0.0,
            variables,
        }
    }

    /// Forgets earlier solves, since the next one is unrelated to them.
    pub(crate) fn forget(&mut self) {
        (self.solves, self.last_wrong, self.mean_wrong) = (0, 0.0, 0.0);
    }

    /// Overwrites the last active set with the usual activity of each row, if that has been the
    /// better guess.
    pub(crate) fn predict(&self, activity: &mut [Activity]) {
        if self.mean_wrong < self.last_wrong {
            for (state, &mean) in activity.iter_mut().zip(&self.mean) {
                *state = match side(mean) {
                    1.0 => Activity::Upper,
                    -1.0 => Activity::Lower,
                    _ => Activity::Inactive,
                };
            }
        }
    }

    /// Takes the active set at the end of a solve.
    pub(crate) fn learn(&mut self, activity: &[Activity]) {
        self.solves = self.solves.saturating_add(1);
        let newest = f32::max(1.0 / f32::from(self.solves), NEWEST);
        let (mut last_wrong, mut mean_wrong) = (0, 0);
        for ((last, mean), &state) in self.last.iter_mut().zip(&mut self.mean).zip(activity) {
            let now = one_if(state == Activity::Upper) - one_if(state == Activity::Lower);
            last_wrong += u32::from(*last != now);
            mean_wrong += u32::from(side(*mean) != now);
            *last = now;
            *mean += newest * (now - *mean);
        }
        if self.solves == 1 || last_wrong as usize > self.variables / JUMP {
            self.mean.copy_from_slice(&self.last);
            self.solves = 1;
        } else {
            self.last_wrong += NEWEST_SCORE * (f64::from(last_wrong) - self.last_wrong);
            self.mean_wrong += NEWEST_SCORE * (f64::from(mean_wrong) - self.mean_wrong);
        }
    }
}

/// Returns the side at which a row is most of the time.
fn side(mean: f32) -> f32 {
    one_if(mean > 0.5) - one_if(mean < -0.5)
}

fn one_if(is: bool) -> f32 {
    f32::from(u8::from(is))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROWS: usize = 24;

    fn wrong(guess: &[Activity], right: &[Activity]) -> usize {
        guess.iter().zip(right).filter(|(guess, right)| guess != right).count()
    }

    /// Returns how often the guesses for a sequence of active sets are wrong, and how often
    /// repeating the last set is.
    fn follow(sets: &[Vec<Activity>]) -> (usize, usize) {
        let mut prediction = Prediction::new(ROWS, ROWS);
        let (mut guessed, mut repeated) = (0, 0);
        for pair in sets.windows(2) {
            prediction.learn(&pair[0]);
            let mut activity = pair[0].clone();
            prediction.predict(&mut activity);
            guessed += wrong(&activity, &pair[1]);
            repeated += wrong(&pair[0], &pair[1]);
        }
        (guessed, repeated)
    }

    fn states() -> impl Strategy<Value = Activity> {
        prop_oneof![Just(Activity::Inactive), Just(Activity::Lower), Just(Activity::Upper)]
    }

    proptest! {
        #[test]
        fn lasting_changes_are_predicted_by_the_last_set(
            first in prop::collection::vec(states(), ROWS),
            changes in prop::collection::vec((0..2 * ROWS, states()), 60),
        ) {
            // Changes of a row are rare enough for its mean to follow. Half of the time there is
            // none.
            let mut sets = vec![first];
            for (i, &(row, state)) in changes.iter().enumerate() {
                let mut next = sets[i].clone();
                let row = (row + i) % (2 * ROWS);
                let settled = sets[i.saturating_sub(12)..].iter().all(|set| {
                    row < ROWS && set[row] == next[row]
                });
                if settled {
                    next[row] = state;
                }
                sets.push(next);
            }
            let (guessed, repeated) = follow(&sets);
            prop_assert_eq!(guessed, repeated);
        }

        #[test]
        fn alternating_rows_are_predicted_by_their_mean(
            usual in prop::collection::vec(states(), ROWS),
            noise in prop::collection::vec(
                prop::collection::vec((prop::bool::weighted(0.1), states()), ROWS), 80,
            ),
        ) {
            let sets: Vec<Vec<_>> = noise
                .iter()
                .map(|rows| {
                    let pairs = rows.iter().zip(&usual);
                    pairs.map(|(&(odd, other), &usual)| if odd { other } else { usual }).collect()
                })
                .collect();
            let (guessed, repeated) = follow(&sets);
            prop_assert!(guessed * 10 < repeated * 9, "{guessed} of {repeated}");
        }

        #[test]
        fn a_jump_ends_all_prediction(
            sets in prop::collection::vec(prop::collection::vec(states(), ROWS), 2..20),
        ) {
            let mut prediction = Prediction::new(ROWS, ROWS);
            for pair in sets.windows(2) {
                prediction.learn(&pair[0]);
                prediction.learn(&pair[1]);
                if wrong(&pair[0], &pair[1]) > ROWS / JUMP {
                    let mut activity = pair[1].clone();
                    prediction.predict(&mut activity);
                    prop_assert_eq!(&activity, &pair[1]);
                }
            }
        }
    }
}
