//! The types of a tensor's elements.

use std::fmt;

/// The type of the elements of a tensor in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum ElementType {
    F64,
    F32,
    F16,
    Bf16,
    I64,
    I32,
    I16,
    I8,
    U8,
    /// One byte, zero or not.
    Bool,
}

impl ElementType {
    /// Types with the name of PyTorch's storage class and that of safetensors.
    const NAMES: [(Self, &'static str, &'static str); 10] = [
        (Self::F64, "DoubleStorage", "F64"),
        (Self::F32, "FloatStorage", "F32"),
        (Self::F16, "HalfStorage", "F16"),
        (Self::Bf16, "BFloat16Storage", "BF16"),
        (Self::I64, "LongStorage", "I64"),
        (Self::I32, "IntStorage", "I32"),
        (Self::I16, "ShortStorage", "I16"),
        (Self::I8, "CharStorage", "I8"),
        (Self::U8, "ByteStorage", "U8"),
        (Self::Bool, "BoolStorage", "BOOL"),
    ];

    pub(super) fn from_storage_class(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(_, class, _)| *class == name).map(|(element, ..)| element)
    }

    pub(super) fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(.., own)| *own == name).map(|(element, ..)| element)
    }

    /// Returns the name in safetensors, such as `"BF16"`.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(element, ..)| *element == self).map_or("", |(.., name)| name)
    }

    /// Returns true for integers and booleans.
    pub(super) const fn is_whole(self) -> bool {
        !matches!(self, Self::F64 | Self::F32 | Self::F16 | Self::Bf16)
    }

    /// Returns the size of one element (bytes).
    pub const fn size(self) -> usize {
        match self {
            Self::F64 | Self::I64 => 8,
            Self::F32 | Self::I32 => 4,
            Self::F16 | Self::Bf16 | Self::I16 => 2,
            Self::I8 | Self::U8 | Self::Bool => 1,
        }
    }

    /// Appends little-endian elements as f32, each rounded to the nearest.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn decode(self, bytes: &[u8], values: &mut Vec<f32>) {
        match self {
            Self::F64 => each(bytes, values, |bytes| f64::from_le_bytes(bytes) as f32),
            Self::F32 => each(bytes, values, f32::from_le_bytes),
            Self::F16 => each(bytes, values, |bytes| half(u16::from_le_bytes(bytes))),
            Self::Bf16 => each(bytes, values, |[low, high]| f32::from_le_bytes([0, 0, low, high])),
            Self::I64 => each(bytes, values, |bytes| i64::from_le_bytes(bytes) as f32),
            Self::I32 => each(bytes, values, |bytes| i32::from_le_bytes(bytes) as f32),
            Self::I16 => each(bytes, values, |bytes| f32::from(i16::from_le_bytes(bytes))),
            Self::I8 => each(bytes, values, |bytes| f32::from(i8::from_le_bytes(bytes))),
            Self::U8 => each(bytes, values, |[byte]: [u8; 1]| f32::from(byte)),
            Self::Bool => each(bytes, values, |[byte]: [u8; 1]| f32::from(u8::from(byte != 0))),
        }
    }
}

impl fmt::Display for ElementType {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

fn each<const SIZE: usize>(bytes: &[u8], values: &mut Vec<f32>, value: impl Fn([u8; SIZE]) -> f32) {
    values.extend(bytes.as_chunks().0.iter().map(|&bytes| value(bytes)));
}

/// Returns the IEEE half-precision number of these bits: sign, 5 bits of exponent, 10 of
/// significand.
fn half(bits: u16) -> f32 {
    let sign = u32::from(bits >> 15) << 31;
    let exponent = u32::from(bits >> 10) & 31;
    let significand = u32::from(bits) & 1023;
    let magnitude = match exponent {
        // Zero and the subnormal numbers are multiples of 2⁻²⁴.
        0 => (significand as f32 * f32::from_bits((127 - 24) << 23)).to_bits(),
        31 => 255 << 23 | significand << 13,
        _ => (exponent + 127 - 15) << 23 | significand << 13,
    };
    f32::from_bits(sign | magnitude)
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn half_precision() {
        for (bits, value) in [
            (0x0000, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 5.960_464_5e-8),
            (0x03ff, 6.097_555e-5),
            (0x0400, 6.103_515_6e-5),
            (0x3555, 0.333_251_95),
            (0x7c00, f32::INFINITY),
            (0xfc00, f32::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:#06x}");
        }
        assert!(half(0x7e00).is_nan());
        assert!(half(0x8000).is_sign_negative());
    }
}
