//! Parts that are added to a model during its construction.

use nalgebra::{Isometry3, UnitQuaternion};

use super::checks::check_pose;
use super::description::AddedFrame;
use super::frame::Frame;
use super::joint::JointKind;
use super::model::Model;
use super::warning::Warning;
use crate::error::Error;
use crate::spatial::Pose;

impl Model {
    pub(super) fn add_frame(&mut self, frame: Frame) -> Result<(), Error> {
        let name = frame.name.clone();
        if self.frame_names.insert(name.clone(), self.frames.len()).is_some() {
            return Err(Error::DuplicateName { line: None, element: "frame", name });
        }
        self.frames.push(frame);
        Ok(())
    }

    pub(super) fn place_frame(&mut self, added: &AddedFrame) -> Result<(), Error> {
        check_pose(&added.pose, || format!("the pose of frame `{}`", added.name))?;
        let on = self.frame_as(&added.on, "the frame that carries another")?;
        let carrier = self.frame(on)?;
        let pose = Pose::from_isometry(&Isometry3::from_parts(
            added.pose.translation,
            UnitQuaternion::new_normalize(added.pose.rotation.into_inner()),
        ));
        let frame =
            Frame { name: added.name.clone(), body: carrier.body, pose: carrier.pose.then(&pose) };
        self.add_frame(frame)
    }

    /// Warns of joints that move neither mass nor inertia.
    pub(super) fn warn_of_massless(&mut self) {
        let mut carried: Vec<bool> =
            self.inertias.iter().map(|own| own.mass > 0.0 || own.inertia.norm() > 0.0).collect();
        for (index, mover) in self.movers.iter().enumerate().rev() {
            carried[mover.parent] |= carried[index + 1];
        }
        let mut moves_mass = vec![false; self.velocities];
        for (mover, carried) in self.movers.iter().zip(carried.iter().skip(1)) {
            moves_mass[mover.velocity] |= carried;
        }
        for joint in &self.joints {
            let moves_mass = match joint.kind {
                JointKind::Floating => carried[0],
                _ => moves_mass[joint.velocity_index],
            };
            if !moves_mass {
                self.warnings.push(Warning::NothingToMove { joint: joint.name.clone() });
            }
        }
    }
}
