#![doc = include_str!("../README.md")]

mod announced_law;
mod command_limits;
mod drive_report;
mod error;
mod fault_log;
mod first_motion;
mod link;
mod lockstep;
mod logbook;
mod loop_tick;
mod packet;
mod packet_error;
mod recorded_camera;
#[cfg(feature = "ros2")]
pub mod ros2;
mod shared_key;
mod simulated;
mod topic_names;
mod udp;
mod udp_server;

pub use announced_law::AnnouncedLaw;
pub use command_limits::CommandRefusal;
pub use drive_report::DriveReport;
pub use error::Error;
pub use fault_log::FaultLog;
pub use link::{LinkRefusal, LinkReport, LinkStatistics, RefusedPackets};
pub use lockstep::LockstepSide;
pub use logbook::Logbook;
pub use loop_tick::{LoopTick, Ticks};
pub use packet::{Packet, PacketHead, PacketKind};
pub use packet_error::PacketError;
pub use recorded_camera::RecordedCamera;
pub use shared_key::SharedKey;
pub use simulated::SimulatedSide;
pub use topic_names::{MAP_FRAME, TopicNames, WORLD_FRAME};
pub use udp::UdpSide;
pub use udp_server::UdpServer;
