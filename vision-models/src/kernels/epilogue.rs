//! What a convolution does with its sums.

use super::vector::Vector;

/// What a convolution does with its sums.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Epilogue<'a> {
    /// Adds what the output holds (the residual connection).
    pub(crate) add: bool,
    /// What comes last.
    pub(crate) finish: Finish<'a>,
}

/// The activation function.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Finish<'a> {
    /// The sums as they are.
    Keep,
    /// Makes negative results zero, and NaN of those that are not finite.
    Relu,
    /// The same, and at most six.
    Relu6,
    /// 1 / (1 + exp(-x)), and NaN of those that are not finite.
    Logistic,
    /// Multiplies negative results by their channel's slope (one for each channel of the panels), and makes
    /// NaN of those that are not finite.
    Prelu(&'a [f32]),
}

/// Lanes of the widest register.
const MOST_LANES: usize = 16;

/// 1 / (1 + exp(-x)); NaN for what is not finite.
fn logistic(value: f32) -> f32 {
    1.0 / (1.0 + (-value).exp()) + 0.0 * value
}

impl Finish<'_> {
    /// The same for the channels of one panel alone.
    pub(super) fn of_panel(self, start: usize, width: usize) -> Self {
        match self {
            Self::Prelu(slopes) => Self::Prelu(&slopes[start..start + width]),
            other => other,
        }
    }

    /// Whether there is a slope for each of so many channels, if there are slopes.
    pub(super) fn has_slopes(self, channels: usize) -> bool {
        !matches!(self, Self::Prelu(slopes) if slopes.len() < channels)
    }

    /// The function of a register of channels, the first of which is `channel`.
    ///
    /// # Safety
    /// The vector's instruction set must be enabled, and there must be slopes for the channels, if any.
    #[inline(always)]
    pub(super) unsafe fn apply<V: Vector>(self, value: V, channel: usize) -> V {
        // SAFETY: passed on to the caller.
        unsafe {
            match self {
                Self::Keep => value,
                Self::Relu => value.relu(),
                Self::Relu6 => V::splat(6.0).min(value.relu()),
                Self::Logistic => {
                    let mut lanes = [0.0; MOST_LANES];
                    value.store(lanes.as_mut_ptr());
                    V::load(lanes.map(logistic).as_ptr())
                }
                Self::Prelu(slopes) => value.prelu(V::load(slopes.as_ptr().add(channel))),
            }
        }
    }

    /// The function of one channel's sum.
    pub(super) fn apply_to_one(self, value: f32, channel: usize) -> f32 {
        // Zero, or NaN where the value is not finite.
        let zero = value * 0.0;
        let positive = if value > zero { value } else { zero };
        match self {
            Self::Keep => value,
            Self::Relu => positive,
            Self::Relu6 => {
                if positive > 6.0 {
                    6.0
                } else {
                    positive
                }
            }
            Self::Logistic => logistic(value),
            Self::Prelu(slopes) => (value - positive) * slopes[channel] + positive,
        }
    }
}
