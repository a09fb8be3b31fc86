//! Changes of shape that are continuous in time.

use crate::error::{Error, positive};
use crate::motion::is_period;
use crate::shape::{Bounds, OrientationShape, PositionShape};

/// Shapes of one kind with blends of the same kind.
pub(crate) trait Blend: Sized {
    /// Returns (1 − share) · self + share · other, if the kind contains it.
    fn blended(&self, other: &Self, share: f64) -> Option<Self>;
}

impl Blend for PositionShape {
    fn blended(&self, other: &Self, share: f64) -> Option<Self> {
        match (self, other) {
            (Self::Box(from), Self::Box(to)) => Some(Self::Box(from.blended(to, share))),
            _ => None,
        }
    }
}

impl Blend for OrientationShape {
    fn blended(&self, other: &Self, share: f64) -> Option<Self> {
        match (self, other) {
            (Self::Box(from), Self::Box(to)) => Some(Self::Box(from.blended(to, share))),
            (Self::Cone(from), Self::Cone(to)) => from.blended(to, share).map(Self::Cone),
            _ => None,
        }
    }
}

/// A shape, or a transition between two shapes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Change<S> {
    from: S,
    to: Option<Target<S>>,
    next: Option<(S, f64)>,
}

#[derive(Debug, Clone, PartialEq)]
struct Target<S> {
    shape: S,
    duration: f64,
    elapsed: f64,
}

/// Current stage of a change.
pub(crate) enum Stage<'a, S> {
    Still(&'a S),
    /// `share` is that of `to`, and `rate` its rate \[1/s\].
    Between {
        from: &'a S,
        to: &'a S,
        share: f64,
        rate: f64,
    },
}

impl<S: Blend + Clone> Change<S> {
    pub(crate) fn still(shape: S) -> Self {
        Self { from: shape, to: None, next: None }
    }

    /// Starts a change to `shape`. A change in progress continues from its current shape if the
    /// kinds allow it. Otherwise it ends first.
    pub(crate) fn begin(&mut self, shape: S, duration: f64) -> Result<(), Error> {
        positive("the duration of a change of shape", duration)?;
        self.next = None;
        let between = match self.stage() {
            Stage::Still(from) => Some(from.clone()),
            Stage::Between { from, to, share, .. } => from.blended(to, share),
        };
        if let Some(from) = between {
            self.from = from;
            self.to = Some(Target { shape, duration, elapsed: 0.0 });
        } else {
            self.next = Some((shape, duration));
        }
        Ok(())
    }

    pub(crate) fn advance(&mut self, period: f64) {
        if !is_period(period) {
            return;
        }
        let Some(target) = &mut self.to else { return };
        target.elapsed += period;
        if target.elapsed < target.duration {
            return;
        }
        if let Some(target) = self.to.take() {
            self.from = target.shape;
        }
        self.to =
            self.next.take().map(|(shape, duration)| Target { shape, duration, elapsed: 0.0 });
    }

    pub(crate) fn stage(&self) -> Stage<'_, S> {
        match &self.to {
            None => Stage::Still(&self.from),
            Some(Target { shape, duration, elapsed }) => {
                // The polynomial 10u³ − 15u⁴ + 6u⁵ has zero velocity and acceleration at both ends.
                let u = (elapsed / duration).clamp(0.0, 1.0);
                let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
                let rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration;
                Stage::Between { from: &self.from, to: shape, share, rate }
            }
        }
    }

    pub(crate) fn is_still(&self) -> bool {
        self.to.is_none()
    }

    /// Returns the final shape.
    pub(crate) fn goal(&self) -> &S {
        match (&self.next, &self.to) {
            (Some((shape, _)), _) => shape,
            (None, Some(target)) => &target.shape,
            (None, None) => &self.from,
        }
    }
}

impl Change<PositionShape> {
    /// Returns the smallest bounds around the current shape.
    pub(crate) fn extent(&self) -> Bounds {
        match self.stage() {
            Stage::Still(shape) => shape.extent(),
            Stage::Between { from, to, share, .. } => from.extent().blended(&to.extent(), share),
        }
    }
}
