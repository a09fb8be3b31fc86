#![doc = include_str!("../README.md")]

pub mod comparison;
pub mod file;
pub mod solving;
