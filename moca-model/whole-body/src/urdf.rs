//! A reader of the elements of a URDF that describe motion.
//!
//! It is a streaming reader that skips everything else: visuals, collisions, meshes, materials, transmissions, plugins
//! and unknown elements. It does not recurse and reads each byte a bounded number of times. It knows the line of
//! everything that it keeps.

pub(crate) mod document;
pub(crate) mod names;
#[cfg(feature = "urdf-rs")]
mod parsed;
mod reader;
pub(crate) mod tree;
