//! Checks of tasks against a robot.

use crate::error::Error;
use crate::robot::description::Base;
use crate::robot::frame::FrameId;
use crate::robot::joint::{Joint, JointId, JointKind};
use crate::robot::model::Model;

impl Model {
    /// Returns an error unless some joint moves the frame.
    pub(crate) fn expect_moving(&self, frame: FrameId) -> Result<(), Error> {
        if self.moved_by(frame)?.next().is_some() {
            return Ok(());
        }
        let remedy = "name one beyond a joint that moves, or let the joints on the way to it move";
        Err(Error::unsuitable(
            format!("no joint moves frame `{}`", self.frame_name(frame)?),
            remedy,
        ))
    }

    /// Returns an error unless some joint moves one frame relative to the other.
    pub(crate) fn expect_apart(&self, reference: FrameId, frame: FrameId) -> Result<(), Error> {
        if self.frame(reference)?.body == self.frame(frame)?.body {
            let [reference, frame] = [self.frame_name(reference)?, self.frame_name(frame)?];
            let what = format!("no joint stands between frames `{reference}` and `{frame}`");
            let remedy = "name frames of two links that move against each other";
            return Err(Error::unsuitable(what, remedy));
        }
        Ok(())
    }

    /// Returns the joint, or an error unless it has one position and one velocity.
    pub(crate) fn expect_single(&self, joint: JointId) -> Result<&Joint, Error> {
        let joint = self.joint(joint)?;
        if joint.kind == JointKind::Floating {
            return Err(Error::floating_joint(&joint.name));
        }
        Ok(joint)
    }

    /// Returns an error if mimic joints let one entry of q̇ move the frame at several places.
    pub(crate) fn expect_no_repetition(&self, frame: FrameId) -> Result<(), Error> {
        let on_the_way: Vec<usize> = self.moved_by(frame)?.collect();
        let repeated = self.mimic_joints().iter().find(|mimic| {
            let entry = self.joint(mimic.follows).map(|joint| joint.velocity_index);
            let count = on_the_way.iter().filter(|other| entry.as_ref().is_ok_and(|e| e == *other));
            count.count() > 1
        });
        match repeated {
            None => Ok(()),
            Some(mimic) => {
                let what = format!(
                    "mimic joint `{}` moves frame `{}` together with the joint that it follows",
                    mimic.name,
                    self.frame_name(frame)?
                );
                let remedy = "the manipulability of such frames is not supported";
                Err(Error::unsuitable(what, remedy))
            }
        }
    }

    /// True if an entry of q̇ is one of a floating base.
    pub(crate) fn is_base_entry(&self, entry: usize) -> bool {
        self.base() == Base::Floating && entry < 6
    }
}
