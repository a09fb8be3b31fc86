#![doc = include_str!("../README.md")]

mod desk;
mod error;
mod head;
mod http;
mod law;
mod page;
mod picture;
mod request;
mod run;
mod server;
mod socket;

pub use desk::{Desk, Order};
pub use error::Error;
pub use head::{Head, SettingsText};
pub use law::{Law, Within};
pub use picture::Picture;
pub use request::{Request, Restart};
pub use server::Server;
// What the public types speak.
pub use {moca_simulation, whole_body};
