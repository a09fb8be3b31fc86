//! The operations on a convolution's sums.

use super::vector::Vector;

/// The operations on a convolution's sums.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Epilogue<'a> {
    /// True to add the output's previous value (the residual connection).
    pub(crate) add: bool,
    /// The last operation.
    pub(crate) finish: Finish<'a>,
}

/// The activation function.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Finish<'a> {
    /// Keeps the sums.
    Keep,
    /// Sets negative results to zero, and those that are not finite to NaN.
    Relu,
    /// Like `Relu`, but limited to six.
    Relu6,
    /// 1 / (1 + exp(-x)), and NaN for results that are not finite.
    Logistic,
    /// Multiplies negative results by their channel's slope (one for each channel of the panels).
    /// Results that are not finite become NaN.
    Prelu(&'a [f32]),
}

/// Lanes of the widest register.
const MOST_LANES: usize = 16;

/// Returns 1 / (1 + exp(-x)), or NaN if the value is not finite.
fn logistic(value: f32) -> f32 {
    1.0 / (1.0 + (-value).exp()) + 0.0 * value
}

impl Finish<'_> {
    /// Returns the function for the channels of one panel.
    pub(super) fn of_panel(self, start: usize, width: usize) -> Self {
        match self {
            Self::Prelu(slopes) => Self::Prelu(&slopes[start..start + width]),
            other => other,
        }
    }

    /// Returns true if there are no slopes, or a slope for each channel.
    pub(super) fn has_slopes(self, channels: usize) -> bool {
        !matches!(self, Self::Prelu(slopes) if slopes.len() < channels)
    }

    /// Applies the function to a register of channels, the first of which is `channel`.
    ///
    /// # Safety
    /// The vector's instruction set must be enabled. If there are slopes, there must be one for
    /// each channel.
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

    /// Applies the function to one channel's sum.
    pub(super) fn apply_to_one(self, value: f32, channel: usize) -> f32 {
        // Zero, or NaN if the value is not finite.
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
