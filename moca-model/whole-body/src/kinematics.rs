//! Where frames are, and how they move with the joints.

pub(crate) mod jacobian;
mod placement;
mod relative;
mod twist;
