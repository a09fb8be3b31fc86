//! The robot: what does not change while it moves.

pub(crate) mod assembly;
pub(crate) mod bodies;
pub(crate) mod configuration;
pub(crate) mod description;
pub(crate) mod frame;
pub(crate) mod friction;
pub(crate) mod inertia;
pub(crate) mod joint;
mod limit_rules;
pub(crate) mod limits;
pub(crate) mod model;
mod selection;
pub(crate) mod warning;
