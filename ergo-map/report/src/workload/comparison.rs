//! Two conditions compared, subject by subject.

use serde::Serialize;

use super::condition::Condition;
use super::quartiles::Quartiles;
use super::questionnaire::Scale;
use super::signed_rank::SignedRank;

/// One scale, or one score, under two conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tested {
    /// The scale or the score.
    pub name: &'static str,
    /// The median of what each subject rated more under the second condition.
    pub median_difference: f64,
    /// Subjects whose ratings differ.
    pub differing: usize,
    /// Sum of the ranks of the subjects who rated more under the second condition.
    pub positive_ranks: f64,
    /// Sum of the ranks of the subjects who rated less.
    pub negative_ranks: f64,
    /// Two-sided probability of the exact signed-rank test.
    pub p: f64,
    /// The same corrected for the six scales that are tested (Holm 1979); none for whole scores.
    pub p_holm: Option<f64>,
    /// Rank-biserial correlation: -1 if all rated less under the second condition, 1 if more.
    pub effect: f64,
}

/// All scales under two conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The first condition.
    pub first: String,
    /// The second one.
    pub second: String,
    /// The six scales, raw TLX and, with weights, weighted TLX.
    pub tested: Vec<Tested>,
}

impl Comparison {
    /// Compares conditions whose subjects are the same and stand in the same order.
    pub(super) fn of(first: &Condition, second: &Condition) -> Self {
        let scales = Scale::ALL.into_iter().enumerate();
        let scales = scales
            .map(|(index, scale)| (scale.name(), first.scale(index), second.scale(index)))
            .map(|(name, before, after)| test(name, &before, &after));
        let mut tested: Vec<Tested> = scales.collect();
        let corrected = holm(&tested.iter().map(|tested| tested.p).collect::<Vec<_>>());
        for (tested, corrected) in tested.iter_mut().zip(corrected) {
            tested.p_holm = Some(corrected);
        }
        tested.push(test("raw_tlx", &first.raw, &second.raw));
        if let (Some(before), Some(after)) = (&first.weighted, &second.weighted) {
            tested.push(test("weighted_tlx", before, after));
        }
        Self { first: first.name.clone(), second: second.name.clone(), tested }
    }
}

fn test(name: &'static str, before: &[f64], after: &[f64]) -> Tested {
    let differences: Vec<f64> = before.iter().zip(after).map(|(one, other)| other - one).collect();
    let ranks = SignedRank::of(&differences);
    Tested {
        name,
        median_difference: Quartiles::of(&differences).median,
        differing: ranks.pairs,
        positive_ranks: ranks.positive,
        negative_ranks: ranks.negative,
        p: ranks.p,
        p_holm: None,
        effect: ranks.effect(),
    }
}

/// Probabilities corrected for being several (Holm 1979), in the given order: the smallest of k
/// counts k times, the next k - 1 times, and none less than one before it.
fn holm(probabilities: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..probabilities.len()).collect();
    order.sort_by(|&one, &other| probabilities[one].total_cmp(&probabilities[other]));
    let mut corrected = vec![0.0; probabilities.len()];
    let mut least = 0.0_f64;
    for (rank, &index) in order.iter().enumerate() {
        let count = (probabilities.len() - rank) as f64;
        least = least.max((count * probabilities[index]).min(1.0));
        corrected[index] = least;
    }
    corrected
}
