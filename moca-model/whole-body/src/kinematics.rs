//! Poses and motions of frames.

pub(crate) mod jacobian;
mod placement;
mod relative;
mod twist;
