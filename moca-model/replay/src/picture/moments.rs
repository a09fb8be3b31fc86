//! State of a replay at a given time.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::recorded::{POINT_COUNT, Replay};

/// Replay at one of its samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment<'a> {
    pub(super) replay: &'a Replay,
    row: &'a [f32],
}

impl<'a> Moment<'a> {
    /// Returns the sample at a time \[s\], or the last one before it.
    pub(super) fn at(replay: &'a Replay, time: f64) -> Self {
        let after = replay.samples.times().partition_point(|&other| other <= time + 1e-9);
        Self { replay, row: replay.samples.row(after.saturating_sub(1)) }
    }

    fn numbers<const N: usize>(&self, group: &str, index: usize) -> Option<[f64; N]> {
        let (begin, _) =
            self.replay.samples.group_places().find(|(_, known)| known.name == group)?;
        let numbers = self.row.get(begin + N * index..)?.first_chunk::<N>()?.map(f64::from);
        numbers.iter().all(|number| number.is_finite()).then_some(numbers)
    }

    /// Returns the pose of a frame of the stage.
    pub(super) fn pose(&self, frame: usize) -> Option<Isometry3<f64>> {
        let [x, y, z, i, j, k, w] = self.numbers::<7>("frames", frame)?;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
        Some(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
    }

    /// Returns the pose of the frame with this name.
    pub(super) fn named(&self, frame: &str) -> Option<Isometry3<f64>> {
        self.pose(self.replay.stage.frames().iter().position(|name| name == frame)?)
    }

    /// Returns the lowest and the highest corner of the shared workspace in its frame.
    pub(super) fn workspace(&self) -> Option<[Vector3<f64>; 2]> {
        let corner = |index| self.numbers::<3>("workspace", index).map(Vector3::from);
        Some([corner(0)?, corner(1)?])
    }

    /// Returns the points of the body with its hand at the tool.
    pub(super) fn body(&self) -> [Option<Vector3<f64>>; POINT_COUNT] {
        std::array::from_fn(|point| self.numbers::<3>("body", point).map(Vector3::from))
    }

    /// Returns the sub-score of a part in that posture; NaN if it is unknown.
    pub(super) fn part(&self, part: usize) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "it was f32")]
        self.numbers::<1>("parts", part).map_or(f32::NAN, |[score]| score as f32)
    }

    /// Returns a number of the series; NaN if it is unknown.
    pub(super) fn series(&self, column: &str) -> f64 {
        let place = self.replay.samples.place("series", column);
        place.and_then(|place| self.row.get(place)).map_or(f64::NAN, |value| f64::from(*value))
    }

    /// Returns the point halfway between the person and the tool, at hip height.
    pub(super) fn middle(&self) -> Option<Vector3<f64>> {
        let (person, tool) = (self.named("person")?, self.named("tool")?);
        let middle = (person.translation.vector + tool.translation.vector) * 0.5;
        Some(Vector3::new(middle.x, middle.y, 0.85))
    }
}

/// Returns the longest interval in which person and robot work together without a break in all replays \[s\]. If there
/// is none, returns the whole interval of the first replay.
pub(super) fn together(replays: &[&Replay]) -> (f64, f64) {
    let Some(first) = replays.first() else { return (0.0, 0.0) };
    let times = first.samples.times();
    let mut longest = (0.0, 0.0);
    let mut begin: Option<f64> = None;
    for &time in times {
        let works = replays.iter().all(|replay| {
            let moment = Moment::at(replay, time);
            moment.series("working together") > 0.5 && moment.middle().is_some()
        });
        begin = if works { begin.or(Some(time)) } else { None };
        if let Some(begin) = begin
            && time - begin > longest.1 - longest.0
        {
            longest = (begin, time);
        }
    }
    if longest.1 > longest.0 {
        longest
    } else {
        (times.first().copied().unwrap_or_default(), times.last().copied().unwrap_or_default())
    }
}
