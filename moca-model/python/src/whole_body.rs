//! `ahqp.whole_body`: any robot by its URDF.

pub(crate) mod bodies;
pub(crate) mod data;
pub(crate) mod description;
pub(crate) mod ik;
pub(crate) mod limits;
pub(crate) mod model;
pub(crate) mod targets;
pub(crate) mod tasks;
