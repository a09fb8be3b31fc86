//! Finds the joints that the limbs' fields connect.

use ndarray::{ArrayView2, ArrayView3, Axis};

use super::GroupingSettings;
use super::peaks::Peak;

/// The joints of each limb and the x component of its field; y is the next map. The order of the COCO model.
const LIMBS: [([usize; 2], usize); 19] = [
    ([1, 2], 12),
    ([1, 5], 20),
    ([2, 3], 14),
    ([3, 4], 16),
    ([5, 6], 22),
    ([6, 7], 24),
    ([1, 8], 0),
    ([8, 9], 2),
    ([9, 10], 4),
    ([1, 11], 6),
    ([11, 12], 8),
    ([12, 13], 10),
    ([1, 0], 28),
    ([0, 14], 30),
    ([14, 16], 34),
    ([0, 15], 32),
    ([15, 17], 36),
    ([2, 16], 18),
    ([5, 17], 26),
];

/// Number of samples of the field along a line.
const SAMPLES: u32 = 10;

/// Two joints that a limb connects: the joint's number, and the number of its maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Connection {
    pub(super) ends: [(usize, usize); 2],
    /// Mean of the field along the line (eq. 10).
    pub(super) score: f64,
}

/// Returns the connections of all limbs, the best first. The best pairs of each limb are taken,
/// each joint once.
pub(super) fn connect(
    peaks: &[Vec<Peak>],
    fields: &ArrayView3<'_, f32>,
    settings: &GroupingSettings,
) -> Vec<Connection> {
    let mut connections = Vec::new();
    for ([from, to], map) in LIMBS {
        let field = [map, map + 1].map(|map| fields.index_axis(Axis(0), map));
        let mut candidates = Vec::new();
        for (first, one) in peaks[from].iter().enumerate() {
            for (second, other) in peaks[to].iter().enumerate() {
                if let Some(score) = score(&field, one.at, other.at, settings) {
                    candidates.push(Connection { ends: [(from, first), (to, second)], score });
                }
            }
        }
        sort(&mut candidates);
        let mut taken: Vec<(usize, usize)> = Vec::new();
        for candidate in candidates {
            if candidate.ends.iter().all(|end| !taken.contains(end)) {
                taken.extend(candidate.ends);
                connections.push(candidate);
            }
        }
    }
    sort(&mut connections);
    connections
}

fn sort(connections: &mut [Connection]) {
    connections.sort_by(|one, other| other.score.total_cmp(&one.score));
}

/// Returns the mean component of the field along the line between two joints. It is reduced for
/// lines longer than half the image's height. `None` if too little of the field points along the
/// line.
fn score(
    field: &[ArrayView2<'_, f32>; 2],
    from: [f64; 2],
    to: [f64; 2],
    settings: &GroupingSettings,
) -> Option<f64> {
    let line = [to[0] - from[0], to[1] - from[1]];
    let length = line[0].hypot(line[1]);
    if length == 0.0 {
        return None;
    }
    let (mut sum, mut along) = (0.0, 0_u32);
    for sample in 0..SAMPLES {
        let part = f64::from(sample) / f64::from(SAMPLES - 1);
        let at = [from[0] + part * line[0], from[1] + part * line[1]];
        let [x, y] = [interpolate(&field[0], at), interpolate(&field[1], at)];
        let value = (x * line[0] + y * line[1]) / length;
        sum += value;
        along += u32::from(value > settings.field);
    }
    let height = field[0].nrows() as f64;
    let score = sum / f64::from(SAMPLES) + (0.5 * height / length - 1.0).min(0.0);
    let is_limb = f64::from(along) >= settings.along * f64::from(SAMPLES) && score > 0.0;
    is_limb.then_some(score)
}

/// Returns a map's value between cells. Beyond the edge it is the edge's value.
fn interpolate(map: &ArrayView2<'_, f32>, [x, y]: [f64; 2]) -> f64 {
    let (rows, columns) = map.dim();
    let split = |at: f64, count: usize| {
        let at = at.clamp(0.0, (count - 1) as f64);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the map"
        )]
        let cell = at.floor() as usize;
        (cell, (cell + 1).min(count - 1), at - at.floor())
    };
    let ((left, right, across), (top, bottom, down)) = (split(x, columns), split(y, rows));
    let mix = |row: usize| {
        let [one, other] = [left, right].map(|column| f64::from(map[(row, column)]));
        one + across * (other - one)
    };
    let (above, below) = (mix(top), mix(bottom));
    above + down * (below - above)
}
