//! Setup with which a workcell begins.

use ergo_map::{ErgonomicsMap, ErgonomicsQuadratic, FitOptions};
use moca_model::ControllerSettings;
use simulated_people::in_range;

use crate::error::Error;
use crate::plant::PlantSettings;

/// Place of the camera that looks at the held object, in the base's frame \[m\].
const ON_BOARD_CAMERA: [f64; 3] = [0.35, 0.0, 1.15];

/// The robot, controller and person that a workcell begins with.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The person's map, which scores the postures and says how tall the person is.
    pub map: ErgonomicsMap,
    /// Quadratic that the controller minimises.
    pub ergonomics: ErgonomicsQuadratic,
    /// The robot, its controller and the loop of torques below it.
    pub robot: PlantSettings,
    /// True if the person brings the object; the robot holds it from the beginning otherwise.
    pub hands_over: bool,
    /// Seed of everything random.
    pub seed: u64,
}

impl Setup {
    /// MOCA under torques for the person of a map, with the default settings, holding the object.
    ///
    /// # Errors
    /// A map that cannot be fitted.
    pub fn new(map: ErgonomicsMap) -> Result<Self, Error> {
        let (ergonomics, _) = map.fit(&FitOptions::default()).map_err(Error::Fit)?;
        let robot = PlantSettings::default();
        let space = robot.controller.space.for_person(map.person(), map.side());
        let controller = ControllerSettings {
            space,
            on_board_camera: Some(ON_BOARD_CAMERA),
            ..robot.controller
        };
        let robot = PlantSettings { controller, ..robot };
        Ok(Self { map, ergonomics, robot, hands_over: false, seed: 1 })
    }

    /// The same for a person of another stature \[m\].
    ///
    /// # Errors
    /// A stature that nobody has.
    pub fn for_stature(&self, stature: f64) -> Result<Self, Error> {
        in_range("stature", stature, 1.4..=2.1, "1.4 to 2.1 m")?;
        let map = self.map.for_stature(stature)?;
        let fresh = Self::new(map)?;
        let space = fresh.robot.controller.space;
        let controller = ControllerSettings { space, ..self.robot.controller.clone() };
        let robot = PlantSettings { controller, ..self.robot.clone() };
        Ok(Self { robot, hands_over: self.hands_over, seed: self.seed, ..fresh })
    }
}
