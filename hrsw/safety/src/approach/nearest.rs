//! The pair of bodies that is given to a supervisor.

/// The pair of bodies with the least room to its protective distance. Only pairs that may not touch
/// count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Index of the robot's body.
    pub robot: usize,
    /// Index of the person's body, or of the robot's second body.
    pub other: usize,
    /// Distance between the surfaces \[m\].
    pub distance: f64,
    /// Protective distance S_p at the last commanded velocity and the person's measured velocity
    /// \[m\].
    pub required: f64,
    /// Speed at which the robot approaches at the last commanded velocity \[m/s\].
    pub approach: f64,
}

impl Nearest {
    /// Returns the distance minus the protective distance \[m\]. Negative if the protective
    /// distance is violated.
    pub fn room(&self) -> f64 {
        self.distance - self.required
    }
}
