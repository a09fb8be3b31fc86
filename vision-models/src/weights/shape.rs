//! How many elements a shape has.

/// More axes than any tensor of a network has.
pub(super) const MAX_AXES: usize = 8;

/// The number of elements of a tensor of this shape; `None` if an axis, or all that are not empty
/// together, are longer than memory can be. No such tensor can be made, even an empty one.
pub(super) fn elements(shape: &[usize]) -> Option<usize> {
    let longest = shape
        .iter()
        .filter(|&&axis| axis > 0)
        .try_fold(1_usize, |size, &axis| size.checked_mul(axis))
        // Of the largest elements, eight bytes each.
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
