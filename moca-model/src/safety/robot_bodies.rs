//! The robot's capsules, placed in the world.

use hrsw::{Capsule, RobotBody};

use super::settings::LinkCapsule;
use crate::error::Error;
use crate::robot::{LinkId, RobotData, RobotModel, world_from_link};

/// The capsules of a robot and where they are.
#[derive(Debug, Clone)]
pub(super) struct RobotBodies {
    shapes: Vec<(LinkId, Capsule)>,
    placed: Vec<RobotBody>,
}

impl RobotBodies {
    pub(super) fn new(model: &RobotModel, bodies: &[LinkCapsule]) -> Result<Self, Error> {
        let mut shapes = Vec::with_capacity(bodies.len());
        let mut placed = Vec::with_capacity(bodies.len());
        for body in bodies {
            let link = model.link(&body.link)?;
            shapes.push((link, body.capsule));
            placed.push(RobotBody { capsule: body.capsule, joints: model.joints_moving(link)? });
        }
        Ok(Self { shapes, placed })
    }

    /// Places them for the configuration of the last forward kinematics.
    pub(super) fn place(&mut self, model: &RobotModel, data: &RobotData) -> Result<(), Error> {
        let mut last = None;
        for (body, &(link, capsule)) in self.placed.iter_mut().zip(&self.shapes) {
            let pose = match last {
                Some((same, pose)) if same == link => pose,
                _ => world_from_link(model, data, link)?,
            };
            body.capsule = capsule.placed(&pose);
            last = Some((link, pose));
        }
        Ok(())
    }

    pub(super) fn placed(&self) -> &[RobotBody] {
        &self.placed
    }
}
