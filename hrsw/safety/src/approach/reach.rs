//! How far pairs matter.

/// The distance beyond which a pair needs no row: it then has more headroom than all that are kept, or than can
/// be used up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// From a person who stands \[m\].
    pub(super) standing: f64,
    /// In which a person comes nearer \[s\].
    pub(super) time: f64,
}

impl Reach {
    /// From a person of this speed towards the robot \[m\].
    pub(super) fn sight(&self, human_speed: f64) -> f64 {
        self.standing + human_speed * self.time
    }
}
