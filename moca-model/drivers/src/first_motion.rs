//! A small circle, as the first motion of a robot.

use std::f64::consts::TAU;

use hrsw::{Attachment, Path};
use moca_model::whole_body::Data;
use moca_model::{Controller, Error};
use nalgebra::{Isometry3, Translation3, Vector3};

/// Radius \[m\], speed \[m/s\] and number of rounds.
const RADIUS: f64 = 0.05;
const SPEED: f64 = 0.04;
const ROUNDS: u32 = 2;
/// Straight lines in a round.
const CORNERS: u32 = 72;

/// Lets the workspace go around upright circles beside the tool at this configuration \[m, rad\], and come to rest there.
/// The tool follows if the workspace is narrow.
///
/// # Errors
/// A configuration that does not fit the robot.
pub(crate) fn circle(controller: &mut Controller, configuration: &[f64]) -> Result<(), Error> {
    let (model, tool) = (controller.robot().model().clone(), controller.robot().tool());
    let tool = Data::new(&model).pose(&model, configuration)?.world_from(tool)?;
    let rotation = tool.rotation * controller.settings().space.tool.inverse();
    let corner = |corner: u32| {
        let angle = TAU * f64::from(corner) / f64::from(CORNERS);
        let way = Vector3::new(0.0, angle.sin(), 1.0 - angle.cos()) * RADIUS;
        Isometry3::from_parts(Translation3::from(tool.translation.vector + way), rotation)
    };
    let corners: Vec<_> = (0..=ROUNDS * CORNERS).map(corner).collect();
    controller.space_mut().assign(Some(Attachment::Path(Path::new(&corners, SPEED)?)))
}
