//! Human-robot shared workspaces: their shapes, softening and motion with the person, and rows
//! that keep the robot's speed within its separation from people.
//!
//! Speed and separation monitoring follows ISO/TS 15066, the limits of contacts ISO 10218-2; this is not
//! safety-rated software.
//!
//! ```
//! use hrsw::{Bounds, FollowerSettings, FrameFollower, Workspace};
//! use nalgebra::{Isometry3, Vector3, Vector6};
//!
//! // A box in front of a person, whose frame follows them.
//! let mut person = FrameFollower::new(Isometry3::identity(), FollowerSettings::default())?;
//! let mut workspace = Workspace::new(
//!     *person.pose(),
//!     Bounds::new(Vector3::new(0.25, -0.4, 0.7), Vector3::new(0.75, 0.3, 1.5))?,
//!     Bounds::symmetric(Vector3::repeat(0.3))?,
//! )?;
//! person.retarget(Isometry3::translation(0.1, 0.0, 0.0), Vector6::zeros())?;
//! person.advance(1e-3);
//! workspace.place(*person.pose(), person.twist())?;
//! assert!(workspace.contains(&Isometry3::translation(0.5, 0.0, 1.0)));
//! # Ok::<(), hrsw::Error>(())
//! ```

mod age;
mod anchor;
mod approach;
mod body_region;
mod change;
mod clock;
mod contact;
mod distance;
mod distance_bounds;
mod error;
mod fault;
mod motion;
mod moving;
mod path;
mod reorientation;
mod rows;
mod safety_state;
mod separation;
mod shape;
mod softening;
mod speed_cap;
mod supervisor;
mod surroundings;
mod workspace;

pub use age::Age;
pub use anchor::{Anchor, AnchorSettings};
pub use approach::{ApproachRows, JointMotion, MeasuredVelocity, Nearest, PersonBody, RobotBody};
pub use body_region::{BodyRegion, ContactKind, ContactLimits, RegionLimits};
pub use clock::{ClockSettings, LoopClock, Tick};
pub use contact::{Contact, ContactLimit};
pub use distance::{Proximity, proximity};
pub use error::Error;
pub use fault::{ClockFault, Fault, FrameFault};
pub use motion::{FollowerSettings, FrameFollower};
pub use moving::{Attachment, MovingSettings, MovingWorkspace};
pub use path::Path;
pub use rows::PoseRow;
pub use safety_state::SafetyState;
pub use separation::{BaseBraking, SeparationSettings};
pub use shape::{
    Bounds, Capsule, Cone, HalfSpace, Mesh, OrientationShape, OrientedBox, Polytope, PositionShape,
};
pub use softening::{Slack, SoftWorkspace, Softening};
pub use speed_cap::SpeedCap;
pub use supervisor::{Cause, Observation, Supervisor, SupervisorSettings};
pub use surroundings::{ForbiddenRegion, Intersection, Reach, Surroundings};
pub use workspace::Workspace;
