#![doc = include_str!("../README.md")]

pub mod page;
pub mod picture;
pub mod recorded;
pub mod report;
