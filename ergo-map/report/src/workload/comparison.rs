//! Comparison of two conditions, subject by subject.

use serde::Serialize;

use super::condition::Condition;
use super::quartiles::Quartiles;
use super::questionnaire::Scale;
use super::signed_rank::SignedRank;

/// One scale or score under two conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tested {
    /// Name of the scale or score.
    pub name: &'static str,
    /// Median of each subject's increase from the first to the second condition.
    pub median_difference: f64,
    /// Number of subjects whose ratings differ.
    pub differing: usize,
    /// Sum of the ranks of the subjects with a higher rating under the second condition.
    pub positive_ranks: f64,
    /// Sum of the ranks of the subjects with a lower rating.
    pub negative_ranks: f64,
    /// Two-sided probability of the exact signed-rank test.
    pub p: f64,
    /// Probability corrected for six tested scales (Holm 1979). None for whole scores.
    pub p_holm: Option<f64>,
    /// Rank-biserial correlation: -1 if all ratings are lower under the second condition, 1 if all
    /// are higher.
    pub effect: f64,
}

/// Scales under two conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The first condition.
    pub first: String,
    /// The second one.
    pub second: String,
    /// The six scales, raw TLX and, if there are weights, weighted TLX.
    pub tested: Vec<Tested>,
}

impl Comparison {
    /// Compares conditions with the same subjects in the same order.
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

/// Corrects probabilities for multiple tests (Holm 1979), and returns them in the given order. The
/// smallest of k is multiplied by k, the next by k - 1, and none is less than the one before.
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
