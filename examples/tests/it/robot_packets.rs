//! The bytes of packets between loop and robot.

use moca_drivers::{Packet, PacketError, PacketHead, PacketKind, SharedKey};
use moca_model::whole_body::control_loop::{
    Grip, JointCommand, JointMeasurement, RobotMode, RobotStatus,
};
use proptest::prelude::*;

const PAGE: &str = include_str!("../../../docs/src/robot-packets.md");

/// The bytes of the page's code blocks, without comments.
fn blocks() -> Vec<Vec<u8>> {
    let texts = PAGE.split("```text\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let bytes = |text: &str| {
        let lines = text.lines().map(|line| line.split('#').next().unwrap());
        let pairs = lines.flat_map(str::split_whitespace);
        pairs.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect()
    };
    texts.map(bytes).collect()
}

fn key() -> SharedKey {
    SharedKey::new(&(0..32).collect::<Vec<u8>>()).unwrap()
}

fn resting(joints: usize) -> JointMeasurement {
    JointMeasurement::resting(vec![0.0; joints], joints)
}

fn head(kind: PacketKind, counter: u64) -> PacketHead {
    PacketHead { kind, controller: 5, robot: 6, counter }
}

#[test]
fn documented_packet_survives_reading_and_writing() {
    let [packet, code] = &blocks()[..] else { panic!("two blocks of bytes") };
    let head = PacketHead {
        kind: PacketKind::Measurement,
        controller: 0x0102_0304_0506_0708,
        robot: 0x1112_1314_1516_1718,
        counter: 42,
    };
    let expected = JointMeasurement {
        position: vec![0.5, 1.0],
        velocity: vec![-2.0, 0.0],
        torque: vec![Some(10.0), None],
        robot: RobotStatus {
            mode: Some(RobotMode::Reflex),
            took_command: Some(false),
            holds: Some(true),
        },
        age: 0.0,
    };
    let sealed: Vec<u8> = packet.iter().chain(code).copied().collect();
    for (bytes, key) in [(packet, None), (&sealed, Some(key()))] {
        let (mut read, mut measured) = (Packet::new(2, key.as_ref()), resting(2));
        assert_eq!(read.take(bytes), Ok(head));
        read.read_measurement(&mut measured);
        assert_eq!(measured, expected);
        let mut written = Packet::new(2, key.as_ref());
        written.write_measurement(head, &expected);
        assert_eq!(written.bytes(), &bytes[..]);
    }
}

fn status() -> impl Strategy<Value = RobotStatus> {
    use RobotMode::{Reflex, Running, Stopped, UserStop};
    let mode = prop::option::of(prop::sample::select(vec![Running, Stopped, Reflex, UserStop]));
    (mode, any::<[Option<bool>; 2]>()).prop_map(|(mode, [took_command, holds])| RobotStatus {
        mode,
        took_command,
        holds,
    })
}

proptest! {
    #[test]
    fn what_is_sent_comes_back(
        [controller, robot, counter] in any::<[u64; 3]>(),
        numbers in prop::collection::vec(-1e9..1e9_f64, 9),
        measured in any::<[bool; 3]>(),
        status in status(),
        keyed in any::<bool>(),
        grip in prop::option::of(prop::sample::select(vec![Grip::Open, Grip::Close])),
    ) {
        let key = keyed.then(key);
        let torque: Vec<_> =
            numbers[6..].iter().zip(measured).map(|(torque, known)| known.then_some(*torque)).collect();
        let (position, velocity) = (numbers[..3].to_vec(), numbers[3..6].to_vec());
        let sent = JointMeasurement { position, velocity, torque, robot: status, age: 0.0 };
        let head = PacketHead { kind: PacketKind::Measurement, controller, robot, counter };
        let mut packet = Packet::new(3, key.as_ref());
        packet.write_measurement(head, &sent);
        let (mut received, mut got) = (Packet::new(3, key.as_ref()), resting(3));
        prop_assert_eq!(received.take(packet.bytes()), Ok(head));
        received.read_measurement(&mut got);
        prop_assert_eq!(got, sent);

        let command = JointCommand {
            position: numbers[..3].to_vec(),
            velocity: numbers[3..6].to_vec(),
            torque: numbers[6..].to_vec(),
            grip,
        };
        let head = PacketHead { kind: PacketKind::Command, ..head };
        packet.write_command(head, &command);
        let mut got = JointCommand::at_rest(&resting(3));
        prop_assert_eq!(received.take(packet.bytes()), Ok(head));
        received.read_command(&mut got);
        prop_assert_eq!(got, command);
    }

    #[test]
    fn bytes_of_another_size_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut packet = Packet::new(3, None);
        let mut marked = b"MOm2\x03\0".to_vec();
        marked.extend(&bytes);
        let (got, wanted) = (marked.len(), packet.bytes().len());
        if got != wanted {
            prop_assert_eq!(packet.take(&marked), Err(PacketError::Size { got, wanted }));
        }
        let long_enough = bytes.len() == wanted;
        prop_assert!(packet.take(&bytes).is_err() || long_enough);
    }

    /// No bit of a packet with a key can change.
    #[test]
    fn changed_bit_invalidates_the_code(at in 0_usize..57 + 32, bit in 0_u8..8) {
        let mut sent = Packet::new(1, Some(&key()));
        sent.write_measurement(head(PacketKind::Measurement, 7), &resting(1));
        let mut bytes = sent.bytes().to_vec();
        bytes[at] ^= 1 << bit;
        let refused = Packet::new(1, Some(&key())).take(&bytes);
        let expected = match at {
            0..6 => refused.is_err(),
            _ => refused == Err(PacketError::Code),
        };
        prop_assert!(expected, "{refused:?}");
    }
}

#[test]
fn packet_without_key_is_refused() {
    let other = SharedKey::new(&[1; 32]).unwrap();
    let mut sent = Packet::new(1, Some(&other));
    sent.write(head(PacketKind::Hello, 1));
    assert_eq!(Packet::new(1, Some(&key())).take(sent.bytes()), Err(PacketError::Code));
    let mut plain = Packet::new(1, None);
    plain.write(head(PacketKind::Hello, 1));
    let refused = Packet::new(1, Some(&key())).take(plain.bytes()).unwrap_err();
    assert!(refused.to_string().contains("give it to both sides or to neither"), "{refused}");
    for short in [0, 31] {
        let error = SharedKey::new(&vec![0; short]).unwrap_err().to_string();
        assert!(error.contains(&format!("{short} bytes")) && error.contains("urandom"), "{error}");
    }
}

/// Bytes that are not allowed at their offset of the page, in a packet of one joint.
#[test]
fn bytes_that_could_be_mistaken_are_refused() {
    use PacketKind::{Command, Halt, Hello, Measurement};
    let bytes_of = |kind: PacketKind| {
        let mut packet = Packet::new(1, None);
        match kind {
            PacketKind::Measurement => packet.write_measurement(head(kind, 1), &resting(1)),
            PacketKind::Command => {
                packet.write_command(head(kind, 1), &JointCommand::at_rest(&resting(1)));
            }
            _ => packet.write(head(kind, 1)),
        }
        packet.bytes().to_vec()
    };
    let refusal = |kind: PacketKind, change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = bytes_of(kind);
        assert!(Packet::new(1, None).take(&bytes).is_ok());
        change(&mut bytes);
        Packet::new(1, None).take(&bytes).unwrap_err()
    };
    let of = |at: usize, value: u8| move |bytes: &mut Vec<u8>| bytes[at] = value;
    let number = |at: usize, value: f64| {
        move |bytes: &mut Vec<u8>| bytes[at..at + 8].copy_from_slice(&value.to_le_bytes())
    };
    assert_eq!(refusal(Measurement, &of(3, b'1')), PacketError::Version { got: 1, wanted: 2 });
    assert_eq!(refusal(Measurement, &of(2, b'?')), PacketError::Kind { got: *b"MO?2" });
    assert_eq!(refusal(Measurement, &of(4, 2)), PacketError::Joints { got: 2, wanted: 1 });
    assert_eq!(refusal(Measurement, &of(6, 5)), PacketError::Mode { got: 5 });
    assert_eq!(refusal(Measurement, &of(7, 9)), PacketError::Took { got: 9 });
    // A torque that is not measured is not a number, and a flag is 0 or 1.
    let torque = |flag, torque| PacketError::Torque { joint: 0, flag, torque };
    assert_eq!(refusal(Measurement, &number(48, 7.0)), torque(0, 7.0));
    assert_eq!(refusal(Measurement, &of(56, 2)), torque(2, 0.0));
    for wrong in [f64::NAN, f64::INFINITY] {
        for at in [32, 40, 48] {
            assert_eq!(refusal(Measurement, &number(at, wrong)), PacketError::NotFinite);
            assert_eq!(refusal(Command, &number(at, wrong)), PacketError::NotFinite);
        }
    }
    for kind in [Command, Hello, Halt] {
        for (at, value) in [(6, 3), (7, 1), (56, 1)] {
            assert_eq!(refusal(kind, &of(at, value)), PacketError::NotZero);
        }
    }
    for kind in [Hello, Halt] {
        assert_eq!(refusal(kind, &number(40, 1.0)), PacketError::NotZero);
    }
}
