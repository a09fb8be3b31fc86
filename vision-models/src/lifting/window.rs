//! The depth of the surface around a pixel.

use nalgebra::Point2;

use crate::camera::DepthImage;

/// Smallest and largest half side of the window (pixels), and its largest number of pixels.
const SMALLEST: usize = 2;
const LARGEST: usize = 8;
const MOST: usize = (2 * LARGEST + 1) * (2 * LARGEST + 1);

/// Requirements of a window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Half the side (m).
    pub(super) half_side: f64,
    /// Focal length (pixels).
    pub(super) focal: f64,
    /// Smallest share of pixels with a depth, and of those on one surface.
    pub(super) least_share: f64,
    /// Nearest and farthest depth (m).
    pub(super) range: [f64; 2],
}

/// The surface that a window shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surface {
    /// Median depth (m).
    pub(super) depth: f64,
    /// True if the window shows another surface too.
    pub(super) at_edge: bool,
}

/// Finds the surface around a pixel.
///
/// Depths that differ by more than `edge(depth)` (m) belong to different surfaces. The nearest
/// surface with its share of the pixels counts, since a person hides what is behind. Surfaces that
/// merge without a gap give nothing.
pub(super) fn surface(
    image: &DepthImage,
    pixel: &Point2<f64>,
    wanted: &Wanted,
    edge: impl Fn(f64) -> f64,
) -> Option<Surface> {
    let [width, height] = image.size();
    let (column, row) = (nearest_pixel(pixel.x, width)?, nearest_pixel(pixel.y, height)?);
    let half = half_side(image, [column, row], wanted);

    let mut values = [0.0_f32; MOST];
    let (mut count, mut pixels) = (0, 0_usize);
    for y in row.saturating_sub(half)..(row + half + 1).min(height) {
        for x in column.saturating_sub(half)..(column + half + 1).min(width) {
            pixels += 1;
            let depth = image.depth(x, y).filter(|&depth| in_range(depth, wanted.range));
            if let (Some(depth), Some(slot)) = (depth, values.get_mut(count)) {
                *slot = depth;
                count += 1;
            }
        }
    }
    let values = values.get_mut(..count)?;
    if values.is_empty() || (count as f64) < wanted.least_share * pixels as f64 {
        return None;
    }
    values.sort_unstable_by(f32::total_cmp);
    let least = wanted.least_share * count as f64;
    let gap = |pair: (&f32, &f32)| f64::from(pair.1 - pair.0) > edge(f64::from(*pair.0));
    let surface = values
        .chunk_by(|one, next| !gap((one, next)))
        .find(|surface| surface.len() as f64 >= least)?;
    let at = |share: usize| surface.get(surface.len() * share / 8).copied().map(f64::from);
    let (depth, [low, high]) = (at(4)?, [at(1)?, at(7)?]);
    // A slope between two surfaces, or a surface seen along its face.
    if high - low > 2.0 * edge(depth) {
        return None;
    }
    Some(Surface { depth, at_edge: surface.len() < count })
}

/// Returns the index of the pixel that contains a coordinate.
fn nearest_pixel(coordinate: f64, side: usize) -> Option<usize> {
    let nearest = coordinate.round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the image")]
    (nearest >= 0.0 && nearest < side as f64).then_some(nearest as usize)
}

/// Returns the half side for the size of the body part in the image, by the first depth around the
/// pixel.
fn half_side(image: &DepthImage, [column, row]: [usize; 2], wanted: &Wanted) -> usize {
    let mut around = (0..3_usize).flat_map(|y| (0..3_usize).map(move |x| (x, y)));
    let depth = around.find_map(|(x, y)| {
        let depth = image.depth((column + x).checked_sub(1)?, (row + y).checked_sub(1)?)?;
        in_range(depth, wanted.range).then_some(depth)
    });
    let Some(depth) = depth else { return SMALLEST };
    let side = wanted.half_side * wanted.focal / f64::from(depth);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let side = side.round().clamp(SMALLEST as f64, LARGEST as f64) as usize;
    side
}

fn in_range(depth: f32, [nearest, farthest]: [f64; 2]) -> bool {
    (nearest..=farthest).contains(&f64::from(depth))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::cast_possible_truncation)]

    use super::*;

    const WANTED: Wanted =
        Wanted { half_side: 0.03, focal: 600.0, least_share: 0.3, range: [0.3, 8.0] };

    fn look(depth: impl Fn(usize, usize) -> f64) -> Option<Surface> {
        let depths = (0..41 * 41).map(|index| depth(index % 41, index / 41) as f32).collect();
        let image = DepthImage::from_metres([41, 41], depths).unwrap();
        surface(&image, &Point2::new(20.2, 19.8), &WANTED, |_| 0.08)
    }

    #[test]
    fn zeros_and_nan_do_not_count() {
        let holes = |x: usize, y: usize| match (x * 7 + y * 3) % 4 {
            0 => 0.0,
            1 => f64::NAN,
            _ => 2.0,
        };
        assert_eq!(look(holes), Some(Surface { depth: 2.0, at_edge: false }));
        assert_eq!(look(|x, y| if (x + y) % 5 == 0 { 2.0 } else { 0.0 }), None, "too few");
        assert_eq!(look(|_, _| 0.0), None);
        assert_eq!(look(|_, _| 9.0), None, "beyond the range");
    }

    #[test]
    fn an_edge_gives_the_nearer_surface() {
        for column in 0..41 {
            let step = |x: usize, _: usize| if x < column { 2.0 } else { 3.5 };
            let depth = look(step).unwrap().depth;
            assert!(depth == 2.0 || depth == 3.5, "{depth}");
            if column > 20 {
                assert_eq!(depth, 2.0);
            }
        }
        // A few pixels of something nearer are no surface.
        let speck = |x: usize, y: usize| if (x, y) == (20, 20) { 1.0 } else { 2.0 };
        assert_eq!(look(speck).map(|surface| surface.depth), Some(2.0));
    }

    #[test]
    fn a_ramp_between_two_surfaces_is_rejected() {
        assert_eq!(look(|x, _| 2.0 + 0.04 * x as f64), None);
        assert!(look(|x, _| 2.0 + 0.004 * x as f64).is_some(), "a slope is a surface");
    }

    #[test]
    fn pixels_outside_the_image_give_nothing() {
        let image = DepthImage::from_metres([4, 4], vec![1.0; 16]).unwrap();
        for (x, y) in [(-1.0, 0.0), (4.0, 0.0), (0.0, 3.6), (f64::NAN, 0.0), (1e300, 0.0)] {
            assert_eq!(surface(&image, &Point2::new(x, y), &WANTED, |_| 0.1), None);
        }
        assert!(surface(&image, &Point2::new(3.4, -0.4), &WANTED, |_| 0.1).is_some());
    }
}
