//! Classes of `ahqp.collaboration`: a person, what the camera sees of them, the controller, and recordings.

pub(crate) mod body;
pub(crate) mod command;
pub(crate) mod controller;
pub(crate) mod object;
pub(crate) mod recording;
pub(crate) mod robot;
pub(crate) mod scene;
mod settings;
mod tables;
