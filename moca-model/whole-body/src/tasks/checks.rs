//! What tasks ask of the robot before they are taken into a stack.

use crate::error::Error;
use crate::robot::description::Base;
use crate::robot::frame::FrameId;
use crate::robot::joint::{Joint, JointId, JointKind};
use crate::robot::model::Model;

impl Model {
    /// An error unless some joint moves the frame.
    pub(crate) fn expect_moving(&self, frame: FrameId) -> Result<(), Error> {
        if self.moved_by(frame)?.next().is_some() {
            return Ok(());
        }
        Err(Error::FrameStandsStill { frame: self.frame_name(frame)?.to_owned() })
    }

    /// An error unless some joint moves one frame against the other.
    pub(crate) fn expect_apart(&self, reference: FrameId, frame: FrameId) -> Result<(), Error> {
        if self.frame(reference)?.body == self.frame(frame)?.body {
            let [reference, frame] = [self.frame_name(reference)?, self.frame_name(frame)?];
            return Err(Error::FramesMoveTogether {
                reference: reference.to_owned(),
                frame: frame.to_owned(),
            });
        }
        Ok(())
    }

    /// The joint, if it has one position and one velocity.
    pub(crate) fn expect_single(&self, joint: JointId) -> Result<&Joint, Error> {
        let joint = self.joint(joint)?;
        if joint.kind == JointKind::Floating {
            return Err(Error::FloatingJoint { joint: joint.name.clone() });
        }
        Ok(joint)
    }

    /// An error if a mimic joint lets one entry of q̇ move the frame at several places.
    pub(crate) fn expect_no_repetition(&self, frame: FrameId) -> Result<(), Error> {
        let on_the_way: Vec<usize> = self.moved_by(frame)?.collect();
        let repeated = self.mimic_joints().iter().find(|mimic| {
            let entry = self.joint(mimic.follows).map(|joint| joint.velocity_index);
            let count = on_the_way.iter().filter(|other| entry.as_ref().is_ok_and(|e| e == *other));
            count.count() > 1
        });
        match repeated {
            None => Ok(()),
            Some(mimic) => Err(Error::MimicOnTheWay {
                joint: mimic.name.clone(),
                frame: self.frame_name(frame)?.to_owned(),
            }),
        }
    }

    /// Whether an entry of q̇ is one of a floating base.
    pub(crate) fn is_base_entry(&self, entry: usize) -> bool {
        self.base() == Base::Floating && entry < 6
    }
}
