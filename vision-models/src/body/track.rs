//! The person at the last measurements.

use nalgebra::Vector2;

use super::{
    filter::Measurement,
    freshness::Freshness,
    heading::Heading,
    settings::{
        ACQUIRE_FRAMES, ACQUIRE_RADIUS, MAX_SPEED, TrackerSettings, jump_distance,
        outlier_distance, turning, walking,
    },
    two_models::TwoModels,
};

/// The person at the last measurements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    pub(super) floor: TwoModels<2>,
    pub(super) floor_time: f64,
    pub(super) heading: TwoModels<1>,
    pub(super) heading_time: f64,
    /// Number of consecutive outlier headings, and the smallest of their squared distances.
    turned: Option<(u32, f64)>,
}

/// A person seen away from the track. It becomes the track if seen there for enough frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    floor: Measurement<2>,
    heading: Option<Heading>,
    time: f64,
    frames: u32,
    /// Squared distance from the track in the frame in which it was nearest.
    distance: f64,
}

impl Track {
    /// Creates a track at rest with this heading, unwrapped.
    pub(super) fn starting_at(floor: &Measurement<2>, heading: &Measurement<1>, time: f64) -> Self {
        Self {
            floor: TwoModels::starting_at(floor, &walking()),
            floor_time: time,
            heading: TwoModels::starting_at(heading, &turning()),
            heading_time: time,
            turned: None,
        }
    }

    /// Updates the position with the measurements that are not outliers. If all are, returns the
    /// squared distance of the nearest.
    pub(super) fn take_floor(
        &mut self,
        floors: impl Iterator<Item = Measurement<2>>,
        time: f64,
    ) -> Result<(), f64> {
        let (motion, elapsed) = (walking(), time - self.floor_time);
        let expected = self.floor.advanced(elapsed, &motion);
        let (mut taken, mut nearest) = (None::<Measurement<2>>, f64::INFINITY);
        for floor in floors {
            let distance = expected.distance_squared(&floor);
            nearest = nearest.min(distance);
            if distance <= outlier_distance() {
                taken = taken.map_or(Some(floor), |before| before.with(&floor));
            }
        }
        let floor = taken.ok_or(nearest)?;
        self.floor = self.floor.corrected(&floor, elapsed, &motion);
        self.floor_time = time;
        Ok(())
    }

    /// Updates the heading. An outlier is ignored unless it lasts. Returns true if the person
    /// turned suddenly.
    pub(super) fn take_heading(
        &mut self,
        heading: Heading,
        time: f64,
        settings: &TrackerSettings,
    ) -> bool {
        let motion = turning();
        let since = time - self.heading_time;
        let elapsed = since.min(Freshness::COASTING);
        let expected = self.heading.advanced(elapsed, &motion);
        let angle = nearest_branch(heading.angle, expected.position().x);
        let measured = settings.heading(angle, &heading);
        let distance = expected.distance_squared(&measured);
        let mut jumped = false;
        if distance <= outlier_distance() {
            self.heading = self.heading.corrected(&measured, elapsed, &motion);
        } else {
            let (frames, nearest) = self.turned.unwrap_or((0, f64::INFINITY));
            let (frames, nearest) = (frames.saturating_add(1), nearest.min(distance));
            jumped = nearest > jump_distance();
            let lasting = frames >= ACQUIRE_FRAMES;
            if !(lasting && (jumped || since > Freshness::COASTING)) {
                self.turned = Some((frames, nearest));
                return false;
            }
            self.heading = TwoModels::starting_at(&measured, &motion);
        }
        self.heading_time = time;
        self.turned = None;
        jumped
    }
}

impl Candidate {
    /// Returns the candidate after a frame. `distance` is the squared distance from the track, if
    /// there is one. The previous candidate continues if the two agree.
    pub(super) fn seen(
        before: Option<Self>,
        floor: Measurement<2>,
        heading: Option<Heading>,
        time: f64,
        distance: f64,
    ) -> Self {
        match before {
            Some(before) if before.agrees_with(&floor.position, time) => Self {
                floor,
                heading: heading.or(before.heading),
                time,
                frames: before.frames.saturating_add(1),
                distance: before.distance.min(distance),
            },
            _ => Self { floor, heading, time, frames: 1, distance },
        }
    }

    fn agrees_with(&self, floor: &Vector2<f64>, time: f64) -> bool {
        let elapsed = time - self.time;
        let reach = ACQUIRE_RADIUS + MAX_SPEED * elapsed;
        elapsed <= Freshness::COASTING && (floor - self.floor.position).norm() <= reach
    }

    /// Returns the person's position and heading, if they were seen there for enough frames.
    pub(super) fn accepted(&self) -> Option<(Measurement<2>, Heading)> {
        let lasting = self.frames >= ACQUIRE_FRAMES;
        self.heading.filter(|_| lasting).map(|heading| (self.floor, heading))
    }

    /// Returns true if the position jumped: noise alone cannot explain the distance in each of the
    /// frames. Otherwise the track has drifted away from the person.
    pub(super) fn is_jump(&self) -> bool {
        self.distance.is_finite() && self.distance > jump_distance()
    }
}

/// Returns the angle nearest to `reference` that differs from `angle` by whole turns (rad).
pub(super) fn nearest_branch(angle: f64, reference: f64) -> f64 {
    use std::f64::consts::TAU;
    angle + TAU * ((reference - angle) / TAU).round()
}
