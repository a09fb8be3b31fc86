//! Classes of `ahqp.vision`: networks, people in images, and their bodies in the world.

mod arrays;
pub(crate) mod body;
pub(crate) mod camera;
pub(crate) mod files;
pub(crate) mod lifting;
pub(crate) mod networks;
pub(crate) mod people;
pub(crate) mod pose;
pub(crate) mod preprocessing;
pub(crate) mod svm;
pub(crate) mod tensorflow_lite;
pub(crate) mod views;
mod weights;
