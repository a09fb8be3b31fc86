//! The person as the camera saw them.

use ergo_map::{RebaSubScores, Side};
use nalgebra::Vector3;
use vision_models::{Body, Percept};

use super::body::{self, BODY_POINTS, POINT_COUNT, Points};
use super::table::{Encoding, Group, Table};

/// Parts that have a sub-score, in the order of the columns.
pub(super) const PARTS: [&str; 6] = ["neck", "trunk", "legs", "upper arm", "lower arm", "wrist"];

/// Number of frames on each side over which a point is averaged.
const REACH: usize = 3;
/// Largest time between frames that belong together \[s\].
const GAP: f64 = 0.5;

/// Points and scores of each frame.
#[derive(Clone, Debug)]
pub(super) struct PersonTrack {
    table: Table,
    stature: f64,
}

impl PersonTrack {
    pub(super) fn new(stature: f64) -> Self {
        Self { table: Table::new(groups()), stature }
    }

    /// Adds a camera frame and the scores of its posture.
    pub(super) fn observe(&mut self, percept: &Percept, measured: Option<(Side, RebaSubScores)>) {
        self.table.push(percept.time, &row(percept.body.as_ref(), self.stature, measured));
    }

    /// Returns the track with each point averaged over neighbouring frames, which also fills short gaps. It is for
    /// pictures only; nothing is computed from it.
    pub(super) fn smoothed(&self) -> Table {
        let mut smooth = Table::new(self.table.groups().to_vec());
        let times = self.table.times();
        for (index, &time) in times.iter().enumerate() {
            let mut row = self.table.row(index).to_vec();
            let around = index.saturating_sub(REACH)..(index + REACH + 1).min(times.len());
            for (column, value) in row.iter_mut().take(3 * POINT_COUNT).enumerate() {
                let (mut sum, mut weights) = (0.0, 0.0);
                for other in around.clone() {
                    let seen = self.table.row(other)[column];
                    if seen.is_nan() || (times[other] - time).abs() > GAP {
                        continue;
                    }
                    let weight = (REACH + 1 - index.abs_diff(other)) as f32;
                    sum += weight * seen;
                    weights += weight;
                }
                *value = sum / weights;
            }
            smooth.push(time, &row);
        }
        smooth
    }
}

/// The columns of a person.
pub(super) fn groups() -> Vec<Group> {
    vec![
        Group::new("body", &BODY_POINTS, 3, Encoding::Steps),
        Group::new("parts", &PARTS, 1, Encoding::Exact),
        // The side of the arm that is scored: 1 left, -1 right.
        Group::new("side", &["side"], 1, Encoding::Exact),
    ]
}

/// A person of a stature \[m\] as a row of numbers: the body, and the scores of its posture with the side of the arm
/// that is scored.
pub fn row(body: Option<&Body>, stature: f64, measured: Option<(Side, RebaSubScores)>) -> Vec<f32> {
    let unseen: Points = [None; POINT_COUNT];
    let points = body.map_or(unseen, |body| body::seen(body, stature));
    let mut row = Vec::with_capacity(3 * POINT_COUNT + PARTS.len() + 1);
    write_points(&points, &mut row);
    write_parts(measured.map(|(_, scores)| scores), &mut row);
    row.push(measured.map_or(f32::NAN, |(side, _)| match side {
        Side::Left => 1.0,
        Side::Right => -1.0,
    }));
    row
}

/// The points of a track at a time, between two frames; none where they are not known.
pub(super) fn points_at(track: &Table, time: f64) -> Points {
    let after = track.times().partition_point(|&other| other <= time);
    let Some(before) = after.checked_sub(1) else { return [None; POINT_COUNT] };
    let next = after.min(track.len() - 1);
    let (begin, end) = (track.times()[before], track.times()[next]);
    if time - begin > GAP {
        return [None; POINT_COUNT];
    }
    let share =
        if end - begin > GAP || end <= begin { 0.0 } else { (time - begin) / (end - begin) };
    let (first, second) = (track.row(before), track.row(next));
    std::array::from_fn(|point| {
        let at = |row: &[f32]| {
            let [x, y, z] = *row.get(3 * point..)?.first_chunk()?;
            let place = Vector3::new(f64::from(x), f64::from(y), f64::from(z));
            (!x.is_nan()).then_some(place)
        };
        let (first, second) = (at(first)?, at(second));
        Some(second.map_or(first, |second| first.lerp(&second, share)))
    })
}

/// Appends three numbers for each point.
#[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
pub(super) fn write_points(points: &Points, row: &mut Vec<f32>) {
    for point in points {
        row.extend(
            point.map_or([f32::NAN; 3], |point| [point.x, point.y, point.z].map(|v| v as f32)),
        );
    }
}

/// Appends a number for each part.
pub(super) fn write_parts(scores: Option<RebaSubScores>, row: &mut Vec<f32>) {
    row.extend(scores.map_or([f32::NAN; PARTS.len()], |scores| {
        let RebaSubScores { neck, trunk, legs, upper_arm, lower_arm, wrist } = scores;
        [neck, trunk, legs, upper_arm, lower_arm, wrist].map(f32::from)
    }));
}

#[cfg(test)]
mod tests {
    use vision_models::{Body, Body25, Confidence, Keypoint};

    use super::*;

    fn percept(time: f64, x: Option<f64>) -> Percept {
        let body = x.map(|x| {
            let mut body = Body::default();
            let position = nalgebra::Point3::new(x, 0.0, 1.0);
            body.set(Body25::Neck, Some(Keypoint { position, confidence: Confidence::ONE }));
            body
        });
        Percept { time, body, action: None, surface: None }
    }

    #[test]
    fn short_gaps_are_filled_long_gaps_are_not() {
        let mut track = PersonTrack::new(1.75);
        for frame in 0..40_u32 {
            let seen = frame != 10 && frame < 20;
            track.observe(
                &percept(0.05 * f64::from(frame), seen.then_some(0.1 * f64::from(frame))),
                None,
            );
        }
        let smooth = track.smoothed();
        let neck = |time: f64| points_at(&smooth, time)[0].map(|neck| neck.x);
        // A straight walk is not changed, except near the gap.
        assert!((neck(0.25).unwrap() - 0.5).abs() < 1e-6);
        assert!((neck(0.5).unwrap() - 1.0).abs() < 1e-6);
        assert!((neck(0.275).unwrap() - 0.55).abs() < 1e-6);
        assert_eq!(neck(1.6), None);
        assert_eq!(neck(-1.0), None);
    }
}
