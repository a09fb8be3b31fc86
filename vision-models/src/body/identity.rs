//! Whether the person who is tracked now is the one who was tracked before.

use super::{
    lengths::{Lengths, SegmentLength, StatureEstimate},
    seen::Seen,
    segment::BodySegment,
};

/// Two people's statures differ by more than this (m), and by three standard errors.
const DIFFERENCE: f64 = 0.03;

/// The lengths of the person who is tracked. When the track was taken up anew, it may be of somebody
/// else: until lengths measured since then say so, those measured before stand.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Identity {
    known: Lengths,
    /// Since the track was taken up anew.
    since: Option<Lengths>,
}

impl Identity {
    /// The track was taken up anew.
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
