//! What the tests of programs share.

mod disk;
mod run;

pub(crate) use disk::SmallDisk;
pub(crate) use run::{Ran, Runs, signal};
