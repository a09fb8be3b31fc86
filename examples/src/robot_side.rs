//! Robots for a [`ControlLoop`](moca_model::whole_body::ControlLoop): a simulated one in the same process, and one that
//! is reached by UDP, as an example of a connection; with the simulated robot at its other end.

mod packet;
mod simulated;
mod udp;
mod udp_server;

pub use packet::{Packet, PacketError, PacketKind};
pub use simulated::SimulatedSide;
pub use udp::UdpSide;
pub use udp_server::UdpServer;

/// The example of the book's page on real robots.
#[cfg(doctest)]
#[doc = include_str!("../../docs/src/real-robot.md")]
struct BookPage;
