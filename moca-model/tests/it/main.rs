//! The integration tests, one module a topic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod allocation;
mod bad_input;
mod controller;
mod drive;
mod fault_table;
mod faults;
mod following_distance;
mod golden;
mod grasped_object;
mod gripping;
mod hidden_legs;
mod hierarchy;
mod intention;
mod late_ticks;
mod left_out;
mod lost_commands;
mod misplaced_head;
mod person_speed;
mod properties;
mod safety;
mod self_collision;
mod several_people;
mod shared;
mod silence;
mod simulation;
mod singular;
mod situation;
mod slow_loops;
mod stack_changes;
mod states;
mod torque;
mod units;
mod walk_in;
