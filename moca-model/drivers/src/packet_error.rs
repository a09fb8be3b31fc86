//! Why bytes are no packet of this protocol.

/// Why a packet is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PacketError {
    /// It is of something else.
    #[error("it begins with {found:?}, which is none of this protocol")]
    Kind {
        /// Its first bytes.
        found: [u8; 4],
    },
    /// It is of another version of the protocol.
    #[error("it is of version {found} of the protocol, expected {expected}: update the other side")]
    Version {
        /// Its version.
        found: u8,
        /// That of this program.
        expected: u8,
    },
    /// It is of another robot.
    #[error("it is of a robot of {found} joints, expected {expected}")]
    Joints {
        /// Its joints.
        found: usize,
        /// Those of this robot.
        expected: usize,
    },
    /// It is too short or too long.
    #[error(
        "it has {found} bytes, expected {expected}; a key makes packets 32 bytes longer: give it to both \
         sides or to neither"
    )]
    Size {
        /// Its bytes.
        found: usize,
        /// Those of this robot's packets.
        expected: usize,
    },
    /// Its code is not that of the shared key.
    #[error("its code is not of this key: another key, a damaged packet, or a stranger")]
    Code,
    /// A byte that means nothing in its kind is not zero.
    #[error("bytes that mean nothing in its kind are not zero")]
    NotZero,
    /// The robot's mode is none.
    #[error("the robot's mode is {found}, expected 0 to 4")]
    Mode {
        /// Its code.
        found: u8,
    },
    /// Whether the command was taken is no answer.
    #[error("whether the last command was taken is {found}, expected 0 to 2")]
    Took {
        /// Its code.
        found: u8,
    },
    /// A torque does not go with its flag.
    #[error(
        "joint {joint} has torque {torque} with flag {flag}; expected flag 1, or flag 0 and torque 0"
    )]
    Torque {
        /// The joint, counted from 0.
        joint: usize,
        /// 1 for a torque that is measured, 0 for none.
        flag: u8,
        /// \[N or Nm\]
        torque: f64,
    },
    /// A number is NaN or infinite.
    #[error("a number is not finite")]
    NotFinite,
}
