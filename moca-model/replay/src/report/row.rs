//! One tick of a run.

use hrsw::Workspace;
use moca_model::Controller;
use nalgebra::Vector3;

/// Distance from the workspace below which x_d counts as within it \[m or rad\].
const INSIDE: f64 = 1e-3;

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
    /// True if the person works with the robot.
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

impl TickRow {
    /// Writes what a controller did in its last step, but for the person's scores. Its hand is there \[m, world\], and
    /// its joints measure this \[m or rad\]. Allocates nothing if the joints' vectors are as long already.
    pub fn write(
        &mut self,
        time: f64,
        controller: &Controller,
        (hand, configuration): (&Vector3<f64>, &[f64]),
        solve_time_us: f64,
    ) {
        let command = controller.command();
        (self.time, self.solve_time_us) = (time, solve_time_us);
        self.desired = command.desired.translation.vector.into();
        self.actual = (*hand).into();
        (self.workspace_min, self.workspace_max) = extent(controller.space().workspace());
        self.slack = command.slack.into();
        for (own, values) in
            [(&mut self.q, configuration), (&mut self.qdot, command.joint_velocity.as_slice())]
        {
            own.clear();
            own.extend_from_slice(values);
        }
    }
}

/// The box along world axes around the workspace.
fn extent(workspace: &Workspace) -> ([f64; 3], [f64; 3]) {
    let bounds = workspace.position();
    let centre = (bounds.min() + bounds.max()) * 0.5;
    let half = (bounds.max() - bounds.min()) * 0.5;
    let frame = workspace.world_from_workspace();
    let middle = frame.transform_point(&centre.into()).coords;
    let reach = frame.rotation.to_rotation_matrix().matrix().abs() * half;
    ((middle - reach).into(), (middle + reach).into())
}

/// State of working together: true from the time at which x_d first arrives in the workspace that they share.
///
/// ```
/// use ergo_map::ErgonomicsQuadratic;
/// use moca_model::{Controller, ControllerSettings, MOCA_HOME, moca};
/// use moca_replay::report::Together;
/// use nalgebra::{Matrix3, Vector3};
///
/// let ergonomics = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 1.0)?;
/// let controller = Controller::new(moca()?, ergonomics, ControllerSettings::default(), &MOCA_HOME)?;
/// // Nobody shares the workspace.
/// assert!(Together::is_inside(&controller) && !Together::default().update(&controller));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Together(bool);

impl Together {
    /// True if they work together after the controller's last step.
    pub fn update(&mut self, controller: &Controller) -> bool {
        let is_shared = controller.situation().is_shared;
        self.0 = is_shared && (self.0 || Self::is_inside(controller));
        self.0
    }

    /// True if x_d is within the workspace, but for a millimetre or a milliradian.
    pub fn is_inside(controller: &Controller) -> bool {
        let workspace = controller.space().workspace();
        workspace.violation(&controller.command().desired).amax() <= INSIDE
    }
}
