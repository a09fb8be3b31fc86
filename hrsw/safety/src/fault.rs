//! Faults of a control loop, and the reaction of the robot to each.

use crate::safety_state::SafetyState;

/// Reason why the time of a tick cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum ClockFault {
    /// The time is NaN or infinite.
    #[error("clock not finite")]
    NotFinite,
    /// The time is that of the tick before.
    #[error("clock standing still")]
    StandsStill,
    /// The time is before that of the tick before.
    #[error("clock set back")]
    SetBack,
    /// The time is far after that of the tick before: the clock was set, or the loop stood still.
    #[error("clock set ahead")]
    SetAhead,
}

/// Reason why a camera frame is refused and counts as no data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum FrameFault {
    /// The stamp is NaN or infinite.
    #[error("frame without a time")]
    NotFinite,
    /// The stamp is after the current time.
    #[error("frame from the future")]
    Future,
    /// The stamp has another origin than the ticks, for instance seconds since 1970 instead of
    /// seconds since the start.
    #[error("frame of another epoch")]
    ForeignEpoch,
    /// The stamp equals that of the newest frame.
    #[error("frame repeated")]
    Repeated,
    /// The stamp is before that of the newest frame.
    #[error("frame out of order")]
    OutOfOrder,
    /// A joint is farther away than anything in a room. It is in other units, such as millimetres.
    #[error("frame in other units")]
    Units,
    /// The frame shows a body with impossible proportions.
    #[error("frame of an impossible body")]
    ImpossibleBody,
    /// The frame shows a person at a place that nobody can have reached since the frame before.
    #[error("frame of an impossible speed")]
    ImpossibleSpeed,
}

/// A fault of the control loop.
///
/// ```
/// use hrsw_safety::{Fault, FrameFault, SafetyState};
///
/// let fault = Fault::from(FrameFault::Repeated);
/// assert_eq!(fault.to_string(), "frame repeated");
/// assert_eq!(fault.state(), SafetyState::Reduced);
/// assert!(!fault.waits());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The time of a tick cannot be used.
    #[error(transparent)]
    Clock(#[from] ClockFault),
    /// A tick came before it was due.
    #[error("tick early")]
    EarlyTick,
    /// Most of the last ticks came late: the loop is slower than its period.
    #[error("tick late")]
    LateTick,
    /// A camera frame was refused.
    #[error(transparent)]
    Frame(#[from] FrameFault),
    /// More people are in view than the robot can track.
    #[error("too many people")]
    TooManyPeople,
    /// The measured state is not finite, or of the wrong size.
    #[error("bad measurement")]
    BadMeasurement,
    /// The robot sends no measurements, and its last known state is too old to control it.
    #[error("measurement missing")]
    MissingMeasurement,
    /// The measurements do not change although they must.
    #[error("measurement frozen")]
    FrozenMeasurement,
    /// The robot does not receive the commands that are sent to it.
    #[error("command lost")]
    LostCommand,
    /// Measured and commanded state differ by more than the following-error limit, because the
    /// robot is held or pushed.
    #[error("following error")]
    FollowingError,
    /// The robot reports that it takes no commands. It stopped by itself, for instance because
    /// packets were lost.
    #[error("robot stopped")]
    RobotStopped,
    /// The force on the robot from outside is too large: a collision, or a person is clamped.
    #[error("contact force")]
    ContactForce,
    /// The tool carries a weight that the robot does not know.
    #[error("unknown payload")]
    UnknownPayload,
    /// The solver found no command.
    #[error("no solution")]
    NoSolution,
    /// The solver ran out of iterations or time before the optimum. The constraints hold.
    #[error("iteration limit")]
    IterationLimit,
    /// A number that the loop computed is not finite.
    #[error("bad data")]
    BadData,
    /// A limit of the robot was violated.
    #[error("limit violated")]
    LimitViolated,
    /// A person or the program around the loop asked the robot to stop.
    #[error("stop requested")]
    StopRequested,
}

impl Fault {
    /// Faults in the order of the enum.
    pub const ALL: [Self; 28] = [
        Self::Clock(ClockFault::NotFinite),
        Self::Clock(ClockFault::StandsStill),
        Self::Clock(ClockFault::SetBack),
        Self::Clock(ClockFault::SetAhead),
        Self::EarlyTick,
        Self::LateTick,
        Self::Frame(FrameFault::NotFinite),
        Self::Frame(FrameFault::Future),
        Self::Frame(FrameFault::ForeignEpoch),
        Self::Frame(FrameFault::Repeated),
        Self::Frame(FrameFault::OutOfOrder),
        Self::Frame(FrameFault::Units),
        Self::Frame(FrameFault::ImpossibleBody),
        Self::Frame(FrameFault::ImpossibleSpeed),
        Self::TooManyPeople,
        Self::BadMeasurement,
        Self::MissingMeasurement,
        Self::FrozenMeasurement,
        Self::LostCommand,
        Self::FollowingError,
        Self::RobotStopped,
        Self::ContactForce,
        Self::UnknownPayload,
        Self::NoSolution,
        Self::IterationLimit,
        Self::BadData,
        Self::LimitViolated,
        Self::StopRequested,
    ];

    /// Returns the safety state that the robot enters at once, unless it is in a stricter state.
    ///
    /// The state is reduced if the loop continues with what it has. Examples are a frame that is
    /// lost or repeated, and a tick that is late or ends before the optimum. If frames stay away,
    /// their age stops the robot.
    pub fn state(self) -> SafetyState {
        match self {
            Self::LateTick
            | Self::IterationLimit
            | Self::Frame(
                FrameFault::NotFinite
                | FrameFault::Repeated
                | FrameFault::OutOfOrder
                | FrameFault::ImpossibleSpeed,
            ) => SafetyState::Reduced,
            _ => SafetyState::ProtectiveStop,
        }
    }

    /// Returns true if the stop for this fault waits for an acknowledgement. Otherwise the robot
    /// recovers when the fault has not come again for the dwell time. The loop itself sees that
    /// such a fault is over.
    pub fn waits(self) -> bool {
        match self {
            Self::EarlyTick
            | Self::LateTick
            | Self::IterationLimit
            | Self::Frame(_)
            | Self::TooManyPeople
            | Self::MissingMeasurement
            | Self::LostCommand => false,
            Self::Clock(_)
            | Self::BadMeasurement
            | Self::FrozenMeasurement
            | Self::FollowingError
            | Self::RobotStopped
            | Self::ContactForce
            | Self::UnknownPayload
            | Self::NoSolution
            | Self::BadData
            | Self::LimitViolated
            | Self::StopRequested => true,
        }
    }
}
