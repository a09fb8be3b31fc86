//! The number of elements of a shape.

/// Largest number of axes. No tensor of a network has more.
pub(super) const MAX_AXES: usize = 8;

/// Returns the number of elements of a tensor of this shape. `None` if an axis, or all non-empty
/// axes together, exceed the size of memory. Such a tensor is not allowed, even if it is empty.
pub(super) fn elements(shape: &[usize]) -> Option<usize> {
    let longest = shape
        .iter()
        .filter(|&&axis| axis > 0)
        .try_fold(1_usize, |size, &axis| size.checked_mul(axis))
        // The largest elements have eight bytes.
        .filter(|&size| size <= isize::MAX.unsigned_abs() / 8)?;
    Some(if shape.contains(&0) { 0 } else { longest })
}

#[cfg(test)]
mod tests {
    use super::elements;

    #[test]
    fn shapes_and_their_elements() {
        assert_eq!(elements(&[]), Some(1));
        assert_eq!(elements(&[2, 3, 4]), Some(24));
        assert_eq!(elements(&[2, 0, 4]), Some(0));
        for axes in [[0, 1 << 62, 8], [1 << 62, 8, 0], [usize::MAX, 0, 1], [1 << 30, 1 << 30, 4]] {
            assert_eq!(elements(&axes), None, "{axes:?}");
        }
    }
}
