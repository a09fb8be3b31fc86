//! What the tests of programs share.

mod disk;
mod networks;
mod pictures;
mod run;

pub(crate) use disk::SmallDisk;
pub(crate) use networks::{resnet18, slow_only_r18};
pub(crate) use pictures::{png_that_claims, save_picture};
pub(crate) use run::{Ran, Runs, signal};
