//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod active_limits;
mod allocation;
mod bad_input;
mod bad_tasks;
mod bad_urdf;
mod control_loop;
mod corner;
mod description;
mod differential_base;
mod dynamics;
mod followers;
mod golden;
mod ik;
mod ik_figures;
mod ik_limits;
mod impedance;
mod kinematics;
mod momentum;
mod out_of_reach;
mod parsed;
mod placement;
mod simulation;
mod singular_arms;
mod support;
mod tasks;
mod torque_control;
mod unknown_effort;
mod velocity_rows;
