//! The robot's bodies: capsules fixed to its links.

use hrsw_safety::{Capsule, LinkCapsule, RobotBody};
use whole_body::{FrameId, Model, Posed};

use crate::error::Error;

/// The capsules of a robot and their places.
#[derive(Debug, Clone)]
pub(super) struct RobotBodies {
    tool: FrameId,
    /// Number of joints that move the tool.
    joints: usize,
    shapes: Vec<(FrameId, Capsule)>,
    placed: Vec<RobotBody>,
    /// Number of capsules that are the robot's own.
    own: usize,
}

/// Room for the grasped object and for the hand tool of the person.
const ATTACHED: usize = 2;

impl RobotBodies {
    pub(super) fn new(model: &Model, tool: FrameId, bodies: &[LinkCapsule]) -> Result<Self, Error> {
        let mut shapes = Vec::with_capacity(bodies.len() + ATTACHED);
        let mut placed = Vec::with_capacity(bodies.len() + ATTACHED);
        for body in bodies {
            let link = model.frame_id(&body.link)?;
            shapes.push((link, body.capsule));
            let joints = joints_moving(model, tool, link)?;
            placed.push(RobotBody { capsule: body.capsule, joints });
        }
        let joints = model.moved_by(tool)?.count();
        Ok(Self { tool, joints, own: placed.len(), shapes, placed })
    }

    /// Replaces the capsules that the tool's frame carries. Allocates nothing.
    pub(super) fn attach(&mut self, capsules: impl IntoIterator<Item = Capsule>) {
        self.shapes.truncate(self.own);
        self.placed.truncate(self.own);
        for capsule in capsules.into_iter().take(ATTACHED) {
            self.shapes.push((self.tool, capsule));
            self.placed.push(RobotBody { capsule, joints: self.joints });
        }
    }

    /// Returns true if the robot has bodies of its own.
    pub(super) fn are_any(&self) -> bool {
        self.own > 0
    }

    pub(super) fn place(&mut self, posed: &Posed<'_>) -> Result<(), Error> {
        let mut last = None;
        for (body, &(link, capsule)) in self.placed.iter_mut().zip(&self.shapes) {
            let pose = match last {
                Some((same, pose)) if same == link => pose,
                _ => posed.world_from(link)?,
            };
            body.capsule = capsule.placed(&pose);
            last = Some((link, pose));
        }
        Ok(())
    }

    pub(super) fn placed(&self) -> &[RobotBody] {
        &self.placed
    }
}

/// Returns the number of first joints that move a link.
///
/// The first columns of the tool's Jacobian give the motion of a point on the link only if these joints move tool and
/// link alike.
fn joints_moving(model: &Model, tool: FrameId, link: FrameId) -> Result<usize, Error> {
    let from_the_root = |frame: FrameId| -> Result<Vec<usize>, Error> {
        let mut entries: Vec<_> = model.moved_by(frame)?.collect();
        entries.reverse();
        Ok(entries)
    };
    let (of_link, of_tool) = (from_the_root(link)?, from_the_root(tool)?);
    let is_first = of_link.iter().copied().eq(0..of_link.len());
    // A joint that others mimic may move the tool by one of them and the link by another.
    let is_followed = model.mimic_joints().iter().any(|mimic| {
        let leader = model.joint(mimic.follows);
        leader.is_ok_and(|joint| of_link.contains(&joint.velocity_index))
    });
    if is_first && !is_followed && of_tool.starts_with(&of_link) {
        return Ok(of_link.len());
    }
    let name = |frame: FrameId| model.frame_name(frame).map(str::to_owned);
    Err(Error::BodyBesideTheWay { link: name(link)?, tool: name(tool)? })
}
