//! Human-robot shared workspaces: their bounds, softening and motion with the person.
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

mod error;
mod motion;
mod softening;
mod workspace;

pub use error::Error;
pub use motion::{FollowerSettings, FrameFollower};
pub use softening::SoftWorkspace;
pub use workspace::{Bounds, Workspace};
