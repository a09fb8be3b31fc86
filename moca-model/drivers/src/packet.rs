//! Packets between a loop and a robot. The book's page on real robots describes their bytes.

use moca_model::whole_body::control_loop::{
    Grip, JointCommand, JointMeasurement, RobotMode, RobotStatus,
};

use super::packet_error::PacketError;
use super::shared_key::{CODE, SharedKey};

/// Kind of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketKind {
    /// From the robot: positions, velocities, torques and its own status.
    Measurement,
    /// From the robot, in lockstep: a period without a measurement.
    Nothing,
    /// To the robot: positions, velocities, torques.
    Command,
    /// To the robot: request of one measurement.
    Hello,
    /// To the robot: no further command comes.
    Halt,
}

/// Head of every packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PacketHead {
    /// Kind of the packet.
    pub kind: PacketKind,
    /// Number that the controller chose for its session.
    pub controller: u64,
    /// Number that the robot chose for the session; zero in a hello.
    pub robot: u64,
    /// Number of the packet in its session and direction.
    pub counter: u64,
}

const VERSION: u8 = b'2';
/// Positions of the parts of a packet.
const MARK: usize = 0;
const JOINTS: usize = 4;
const MODE: usize = 6;
const TOOK: usize = 7;
const CONTROLLER: usize = 8;
const ROBOT: usize = 16;
const COUNTER: usize = 24;
const NUMBERS: usize = 32;

/// Buffer for the packets of one robot.
///
/// ```
/// use moca_drivers::{Packet, PacketHead, PacketKind};
/// use moca_model::whole_body::control_loop::{JointMeasurement, RobotMode};
///
/// let mut measured = JointMeasurement::resting(vec![0.1, 0.2], 2);
/// measured.torque[1] = Some(7.0);
/// measured.robot.mode = Some(RobotMode::Reflex);
/// let head = PacketHead { kind: PacketKind::Measurement, controller: 5, robot: 6, counter: 7 };
/// let mut sent = Packet::new(2, None);
/// sent.write_measurement(head, &measured);
///
/// let mut received = Packet::new(2, None);
/// assert_eq!(received.take(sent.bytes())?, head);
/// let mut read = JointMeasurement::resting(vec![0.0; 2], 2);
/// received.read_measurement(&mut read);
/// assert_eq!(read, measured);
/// # Ok::<(), moca_drivers::PacketError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Packet {
    bytes: Vec<u8>,
    joints: usize,
    key: Option<SharedKey>,
}

impl PacketKind {
    const ALL: [(Self, [u8; 3]); 5] = [
        (Self::Measurement, *b"MOm"),
        (Self::Nothing, *b"MOn"),
        (Self::Command, *b"MOc"),
        (Self::Hello, *b"MOh"),
        (Self::Halt, *b"MOx"),
    ];

    fn mark(self) -> [u8; 4] {
        let known = Self::ALL.iter().find(|(kind, _)| *kind == self);
        let [first, second, third] = known.map_or([0; 3], |(_, letters)| *letters);
        [first, second, third, VERSION]
    }

    fn from_mark(mark: [u8; 4]) -> Result<Self, PacketError> {
        let [first, second, third, version] = mark;
        let letters = [first, second, third];
        let known = Self::ALL.iter().find(|(_, known)| *known == letters);
        match known {
            Some((kind, _)) if version == VERSION => Ok(*kind),
            Some(_) if version.is_ascii_digit() => {
                Err(PacketError::Version { got: version - b'0', wanted: VERSION - b'0' })
            }
            _ => Err(PacketError::Kind { got: mark }),
        }
    }
}

impl Packet {
    /// Creates the buffer for a robot with `joints` joints. Each packet ends with a code if there is a key.
    pub fn new(joints: usize, key: Option<&SharedKey>) -> Self {
        let length = NUMBERS + 25 * joints + key.map_or(0, |_| CODE);
        Self { bytes: vec![0; length], joints, key: key.cloned() }
    }

    /// Returns the bytes of the packet.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Becomes a packet without numbers: a hello, a halt, or a period without a measurement.
    pub fn write(&mut self, head: PacketHead) {
        self.begin(head);
        self.seal();
    }

    /// Writes a command into the packet.
    pub fn write_command(&mut self, head: PacketHead, command: &JointCommand) {
        self.begin(head);
        let JointCommand { position, velocity, torque, grip } = command;
        self.put(MODE, &[grip.map_or(0, grip_code)]);
        for (part, numbers) in [position, velocity, torque].into_iter().enumerate() {
            self.put_numbers(part, numbers.iter().copied());
        }
        self.seal();
    }

    /// Writes a measurement into the packet.
    pub fn write_measurement(&mut self, head: PacketHead, measured: &JointMeasurement) {
        self.begin(head);
        let JointMeasurement { position, velocity, torque, robot, .. } = measured;
        self.put(MODE, &[mode_code(robot.mode)]);
        self.put(TOOK, &[answer_code(robot.took_command) + 3 * answer_code(robot.holds)]);
        self.put_numbers(0, position.iter().copied());
        self.put_numbers(1, velocity.iter().copied());
        self.put_numbers(2, torque.iter().map(|torque| torque.unwrap_or_default()));
        let flags = NUMBERS + 24 * self.joints;
        for (joint, torque) in torque.iter().enumerate().take(self.joints) {
            self.put(flags + joint, &[u8::from(torque.is_some())]);
        }
        self.seal();
    }

    /// Takes the bytes of a received packet and returns its head.
    ///
    /// # Errors
    /// Why the bytes are no valid packet. The packet that was taken before is then kept.
    pub fn take(&mut self, bytes: &[u8]) -> Result<PacketHead, PacketError> {
        let (got, wanted) = (bytes.len(), self.bytes.len());
        let sized = PacketError::Size { got, wanted };
        let kind = PacketKind::from_mark(array(bytes, MARK).ok_or(sized)?)?;
        let joints = usize::from(u16::from_le_bytes(array(bytes, JOINTS).ok_or(sized)?));
        if joints != self.joints {
            return Err(PacketError::Joints { got: joints, wanted: self.joints });
        }
        if got != wanted {
            return Err(sized);
        }
        if let Some(key) = &self.key {
            let (body, code) = bytes.split_last_chunk().ok_or(sized)?;
            if !key.agrees(body, code) {
                return Err(PacketError::Code);
            }
        }
        self.check_content(kind, bytes)?;
        self.bytes.copy_from_slice(bytes);
        let number = |at: usize| array(bytes, at).map_or(0, u64::from_le_bytes);
        let [controller, robot, counter] = [CONTROLLER, ROBOT, COUNTER].map(number);
        Ok(PacketHead { kind, controller, robot, counter })
    }

    /// Reads the command that was taken into `command`.
    pub fn read_command(&self, command: &mut JointCommand) {
        let JointCommand { position, velocity, torque, grip } = command;
        for (part, own) in [position, velocity, torque].into_iter().enumerate() {
            own.iter_mut().zip(self.numbers(part)).for_each(|(own, number)| *own = number);
        }
        *grip = grip_of(self.byte(MODE));
    }

    /// Reads the measurement that was taken, and the robot's status, into `measured`. The age is not in a packet.
    pub fn read_measurement(&self, measured: &mut JointMeasurement) {
        let JointMeasurement { position, velocity, torque, robot, .. } = measured;
        for (part, own) in [position, velocity].into_iter().enumerate() {
            own.iter_mut().zip(self.numbers(part)).for_each(|(own, number)| *own = number);
        }
        let flags = self.bytes.get(NUMBERS + 24 * self.joints..).unwrap_or_default();
        for ((own, number), flag) in torque.iter_mut().zip(self.numbers(2)).zip(flags) {
            *own = (*flag == 1).then_some(number);
        }
        let answers = self.byte(TOOK);
        *robot = RobotStatus {
            mode: mode_of(self.byte(MODE)).unwrap_or_default(),
            took_command: answer_of(answers % 3),
            holds: answer_of(answers / 3),
        };
    }

    fn byte(&self, at: usize) -> u8 {
        self.bytes.get(at).copied().unwrap_or_default()
    }

    fn begin(&mut self, head: PacketHead) {
        let PacketHead { kind, controller, robot, counter } = head;
        self.bytes.fill(0);
        self.put(MARK, &kind.mark());
        self.put(JOINTS, &u16::try_from(self.joints).unwrap_or(u16::MAX).to_le_bytes());
        self.put(CONTROLLER, &controller.to_le_bytes());
        self.put(ROBOT, &robot.to_le_bytes());
        self.put(COUNTER, &counter.to_le_bytes());
    }

    fn put(&mut self, at: usize, bytes: &[u8]) {
        if let Some(place) = self.bytes.get_mut(at..at + bytes.len()) {
            place.copy_from_slice(bytes);
        }
    }

    /// Writes numbers of a part: 0 for positions, 1 for velocities, 2 for torques.
    fn put_numbers(&mut self, part: usize, numbers: impl Iterator<Item = f64>) {
        let begin = NUMBERS + 8 * self.joints * part;
        for (joint, number) in numbers.take(self.joints).enumerate() {
            self.put(begin + 8 * joint, &number.to_le_bytes());
        }
    }

    /// Writes the code of the bytes before it.
    fn seal(&mut self) {
        let Some(key) = &self.key else { return };
        if let Some((body, code)) = self.bytes.split_last_chunk_mut() {
            *code = key.code(body);
        }
    }

    fn numbers(&self, part: usize) -> impl Iterator<Item = f64> + '_ {
        let body = self.bytes.get(NUMBERS + 8 * self.joints * part..).unwrap_or_default();
        doubles(body).take(self.joints)
    }

    /// Checks that each byte has exactly one meaning.
    fn check_content(&self, kind: PacketKind, bytes: &[u8]) -> Result<(), PacketError> {
        let [mode, took] = array(bytes, MODE).unwrap_or_default();
        let numbers = bytes.get(NUMBERS..NUMBERS + 24 * self.joints).unwrap_or_default();
        let flags = bytes.get(NUMBERS + 24 * self.joints..).unwrap_or_default();
        let flags = flags.get(..self.joints).unwrap_or_default();
        if kind != PacketKind::Measurement {
            let is_command = kind == PacketKind::Command;
            let rest = if is_command { &[] } else { numbers };
            let grip = if is_command && grip_of(mode).is_some() { 0 } else { mode };
            if [grip, took].iter().chain(flags).chain(rest).any(|byte| *byte != 0) {
                return Err(PacketError::NotZero);
            }
        }
        if mode_of(mode).is_none() {
            return Err(PacketError::Mode { got: mode });
        }
        if took > 8 {
            return Err(PacketError::Took { got: took });
        }
        if !doubles(numbers).all(f64::is_finite) {
            return Err(PacketError::NotFinite);
        }
        let torques = doubles(numbers).skip(2 * self.joints);
        for (joint, (flag, torque)) in flags.iter().zip(torques).enumerate() {
            if *flag > 1 || (*flag == 0 && torque != 0.0 && kind == PacketKind::Measurement) {
                return Err(PacketError::Torque { joint, flag: *flag, torque });
            }
        }
        Ok(())
    }
}

fn grip_code(grip: Grip) -> u8 {
    match grip {
        Grip::Open => 1,
        Grip::Close => 2,
    }
}

fn grip_of(code: u8) -> Option<Grip> {
    [Grip::Open, Grip::Close].into_iter().find(|grip| grip_code(*grip) == code)
}

/// Returns the code of what a robot says or does not say.
fn answer_code(said: Option<bool>) -> u8 {
    said.map_or(0, |said| if said { 2 } else { 1 })
}

fn answer_of(code: u8) -> Option<bool> {
    (code != 0).then_some(code == 2)
}

/// Returns the code of a mode. A mode that this version does not know counts as a stop.
fn mode_code(mode: Option<RobotMode>) -> u8 {
    match mode {
        None => 0,
        Some(RobotMode::Running) => 1,
        Some(RobotMode::Reflex) => 3,
        Some(RobotMode::UserStop) => 4,
        Some(_) => 2,
    }
}

/// Returns the mode of a code; `None` if no mode has this code.
#[expect(clippy::option_option, reason = "a code of no mode, and a robot that says none")]
fn mode_of(code: u8) -> Option<Option<RobotMode>> {
    match code {
        0 => Some(None),
        1 => Some(Some(RobotMode::Running)),
        2 => Some(Some(RobotMode::Stopped)),
        3 => Some(Some(RobotMode::Reflex)),
        4 => Some(Some(RobotMode::UserStop)),
        _ => None,
    }
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..).and_then(|bytes| bytes.first_chunk()).copied()
}

fn doubles(bytes: &[u8]) -> impl Iterator<Item = f64> + '_ {
    bytes.as_chunks::<8>().0.iter().map(|number| f64::from_le_bytes(*number))
}
