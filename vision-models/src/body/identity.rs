//! Decides whether the tracked person is still the same one.

use super::{
    lengths::{Lengths, SegmentLength, StatureEstimate},
    seen::Seen,
    segment::BodySegment,
};

/// Two persons' statures differ by more than this (m) plus three standard errors.
const DIFFERENCE: f64 = 0.03;

/// Lengths of the tracked person. A restarted track may belong to another person. The earlier
/// lengths hold until the lengths measured since the restart contradict them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Identity {
    known: Lengths,
    /// Lengths measured since the track restarted.
    since: Option<Lengths>,
}

impl Identity {
    /// Notes that the track restarted.
    pub(super) fn doubt(&mut self) {
        self.since = self.known.stature().map(|_| Lengths::default());
        if self.since.is_none() {
            self.known = Lengths::default();
        }
    }

    pub(super) fn update(&mut self, seen: &Seen<'_>) {
        let Some(since) = &mut self.since else {
            self.known.update(seen);
            return;
        };
        since.update(seen);
        let (Some(before), Some(now)) = (self.known.stature(), since.stature()) else { return };
        let error = before.standard_error.hypot(now.standard_error);
        if (before.stature - now.stature).abs() > DIFFERENCE + 3.0 * error {
            self.known = *since;
        }
        self.since = None;
    }

    pub(super) fn stature(&self) -> Option<StatureEstimate> {
        self.known.stature()
    }

    pub(super) fn length(&self, segment: BodySegment) -> Option<SegmentLength> {
        self.known.length(segment)
    }
}
