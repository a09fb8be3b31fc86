#![doc = include_str!("../README.md")]

pub mod limits;
pub mod people;
pub mod plant;
pub mod random;
