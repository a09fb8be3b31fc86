//! Bilinear interpolation between the four nearest pixels, without antialiasing: OpenCV's for 8-bit
//! images, in fixed point, and PyTorch's, in f32.

use ndarray::{Array3, ArrayView3, s};

/// Fractional bits of a weight in OpenCV.
const PRECISION: i32 = 11;

/// The two neighbours of a position along an axis, and its distance from the first.
#[derive(Clone, Copy)]
struct Place {
    first: usize,
    second: usize,
    fraction: f32,
}

/// Resizes a height × width × channels image as OpenCV's `INTER_LINEAR` does. No side may be zero.
pub(super) fn resize_opencv(frame: ArrayView3<'_, u8>, height: usize, width: usize) -> Array3<u8> {
    let (rows, columns, channels) = frame.dim();
    if (rows, columns) == (height, width) {
        return frame.to_owned();
    }
    if (rows, columns) == (2 * height, 2 * width) {
        return halve(frame);
    }
    let mut xs = opencv_places(columns, width);
    for x in xs.iter_mut().filter(|x| x.first == x.second) {
        // Beyond the outermost pixel of a row, OpenCV does not blend the pixel with itself. The sum
        // of the two weights may differ from one.
        x.fraction = 0.0;
    }
    let ys = opencv_places(rows, height);
    // The second pass drops bits of the first so that products fit into 16 bits.
    let blend = |upper: i32, lower: i32, [one, two]: [i32; 2]| {
        let sum = ((one * (upper >> 4)) >> 16) + ((two * (lower >> 4)) >> 16);
        u8::try_from(((sum + 2) >> 2).clamp(0, 255)).unwrap_or(0)
    };
    let mut resized = Array3::zeros((height, width, channels));
    for (mut out, y) in resized.outer_iter_mut().zip(ys) {
        let (upper, lower) = (frame.slice(s![y.first, .., ..]), frame.slice(s![y.second, .., ..]));
        for (mut pixel, x) in out.outer_iter_mut().zip(&xs) {
            let [left, right] = weights(x.fraction);
            for (channel, value) in pixel.iter_mut().enumerate() {
                let across = |row: &ndarray::ArrayView2<'_, u8>| {
                    i32::from(row[[x.first, channel]]) * left
                        + i32::from(row[[x.second, channel]]) * right
                };
                *value = blend(across(&upper), across(&lower), weights(y.fraction));
            }
        }
    }
    resized
}

/// Returns the weights of the two neighbours in fixed point, each rounded half to even.
#[allow(clippy::cast_possible_truncation)]
fn weights(fraction: f32) -> [i32; 2] {
    let scale = (1 << PRECISION) as f32;
    [1.0 - fraction, fraction].map(|weight| (weight * scale).round_ties_even() as i32)
}

/// Returns the mean of each square of four pixels, as OpenCV does for exactly half the size.
fn halve(frame: ArrayView3<'_, u8>) -> Array3<u8> {
    let (rows, columns, channels) = frame.dim();
    Array3::from_shape_fn((rows / 2, columns / 2, channels), |(row, column, channel)| {
        let square = frame.slice(s![2 * row..2 * row + 2, 2 * column..2 * column + 2, channel]);
        let sum: u16 = square.iter().map(|&pixel| u16::from(pixel)).sum();
        u8::try_from((sum + 2) >> 2).unwrap_or(u8::MAX)
    })
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // indices within the image
fn opencv_places(from: usize, to: usize) -> Vec<Place> {
    let scale = 1.0 / (to as f64 / from as f64);
    let place = |index: usize| {
        let place = ((index as f64 + 0.5) * scale - 0.5) as f32;
        let floor = place.floor();
        let first = (floor.max(0.0) as usize).min(from - 1);
        let second = if floor < 0.0 { first } else { (first + 1).min(from - 1) };
        Place { first, second, fraction: place - floor }
    };
    (0..to).map(place).collect()
}

/// Resizes a height × width × channels image as `torch.nn.functional.interpolate` does
/// (`mode="bilinear"`, `align_corners=False`). No side may be zero.
pub(super) fn resize_torch(frame: ArrayView3<'_, u8>, height: usize, width: usize) -> Array3<f32> {
    let (rows, columns, channels) = frame.dim();
    let xs = torch_places(columns, width);
    let ys = torch_places(rows, height);
    Array3::from_shape_fn((height, width, channels), |(row, column, channel)| {
        let (y, x) = (ys[row], xs[column]);
        let pixel = |row: usize, column: usize| f32::from(frame[[row, column, channel]]);
        let across = |row: usize| {
            (1.0 - x.fraction) * pixel(row, x.first) + x.fraction * pixel(row, x.second)
        };
        (1.0 - y.fraction) * across(y.first) + y.fraction * across(y.second)
    })
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // indices within the image
fn torch_places(from: usize, to: usize) -> Vec<Place> {
    let scale = from as f32 / to as f32;
    let place = |index: usize| {
        let place = ((index as f32 + 0.5) * scale - 0.5).max(0.0);
        let first = (place as usize).min(from - 1);
        let second = (first + 1).min(from - 1);
        Place { first, second, fraction: (place - first as f32).clamp(0.0, 1.0) }
    };
    (0..to).map(place).collect()
}
