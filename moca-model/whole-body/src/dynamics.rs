//! Forces and inertias.
//!
//! All sums are in world axes, so that nothing is rotated from body to body. They are about the origins of the bodies,
//! so that they contain no distances longer than a link.

pub(crate) mod articulated;
mod carried;
mod centre_of_mass;
mod effective_mass;
mod energy;
pub(crate) mod external;
mod forward;
mod friction;
mod gravity;
mod hybrid;
mod inverse;
mod joint_momentum;
mod mass_matrix;
