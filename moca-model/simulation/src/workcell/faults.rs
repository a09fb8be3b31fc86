//! Faults around the controller, by switches.

use nalgebra::Vector3;
use simulated_people::{CameraSettings, in_range};

use crate::error::Error;

/// No joint is seen farther than this from where it is, times the factor on noise \[m\]: within the uncertainty that the
/// protective distance allows for.
const LARGEST_ERROR: f64 = 0.02;

/// Things that go wrong.
///
/// ```
/// use moca_simulation::workcell::Faults;
///
/// let faults = Faults { lost: 1.5, ..Faults::default() };
/// assert_eq!(faults.validate().unwrap_err().to_string(), "lost = 1.5: give a probability of 0 to 1");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faults {
    /// Factor on the camera's noise, 0 to 5. Default 1.
    pub noise: f64,
    /// Probability that a joint is missing in a frame; frames are missing in proportion. Default 0.02.
    pub lost: f64,
    /// Delay of frames beyond the usual one \[s\], 0 to 2. Default 0.
    pub latency: f64,
    /// Something stands between the camera and the people. Default false.
    pub occluded: bool,
    /// Mass at the tool that the robot was not told of \[kg\], 0 to 5. Default 0.
    pub payload: f64,
    /// Force on the tool \[N, world\], each axis −200 to 200. Default none.
    pub push_tool: Vector3<f64>,
    /// Force on the elbow likewise.
    pub push_elbow: Vector3<f64>,
    /// Share of the wheels' way that they slip, 0 to 0.5: odometry measures that way as well. Default 0.
    pub slip: f64,
    /// The cable is pulled: commands do not arrive. Default false.
    pub cable: bool,
    /// The robot measures nothing. Default false.
    pub measurements: bool,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            noise: 1.0,
            lost: 0.02,
            latency: 0.0,
            occluded: false,
            payload: 0.0,
            push_tool: Vector3::zeros(),
            push_elbow: Vector3::zeros(),
            slip: 0.0,
            cable: false,
            measurements: false,
        }
    }
}

impl Faults {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Value`] names the field that is wrong.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("noise", self.noise, 0.0..=5.0, "a factor of 0 to 5")?;
        in_range("lost", self.lost, 0.0..=1.0, "a probability of 0 to 1")?;
        in_range("latency", self.latency, 0.0..=2.0, "0 to 2 s")?;
        in_range("payload", self.payload, 0.0..=5.0, "0 to 5 kg")?;
        in_range("slip", self.slip, 0.0..=0.5, "a share of 0 to 0.5")?;
        for (name, force) in [("push_tool", self.push_tool), ("push_elbow", self.push_elbow)] {
            for value in &force {
                in_range(name, *value, -200.0..=200.0, "forces of -200 to 200 N")?;
            }
        }
        Ok(())
    }

    /// The camera.
    pub(super) fn camera(&self) -> CameraSettings {
        CameraSettings {
            noise: self.noise,
            largest_error: LARGEST_ERROR * self.noise.max(1.0),
            drop: self.lost,
            ..CameraSettings::default()
        }
    }

    /// True if the robot may be moved out of its command by something else than the controller.
    pub(super) fn disturb_the_robot(&self) -> bool {
        let forces = self.push_tool.norm() + self.push_elbow.norm();
        self.cable || self.measurements || self.payload > 0.0 || forces > 0.0
    }
}
