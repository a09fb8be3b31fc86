//! The printed classes of an angle: a score that jumps at thresholds.

/// Angles closer to a threshold than this are on it \[rad\], since a converted angle may be off by
/// an ulp.
const ON_THRESHOLD: f64 = 1e-9;

/// A score for very negative angles, and the jump at each threshold, in degrees as printed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps {
    pub(crate) start: f64,
    pub(crate) jumps: &'static [(f64, f64)],
}

impl Steps {
    pub(crate) const fn new(start: f64, jumps: &'static [(f64, f64)]) -> Self {
        Self { start, jumps }
    }

    /// Returns the class of an angle \[rad\]. Exactly on a threshold the lower class holds.
    pub(crate) fn class(&self, angle: f64) -> u8 {
        let mut score = self.start;
        for &(threshold, jump) in self.jumps {
            let threshold = threshold.to_radians();
            let passed = if jump > 0.0 {
                angle > threshold + ON_THRESHOLD
            } else {
                angle >= threshold - ON_THRESHOLD
            };
            if passed {
                score += jump;
            }
        }
        // The values are small integers by construction.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        {
            score as u8
        }
    }

    /// Returns value and derivative with each jump replaced by a smooth step over ± `half_width`
    /// \[rad\].
    pub(crate) fn softened(&self, angle: f64, half_width: f64) -> (f64, f64) {
        let (mut value, mut slope) = (self.start, 0.0);
        for &(threshold, jump) in self.jumps {
            let u = (angle - threshold.to_radians()) / half_width;
            let (step, rate) = smooth_step(0.5 + 0.5 * u);
            value += jump * step;
            slope += jump * rate * 0.5 / half_width;
        }
        (value, slope)
    }
}

/// Steepness of a smooth step at its centre, over its width.
///
/// A plain smoothstep (1.5) spends much of its width between two classes. Where a table jumps by
/// two, or two parts change at once, the score would round to a value that neither side has.
const STEEPNESS: i32 = 24;

/// Returns a step from 0 to 1 over [0, 1], tᵖ / (tᵖ + (1 - t)ᵖ), with its derivative.
fn smooth_step(t: f64) -> (f64, f64) {
    if t <= 0.0 || t >= 1.0 {
        return (f64::from(u8::from(t >= 1.0)), 0.0);
    }
    let (up, down) = (t.powi(STEEPNESS), (1.0 - t).powi(STEEPNESS));
    let sum = up + down;
    let rate = f64::from(STEEPNESS) * up * down / (t * (1.0 - t) * sum * sum);
    (up / sum, rate)
}
