//! Distance up to which pairs matter.

/// Terms of the distance beyond which a pair needs no row. A pair beyond it has more headroom than
/// all pairs that are kept, or than can be used up within a tick.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// Distance to a person who stands still \[m\].
    pub(super) standing: f64,
    /// Time in which a moving person comes closer \[s\].
    pub(super) time: f64,
}

impl Reach {
    /// Returns the distance for a person with this speed towards the robot \[m\].
    pub(super) fn sight(&self, human_speed: f64) -> f64 {
        self.standing + human_speed * self.time
    }
}
