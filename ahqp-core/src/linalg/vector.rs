//! Kernels over slices. Sums are split in four so that the compiler can use vector units.

/// Returns aᵀb.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        sum[0] += x[0] * y[0];
        sum[1] += x[1] * y[1];
        sum[2] += x[2] * y[2];
        sum[3] += x[3] * y[3];
    }
    (sum[0] + sum[2]) + (sum[1] + sum[3]) + tail
}

/// Computes y ← y + αx.
#[inline]
pub(crate) fn add_scaled(y: &mut [f64], alpha: f64, x: &[f64]) {
    for (to, from) in y.iter_mut().zip(x) {
        *to += alpha * from;
    }
}

/// Returns ‖a‖₂.
#[inline]
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Returns √(a² + b²), for numbers whose squares do not overflow.
#[inline]
pub(crate) fn length(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// Returns max |aᵢ|.
#[inline]
pub(crate) fn norm_max(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |largest, value| f64::max(largest, value.abs()))
}

/// Computes a Householder reflection I − τvvᵀ that maps a vector to a multiple of the first axis.
///
/// Overwrites `v`, which contains the vector, with the reflector. Returns τ and the first entry of
/// the image. τ is zero for a zero vector.
#[inline]
pub(crate) fn reflector(v: &mut [f64]) -> (f64, f64) {
    let length = norm(v);
    let Some(first) = v.first_mut() else { return (0.0, 0.0) };
    if length == 0.0 {
        return (0.0, 0.0);
    }
    let image = if *first > 0.0 { -length } else { length };
    let pivot = *first - image;
    *first = pivot;
    // vᵀv = 2 pivot · (pivot + …) reduces to −2 image · pivot.
    (1.0 / (-image * pivot), image)
}
