//! From percepts to where the robot may be: the person's frame and the shared workspace.

use ergo_map::PersonPose as ErgonomicPose;
use hrsw::{Bounds, FrameFollower, Workspace};
use nalgebra::{Isometry3, Translation3, Vector3, Vector6};
use vision_models::{BodyTracker, Percept, PersonPose};

use crate::error::Error;
use crate::intention::{Intention, IntentionFilter};
use crate::settings::ControllerSettings;

/// Tracks the person, filters their intention, and moves the shared workspace with them.
///
/// While person and robot work together the workspace is attached to the person and leads them
/// in the direction in which they walk; apart, or with the person lost, it stays where it is.
#[derive(Debug, Clone)]
pub struct SharedSpace {
    tracker: BodyTracker,
    intention: IntentionFilter,
    frame: FrameFollower,
    person: Option<PersonPose>,
    workspace: Workspace,
    bounds: Bounds,
    lead: Vector3<f64>,
    lead_target: f64,
    lead_rate: f64,
    attached: bool,
}

impl SharedSpace {
    /// A space that nobody shares yet, around the tool's present pose.
    ///
    /// # Errors
    /// Settings out of range, or a pose that is not finite.
    pub fn new(settings: &ControllerSettings, tool: &Isometry3<f64>) -> Result<Self, Error> {
        let space = &settings.space;
        let bounds = Bounds::new(space.min, space.max)?;
        let turn = Bounds::symmetric(space.turn)?;
        let workspace =
            Workspace::new(Isometry3::identity(), bounds, turn)?.with_reference(space.tool);
        let mut shared = Self {
            tracker: BodyTracker::new(settings.tracker.clone())?,
            intention: IntentionFilter::new(settings.intention)?,
            frame: FrameFollower::new(Isometry3::identity(), settings.follower)?,
            person: None,
            workspace,
            bounds,
            lead: Vector3::zeros(),
            lead_target: space.lead,
            lead_rate: space.lead_rate,
            attached: false,
        };
        shared.leave_around(tool)?;
        Ok(shared)
    }

    /// Takes a camera frame.
    ///
    /// # Errors
    /// [`Error::Perception`] for times that go backwards; the frame is then ignored.
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        self.tracker.update(percept)?;
        self.intention.update(percept.time, percept.action.as_ref());
        Ok(())
    }

    /// Moves frame and workspace on by `period`, to the time `now` \[s\]; `desired` is x_d.
    ///
    /// # Errors
    /// Poses that are not finite.
    pub fn advance(
        &mut self,
        now: f64,
        period: f64,
        desired: &Isometry3<f64>,
    ) -> Result<(), Error> {
        let seen_before = self.person.is_some();
        self.person = self.tracker.predict(now).or(self.person);
        let usable = self.person.is_some_and(|person| person.status.is_usable());
        match self.person {
            Some(person) if usable => {
                let target = person.world_from_person();
                if seen_before {
                    let (v, w) = (person.velocity, person.heading_rate);
                    self.frame.retarget(target, Vector6::new(v.x, v.y, 0.0, 0.0, 0.0, w))?;
                } else {
                    self.frame.reset(target)?;
                }
            }
            _ => self.frame.hold(),
        }
        self.frame.advance(period);
        self.advance_lead(usable, period);
        let attach = self.intention.intention().is_together() && self.person.is_some();
        if attach {
            self.workspace.place(*self.frame.pose(), self.frame.twist())?;
            self.workspace.set_position(self.bounds.shifted(&self.lead));
        } else if self.attached {
            self.leave_around(desired)?;
        }
        self.attached = attach;
        Ok(())
    }

    /// The lead grows and shrinks at a limited rate.
    fn advance_lead(&mut self, usable: bool, period: f64) {
        let direction = self.intention.intention().walking().filter(|_| usable);
        let target = direction.map_or(Vector3::zeros(), |direction| {
            let unit = direction.unit();
            Vector3::new(unit.x, unit.y, 0.0) * self.lead_target
        });
        let gap = target - self.lead;
        let step = self.lead_rate * period;
        self.lead += if gap.norm() > step { gap * (step / gap.norm()) } else { gap };
    }

    /// Leaves the workspace around `tool`, at rest.
    fn leave_around(&mut self, tool: &Isometry3<f64>) -> Result<(), Error> {
        self.workspace.set_position(self.bounds);
        let centre = (self.bounds.min() + self.bounds.max()) * 0.5;
        let rotation = tool.rotation * self.workspace.reference().inverse();
        let origin = tool.translation.vector - rotation * centre;
        let frame = Isometry3::from_parts(Translation3::from(origin), rotation);
        self.workspace.place(frame, Vector6::zeros())?;
        Ok(())
    }

    /// The shared workspace.
    pub fn workspace(&self) -> &Workspace {
        &self.workspace
    }

    /// What the person wants.
    pub fn intention(&self) -> Intention {
        self.intention.intention()
    }

    /// Whether the workspace is the person's: they work with the robot, and were seen.
    pub fn is_shared(&self) -> bool {
        self.attached
    }

    /// The person as tracked, if anybody was seen.
    pub fn person(&self) -> Option<&PersonPose> {
        self.person.as_ref()
    }

    /// How long ago the person was seen \[s\]; infinite if never.
    pub fn age(&self) -> f64 {
        self.person.map_or(f64::INFINITY, |person| person.age)
    }

    /// The velocity at which the tracked person walks, world axes \[m/s\]; zero when they are
    /// lost. Not that of the smooth frame, which also moves to mend its own distance.
    pub fn person_velocity(&self) -> Vector3<f64> {
        match &self.person {
            Some(person) if person.status.is_usable() => {
                Vector3::new(person.velocity.x, person.velocity.y, 0.0)
            }
            _ => Vector3::zeros(),
        }
    }

    /// The person's frame as the controller sees it: smooth in time.
    ///
    /// # Errors
    /// None while the frame is finite, which it always is.
    pub fn person_frame(&self) -> Result<ErgonomicPose, Error> {
        let pose = self.frame.pose();
        let forward = pose.rotation * Vector3::x();
        Ok(ErgonomicPose::new(pose.translation.vector, forward.y.atan2(forward.x))?)
    }
}
