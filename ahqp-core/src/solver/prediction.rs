//! The prediction of the next active set.
//!
//! Along a smooth motion it is the last one. Where the data are noisy, rows near their bounds come
//! and go, and what a row does most of the time says more. As in branch prediction (`McFarling`,
//! Combining Branch Predictors, 1993) both guesses are kept, and the one is taken that has been
//! wrong in fewer rows of late.

use super::activity::Activity;
use super::tolerances::{JUMP, NEWEST, NEWEST_SCORE};

/// What the rows of a problem did in the last solves.
#[derive(Debug, Clone)]
pub(crate) struct Prediction {
    /// Of every row where it was last: −1 at its lower bound, 1 at its upper, else 0.
    last: Vec<f32>,
    /// The mean of the same.
    mean: Vec<f32>,
    /// Solves that the means are of.
    solves: u16,
    /// In how many rows the guesses were wrong, on average.
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

    /// The next solve has nothing to do with those before.
    pub(crate) fn forget(&mut self) {
        (self.solves, self.last_wrong, self.mean_wrong) = (0, 0.0, 0.0);
    }

    /// Overwrites the last active set with what each row does most of the time, if that has been the
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

    /// Takes the active set that a solve ended with.
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

/// Where a row is most of the time.
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

    /// How often the guesses at a sequence of active sets are wrong, and how often the last set.
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
        fn rows_that_change_for_good_are_taken_as_they_were_last(
            first in prop::collection::vec(states(), ROWS),
            changes in prop::collection::vec((0..2 * ROWS, states()), 60),
        ) {
            // Every row changes seldom enough for its mean to have followed; half the times none.
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
        fn rows_that_come_and_go_are_taken_as_they_usually_are(
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
