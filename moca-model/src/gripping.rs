//! The gripper, and the object that it takes.

use whole_body::control_loop::Grip;

use crate::error::Error;
use crate::grasped_object::GraspedObject;
use crate::interaction::Phase;
use crate::torque::TorqueController;

/// Time at which the gripper closes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GripTime {
    /// In the first tick: the object is between the fingers.
    AtOnce,
    /// When the tool is at the object that the person holds out.
    WhenOffered,
}

/// Closes the gripper, and tells the controller what it holds as soon as the robot says that it holds something.
#[derive(Debug)]
pub(crate) struct Gripping {
    time: GripTime,
    /// Object as the controller believes it to be; `None` while the robot holds it.
    awaited: Option<GraspedObject>,
}

impl Gripping {
    /// Creates a gripper for this object.
    ///
    /// # Errors
    /// Those of [`GraspedObject::validate`].
    pub(crate) fn new(object: GraspedObject, time: GripTime) -> Result<Self, Error> {
        object.validate()?;
        Ok(Self { time, awaited: Some(object) })
    }

    /// Takes whether the robot holds something, and returns what the gripper is to do. An object that is no longer held
    /// is released.
    ///
    /// # Errors
    /// Never, for an object that was checked.
    pub(crate) fn advance(
        &mut self,
        controller: &mut TorqueController,
        holds: Option<bool>,
    ) -> Result<Grip, Error> {
        if holds == Some(false) && controller.controller().object().is_some() {
            self.awaited = controller.release()?;
        }
        let closes = match self.time {
            GripTime::AtOnce => true,
            GripTime::WhenOffered => {
                let controller = controller.controller();
                controller.object().is_some() || controller.command().phase == Phase::Grasping
            }
        };
        if closes
            && holds == Some(true)
            && let Some(object) = self.awaited.take()
        {
            controller.grasp(object)?;
        }
        Ok(if closes { Grip::Close } else { Grip::Open })
    }
}
