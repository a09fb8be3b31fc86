//! Inverse kinematics.

use std::ffi::c_char;

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use whole_body::Ik;
use whole_body::ik::IkBuilder;
use whole_body::stack::TaskId;
use whole_body::tasks::{FrameTask, OrientationTask, PositionTask, PostureTask};

use crate::failure::{AhqpStatus, Failure, Result, call, status};
use crate::handle::{free, give, read, write};
use crate::model::AhqpModel;
use crate::views::{AhqpVector, output, text};

/// Differential inverse kinematics of one robot. It computes velocities for levels of tasks within the limits of all
/// joints. Each level is fulfilled as well as the levels above it allow. First add the tasks, then build, then step.
#[derive(Debug)]
pub struct AhqpIk {
    model: whole_body::Model,
    phase: Phase,
    tasks: Vec<Task>,
}

#[derive(Debug)]
enum Phase {
    Building(Box<IkBuilder>),
    Built(Box<Ik>),
}

#[derive(Debug, Clone, Copy)]
enum Task {
    Position(TaskId<PositionTask>),
    Orientation(TaskId<OrientationTask>),
    Frame(TaskId<FrameTask>),
    Posture(TaskId<PostureTask>),
}

impl AhqpIk {
    fn builder(&mut self) -> Result<&mut IkBuilder> {
        match &mut self.phase {
            Phase::Building(builder) => Ok(builder),
            Phase::Built(_) => {
                let text = "the inverse kinematics is built already; add tasks before";
                Err(Failure::new(AhqpStatus::BadArgument, &text))
            }
        }
    }

    fn built(&mut self) -> Result<(&mut Ik, &[Task])> {
        match &mut self.phase {
            Phase::Built(ik) => Ok((ik, &self.tasks)),
            Phase::Building(_) => {
                let text = "the inverse kinematics is not built yet; call ahqp_ik_build";
                Err(Failure::new(AhqpStatus::BadArgument, &text))
            }
        }
    }
}

/// Creates an inverse kinematics without tasks.
///
/// # Safety
/// The model is valid; `out` points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_new(model: *const AhqpModel, out: *mut *mut AhqpIk) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let model = unsafe { read("the model", model) }?.0.clone();
        let make = || {
            let phase = Phase::Building(Box::new(Ik::builder(&model)));
            Ok(AhqpIk { model: model.clone(), phase, tasks: Vec::new() })
        };
        // SAFETY: the caller's promise.
        unsafe { give(out, make) }
    })
}

/// Frees an inverse kinematics. A null pointer is allowed.
///
/// # Safety
/// `ik` came from `ahqp_ik_new` and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_free(ik: *mut AhqpIk) {
    // SAFETY: the caller's promise.
    unsafe { free(ik) }
}

/// Adds a task that brings the origin of a frame to a point, on a level below all present ones. The number of the task
/// is written to `task`, which may be null.
///
/// # Safety
/// The handle is valid; the texts end with a zero byte; `task` points to room or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_push_position(
    ik: *mut AhqpIk,
    name: *const c_char,
    frame: *const c_char,
    task: *mut usize,
) -> AhqpStatus {
    // SAFETY: the caller's promise.
    call(|| unsafe {
        push_of_frame(ik, name, frame, task, |builder, name, frame| {
            Task::Position(builder.push(name, PositionTask::new(frame)))
        })
    })
}

/// Adds a task that turns a frame to an orientation.
///
/// # Safety
/// See `ahqp_ik_push_position`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_push_orientation(
    ik: *mut AhqpIk,
    name: *const c_char,
    frame: *const c_char,
    task: *mut usize,
) -> AhqpStatus {
    // SAFETY: the caller's promise.
    call(|| unsafe {
        push_of_frame(ik, name, frame, task, |builder, name, frame| {
            Task::Orientation(builder.push(name, OrientationTask::new(frame)))
        })
    })
}

/// Adds a task that brings a frame to a pose.
///
/// # Safety
/// See `ahqp_ik_push_position`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_push_frame(
    ik: *mut AhqpIk,
    name: *const c_char,
    frame: *const c_char,
    task: *mut usize,
) -> AhqpStatus {
    // SAFETY: the caller's promise.
    call(|| unsafe {
        push_of_frame(ik, name, frame, task, |builder, name, frame| {
            Task::Frame(builder.push(name, FrameTask::new(frame)))
        })
    })
}

/// # Safety
/// See `ahqp_ik_push_position`.
unsafe fn push_of_frame(
    ik: *mut AhqpIk,
    name: *const c_char,
    frame: *const c_char,
    task: *mut usize,
    add: impl FnOnce(&mut IkBuilder, String, whole_body::FrameId) -> Task,
) -> Result<AhqpStatus> {
    // SAFETY: the caller's promise.
    let ik = unsafe { write("the inverse kinematics", ik) }?;
    // SAFETY: the caller's promise.
    let (name, frame) = unsafe { (text("the name", name)?, text("the frame", frame)?) };
    let frame = ik.model.frame_id(frame)?;
    let new = add(ik.builder()?, name.to_owned(), frame);
    // SAFETY: the caller's promise.
    unsafe { number(ik, new, task) };
    Ok(AhqpStatus::Ok)
}

/// # Safety
/// `out` points to room or is null.
unsafe fn number(ik: &mut AhqpIk, task: Task, out: *mut usize) {
    ik.tasks.push(task);
    if !out.is_null() {
        // SAFETY: not null; the caller promises room.
        unsafe { *out = ik.tasks.len() - 1 };
    }
}

/// Adds a task that brings all joints to a configuration. As the last task it decides the motions that no other task
/// decides.
///
/// # Safety
/// See `ahqp_ik_push_position`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_push_posture(
    ik: *mut AhqpIk,
    name: *const c_char,
    task: *mut usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let ik = unsafe { write("the inverse kinematics", ik) }?;
        // SAFETY: the caller's promise.
        let name = unsafe { text("the name", name) }?.to_owned();
        let new = Task::Posture(ik.builder()?.push(name, PostureTask::new()));
        // SAFETY: the caller's promise.
        unsafe { number(ik, new, task) };
        Ok(AhqpStatus::Ok)
    })
}

/// Builds the problem of all tasks, with the robot at rest at q. Tasks without a target hold the state at q.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_build(ik: *mut AhqpIk, q: AhqpVector) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let ik = unsafe { write("the inverse kinematics", ik) }?;
        // SAFETY: the caller's promise.
        let q = unsafe { q.required("q", ik.model.position_count()) }?;
        let built = ik.builder()?.clone().build_at(q)?;
        ik.phase = Phase::Built(Box::new(built));
        Ok(AhqpStatus::Ok)
    })
}

/// Sets the target of a position task: a point of the world \[m\] and its velocity \[m/s\], three numbers each. A null
/// velocity means a point at rest.
///
/// # Safety
/// The handle is valid; the vectors point to the numbers that they describe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_set_position(
    ik: *mut AhqpIk,
    task: usize,
    position: AhqpVector,
    velocity: AhqpVector,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, tasks) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        // SAFETY: the caller's promise.
        let position = unsafe { position.required("the position", 3) }?;
        // SAFETY: the caller's promise.
        let velocity = unsafe { velocity.optional("the velocity", 3) }?.unwrap_or(&[0.0; 3]);
        let Some(Task::Position(id)) = tasks.get(task) else { return Err(other(task, "position")) };
        let point = Point3::from_slice(position);
        let velocity = nalgebra::Vector3::from_column_slice(velocity);
        ik.task_mut(*id)?.set_moving_target(point, velocity)?;
        Ok(AhqpStatus::Ok)
    })
}

/// Sets the target of an orientation task: a unit quaternion x, y, z, w.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_set_orientation(
    ik: *mut AhqpIk,
    task: usize,
    quaternion: AhqpVector,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, tasks) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        // SAFETY: the caller's promise.
        let quaternion = unsafe { quaternion.required("the quaternion", 4) }?;
        let Some(Task::Orientation(id)) = tasks.get(task) else {
            return Err(other(task, "orientation"));
        };
        ik.task_mut(*id)?.set_target(rotation(quaternion)?)?;
        Ok(AhqpStatus::Ok)
    })
}

/// Sets the target of a frame task: a point of the world \[m\] and a unit quaternion x, y, z, w.
///
/// # Safety
/// The handle is valid; the vectors point to the numbers that they describe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_set_pose(
    ik: *mut AhqpIk,
    task: usize,
    position: AhqpVector,
    quaternion: AhqpVector,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, tasks) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        // SAFETY: the caller's promise.
        let position = unsafe { position.required("the position", 3) }?;
        // SAFETY: the caller's promise.
        let quaternion = unsafe { quaternion.required("the quaternion", 4) }?;
        let Some(Task::Frame(id)) = tasks.get(task) else { return Err(other(task, "frame")) };
        let translation = Translation3::from(Point3::from_slice(position));
        let pose = Isometry3::from_parts(translation, rotation(quaternion)?);
        ik.task_mut(*id)?.set_target(pose)?;
        Ok(AhqpStatus::Ok)
    })
}

/// Sets the target of a posture task, a complete q.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_set_posture(
    ik: *mut AhqpIk,
    task: usize,
    q: AhqpVector,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, tasks) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        // SAFETY: the caller's promise.
        let q = unsafe { q.required("q", ik.model().position_count()) }?;
        let Some(Task::Posture(id)) = tasks.get(task) else { return Err(other(task, "posture")) };
        ik.task_mut(*id)?.set_target(q)?;
        Ok(AhqpStatus::Ok)
    })
}

fn other(task: usize, kind: &str) -> Failure {
    let text = format_args!("task {task} is no {kind} task of this inverse kinematics");
    Failure::new(AhqpStatus::BadArgument, &text)
}

/// Returns the rotation of four numbers.
fn rotation(quaternion: &[f64]) -> Result<UnitQuaternion<f64>> {
    let quaternion = Quaternion::from_vector(nalgebra::Vector4::from_column_slice(quaternion));
    let norm = quaternion.norm();
    if (norm - 1.0).abs() < 1e-6 {
        return Ok(UnitQuaternion::from_quaternion(quaternion));
    }
    let text = format_args!("the quaternion has norm {norm}; it must be 1");
    Err(Failure::new(AhqpStatus::BadArgument, &text))
}

/// Computes the velocities for the next `period` \[s\], from q and the velocity of the last step. Writes q̇, and q
/// after the period; either pointer may be null. `next_q` may point to the numbers of q. Allocates nothing, unless it
/// returns an error.
///
/// Returns `AHQP_STATUS_OK`, or `…_LIMIT` if the solver's iterations ran out; the limits hold in this case too. After
/// an error, `ahqp_ik_brake` gives velocities that stop the robot.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes; the pointers, if not null, point to room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_step(
    ik: *mut AhqpIk,
    q: AhqpVector,
    period: f64,
    velocity: *mut f64,
    velocity_size: usize,
    next_q: *mut f64,
    next_q_size: usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, _) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        let (positions, velocities) = (ik.model().position_count(), ik.model().velocity_count());
        for (what, data, size, expected) in [
            ("the velocity", velocity, velocity_size, velocities),
            ("next_q", next_q, next_q_size, positions),
        ] {
            if !data.is_null() {
                // SAFETY: the caller's promise; nothing is read or written yet.
                unsafe { output(what, data, size, expected) }?;
            }
        }
        let step = {
            // SAFETY: the caller's promise. This is over before q may be written.
            let q = unsafe { q.required("q", positions) }?;
            ik.step(q, period)?
        };
        if !velocity.is_null() {
            // SAFETY: the caller's promise.
            let out = unsafe { output("the velocity", velocity, velocity_size, velocities) }?;
            out.copy_from_slice(step.velocity());
        }
        if !next_q.is_null() {
            // SAFETY: both have room for as many numbers; they may be equal.
            unsafe { std::ptr::copy(q.data, next_q, positions) };
            // SAFETY: the caller's promise.
            step.integrate(unsafe { output("next_q", next_q, next_q_size, positions) }?)?;
        }
        Ok(status(step.status()))
    })
}

/// Brakes every joint for a period \[s\], at the limits of acceleration and jerk, and writes q̇.
///
/// # Safety
/// The handle is valid; `velocity` points to `size` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_brake(
    ik: *mut AhqpIk,
    period: f64,
    velocity: *mut f64,
    size: usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, _) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        let expected = ik.model().velocity_count();
        // SAFETY: the caller's promise.
        let out = unsafe { output("the velocity", velocity, size, expected) }?;
        out.copy_from_slice(ik.brake(period)?);
        Ok(AhqpStatus::Ok)
    })
}

/// Sets the robot's current velocity, without acceleration.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_reset(ik: *mut AhqpIk, velocity: AhqpVector) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, _) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        // SAFETY: the caller's promise.
        let velocity = unsafe { velocity.required("the velocity", ik.model().velocity_count()) }?;
        ik.reset(velocity)?;
        Ok(AhqpStatus::Ok)
    })
}

/// Writes the pose of a frame in the world at q: its position \[m\], three numbers, and its orientation, a unit
/// quaternion x, y, z, w. Either pointer may be null.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes; the text ends with a zero byte; the
/// pointers, if not null, point to room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_ik_pose(
    ik: *mut AhqpIk,
    q: AhqpVector,
    frame: *const c_char,
    position: *mut f64,
    quaternion: *mut f64,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (ik, _) = unsafe { write("the inverse kinematics", ik) }?.built()?;
        // SAFETY: the caller's promise.
        let q = unsafe { q.required("q", ik.model().position_count()) }?;
        // SAFETY: the caller's promise.
        let frame = ik.model().frame_id(unsafe { text("the frame", frame) }?)?;
        let pose = ik.pose(q, frame)?;
        if !position.is_null() {
            // SAFETY: the caller's promise.
            let out = unsafe { output("the position", position, 3, 3) }?;
            out.copy_from_slice(pose.translation.vector.as_slice());
        }
        if !quaternion.is_null() {
            // SAFETY: the caller's promise.
            let out = unsafe { output("the quaternion", quaternion, 4, 4) }?;
            out.copy_from_slice(pose.rotation.coords.as_slice());
        }
        Ok(AhqpStatus::Ok)
    })
}
