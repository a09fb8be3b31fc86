//! Judge of the robot's distance tick by tick.

use moca_model::whole_body::robot::JointLimits;
use moca_model::whole_body::{Data, FrameId, Model};
use nalgebra::Point3;
use simulated_people::Joints;

use super::body;
use super::judgement::{Body, MOMENT, Robot, Terms, Verdict, emergency_stop, judge};
use super::rod::Rod;
use crate::error::Error;

/// The person in a tick, now and a period before. The earlier joints are `None` after a jump, or for a person who
/// counts as standing.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Joints now \[m\].
    pub person: (&'a Joints, Option<&'a Joints>),
    /// Joints in the newest frame that shows the person and has arrived \[m\].
    pub known: Option<(&'a Joints, Option<&'a Joints>)>,
    /// True if all parts except the head may touch the robot.
    pub contact: bool,
}

/// The robot's own capsules.
#[derive(Clone, Debug)]
pub struct Rods {
    /// Names of links, each with a capsule in the link's frame \[m\].
    pub links: Vec<(String, Rod)>,
    /// Pairs of these capsules that must keep apart, by index.
    pub own_pairs: Vec<(usize, usize)>,
}

/// Judges every tick of a robot.
#[derive(Clone, Debug)]
pub struct SeparationMonitor {
    model: Model,
    data: Data,
    shapes: Vec<(FrameId, Rod)>,
    /// Number of capsules that are the robot's own.
    own: usize,
    own_pairs: Vec<(usize, usize)>,
    terms: Terms,
    limits: Vec<JointLimits>,
    period: f64,
    /// Velocities in an emergency stop, then as commanded.
    velocity: Vec<f64>,
    /// Last commanded velocities, and their rates.
    last: Vec<f64>,
    acceleration: Vec<f64>,
    robot: Robot,
}

impl SeparationMonitor {
    /// Creates a monitor for a robot at rest, with the control period \[s\].
    ///
    /// # Errors
    /// Bodies on links that the robot does not have.
    pub fn new(model: &Model, rods: Rods, terms: Terms, period: f64) -> Result<Self, Error> {
        let mut shapes = Vec::new();
        for (link, rod) in &rods.links {
            shapes.push((model.frame_id(link)?, *rod));
        }
        let limits = model.limits().to_vec();
        let rest = vec![0.0; limits.len()];
        Ok(Self {
            data: Data::new(model),
            own: shapes.len(),
            own_pairs: rods.own_pairs,
            terms,
            velocity: rest.clone(),
            last: rest.clone(),
            acceleration: rest,
            robot: Robot::default(),
            model: model.clone(),
            limits,
            shapes,
            period,
        })
    }

    /// Sets the capsule that a frame carries.
    pub fn carry(&mut self, frame: FrameId, rod: Rod) {
        self.shapes.truncate(self.own);
        self.shapes.push((frame, rod));
    }

    /// Judges the tick of a command, n \[m/s, rad/s\], that begins at `configuration`, n \[m, rad\], for each person.
    ///
    /// # Errors
    /// A configuration that does not belong to the robot.
    pub fn check(
        &mut self,
        velocity: &[f64],
        configuration: &[f64],
        people: &[Moment<'_>],
    ) -> Result<Verdict, Error> {
        emergency_stop(&self.limits, &self.acceleration, &mut self.velocity, self.period);
        self.place(velocity, configuration)?;
        for ((acceleration, now), before) in
            self.acceleration.iter_mut().zip(velocity).zip(&self.last)
        {
            *acceleration = (now - before) / self.period;
        }
        self.velocity.copy_from_slice(velocity);
        self.last.copy_from_slice(velocity);
        let body = |(now, before): (&Joints, Option<&Joints>)| Body {
            now: body::capsules(now),
            before: before.map(body::capsules),
        };
        let mut verdict = Verdict::default();
        for Moment { person, known, contact } in people {
            let (now, known) = (body(*person), known.map(body));
            let of_one =
                judge(&self.terms, &self.robot, &now, known.as_ref(), *contact, self.period);
            verdict.add(&of_one);
        }
        Ok(verdict)
    }

    /// Distance of a person's trunk, head and legs from the robot, as in the last tick, up to a distance that is
    /// enough \[m\].
    pub(crate) fn gap(&self, joints: &Joints, enough: f64) -> f64 {
        let parts = body::capsules(joints);
        let parts = parts.iter().enumerate().filter(|(part, _)| !body::is_arm(*part));
        let links: Vec<_> = self.robot.now.iter().map(|link| (link, link.ball())).collect();
        let mut gap = enough;
        for (_, part) in parts {
            let ball = part.ball();
            let near = links.iter().filter(|(_, around)| !ball.is_beyond(around, enough));
            gap = near.map(|(link, _)| link.distance(part)).fold(gap, f64::min);
        }
        gap
    }

    /// Returns the largest overlap of two bodies of the robot that must keep apart \[m\].
    pub fn overlap(&self) -> f64 {
        self.overlap_of(&self.robot.now)
    }

    /// Returns the same with the robot at another configuration, n \[m, rad\].
    ///
    /// # Errors
    /// A configuration that does not belong to the robot.
    pub(crate) fn overlap_at(&mut self, configuration: &[f64]) -> Result<f64, Error> {
        let mut rods = Vec::with_capacity(self.shapes.len());
        place(&mut self.data, &self.model, &self.shapes, configuration, &mut rods)?;
        Ok(self.overlap_of(&rods))
    }

    fn overlap_of(&self, rods: &[Rod]) -> f64 {
        let overlaps = self.own_pairs.iter().map(|&(i, j)| -rods[i].distance(&rods[j]));
        overlaps.fold(0.0, f64::max)
    }

    /// Computes the robot's bodies now, and their motions as commanded and in an emergency stop.
    fn place(&mut self, commanded_velocity: &[f64], configuration: &[f64]) -> Result<(), Error> {
        let Robot { now, commanded, base, stopping } = &mut self.robot;
        let base_joints = self.terms.base_joints;
        let mut of_base = commanded_velocity.to_vec();
        of_base.iter_mut().skip(base_joints).for_each(|velocity| *velocity = 0.0);
        for (rods, velocity, time) in [
            (now, commanded_velocity, 0.0),
            (&mut base.before, &of_base, -MOMENT),
            (&mut base.after, &of_base, MOMENT),
            (&mut commanded.before, commanded_velocity, -MOMENT),
            (&mut commanded.after, commanded_velocity, MOMENT),
            (&mut stopping.before, &self.velocity, -MOMENT),
            (&mut stopping.after, &self.velocity, MOMENT),
        ] {
            let moved = configuration.iter().zip(velocity).map(|(q, v)| q + v * time);
            let q: Vec<f64> = moved.collect();
            place(&mut self.data, &self.model, &self.shapes, &q, rods)?;
        }
        Ok(())
    }
}

/// Places the shapes for a configuration.
fn place(
    data: &mut Data,
    model: &Model,
    shapes: &[(FrameId, Rod)],
    configuration: &[f64],
    rods: &mut Vec<Rod>,
) -> Result<(), Error> {
    let posed = data.pose(model, configuration)?;
    rods.clear();
    for (link, rod) in shapes {
        let pose = posed.world_from(*link)?;
        let ends = rod.ends.map(|end| (pose * Point3::from(end)).coords);
        rods.push(Rod { ends, ..*rod });
    }
    Ok(())
}
