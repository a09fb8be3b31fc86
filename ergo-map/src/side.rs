/// A side of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    #[default]
    Right,
}

impl Side {
    /// Returns the sign of y on this side in the person's frame: left +1, right -1.
    pub const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}
