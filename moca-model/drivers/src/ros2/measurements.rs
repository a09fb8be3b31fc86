//! Conversion of joint states and odometry to measurements.

use std::f64::consts::{PI, TAU};
use std::time::SystemTime;

use moca_model::whole_body::control_loop::{JointMeasurement, RobotMode, RobotStatus};
use moca_model::{MOCA_BASE_JOINTS, MOCA_JOINTS};
use nalgebra::{Quaternion as Coordinates, UnitQuaternion, Vector2};

use super::messages::{JointState, Odometry, Text, Time, Twist};
use super::refusal::Refusal;
use super::stamps::Stamps;
use super::{BASE_FRAME, WORLD_FRAME};

/// Largest age of the odometry in a measurement \[s\]. Bases publish more slowly than arms.
const OLDEST_ODOMETRY: f64 = 0.1;
/// Time for which a mode that the robot reports stays valid \[s\].
const MODE_HOLDS: f64 = 1.0;
/// Modes by their names.
const MODES: [(&str, RobotMode); 4] = [
    ("running", RobotMode::Running),
    ("stopped", RobotMode::Stopped),
    ("reflex", RobotMode::Reflex),
    ("user_stop", RobotMode::UserStop),
];
/// Largest deviation of an orientation's norm from 1.
pub(super) const NORM: f64 = 1e-3;
/// Frame of the base on its axles. In the plane it moves like [`BASE_FRAME`].
const AXLES_FRAME: &str = "base_link";

/// Joints of a robot: x, y and yaw of a base, if it has one, then the joints of an arm by their names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotJoints {
    has_base: bool,
    arm: Vec<String>,
}

impl RobotJoints {
    /// Returns the joints of MOCA.
    pub fn moca() -> Self {
        Self::on_base(MOCA_JOINTS.iter().skip(MOCA_BASE_JOINTS).map(ToString::to_string).collect())
    }

    /// Returns the joints of an arm on a base that odometry measures.
    pub fn on_base(arm: Vec<String>) -> Self {
        Self { has_base: true, arm }
    }

    /// Returns the joints of an arm that stands.
    pub fn of_arm(arm: Vec<String>) -> Self {
        Self { has_base: false, arm }
    }

    /// Returns the names of the arm's joints, in the order of q.
    pub fn arm(&self) -> &[String] {
        &self.arm
    }

    /// Returns the number of the base's joints.
    pub(super) fn of_base(&self) -> usize {
        if self.has_base { MOCA_BASE_JOINTS } else { 0 }
    }

    /// Returns the number of joints, with the three of a base.
    pub fn count(&self) -> usize {
        self.of_base() + self.arm.len()
    }
}

/// Combines joint states of the arm with odometry of the base.
///
/// A joint state gives a measurement of both if the last odometry is at most 0.1 s older, or if there is no base. Other
/// joints in the message
/// are ignored: grippers and wheels are published together with the arm.
#[derive(Clone, Debug)]
pub struct Measurements {
    joints: RobotJoints,
    measured: JointMeasurement,
    /// Place of each joint of the arm in a message.
    places: Vec<usize>,
    joint_stamps: Stamps,
    odometry_stamps: Stamps,
    /// Time of the newest odometry.
    odometry: Option<Time>,
    mode: Option<(RobotMode, SystemTime)>,
}

/// Returns the name of a mode on `/robot_mode`.
pub(super) fn mode_name(mode: RobotMode) -> &'static str {
    MODES.iter().find(|(_, known)| *known == mode).map_or("stopped", |(name, _)| name)
}

impl Measurements {
    /// Creates the combination for a robot with these joints, before the first message.
    pub fn new(joints: RobotJoints) -> Self {
        let count = joints.count();
        Self {
            places: Vec::with_capacity(joints.arm.len()),
            measured: JointMeasurement::resting(vec![0.0; count], count),
            joints,
            joint_stamps: Stamps::of_robot(),
            odometry_stamps: Stamps::of_robot(),
            odometry: None,
            mode: None,
        }
    }

    /// Returns the newest measurement of base and arm: q in the world, q̇ along the world's axes. The base measures no
    /// torques.
    pub fn newest(&self) -> &JointMeasurement {
        &self.measured
    }

    /// Takes a joint state that came at time `now` and that completes a measurement. Returns its age \[s\].
    ///
    /// The velocities are required. An empty list of efforts, or a NaN for a joint, means that the torque is not
    /// measured.
    ///
    /// # Errors
    /// Why there is no measurement. The numbers are then unchanged, except with [`Refusal::NoOdometry`].
    pub fn take_joint_state(
        &mut self,
        state: &JointState,
        now: SystemTime,
    ) -> Result<f64, Refusal> {
        let JointState { header, name, position, velocity, effort } = state;
        check_size("position", position, name.len())?;
        check_size("velocity", velocity, name.len())?;
        if !effort.is_empty() {
            check_size("effort", effort, name.len())?;
        }
        self.find(name)?;
        let of = |numbers: &[f64], place: &usize| numbers.get(*place).copied();
        let parts = [("position", position), ("velocity", velocity)];
        for (what, numbers) in parts {
            let finite = |place: &usize| of(numbers, place).is_some_and(f64::is_finite);
            if !self.places.iter().all(finite) {
                return Err(Refusal::NotFinite { what });
            }
        }
        let infinite = |place: &usize| of(effort, place).is_some_and(f64::is_infinite);
        if self.places.iter().any(infinite) {
            return Err(Refusal::NotFinite { what: "effort" });
        }
        let age = self.joint_stamps.admit(header.stamp, now)?;
        let (robot, base) = (self.status(now), self.joints.of_base());
        let measured = &mut self.measured;
        let own = [&mut measured.position, &mut measured.velocity];
        for (own, (_, numbers)) in own.into_iter().zip(parts) {
            for (own, place) in own.iter_mut().skip(base).zip(&self.places) {
                *own = of(numbers, place).unwrap_or(*own);
            }
        }
        for (own, place) in measured.torque.iter_mut().skip(base).zip(&self.places) {
            *own = of(effort, place).filter(|effort| !effort.is_nan());
        }
        measured.robot = robot;
        let oldest = OLDEST_ODOMETRY;
        let recent = |stamp: Time| header.stamp.seconds_since(stamp) <= oldest;
        if base == 0 || self.odometry.is_some_and(recent) {
            Ok(age)
        } else {
            Err(Refusal::NoOdometry { oldest })
        }
    }

    /// Takes odometry that came at time `now`. Returns its age \[s\]. Only the yaw of the orientation counts; it
    /// continues over full turns, as the robot's yaw does.
    ///
    /// # Errors
    /// Why the odometry is refused; the numbers are then unchanged.
    pub fn take_odometry(&mut self, odometry: &Odometry, now: SystemTime) -> Result<f64, Refusal> {
        check_frame(&odometry.header.frame_id, WORLD_FRAME)?;
        if odometry.child_frame_id != AXLES_FRAME {
            check_frame(&odometry.child_frame_id, BASE_FRAME)?;
        }
        let (pose, twist) = (&odometry.pose.pose, &odometry.twist.twist);
        let (at, turned) = (pose.position, pose.orientation);
        if ![at.x, at.y].into_iter().all(f64::is_finite) {
            return Err(Refusal::NotFinite { what: "position" });
        }
        check_twist(twist)?;
        let orientation = Coordinates::new(turned.w, turned.x, turned.y, turned.z);
        let norm = orientation.norm();
        if norm.is_nan() || (norm - 1.0).abs() > NORM {
            return Err(Refusal::Orientation { norm });
        }
        let age = self.odometry_stamps.admit(odometry.header.stamp, now)?;
        if self.joints.of_base() == 0 {
            return Ok(age);
        }
        let (_, _, heading) = UnitQuaternion::from_quaternion(orientation).euler_angles();
        let along =
            nalgebra::Rotation2::new(heading) * Vector2::new(twist.linear.x, twist.linear.y);
        let JointMeasurement { position, velocity, .. } = &mut self.measured;
        if let Some([x, y, yaw]) = position.first_chunk_mut() {
            let turn = (heading - *yaw + PI).rem_euclid(TAU) - PI;
            (*x, *y, *yaw) = (at.x, at.y, *yaw + turn);
        }
        if let Some(base) = velocity.first_chunk_mut() {
            *base = [along.x, along.y, twist.angular.z];
        }
        self.odometry = Some(odometry.header.stamp);
        Ok(age)
    }

    /// Takes the name of the robot's mode that came at time `now`: `running`, `stopped`, `reflex` or `user_stop`.
    ///
    /// # Errors
    /// [`Refusal::Mode`] for another name.
    pub fn take_mode(&mut self, text: &Text, now: SystemTime) -> Result<(), Refusal> {
        let known = MODES.iter().find(|(name, _)| *name == text.data);
        let (_, mode) = known.ok_or_else(|| Refusal::Mode { found: text.data.clone() })?;
        self.mode = Some((*mode, now));
        Ok(())
    }

    /// Returns the mode that the robot reported within the last second. ROS does not say whether the robot took a
    /// command.
    fn status(&self, now: SystemTime) -> RobotStatus {
        let holds = |at: SystemTime| {
            now.duration_since(at).map_or(true, |since| since.as_secs_f64() <= MODE_HOLDS)
        };
        let mode = self.mode.filter(|(_, at)| holds(*at)).map(|(mode, _)| mode);
        RobotStatus { mode, ..RobotStatus::default() }
    }

    /// Finds the places of the arm's joints.
    fn find(&mut self, names: &[String]) -> Result<(), Refusal> {
        self.places.clear();
        for joint in &self.joints.arm {
            let mut places = names.iter().enumerate().filter(|(_, name)| *name == joint);
            let Some((place, _)) = places.next() else {
                return Err(Refusal::MissingJoint { joint: joint.clone(), found: names.to_vec() });
            };
            if places.next().is_some() {
                return Err(Refusal::RepeatedJoint { joint: joint.clone() });
            }
            self.places.push(place);
        }
        Ok(())
    }
}

pub(super) fn check_size(
    what: &'static str,
    numbers: &[f64],
    expected: usize,
) -> Result<(), Refusal> {
    let found = numbers.len();
    if found == expected { Ok(()) } else { Err(Refusal::Size { what, found, expected }) }
}

pub(super) fn check_frame(found: &str, expected: &'static str) -> Result<(), Refusal> {
    if found == expected {
        return Ok(());
    }
    Err(Refusal::Frame { found: found.to_owned(), expected })
}

/// Checks the twist of a base: x, y and the turn about z.
pub(super) fn check_twist(twist: &Twist) -> Result<(), Refusal> {
    let numbers = [twist.linear.x, twist.linear.y, twist.angular.z];
    if numbers.into_iter().all(f64::is_finite) {
        return Ok(());
    }
    Err(Refusal::NotFinite { what: "twist" })
}
