//! The eight walking directions.

use std::f64::consts::FRAC_PI_4;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// A direction on the floor in the person's frame: x forwards, y to the left.
///
/// ```
/// use nalgebra::Vector2;
/// use vision_models::WalkingDirection;
///
/// let direction = WalkingDirection::nearest(Vector2::new(-0.3, 0.28));
/// assert_eq!(direction, Some(WalkingDirection::BackwardsLeft));
/// assert!((WalkingDirection::Left.unit() - Vector2::y()).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WalkingDirection {
    /// The direction of x.
    Forwards,
    /// Halfway between forwards and left.
    ForwardsLeft,
    /// The direction of y.
    Left,
    /// Halfway between backwards and left.
    BackwardsLeft,
    /// The direction opposite to x.
    Backwards,
    /// Halfway between backwards and right.
    BackwardsRight,
    /// The direction opposite to y.
    Right,
    /// Halfway between forwards and right.
    ForwardsRight,
}

impl WalkingDirection {
    /// The eight directions, counter-clockwise from forwards in steps of 45°.
    pub const ALL: [Self; 8] = [
        Self::Forwards,
        Self::ForwardsLeft,
        Self::Left,
        Self::BackwardsLeft,
        Self::Backwards,
        Self::BackwardsRight,
        Self::Right,
        Self::ForwardsRight,
    ];

    /// Returns the angle from forwards, counter-clockwise, in (-π, π] (rad).
    pub fn yaw(self) -> f64 {
        let eighths = match self {
            Self::Forwards => 0.0,
            Self::ForwardsLeft => 1.0,
            Self::Left => 2.0,
            Self::BackwardsLeft => 3.0,
            Self::Backwards => 4.0,
            Self::BackwardsRight => -3.0,
            Self::Right => -2.0,
            Self::ForwardsRight => -1.0,
        };
        eighths * FRAC_PI_4
    }

    /// Returns the direction with left and right exchanged.
    #[must_use]
    pub fn mirrored(self) -> Self {
        match self {
            Self::ForwardsLeft => Self::ForwardsRight,
            Self::Left => Self::Right,
            Self::BackwardsLeft => Self::BackwardsRight,
            Self::BackwardsRight => Self::BackwardsLeft,
            Self::Right => Self::Left,
            Self::ForwardsRight => Self::ForwardsLeft,
            Self::Forwards | Self::Backwards => self,
        }
    }

    /// Returns the unit vector in the person's frame.
    pub fn unit(self) -> Vector2<f64> {
        let (sin, cos) = self.yaw().sin_cos();
        Vector2::new(cos, sin)
    }

    /// Returns the direction nearest to a vector in the person's frame. `None` for the zero vector
    /// and for one that is not finite.
    pub fn nearest(vector: Vector2<f64>) -> Option<Self> {
        let vector = vector.try_normalize(0.0)?;
        Self::ALL
            .into_iter()
            .map(|direction| (direction, direction.unit().dot(&vector)))
            .filter(|(_, cosine)| cosine.is_finite())
            .max_by(|(_, one), (_, other)| one.total_cmp(other))
            .map(|(direction, _)| direction)
    }

    pub(super) fn name_while_drilling(self) -> &'static str {
        match self {
            Self::Forwards => "Move Forwards While Drilling",
            Self::ForwardsLeft => "Move Diagonally Forwards Left With Drill",
            Self::Left => "Move Left While Drilling",
            Self::BackwardsLeft => "Move Diagonally Backwards Left With Drill",
            Self::Backwards => "Move Backwards While Drilling",
            Self::BackwardsRight => "Move Diagonally Backwards Right With Drill",
            Self::Right => "Move Right While Drilling",
            Self::ForwardsRight => "Move Diagonally Forwards Right With Drill",
        }
    }

    pub(super) fn name_while_polishing(self) -> &'static str {
        match self {
            Self::Forwards => "Move Forwards While Polishing",
            Self::ForwardsLeft => "Move Diagonally Forwards Left With Polisher",
            Self::Left => "Move Left While Polishing",
            Self::BackwardsLeft => "Move Diagonally Backwards Left With Polisher",
            Self::Backwards => "Move Backwards While Polishing",
            Self::BackwardsRight => "Move Diagonally Backwards Right With Polisher",
            Self::Right => "Move Right While Polishing",
            Self::ForwardsRight => "Move Diagonally Forwards Right With Polisher",
        }
    }
}
