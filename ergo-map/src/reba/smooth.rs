//! One implementation for values alone and for values with their gradients.

use crate::posture::Posture;

/// A number that may have derivatives with respect to the posture's angles.
pub(super) trait Smooth: Copy {
    /// The number.
    fn value(self) -> f64;
    /// Returns a function of this number, given its value and its derivative.
    fn chain(self, value: f64, slope: f64) -> Self;
    /// Returns a function of three numbers, given its value and its partial derivatives.
    fn chain3(arguments: [Self; 3], value: f64, partials: [f64; 3]) -> Self;

    /// Returns the sum of two numbers.
    fn plus(self, other: Self) -> Self {
        Self::chain3([self, other, self], self.value() + other.value(), [1.0, 1.0, 0.0])
    }

    /// Returns the number shifted by a constant.
    fn shifted(self, by: f64) -> Self {
        self.chain(self.value() + by, 1.0)
    }

    /// Returns the number clamped to an interval. The derivative is zero outside.
    fn clamped(self, min: f64, max: f64) -> Self {
        let inside = (min..=max).contains(&self.value());
        self.chain(self.value().clamp(min, max), f64::from(u8::from(inside)))
    }

    /// Returns the larger of two numbers, with its derivatives.
    fn larger(self, other: Self) -> Self {
        if other.value() > self.value() { other } else { self }
    }
}

impl Smooth for f64 {
    fn value(self) -> f64 {
        self
    }

    fn chain(self, value: f64, _slope: f64) -> Self {
        value
    }

    fn chain3(_arguments: [Self; 3], value: f64, _partials: [f64; 3]) -> Self {
        value
    }
}

/// A value with its gradient with respect to the fourteen angles of a [`Posture`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) gradient: [f64; Posture::LEN],
}

impl Dual {
    /// Returns the angles of a posture as independent variables.
    pub(super) fn angles(posture: &Posture) -> [Self; Posture::LEN] {
        let mut index = 0;
        posture.to_array().map(|value| {
            let mut gradient = [0.0; Posture::LEN];
            if let Some(own) = gradient.get_mut(index) {
                *own = 1.0;
            }
            index += 1;
            Self { value, gradient }
        })
    }
}

impl Smooth for Dual {
    fn value(self) -> f64 {
        self.value
    }

    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.map(|g| g * slope) }
    }

    fn chain3([a, b, c]: [Self; 3], value: f64, [pa, pb, pc]: [f64; 3]) -> Self {
        let mut gradient = a.gradient.map(|g| g * pa);
        for ((out, b), c) in gradient.iter_mut().zip(b.gradient).zip(c.gradient) {
            *out += pb * b + pc * c;
        }
        Self { value, gradient }
    }
}
