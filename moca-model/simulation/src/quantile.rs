//! Quantiles of values.

/// Returns the quantile of this number of thousandths; `None` without values. Sorts the values.
pub(crate) fn quantile(values: &mut [f64], thousandths: usize) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((values.len() * thousandths / 1000).min(last)).copied()
}
