//! The exact signed-rank test of Wilcoxon (1945).

/// Differences closer than this are equal. Ratings end at 20, and rounding is much smaller.
const EQUAL: f64 = 1e-9;

/// The signed-rank test of paired differences, which tests whether one of the two is larger.
///
/// Pairs without a difference are left out. Equal differences share the mean of their ranks. The
/// probability counts all signs of the actual ranks, so it is exact with ties too.
///
/// ```
/// use ergo_report::workload::SignedRank;
///
/// let test = SignedRank::of(&[3.0, 1.0, -2.0, 4.0, 5.0]);
/// assert_eq!((test.positive, test.negative, test.pairs), (13.0, 2.0, 5));
/// // Of 32 ways to give signs, three have a sum of at most 2; both ends count.
/// assert_eq!(test.p, 6.0 / 32.0);
/// assert_eq!(test.effect(), 11.0 / 15.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRank {
    /// Sum of the ranks of positive differences.
    pub positive: f64,
    /// Sum of the ranks of negative differences.
    pub negative: f64,
    /// Number of pairs with a difference.
    pub pairs: usize,
    /// Probability of ranks that are at least as one-sided if both conditions are equal: twice the
    /// smaller tail, at most 1.
    pub p: f64,
}

impl SignedRank {
    /// Tests these differences.
    pub fn of(differences: &[f64]) -> Self {
        let mut ordered: Vec<f64> =
            differences.iter().copied().filter(|difference| difference.abs() > EQUAL).collect();
        ordered.sort_by(|one, other| one.abs().total_cmp(&other.abs()));
        let pairs = ordered.len();
        let ranks = doubled_ranks(&ordered);
        let sum = |positive: bool| -> usize {
            let signed = ordered.iter().zip(&ranks).filter(|(x, _)| (**x > 0.0) == positive);
            signed.map(|(_, rank)| rank).sum()
        };
        let (positive, negative) = (sum(true), sum(false));
        let tail = at_most(&ranks, positive.min(negative));
        let p = (2.0 * tail).min(1.0);
        Self { positive: positive as f64 / 2.0, negative: negative as f64 / 2.0, pairs, p }
    }

    /// Returns the rank-biserial correlation (Kerby 2014), from -1 (all differences negative) to 1
    /// (all positive). It is 0 if no pair differs.
    pub fn effect(&self) -> f64 {
        let sum = self.positive + self.negative;
        if sum > 0.0 { (self.positive - self.negative) / sum } else { 0.0 }
    }
}

/// Returns twice the rank of each difference, in the order of size. These are integers even if
/// equal differences share a mean rank.
fn doubled_ranks(ordered: &[f64]) -> Vec<usize> {
    let mut ranks = Vec::with_capacity(ordered.len());
    for equal in ordered.chunk_by(|one, other| (one.abs() - other.abs()).abs() <= EQUAL) {
        let (before, count) = (ranks.len(), equal.len());
        // The ranks are from before + 1 to before + count.
        ranks.resize(before + count, 2 * before + count + 1);
    }
    ranks
}

/// Returns the probability that the ranks of one sign sum to at most this, if each sign is equally
/// likely. The distribution is symmetric, so it is the same for both signs.
fn at_most(ranks: &[usize], sum: usize) -> f64 {
    let total: usize = ranks.iter().sum();
    let mut probability = vec![0.0; total + 1];
    probability[0] = 1.0;
    let mut reached = 0;
    for rank in ranks {
        reached += rank;
        for sum in (0..=reached).rev() {
            let with = sum.checked_sub(*rank).map_or(0.0, |without| probability[without]);
            probability[sum] = 0.5 * (probability[sum] + with);
        }
    }
    probability.iter().take(sum + 1).sum()
}
