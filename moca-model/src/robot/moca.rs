//! MOCA: a Franka Emika Panda on a Robotnik SUMMIT-XL STEEL.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use whole_body::robot::{JointFriction, LimitOverride};
use whole_body::{Description, Model};

use crate::error::Error;

/// The URDF of MOCA in this crate; its header names the sources.
pub const MOCA_URDF: &str = include_str!("../../urdf/moca.urdf");

/// The joints of q: base x, y, yaw, then the arm's seven joints.
pub const MOCA_JOINTS: [&str; 10] = [
    "base_x",
    "base_y",
    "base_yaw",
    "panda_joint1",
    "panda_joint2",
    "panda_joint3",
    "panda_joint4",
    "panda_joint5",
    "panda_joint6",
    "panda_joint7",
];

/// MOCA's tool: the point between the finger tips.
pub const MOCA_TOOL: &str = "panda_tcp";

/// The joint that mounts the arm, for [`Description::origins`]. Its origin is the pose of `panda_link0` in `base_link`,
/// which is 0.12688 m above the floor. MOCA's mount is not published; the URDF's is that of a similar pair of robots.
pub const MOCA_ARM_MOUNT: &str = "arm_mount";

/// The number of MOCA's base joints, which come first.
pub const MOCA_BASE_JOINTS: usize = 3;

/// The base at the world's origin and the arm at its manufacturer's home \[m, rad\].
pub const MOCA_HOME: [f64; 10] =
    [0.0, 0.0, 0.0, 0.0, -FRAC_PI_4, 0.0, -3.0 * PI / 4.0, 0.0, FRAC_PI_2, FRAC_PI_4];

/// Acceleration \[rad/s²\] and jerk \[rad/s³\] limits of the Panda's joints,
/// from Franka Emika's interface specification.
const ARM_MOTION: [(f64, f64); 7] = [
    (15.0, 7500.0),
    (7.5, 3750.0),
    (10.0, 5000.0),
    (12.5, 6250.0),
    (15.0, 7500.0),
    (20.0, 10000.0),
    (20.0, 10000.0),
];

/// Acceleration limits of the base: x and y \[m/s²\], yaw \[rad/s²\], from the
/// configuration of the SUMMIT-XL STEEL's own controller. It states no jerk.
const BASE_ACCELERATION: [f64; 3] = [0.6, 0.6, 1.5];

/// Speed of the rim of a SUMMIT-XL STEEL wheel at its motor's limit \[m/s\]:
/// 27.27 rad/s on a radius of 0.127 m.
pub const MOCA_WHEEL_SPEED: f64 = 27.27 * 0.127;

/// The distance from the base's centre at which a wheel acts when the base turns \[m\]: half the wheelbase plus half
/// the track, 0.2225 + 0.2045.
///
/// A mecanum base can move at (vₓ, vᵧ, ω) in its own frame if |vₓ| + |vᵧ| + `MOCA_WHEEL_LEVER`·|ω| ≤
/// [`MOCA_WHEEL_SPEED`].
pub const MOCA_WHEEL_LEVER: f64 = 0.2225 + 0.2045;

/// Largest speed of the base along each of its own axes \[m/s\], as its real controller is
/// configured.
pub const MOCA_AXIS_SPEED: f64 = 1.5;

/// Creates the model of MOCA with its fingers closed, n = 10.
///
/// ```
/// use moca_model::whole_body::Data;
/// use moca_model::{MOCA_HOME, MOCA_TOOL, moca};
///
/// let model = moca()?;
/// assert_eq!(model.velocity_count(), 10); // base x, y, yaw, then the arm's seven
///
/// let tool = model.frame_id(MOCA_TOOL)?;
/// let mut data = Data::new(&model);
/// let height = data.pose(&model, &MOCA_HOME)?.world_from(tool)?.translation.z;
/// assert!((height - 0.9959).abs() < 1e-4); // metres above the floor
/// # Ok::<(), moca_model::Error>(())
/// ```
///
/// # Errors
/// Never with this URDF.
pub fn moca() -> Result<Model, Error> {
    Ok(Model::from_urdf(MOCA_URDF, &moca_description())?)
}

/// Returns the description of [`MOCA_URDF`]: the joints of [`MOCA_JOINTS`] move [`MOCA_TOOL`] on a fixed base.
///
/// Acceleration and jerk limits are from the manufacturers' specifications. Positions and efforts of the base's joints
/// are unlimited. The friction of the arm's joints is that of Gaz et al.
///
/// ```
/// use moca_model::whole_body::Model;
/// use moca_model::{MOCA_ARM_MOUNT, MOCA_URDF, moca_description};
/// use nalgebra::Isometry3;
///
/// // An arm mounted 10 cm further to the front:
/// let mut description = moca_description();
/// let mount = Isometry3::translation(0.1, 0.0, 0.38212);
/// description.origins.push((MOCA_ARM_MOUNT.into(), mount));
/// let model = Model::from_urdf(MOCA_URDF, &description)?;
/// # Ok::<(), moca_model::whole_body::Error>(())
/// ```
pub fn moca_description() -> Description {
    let base = BASE_ACCELERATION.map(|acceleration| LimitOverride {
        position: Some((f64::NEG_INFINITY, f64::INFINITY)),
        acceleration: Some(acceleration),
        effort: Some(f64::INFINITY),
        ..LimitOverride::default()
    });
    let arm = ARM_MOTION.map(|(acceleration, jerk)| LimitOverride {
        acceleration: Some(acceleration),
        jerk: Some(jerk),
        ..LimitOverride::default()
    });
    let names = MOCA_JOINTS.map(str::to_owned);
    let arm_names = names.iter().skip(MOCA_BASE_JOINTS).cloned();
    Description {
        tips: vec![MOCA_TOOL.to_owned()],
        friction: arm_names.zip(JointFriction::PANDA).collect(),
        joints: names.to_vec(),
        limits: names.into_iter().zip(base.into_iter().chain(arm)).collect(),
        ..Description::default()
    }
}
