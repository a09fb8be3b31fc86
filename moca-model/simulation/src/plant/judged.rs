//! What the judge of distances is told of a robot, from the controller's settings.

use hrsw_safety::{Capsule, SafetySettings};
use moca_model::ControllerSettings;
use moca_model::whole_body::Model;

use crate::Error;
use crate::judges::{Rod, Rods, SeparationMonitor, Terms};

/// Creates the judge of the distances of a robot at rest with these settings.
///
/// # Errors
/// Bodies on links that the robot does not have.
pub(crate) fn separation_monitor(
    model: &Model,
    settings: &ControllerSettings,
) -> Result<SeparationMonitor, Error> {
    let safety = &settings.safety;
    SeparationMonitor::new(model, rods(safety), terms(safety), settings.period)
}

/// The numbers of a capsule.
pub(crate) fn rod(capsule: &Capsule) -> Rod {
    Rod { ends: [*capsule.start(), *capsule.end()], radius: capsule.radius() }
}

fn rods(safety: &SafetySettings) -> Rods {
    let bodies = safety.bodies.iter();
    Rods {
        links: bodies.map(|body| (body.link.clone(), rod(&body.capsule))).collect(),
        own_pairs: safety.own_pairs.clone(),
    }
}

fn terms(safety: &SafetySettings) -> Terms {
    let separation = &safety.separation;
    Terms {
        reaction_time: separation.reaction_time,
        deceleration: separation.deceleration,
        base_joints: separation.base.map_or(0, |base| base.joints),
        base_deceleration: separation.base.map_or(separation.deceleration, |b| b.deceleration),
        intrusion: separation.intrusion,
        robot_uncertainty: separation.robot_uncertainty,
    }
}
