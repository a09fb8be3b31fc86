//! Reading a URDF: the few elements that say how a robot moves.
//!
//! A streaming reader takes what is needed and skips all else unread: visuals, collisions, meshes,
//! materials, transmissions, plugins, unknown elements. It does not recurse, looks at each byte a
//! bounded number of times, and knows the line of everything that it keeps.

pub(crate) mod document;
pub(crate) mod names;
#[cfg(feature = "urdf-rs")]
mod parsed;
mod reader;
pub(crate) mod tree;
