//! What gravity asks of the joints.

use nalgebra::Vector3;

use super::data::RobotData;
use super::model::RobotModel;
use crate::error::Error;

/// Computes the torques and forces that hold the robot still against gravity,
/// at the configuration of the last [`forward_kinematics`](crate::forward_kinematics);
/// see [`RobotData::gravity`].
///
/// The potential energy is U = −gᵀ Σ mₖ cₖ, with cₖ the centres of mass. Its
/// derivative by qᵢ sees only the mass M that joint i carries:
/// ∂U/∂qᵢ = −gᵀ (zᵢ × Σ mₖ(cₖ − pᵢ)) for a turning joint and −M gᵀzᵢ for a
/// sliding one. The sums are built from the tool backwards.
///
/// # Errors
/// [`Error::ForeignData`].
pub fn gravity(model: &RobotModel, data: &mut RobotData) -> Result<(), Error> {
    data.check(model)?;
    // Σ m (c − p) of all bodies behind the joint, and the last joint's p and M.
    let mut moment = Vector3::zeros();
    let mut reference = Vector3::zeros();
    let mut mass = 0.0;
    let torques = data.gravity.as_mut_slice().iter_mut();
    let joints = model.segments.iter().zip(&data.frames).zip(torques);
    for ((segment, frame), torque) in joints.rev() {
        moment += mass * (reference - frame.position) + frame.rotation * segment.first_moment;
        reference = frame.position;
        mass = segment.distal_mass;
        let axis = frame.rotation.column(2);
        *torque = if segment.slides {
            -mass * model.gravity.dot(&axis)
        } else {
            -model.gravity.dot(&axis.cross(&moment))
        };
    }
    Ok(())
}

/// Potential energy of the moving links \[J\], zero when their common centre of
/// mass is at the world's origin, at the configuration of the last
/// [`forward_kinematics`](crate::forward_kinematics).
///
/// # Errors
/// [`Error::ForeignData`].
pub fn potential_energy(model: &RobotModel, data: &RobotData) -> Result<f64, Error> {
    data.check(model)?;
    let mut behind = 0.0;
    let mut moment = Vector3::zeros();
    for (segment, frame) in model.segments.iter().zip(&data.frames).rev() {
        let own_mass = segment.distal_mass - behind;
        behind = segment.distal_mass;
        moment += own_mass * frame.position + frame.rotation * segment.first_moment;
    }
    Ok(-model.gravity.dot(&moment))
}
