//! What a robot is asked to do: rows `A q̇ ∈ [lower, upper]` or a quadratic, one kind of task a file.

pub(crate) mod augmented_frame;
pub(crate) mod axis;
pub(crate) mod centre_of_mass;
mod checks;
pub(crate) mod curvature;
pub(crate) mod damping;
pub(crate) mod feedback;
pub(crate) mod frame_pose;
pub(crate) mod input;
pub(crate) mod joint_coupling;
pub(crate) mod manipulability;
pub(crate) mod mask;
pub(crate) mod orientation;
pub(crate) mod pose_task;
pub(crate) mod position;
pub(crate) mod posture;
pub(crate) mod quadratic;
pub(crate) mod relative_frame;
pub(crate) mod rows;
pub(crate) mod task;
pub(crate) mod variables;
pub(crate) mod vector_task;
pub(crate) mod velocity;
