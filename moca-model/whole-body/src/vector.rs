//! Sums over slices, four at a time, so that additions need not wait for each other.

/// Σ aᵢ bᵢ, of one length.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len());
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Σ |aᵢ| bᵢ, of one length.
pub(crate) fn dot_of_sizes(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len());
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a.abs() * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a.abs() * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// a ← a − factor · b, of one length.
pub(crate) fn subtract(a: &mut [f64], factor: f64, b: &[f64]) {
    debug_assert_eq!(a.len(), b.len());
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= factor * b);
}

pub(crate) fn law() -> f64 {
    static P: std::sync::OnceLock<f64> = std::sync::OnceLock::new();
    *P.get_or_init(|| std::env::var("LAW").ok().and_then(|t| t.parse().ok()).unwrap_or(1.0))
}

/// Experiments: the n-th number of the environment variable P.
pub(crate) fn p(n: usize, default: f64) -> f64 {
    static P: std::sync::OnceLock<Vec<Option<f64>>> = std::sync::OnceLock::new();
    P.get_or_init(|| std::env::var("P").unwrap_or_default().split(',').map(|t| t.parse().ok()).collect())
        .get(n).copied().flatten().unwrap_or(default)
}

pub(crate) static TRACE: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
pub(crate) fn trace() -> bool { TRACE.load(std::sync::atomic::Ordering::Relaxed) }
