//! Forces and inertias.

mod carried;
mod centre_of_mass;
mod friction;
mod gravity;
