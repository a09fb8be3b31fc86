//! The robot of a run.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use whole_body::robot::{JointKind, UnusableLimits};
use whole_body::{Base, Description, Model};

/// The kind of motion of the root link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BaseKind {
    /// Fixed in the world.
    Fixed,
    /// Moving on the floor.
    Planar,
    /// Moving freely.
    Floating,
}

/// The robot, and its start.
#[derive(Args, Clone, Debug)]
pub(crate) struct RobotOptions {
    /// The URDF of the robot.
    #[arg(value_name = "URDF")]
    pub(crate) urdf: PathBuf,
    /// The kind of motion of its root link.
    #[arg(long, value_enum, default_value_t = BaseKind::Fixed)]
    pub(crate) base: BaseKind,
    /// The link to start from, in place of the URDF's root.
    #[arg(long, value_name = "LINK")]
    pub(crate) root: Option<String>,
    /// Ignore limits that cannot be meant, such as a velocity of zero.
    #[arg(long)]
    pub(crate) ignore_bad_limits: bool,
    /// The start: all positions, separated by commas, in place of the middle of all ranges.
    #[arg(long, value_name = "POSITIONS", value_delimiter = ',', allow_negative_numbers = true)]
    pub(crate) start: Vec<f64>,
}

impl RobotOptions {
    /// Reads the robot.
    ///
    /// # Errors
    /// A URDF that cannot be read.
    pub(crate) fn model(&self) -> Result<Model> {
        let description = Description {
            base: match self.base {
                BaseKind::Fixed => Base::Fixed,
                BaseKind::Planar => Base::Planar,
                BaseKind::Floating => Base::Floating,
            },
            root: self.root.clone(),
            unusable_limits: if self.ignore_bad_limits {
                UnusableLimits::Ignore
            } else {
                UnusableLimits::Refuse
            },
            ..Description::default()
        };
        Model::from_urdf_file(&self.urdf, &description).map_err(|error| {
            let is_ignorable = error.is_unusable_limit();
            let error = anyhow::Error::new(error);
            if is_ignorable {
                error.context("--ignore-bad-limits takes such a limit for none")
            } else {
                error
            }
        })
    }

    /// The start configuration.
    ///
    /// # Errors
    /// A wrong number of positions.
    pub(crate) fn start(&self, model: &Model) -> Result<Vec<f64>> {
        let mut q = model.neutral();
        if self.start.is_empty() {
            for joint in model.joints().iter().filter(|joint| joint.kind != JointKind::Floating) {
                let limits = &model.limits()[joint.velocity_index];
                let middle = 0.5 * (limits.lower + limits.upper);
                q[joint.position_index] = if middle.is_finite() { middle } else { 0.0 };
            }
        } else if self.start.len() == q.len() {
            q.clone_from(&self.start);
        } else {
            let names: Vec<_> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
            bail!(
                "--start has {} positions; this robot has {}, of {}",
                self.start.len(),
                q.len(),
                names.join(", ")
            );
        }
        Ok(q)
    }
}
