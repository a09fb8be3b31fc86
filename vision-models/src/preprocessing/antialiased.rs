//! Pillow's bilinear resize of 8-bit images: a triangle filter as wide as the pixels of the smaller
//! image, in fixed point.

use std::borrow::Cow;

use ndarray::{Array3, ArrayView3};

/// Fractional bits of a weight: 32, minus 8 for the pixel and 2 for the sum.
const PRECISION: u32 = 22;
/// One half in fixed point.
const HALF: i32 = 1 << (PRECISION - 1);

/// Resizes a height × width × 3 image, first along rows, then along columns, with 8-bit pixels in
/// between. Every byte agrees with version 12 of Pillow. Later versions resize the columns first if
/// the height shrinks by more than twice as many pixels as the width. No side may be zero.
pub(super) fn resize(frame: ArrayView3<'_, u8>, height: usize, width: usize) -> Array3<u8> {
    let (rows, columns, _) = frame.dim();
    let frame = frame.as_standard_layout();
    let mut bytes = Cow::Borrowed(frame.as_slice().unwrap_or_default());
    if columns != width {
        bytes = along_rows(&bytes, columns, width).into();
    }
    if rows != height {
        bytes = along_columns(&bytes, rows, height).into();
    }
    Array3::from_shape_vec((height, width, 3), bytes.into_owned()).unwrap_or_default()
}

/// Resizes each row of pixels from `from` to `to` pixels.
fn along_rows(bytes: &[u8], from: usize, to: usize) -> Vec<u8> {
    let windows: Vec<Window> = windows(from, to).collect();
    let (pixels, _) = bytes.as_chunks::<3>();
    let mut resized = Vec::with_capacity(pixels.len() / from * to * 3);
    for row in pixels.chunks_exact(from) {
        for window in &windows {
            let mut sums = [HALF; 3];
            for (pixel, &weight) in row.iter().skip(window.start).zip(&window.weights) {
                for (sum, &value) in sums.iter_mut().zip(pixel) {
                    *sum += i32::from(value) * weight;
                }
            }
            resized.extend(sums.map(to_byte));
        }
    }
    resized
}

/// Resizes from `from` rows to `to` rows.
fn along_columns(bytes: &[u8], from: usize, to: usize) -> Vec<u8> {
    let length = bytes.len() / from;
    let mut sums = vec![HALF; length];
    let mut resized = Vec::with_capacity(length * to);
    for window in windows(from, to) {
        sums.fill(HALF);
        let rows = bytes.chunks_exact(length).skip(window.start);
        for (row, &weight) in rows.zip(&window.weights) {
            for (sum, &value) in sums.iter_mut().zip(row) {
                *sum += i32::from(value) * weight;
            }
        }
        resized.extend(sums.iter().copied().map(to_byte));
    }
    resized
}

/// Returns the sum without its fraction. The sum started at one half, so this rounds.
fn to_byte(sum: i32) -> u8 {
    u8::try_from((sum >> PRECISION).clamp(0, 255)).unwrap_or(0)
}

/// The pixels that are combined to one pixel of the result.
struct Window {
    start: usize,
    weights: Vec<i32>,
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // indices within the image
fn windows(from: usize, to: usize) -> impl Iterator<Item = Window> {
    let scale = from as f64 / to as f64;
    // In an enlargement, the triangle is as wide as a pixel of the original.
    let support = scale.max(1.0);
    let slope = 1.0 / support;
    (0..to).map(move |index| {
        let centre = (index as f64 + 0.5) * scale;
        let start = (centre - support + 0.5).max(0.0) as usize;
        let end = ((centre + support + 0.5) as usize).min(from);
        let triangle =
            |pixel: usize| (1.0 - ((pixel as f64 - centre + 0.5) * slope).abs()).max(0.0);
        let sum: f64 = (start..end).map(triangle).sum();
        let fixed = |weight: f64| (weight / sum * f64::from(1 << PRECISION) + 0.5) as i32;
        Window { start, weights: (start..end).map(triangle).map(fixed).collect() }
    })
}
