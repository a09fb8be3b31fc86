//! Workspaces that move with a person, move along a path, or rest.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3, Vector6};

use crate::error::{Error, check_all, check_pose, positive};
use crate::motion::{FrameFollower, moved};
use crate::path::Path;
use crate::reorientation::Reorientation;
use crate::shape::{OrientationShape, PositionShape};
use crate::workspace::Workspace;

/// Carrier of a workspace.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Attachment {
    /// The world: the workspace rests at this pose.
    World(Isometry3<f64>),
    /// The person. The pose is that of the workspace in the person's frame.
    Person(Isometry3<f64>),
    /// A path in the world, which starts when it is attached.
    Path(Path),
}

/// A workspace whose frame follows its carrier smoothly.
///
/// Attachment, lead, reference and shape may change at any time. The velocity of the frame changes
/// no faster than its limits, and one shape changes continuously into the next.
///
/// ```
/// use hrsw::{Attachment, Bounds, FrameFollower, MovingWorkspace, Workspace};
/// use nalgebra::{Isometry3, Vector3, Vector6};
///
/// let workspace = Workspace::new(
///     Isometry3::identity(),
///     Bounds::new(Vector3::new(0.25, -0.4, 0.7), Vector3::new(0.75, 0.3, 1.5))?,
///     Bounds::symmetric(Vector3::repeat(0.3))?,
/// )?;
/// let mut moving = MovingWorkspace::new(workspace, FrameFollower::SPEED)?;
/// moving.attach(Attachment::Person(Isometry3::identity()))?;
/// for _tick in 0..5000 {
///     moving.set_person(Isometry3::translation(1.0, 0.0, 0.0), Vector6::zeros())?;
///     moving.advance(1e-3)?;
/// }
/// assert!(moving.workspace().contains(&Isometry3::translation(1.5, 0.0, 1.0)));
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MovingWorkspace {
    workspace: Workspace,
    attachment: Attachment,
    frame: FrameFollower,
    reference: Reorientation,
    /// The person's frame, and its velocity in the next period. None before it was set.
    person: Option<(Isometry3<f64>, Vector6<f64>)>,
    lead: Vector3<f64>,
    on_path: f64,
    /// True if the carrier is new, and the motion to it has not started.
    is_new: bool,
}

impl MovingWorkspace {
    /// Creates a moving workspace from `workspace`, at rest in the world. `speed` is the largest one
    /// of its frame \[m/s\].
    ///
    /// # Errors
    /// [`Error::Value`] if the speed is not positive and finite.
    pub fn new(workspace: Workspace, speed: f64) -> Result<Self, Error> {
        let pose = *workspace.world_from_workspace();
        Ok(Self {
            frame: FrameFollower::new(pose)?.with_speed(speed)?,
            reference: Reorientation::new(*workspace.reference())?,
            person: None,
            attachment: Attachment::World(pose),
            lead: Vector3::zeros(),
            on_path: 0.0,
            is_new: false,
            workspace,
        })
    }

    /// Returns the workspace in its current state.
    pub fn workspace(&self) -> &Workspace {
        &self.workspace
    }

    /// Returns the carrier of the workspace.
    pub fn attachment(&self) -> &Attachment {
        &self.attachment
    }

    /// Attaches the workspace to another carrier. It moves there at its limited rates.
    ///
    /// # Errors
    /// [`Error::Value`] if a pose is invalid. The attachment is then unchanged.
    pub fn attach(&mut self, attachment: Attachment) -> Result<(), Error> {
        match &attachment {
            Attachment::World(pose) | Attachment::Person(pose) => check_pose(pose)?,
            Attachment::Path(_) => {}
        }
        self.attachment = attachment;
        (self.on_path, self.is_new) = (0.0, true);
        Ok(())
    }

    /// Leaves the workspace in the world. It comes to rest where it can stop, and its lead ends.
    pub fn detach(&mut self) {
        self.lead = Vector3::zeros();
        self.attachment = Attachment::World(self.frame.stopping_pose());
    }

    /// Sets the person's frame of this moment and its velocity, linear at its origin, then angular,
    /// in world axes \[m/s, rad/s\]. The frame moves on for one period, and then stands until it is
    /// set again.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is invalid. The frame is then unchanged.
    pub fn set_person(
        &mut self,
        mut pose: Isometry3<f64>,
        twist: Vector6<f64>,
    ) -> Result<(), Error> {
        check_pose(&pose)?;
        check_all("the twist of the person's frame", twist.iter())?;
        // A rotation may be a unit quaternion up to 1e-6 only.
        pose.rotation.renormalize_fast();
        self.person = Some((pose, twist));
        Ok(())
    }

    /// Shifts the workspace by `lead` in the axes of its carrier \[m\], at its limited rates.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is not finite. The lead is then unchanged.
    pub fn set_lead(&mut self, lead: Vector3<f64>) -> Result<(), Error> {
        check_all("the lead of a workspace", lead.iter())?;
        self.lead = lead;
        Ok(())
    }

    /// Turns the reference of orientations to `goal`, in the axes of the frame, together with the
    /// shape of orientations.
    ///
    /// The turn follows a geodesic at limited rates. If it is half a turn, two ways are equally
    /// short. It then turns in the positive sense of `axis`, in the axes of the reference.
    ///
    /// # Errors
    /// [`Error::Value`] if the goal is not a rotation. The goal is then unchanged.
    pub fn reorient(
        &mut self,
        goal: UnitQuaternion<f64>,
        axis: &Unit<Vector3<f64>>,
    ) -> Result<(), Error> {
        self.reference.turn_to(goal, axis)
    }

    /// Returns the goal of the reference of orientations.
    pub fn reference_goal(&self) -> UnitQuaternion<f64> {
        self.reference.goal()
    }

    /// Changes the shape of positions over `duration` \[s\]. Has no effect if `position` is the
    /// goal already.
    ///
    /// # Errors
    /// Those of [`Workspace::reshape_position`].
    pub fn reshape_position(
        &mut self,
        position: &PositionShape,
        duration: f64,
    ) -> Result<(), Error> {
        if self.workspace.position_shape() == position {
            return Ok(());
        }
        self.workspace.reshape_position(position.clone(), duration)
    }

    /// Changes the shape of orientations over `duration` \[s\]. Has no effect if `orientation` is
    /// the goal already.
    ///
    /// # Errors
    /// Those of [`Workspace::reshape_orientation`].
    pub fn reshape_orientation(
        &mut self,
        orientation: &OrientationShape,
        duration: f64,
    ) -> Result<(), Error> {
        if self.workspace.orientation_shape() == orientation {
            return Ok(());
        }
        self.workspace.reshape_orientation(*orientation, duration)
    }

    /// Advances by `period` \[s\]. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Value`] if the period is not positive and finite. The workspace is then unchanged.
    pub fn advance(&mut self, period: f64) -> Result<(), Error> {
        positive("the period", period)?;
        self.on_path += period;
        if let Some((pose, twist)) = &mut self.person {
            let part = |first| twist.fixed_rows::<3>(first) * period;
            *pose = moved(pose, &part(0), &part(3));
        }
        let target = self.target();
        if let Some((_, twist)) = &mut self.person {
            *twist = Vector6::zeros();
        }
        if let Some((pose, twist)) = target {
            if self.frame.retarget(pose, twist).is_err() {
                // The pose of the carrier has overflowed.
                self.frame.hold();
            }
            if std::mem::take(&mut self.is_new) {
                self.frame.approach_slowly();
            }
        }
        self.frame.advance(period);
        self.reference.advance(period)?;
        self.workspace.advance(period);
        self.workspace.place(*self.frame.pose(), self.frame.twist())?;
        self.workspace.set_reference(*self.reference.rotation(), self.reference.rate())
    }

    /// Returns the target of the frame and its velocity. None if the carrier was never seen.
    fn target(&self) -> Option<(Isometry3<f64>, Vector6<f64>)> {
        let carried = |(pose, twist): &(Isometry3<f64>, Vector6<f64>), offset: &Isometry3<f64>| {
            let target = pose * (Translation3::from(self.lead) * offset);
            let arm = target.translation.vector - pose.translation.vector;
            let turning = twist.fixed_rows::<3>(3).into_owned();
            let mut carried = *twist;
            let mut linear = carried.fixed_rows_mut::<3>(0);
            linear += turning.cross(&arm);
            (target, carried)
        };
        match &self.attachment {
            Attachment::Person(offset) => {
                self.person.as_ref().map(|person| carried(person, offset))
            }
            Attachment::World(pose) => Some((led(pose, &self.lead), Vector6::zeros())),
            Attachment::Path(path) => {
                let (pose, twist) = path.at(self.on_path);
                Some((led(&pose, &self.lead), twist))
            }
        }
    }
}

/// Returns the pose shifted by `lead` in its own axes.
fn led(pose: &Isometry3<f64>, lead: &Vector3<f64>) -> Isometry3<f64> {
    let origin = pose * Point3::from(*lead);
    Isometry3::from_parts(Translation3::from(origin.coords), pose.rotation)
}
