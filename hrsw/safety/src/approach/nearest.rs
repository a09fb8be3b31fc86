//! What a supervisor has to know.

/// The pair that is nearest to its protective distance, or deepest within, of those that may not
/// touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Index of the robot's body.
    pub robot: usize,
    /// Index of the person's body, or of the robot's other.
    pub other: usize,
    /// Between the surfaces \[m\].
    pub distance: f64,
    /// S_p at the last commanded velocity and the person's as measured \[m\].
    pub required: f64,
    /// How fast the robot comes nearer at the last commanded velocity \[m/s\].
    pub approach: f64,
}

impl Nearest {
    /// The distance above the protective one \[m\]; negative where it is undercut.
    pub fn room(&self) -> f64 {
        self.distance - self.required
    }
}
