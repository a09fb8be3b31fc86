//! Packets between a loop and a robot.

use moca_model::whole_body::{JointCommand, JointMeasurement};

/// What a packet is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketKind {
    /// Of the robot: position, velocity, torque.
    Measurement,
    /// To the robot: position, velocity, torque.
    Command,
    /// To the robot: somebody is there; all numbers are zero.
    Hello,
    /// To the robot: no command comes any more.
    Halt,
}

/// Why a packet is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PacketError {
    /// It is too short or too long.
    #[error("a packet of {found} bytes, expected {expected} for this robot")]
    Size {
        /// Its bytes.
        found: usize,
        /// Those of this robot's packets.
        expected: usize,
    },
    /// It is of something else.
    #[error("a packet that begins with {found:?} is none of this protocol")]
    Kind {
        /// Its first bytes.
        found: [u8; 4],
    },
    /// A number is NaN or infinite.
    #[error("a packet with numbers that are not finite")]
    NotFinite,
}

/// Bytes before the numbers: the kind, and the sequence number.
const HEAD: usize = 12;

/// A packet with room for the packets of one robot: four bytes of kind, eight of sequence number, then three
/// numbers a joint, all of positions, all of velocities, all of torques; little-endian.
///
/// ```
/// use examples::robot_side::{Packet, PacketKind};
///
/// let mut sent = Packet::new(1);
/// sent.write(PacketKind::Command, 7, [&[0.1], &[0.2], &[0.3]]);
/// let mut received = Packet::new(1);
/// assert_eq!(received.take(sent.bytes())?, (PacketKind::Command, 7));
/// let [_, velocity, _] = received.numbers();
/// assert_eq!(velocity.collect::<Vec<_>>(), [0.2]);
/// # Ok::<(), examples::robot_side::PacketError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Packet {
    bytes: Vec<u8>,
    joints: usize,
}

impl PacketKind {
    const ALL: [(Self, [u8; 4]); 4] = [
        (Self::Measurement, *b"MOm1"),
        (Self::Command, *b"MOc1"),
        (Self::Hello, *b"MOh1"),
        (Self::Halt, *b"MOx1"),
    ];

    fn mark(self) -> [u8; 4] {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or([0; 4], |(_, mark)| *mark)
    }
}

impl Packet {
    /// For a robot of so many joints.
    pub fn new(joints: usize) -> Self {
        Self { bytes: vec![0; HEAD + 3 * 8 * joints], joints }
    }

    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Becomes a packet of these numbers; what is missing is zero.
    pub fn write(&mut self, kind: PacketKind, sequence: u64, numbers: [&[f64]; 3]) {
        self.bytes.fill(0);
        let (head, body) = self.bytes.split_at_mut(HEAD);
        let (mark, count) = head.split_at_mut(4);
        mark.copy_from_slice(&kind.mark());
        count.copy_from_slice(&sequence.to_le_bytes());
        for (part, numbers) in body.chunks_mut((8 * self.joints).max(1)).zip(numbers) {
            for (place, number) in part.chunks_exact_mut(8).zip(numbers) {
                place.copy_from_slice(&number.to_le_bytes());
            }
        }
    }

    /// Becomes a command.
    pub fn write_command(&mut self, sequence: u64, command: &JointCommand) {
        let JointCommand { position, velocity, torque } = command;
        self.write(PacketKind::Command, sequence, [position, velocity, torque]);
    }

    /// Becomes a measurement.
    pub fn write_measurement(&mut self, sequence: u64, measured: &JointMeasurement) {
        let JointMeasurement { position, velocity, torque, .. } = measured;
        let torque: Vec<_> = torque.iter().map(|torque| torque.unwrap_or_default()).collect();
        self.write(PacketKind::Measurement, sequence, [position, velocity, &torque]);
    }

    /// Takes the bytes of a packet that has come; its kind and its sequence number.
    ///
    /// # Errors
    /// Why it is none; the numbers are then as they were.
    pub fn take(&mut self, bytes: &[u8]) -> Result<(PacketKind, u64), PacketError> {
        let (found, expected) = (bytes.len(), self.bytes.len());
        let sized = PacketError::Size { found, expected };
        let (mark, rest) = bytes.split_first_chunk::<4>().ok_or(sized)?;
        let kind = PacketKind::ALL.iter().find(|(_, known)| known == mark);
        let (kind, _) = kind.ok_or(PacketError::Kind { found: *mark })?;
        let (sequence, numbers) = rest.split_first_chunk::<8>().ok_or(sized)?;
        if found != expected {
            return Err(sized);
        }
        if !self::numbers(numbers).all(f64::is_finite) {
            return Err(PacketError::NotFinite);
        }
        self.bytes.copy_from_slice(bytes);
        Ok((*kind, u64::from_le_bytes(*sequence)))
    }

    /// Positions, velocities and torques.
    pub fn numbers(&self) -> [impl Iterator<Item = f64> + '_; 3] {
        let body = self.bytes.get(HEAD..).unwrap_or_default();
        let part = |index: usize| body.get(8 * self.joints * index..).unwrap_or_default();
        [0, 1, 2].map(|index| numbers(part(index)).take(self.joints))
    }
}

fn numbers(bytes: &[u8]) -> impl Iterator<Item = f64> + '_ {
    bytes.as_chunks::<8>().0.iter().map(|number| f64::from_le_bytes(*number))
}
