//! Joints with torque drives, by name.

use crate::error::Error;
use crate::robot::joint::JointKind;
use crate::robot::model::Model;

/// Returns the entries of q and q̇ of joints by name, in the order of q.
pub(crate) fn joints(model: &Model, names: &[String]) -> Result<Vec<(usize, usize)>, Error> {
    let mut ids: Vec<_> = model.joint_ids().collect();
    if !names.is_empty() {
        let named: Vec<_> =
            names.iter().map(|name| model.joint_id(name)).collect::<Result<_, _>>()?;
        ids.retain(|id| named.contains(id));
    }
    let joints = ids.into_iter().map(|id| {
        let joint = model.joint(id)?;
        if joint.kind == JointKind::Floating {
            return Err(Error::floating_joint(&joint.name));
        }
        Ok((joint.position_index, joint.velocity_index))
    });
    joints.collect()
}
