#![doc = include_str!("../README.md")]

#[cfg(feature = "mcap")]
pub mod mcap;
pub mod page;
pub mod picture;
pub mod recorded;
pub mod report;
