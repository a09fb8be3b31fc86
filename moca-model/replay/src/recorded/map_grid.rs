//! The person's ergonomics map on a grid, for display.

use ergo_map::{ErgonomicsMap, Region};
use nalgebra::Vector3;

/// Distance of neighbours \[m\].
const SPACING: f64 = 0.05;
/// Value for a score that the map does not know.
const UNKNOWN: u8 = 255;

/// Scores `e_s` on a grid in the person's frame: x fastest, then y, then z.
///
/// ```
/// use ergo_map::{ErgonomicsMap, MapOptions, Person};
/// use moca_replay::recorded::MapGrid;
///
/// let options = MapOptions { spacing: 0.3, ..MapOptions::default() };
/// let map = ErgonomicsMap::build(&Person::average(), &options, None)?;
/// let grid = MapGrid::of(&map);
/// assert_eq!(grid.scores.len(), grid.counts.iter().product::<usize>());
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MapGrid {
    /// First node \[m\].
    pub origin: Vector3<f64>,
    /// Distance of neighbours \[m\].
    pub spacing: f64,
    /// Number of nodes along x, y and z.
    pub counts: [usize; 3],
    /// Scores as bytes: 0 is the score 0, 254 is `greatest`, 255 marks nodes that the hand cannot reach.
    pub scores: Vec<u8>,
    /// Score of the value 254.
    pub greatest: f64,
}

impl MapGrid {
    /// Samples everything within reach.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded")]
    pub fn of(map: &ErgonomicsMap) -> Self {
        let region = Region::surroundings(map.stature(), map.side());
        let (origin, size) = (*region.min(), region.size());
        let counts = [size.x, size.y, size.z].map(|edge| (edge / SPACING).ceil() as usize + 1);
        let greatest = 4.25;
        let mut scores = Vec::with_capacity(counts.iter().product());
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let node = Vector3::new(x as f64, y as f64, z as f64) * SPACING;
                    let score = map.sample(&(origin + node)).map(|sample| sample.score);
                    scores.push(score.map_or(UNKNOWN, |score| {
                        (score / greatest * 254.0).round().clamp(0.0, 254.0) as u8
                    }));
                }
            }
        }
        Self { origin, spacing: SPACING, counts, scores, greatest }
    }
}
