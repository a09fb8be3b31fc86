//! One tick of a run.

/// Values of one tick of the controller. Positions are those of the end effector in the world.
///
/// ```
/// use moca_replay::report::TickRow;
///
/// let row = TickRow { time: 1.0, actual: [0.8, 0.0, 1.1], ..TickRow::default() };
/// assert!(!row.collaborating);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TickRow {
    /// Time since the start \[s\].
    pub time: f64,
    /// Desired position x, y, z \[m\].
    pub desired: [f64; 3],
    /// Actual position x, y, z \[m\].
    pub actual: [f64; 3],
    /// Lower bound of the shared workspace on each axis \[m\]; NaN while there is no workspace.
    pub workspace_min: [f64; 3],
    /// Upper bound of the shared workspace on each axis \[m\]; NaN while there is no workspace.
    pub workspace_max: [f64; 3],
    /// Continuous ergonomics score `e_s`, 0 (good) to 4.25.
    pub score: f64,
    /// Integer REBA score of the predicted posture, 1 (good) to 15.
    pub reba: u8,
    /// REBA score of the measured posture, where the person was seen.
    pub reba_measured: Option<u8>,
    /// Whether the person works with the robot.
    pub collaborating: bool,
    /// Configuration, joint by joint \[m or rad\].
    pub q: Vec<f64>,
    /// Rates of `q` \[m/s or rad/s\].
    pub qdot: Vec<f64>,
    /// Violation of the workspace's bounds: position \[m\], then orientation \[rad\].
    pub slack: [f64; 6],
    /// Time of the controller's whole step, with kinematics and tracking \[µs\].
    pub solve_time_us: f64,
}
