//! The object that the robot is to hold.

use anyhow::Result;
use clap::ValueEnum;
use moca_model::{GripTime, LoopController};
use moca_simulation::run::{Delivery, Scenario};
use vision_models::Surface;

/// The object for the robot's gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ObjectOption {
    /// The robot holds it from the first tick on. Its surfaces are as recorded.
    Held,
    /// The person hands it over, with its drilled surface in front.
    OfferedDrilled,
    /// The person hands it over, with its smooth surface in front.
    OfferedSmooth,
}

impl ObjectOption {
    /// The scenario with this object.
    pub fn in_scenario(self, scenario: Scenario) -> Scenario {
        match self {
            Self::Held => scenario,
            Self::OfferedDrilled => scenario.handed_over(Surface::Drilled),
            Self::OfferedSmooth => scenario.handed_over(Surface::Smooth),
        }
    }

    /// The law of a robot whose gripper takes the object of this scenario.
    ///
    /// # Errors
    /// None, for the objects of scenarios.
    pub fn taken_by(law: LoopController, scenario: &Scenario) -> Result<LoopController> {
        let taking = match &scenario.delivery {
            Delivery::Grasped => law.taking(scenario.object.clone(), GripTime::AtOnce),
            Delivery::HandedOver { believed } => {
                law.taking(believed.clone(), GripTime::WhenOffered)
            }
        };
        Ok(taking?)
    }
}
