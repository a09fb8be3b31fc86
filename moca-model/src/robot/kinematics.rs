//! Where the links are, and how the tool moves with the joints.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

use super::data::RobotData;
use super::model::{Frame, LinkId, RobotModel};
use crate::error::{Error, check_finite, check_size};

/// Places every link and the tool for the configuration `q`, n \[rad or m\].
///
/// Given q, the world pose of joint i is that of joint i−1, then the fixed
/// placement of the joint, then the turn or slide by qᵢ along its axis.
///
/// # Errors
/// [`Error::WrongSize`] and [`Error::NotFinite`] on q; [`Error::ForeignData`].
/// The data is then as before.
pub fn forward_kinematics(
    model: &RobotModel,
    data: &mut RobotData,
    q: &[f64],
) -> Result<(), Error> {
    data.check(model)?;
    check_size("q", q, model.joint_count())?;
    for (joint, &position) in model.joints.iter().zip(q) {
        check_finite(position, || format!("the position of joint `{}`", joint.name))?;
    }
    place(model, data, q.iter().copied());
    Ok(())
}

pub(super) fn place(model: &RobotModel, data: &mut RobotData, q: impl Iterator<Item = f64>) {
    let mut world = Frame::identity();
    for ((segment, frame), position) in model.segments.iter().zip(&mut data.frames).zip(q) {
        world.position += world.rotation * segment.placement.position;
        world.rotation *= segment.placement.rotation;
        if segment.slides {
            world.position += position * world.rotation.column(2);
        } else {
            turn_about_z(&mut world.rotation, position);
        }
        *frame = world;
    }
    data.tool = Frame {
        rotation: world.rotation * model.tool_from_last_joint.rotation,
        position: world.position + world.rotation * model.tool_from_last_joint.position,
    };
    data.world_from_tool = isometry(&data.tool);
}

/// R ← R · Rz(angle).
fn turn_about_z(rotation: &mut Matrix3<f64>, angle: f64) {
    let (sin, cos) = angle.sin_cos();
    let x = rotation.column(0).into_owned();
    let y = rotation.column(1).into_owned();
    rotation.set_column(0, &(cos * x + sin * y));
    rotation.set_column(1, &(cos * y - sin * x));
}

/// Computes the geometric Jacobian at the configuration of the last
/// [`forward_kinematics`]; see [`RobotData::jacobian`].
///
/// Column i is [zᵢ × (p − pᵢ); zᵢ] for a turning joint and [zᵢ; 0] for a
/// sliding one, with zᵢ its axis, pᵢ its origin and p the tool's.
///
/// # Errors
/// [`Error::ForeignData`].
pub fn jacobian(model: &RobotModel, data: &mut RobotData) -> Result<(), Error> {
    data.check(model)?;
    let tool = data.tool.position;
    let columns = data.jacobian.as_mut_slice().as_chunks_mut::<6>().0;
    for ((segment, frame), column) in model.segments.iter().zip(&data.frames).zip(columns) {
        let axis = frame.rotation.column(2);
        *column = if segment.slides {
            [axis.x, axis.y, axis.z, 0.0, 0.0, 0.0]
        } else {
            let linear = axis.cross(&(tool - frame.position));
            [linear.x, linear.y, linear.z, axis.x, axis.y, axis.z]
        };
    }
    Ok(())
}

/// Pose in the world of a link, at the configuration of the last
/// [`forward_kinematics`].
///
/// # Errors
/// [`Error::ForeignData`]; [`Error::ForeignLink`] if `link` is of another model.
pub fn world_from_link(
    model: &RobotModel,
    data: &RobotData,
    link: LinkId,
) -> Result<Isometry3<f64>, Error> {
    data.check(model)?;
    let found = model
        .links
        .get(link.0)
        .ok_or(Error::ForeignLink { index: link.0, count: model.links.len() })?;
    let joint = found.joint.and_then(|index| data.frames.get(index));
    Ok(match joint {
        Some(world_from_joint) => isometry(world_from_joint) * found.joint_from_link,
        None => found.joint_from_link,
    })
}

fn isometry(frame: &Frame) -> Isometry3<f64> {
    let rotation = Rotation3::from_matrix_unchecked(frame.rotation);
    Isometry3::from_parts(
        Translation3::from(frame.position),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}
