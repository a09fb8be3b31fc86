//! A robot's side of `drive --robot HOST:PORT --lockstep --compensation franka`: udp_robot HOST:PORT
//!
//! Put your simulator in place of `Robot`.
#![allow(clippy::print_stdout)]

use std::net::UdpSocket;

use moca_drivers::{Packet, PacketHead, PacketKind};
use moca_model::whole_body::control_loop::{JointCommand, JointMeasurement, RobotMode};
use moca_model::{MOCA_BASE_JOINTS, MOCA_HOME};

/// Period \[s\], and inertia of each joint of the arm \[kg m²\].
const PERIOD: f64 = 1e-3;
const INERTIA: [f64; 7] = [1.2, 1.2, 0.8, 0.8, 0.1, 0.1, 0.05];
/// The robot's number of the session.
const OWN_NUMBER: u64 = 7;

/// A base that follows velocities, and a flywheel for each joint of an arm that carries itself. It measures no torques.
struct Robot {
    measured: JointMeasurement,
}

impl Robot {
    fn new() -> Self {
        let mut measured = JointMeasurement::resting(MOCA_HOME.to_vec(), MOCA_HOME.len());
        measured.robot.mode = Some(RobotMode::Running);
        measured.robot.took_command = Some(true);
        Self { measured }
    }

    fn step(&mut self, command: &JointCommand) {
        let JointMeasurement { position, velocity, .. } = &mut self.measured;
        let (base, arm) = velocity.split_at_mut(MOCA_BASE_JOINTS);
        base.iter_mut().zip(&command.velocity).for_each(|(own, wanted)| *own = *wanted);
        let torques = command.torque.iter().skip(MOCA_BASE_JOINTS);
        for ((own, torque), inertia) in arm.iter_mut().zip(torques).zip(INERTIA) {
            *own += PERIOD * torque / inertia;
        }
        position.iter_mut().zip(velocity).for_each(|(own, speed)| *own += PERIOD * *speed);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let address = std::env::args().nth(1).ok_or("give HOST:PORT")?;
    let (link, mut robot) = (UdpSocket::bind(address)?, Robot::new());
    println!("a robot at {}", link.local_addr()?);
    let mut packet = Packet::new(MOCA_HOME.len(), None);
    let mut command = JointCommand::at_rest(&robot.measured);
    let (mut bytes, mut commands) = ([0; 4096], 0);
    loop {
        let (length, controller) = link.recv_from(&mut bytes)?;
        let head = packet.take(bytes.get(..length).unwrap_or_default())?;
        match head.kind {
            PacketKind::Halt => break,
            PacketKind::Command => {
                packet.read_command(&mut command);
                robot.step(&command);
                commands += 1;
            }
            _ => {}
        }
        let answer = PacketHead { kind: PacketKind::Measurement, robot: OWN_NUMBER, ..head };
        packet.write_measurement(answer, &robot.measured);
        link.send_to(packet.bytes(), controller)?;
    }
    let joints: Vec<_> = robot.measured.position.iter().map(f64::to_string).collect();
    println!("{commands} commands; joints at {}", joints.join(" "));
    Ok(())
}
