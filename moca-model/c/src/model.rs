//! Robots.

use std::ffi::c_char;

use whole_body::{Base, Description, Model};

use crate::failure::{AhqpStatus, call};
use crate::handle::{free, give, read};
use crate::views::{output, text};

/// A robot: a tree of joints, the bodies that they move, and frames on these. It does not change.
#[derive(Debug, Clone)]
pub struct AhqpModel(pub(crate) Model);

/// Motion of the root link in the world.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AhqpBase {
    /// No motion.
    Fixed,
    /// Motion on the plane z = 0: q begins with x, y \[m\] and yaw \[rad\].
    Planar,
    /// Free motion: q begins with position \[m\] and quaternion x, y, z, w, q̇ with a twist in the world's axes.
    Floating,
}

/// Reads a robot from the text of a URDF. `base` is a value of `AhqpBase`.
///
/// # Safety
/// The text ends with a zero byte; `out` points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_model_from_urdf(
    urdf: *const c_char,
    base: i32,
    out: *mut *mut AhqpModel,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let urdf = unsafe { text("the URDF", urdf) }?;
        let make = || Ok(AhqpModel(Model::from_urdf(urdf, &description(base)?)?));
        // SAFETY: the caller's promise.
        unsafe { give(out, make) }
    })
}

/// Reads a robot from a URDF file.
///
/// # Safety
/// See `ahqp_model_from_urdf`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_model_from_file(
    path: *const c_char,
    base: i32,
    out: *mut *mut AhqpModel,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let path = unsafe { text("the path", path) }?;
        let make = || Ok(AhqpModel(Model::from_urdf_file(path, &description(base)?)?));
        // SAFETY: the caller's promise.
        unsafe { give(out, make) }
    })
}

/// Takes a number, because an enum of C may hold any.
fn description(base: i32) -> crate::failure::Result<Description> {
    let bases = [Base::Fixed, Base::Planar, Base::Floating];
    let base = usize::try_from(base).ok().and_then(|base| bases.get(base)).ok_or_else(|| {
        let text = format_args!("base is {base}; it must be a value of AhqpBase, 0 to 2");
        crate::failure::Failure::new(AhqpStatus::BadArgument, &text)
    })?;
    Ok(Description { base: *base, ..Description::default() })
}

/// Frees a robot. A null pointer is allowed. Objects that were made from the robot stay valid.
///
/// # Safety
/// `model` came from this library and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_model_free(model: *mut AhqpModel) {
    // SAFETY: the caller's promise.
    unsafe { free(model) }
}

/// Returns the size of q; 0 for null.
///
/// # Safety
/// The handle is valid or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_model_position_count(model: *const AhqpModel) -> usize {
    // SAFETY: the caller's promise.
    unsafe { model.as_ref() }.map_or(0, |model| model.0.position_count())
}

/// Returns the size of q̇, the number of degrees of freedom; 0 for null.
///
/// # Safety
/// The handle is valid or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_model_velocity_count(model: *const AhqpModel) -> usize {
    // SAFETY: the caller's promise.
    unsafe { model.as_ref() }.map_or(0, |model| model.0.velocity_count())
}

/// Writes q with all joints at zero.
///
/// # Safety
/// The handle is valid; `q` points to `size` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_model_neutral(
    model: *const AhqpModel,
    q: *mut f64,
    size: usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let model = &unsafe { read("the model", model) }?.0;
        // SAFETY: the caller's promise.
        let q = unsafe { output("q", q, size, model.position_count()) }?;
        q.copy_from_slice(&model.neutral());
        Ok(AhqpStatus::Ok)
    })
}
