//! One tick of a run.

/// What is kept of one tick of the controller. Positions are the end effector's, in the world.
///
/// ```
/// use moca_replay::report::TickRow;
///
/// let row = TickRow { time: 1.0, actual: [0.8, 0.0, 1.1], ..TickRow::default() };
/// assert!(!row.collaborating);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TickRow {
    /// Since the start (s).
    pub time: f64,
    /// Desired position x, y, z (m).
    pub desired: [f64; 3],
    /// Actual position x, y, z (m).
    pub actual: [f64; 3],
    /// Lower bounds of the shared workspace, each axis (m); NaN while there is no workspace.
    pub workspace_min: [f64; 3],
    /// Upper bounds of the shared workspace, each axis (m); NaN while there is no workspace.
    pub workspace_max: [f64; 3],
    /// The continuous ergonomics score `e_s`, 0 (good) to 4.25.
    pub score: f64,
    /// The integer REBA score of the predicted posture, 1 (good) to 15.
    pub reba: u8,
    /// That of the posture that was measured, where the person was seen.
    pub reba_measured: Option<u8>,
    /// Whether the person works with the robot.
    pub collaborating: bool,
    /// The configuration, joint by joint (m or rad).
    pub q: Vec<f64>,
    /// Rates of `q` (m/s or rad/s).
    pub qdot: Vec<f64>,
    /// How far the workspace is softened, position (m) then orientation (rad).
    pub slack: [f64; 6],
    /// Of the controller's whole step, kinematics and tracking included (µs).
    pub solve_time_us: f64,
}
