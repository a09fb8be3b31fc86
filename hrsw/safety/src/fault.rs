//! What can go wrong in a control loop, and what each fault asks of the robot.

use crate::safety_state::SafetyState;

/// Why the time of a tick cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum ClockFault {
    /// It is NaN or infinite.
    #[error("clock not finite")]
    NotFinite,
    /// It is that of the tick before.
    #[error("clock standing still")]
    StandsStill,
    /// It lies before that of the tick before.
    #[error("clock set back")]
    SetBack,
    /// It lies far after that of the tick before: the clock was set, or the loop stood.
    #[error("clock set ahead")]
    SetAhead,
}

/// Why a camera frame is refused: it counts as no data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum FrameFault {
    /// Its stamp is NaN or infinite.
    #[error("frame without a time")]
    NotFinite,
    /// It is stamped after the present.
    #[error("frame from the future")]
    Future,
    /// Its stamp counts from another origin than the ticks do, such as seconds since 1970 against
    /// seconds since the start.
    #[error("frame of another epoch")]
    ForeignEpoch,
    /// It is stamped like the newest one.
    #[error("frame repeated")]
    Repeated,
    /// It is stamped before the newest one.
    #[error("frame out of order")]
    OutOfOrder,
    /// A joint in it is farther away than anything in a room: it is in other units, such as millimetres.
    #[error("frame in other units")]
    Units,
    /// It shows a body that nobody has.
    #[error("frame of an impossible body")]
    ImpossibleBody,
    /// It shows a person where nobody can have gone since the frame before.
    #[error("frame of an impossible speed")]
    ImpossibleSpeed,
}

/// Something that went wrong in the control loop.
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
    /// A tick came too soon after the one before.
    #[error("tick early")]
    EarlyTick,
    /// A tick came too late after the one before.
    #[error("tick late")]
    LateTick,
    /// A camera frame was refused.
    #[error(transparent)]
    Frame(#[from] FrameFault),
    /// More people are in view than the robot can keep its distance from.
    #[error("too many people")]
    TooManyPeople,
    /// The measured state is not finite, or of the wrong size.
    #[error("bad measurement")]
    BadMeasurement,
    /// The robot measures nothing: what is known of it is too old to control it by.
    #[error("measurement missing")]
    MissingMeasurement,
    /// What the robot measures does not change although it must.
    #[error("measurement frozen")]
    FrozenMeasurement,
    /// The robot does not take the commands that it is sent: they are lost on the way.
    #[error("command lost")]
    LostCommand,
    /// The robot does not follow: measured and commanded state are farther apart than they may be,
    /// because it is held or pushed.
    #[error("following error")]
    FollowingError,
    /// The robot says that it takes no commands: it stopped by itself, for packets that were lost, say.
    #[error("robot stopped")]
    RobotStopped,
    /// Something pushes the robot harder than anything should: a collision, or somebody is clamped.
    #[error("contact force")]
    ContactForce,
    /// The tool carries a weight that nobody told the robot of.
    #[error("unknown payload")]
    UnknownPayload,
    /// The solver found no command.
    #[error("no solution")]
    NoSolution,
    /// The solver's iterations, or its time, ran out before the optimum; the constraints hold.
    #[error("iteration limit")]
    IterationLimit,
    /// A number that the loop computed is not finite.
    #[error("bad data")]
    BadData,
    /// A limit of the robot was violated.
    #[error("limit violated")]
    LimitViolated,
    /// Somebody, or the program around the loop, asked the robot to stop.
    #[error("stop requested")]
    StopRequested,
}

impl Fault {
    /// Every fault.
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

    /// The state that it puts the robot into at once, unless that is in a worse one.
    ///
    /// Reduced where the loop goes on with what it has: a frame that is lost or comes twice, a
    /// tick that is late or ends before the optimum. If frames stay away their age stops the robot.
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

    /// Returns true if its stop waits for an acknowledgement. Else the robot recovers when it has not come
    /// again for the dwell time: what the loop itself sees to be over needs nobody to look.
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
