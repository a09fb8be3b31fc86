//! Reasons why bytes are no valid packet of this protocol.

/// Reason why a packet is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PacketError {
    /// The packet belongs to another protocol.
    #[error("it begins with {got:?}, which is none of this protocol")]
    Kind {
        /// First bytes of the packet.
        got: [u8; 4],
    },
    /// The packet has another version of the protocol.
    #[error("it is of version {got} of the protocol, expected {wanted}: update the other side")]
    Version {
        /// Version of the packet.
        got: u8,
        /// Version of this program.
        wanted: u8,
    },
    /// The packet belongs to a robot with another number of joints.
    #[error("it is of a robot of {got} joints, expected {wanted}")]
    Joints {
        /// Number of joints in the packet.
        got: usize,
        /// Number of joints of this robot.
        wanted: usize,
    },
    /// The packet is too short or too long.
    #[error(
        "it has {got} bytes, expected {wanted}; a key makes packets 32 bytes longer: give it to both \
         sides or to neither"
    )]
    Size {
        /// Number of bytes.
        got: usize,
        /// Number of bytes of this robot's packets.
        wanted: usize,
    },
    /// The code does not match the shared key.
    #[error("its code is not of this key: another key, a damaged packet, or a stranger")]
    Code,
    /// A byte without meaning in this kind of packet is not zero.
    #[error("bytes that mean nothing in its kind are not zero")]
    NotZero,
    /// The code of the robot's mode is unknown.
    #[error("the robot's mode is {got}, expected 0 to 4")]
    Mode {
        /// Code of the mode.
        got: u8,
    },
    /// The code for whether the command was taken and the gripper holds something is unknown.
    #[error("the robot's two answers are {got}, expected 0 to 8")]
    Took {
        /// Code that was found.
        got: u8,
    },
    /// A torque does not agree with its flag.
    #[error(
        "joint {joint} has torque {torque} with flag {flag}; expected flag 1, or flag 0 and torque 0"
    )]
    Torque {
        /// Joint, counted from 0.
        joint: usize,
        /// 1 for a measured torque, 0 for a missing one.
        flag: u8,
        /// Torque \[N or Nm\].
        torque: f64,
    },
    /// A number is NaN or infinite.
    #[error("a number is not finite")]
    NotFinite,
}
