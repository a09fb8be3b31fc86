#![doc = include_str!("../README.md")]

pub mod maps;
pub mod sheets;
pub mod workload;
