//! Separation of the robot from people and from itself: rows for the stack, and a supervisor.

use ahqp_core::{AugmentedState, Rows};
use nalgebra::Vector3;
use vision_models::{Body, Percept};

use crate::age::Age;
use crate::approach::{ApproachRows, JointMotion, Nearest, PersonBody, RobotBody};
use crate::distance::proximity;
use crate::error::{Error, check_size, positive};
use crate::fault::Fault;
use crate::people::SeenPeople;
use crate::safety_state::SafetyState;
use crate::separation::SeparationSettings;
use crate::settings::SafetySettings;
use crate::speed_cap::SpeedCap;
use crate::supervisor::{Observation, Supervisor};

/// Rate at which the contact speed rises and falls when working together begins and ends \[m/s²\].
const CONTACT_ACCELERATION: f64 = 1.0;
/// Number of pairs of a robot's and a person's body that get a row. The robot brakes if more are at
/// their limits.
const PAIRS: usize = 40;
/// Number of pairs of the robot's own bodies that get a row.
const OWN_ROWS: usize = 6;
/// Margin between the robot's own bodies \[m\]. Within a period they approach by some millimetres at
/// most.
const OWN_MARGIN: f64 = 0.03;
/// Deceleration of the arm before a self-collision \[m/s²\].
const OWN_DECELERATION: f64 = 2.0;

/// Inputs of a tick.
#[derive(Debug, Clone, Copy)]
pub struct SafetyInput {
    /// Time of the tick \[s\].
    pub now: f64,
    /// Time since the tick before \[s\].
    pub elapsed: f64,
    /// Age of the newest camera frame.
    pub age: Age,
    /// True if person and robot work together.
    pub together: bool,
    /// True if a contact would be noticed, because the force from outside was measured for this
    /// tick.
    pub measures_force: bool,
}

/// Speed and separation monitoring between robot and people, with self-collision avoidance, the
/// speed cap and the supervisor.
///
/// In every tick, [`measure`](Self::measure) computes the distances. [`decide`](Self::decide)
/// updates the supervisor, which limits the robot's speed. From that limit follow the velocities
/// that the joints may take. [`write_cap`](Self::write_cap), [`separation`](Self::separation) and
/// [`own`](Self::own) write the rows of a stack in place. The hard rows admit the slowest of these
/// velocities.
#[derive(Debug, Clone)]
pub struct Safety {
    settings: SafetySettings,
    people: SeenPeople,
    /// The capsules of all people in this tick.
    bodies: Vec<PersonBody>,
    /// Largest accelerations of the joints.
    acceleration_limits: Vec<f64>,
    /// Speed at which the robot can leave a person \[m/s\].
    full_speed: f64,
    /// Largest change of each joint's velocity in this tick.
    velocity_change: Vec<f64>,
    contact_speed: f64,
    person_velocity: Vector3<f64>,
    /// Speed of the approaching person, which is added to the supervisor's speed in retreat
    /// \[m/s\].
    leaving_speed: f64,
    nearest: Option<Nearest>,
    supervisor: Supervisor,
    separation: ApproachRows,
    own: ApproachRows,
    /// Pairs of the settings, then those of a grasped object.
    own_pairs: Vec<(usize, usize)>,
}

impl Safety {
    /// Creates the monitoring for the layout of χ and a control period \[s\]. The robot has these
    /// largest `accelerations` of its joints, n \[m/s² or rad/s²\]. At full speed of its joints it
    /// leaves a person at `speed` \[m/s\], that of its base if it has one.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting or limit is out of range. [`Error::Size`] if the number of
    /// accelerations is not that of the joints, or if a pair has an index beyond the bodies of the
    /// settings.
    pub fn new(
        state: AugmentedState,
        settings: SafetySettings,
        accelerations: &[f64],
        speed: f64,
        period: f64,
    ) -> Result<Self, Error> {
        settings.validate()?;
        check_size("the accelerations of the joints", accelerations.len(), state.joints)?;
        let full_speed = positive("the full speed of the robot", speed)?;
        let pairs = if settings.keeps_distances() { PAIRS } else { 0 };
        let separation =
            ApproachRows::new(state, settings.separation, pairs)?.watching(Supervisor::HYSTERESIS);
        let between = SeparationSettings::between_own_bodies(period, OWN_DECELERATION, OWN_MARGIN);
        let own_rows = if settings.own_pairs.is_empty() { 0 } else { OWN_ROWS };
        let own = ApproachRows::new(state, between, own_rows)?;
        let count = settings.bodies.len();
        for &(first, second) in &settings.own_pairs {
            if first.max(second) >= count {
                let got = first.max(second);
                return Err(Error::Size { what: "a body's index", got, wanted: count });
            }
        }
        // A pair of two bodies of the gripper adds two for the grasped object.
        let mut own_pairs = Vec::with_capacity(3 * settings.own_pairs.len());
        own_pairs.extend_from_slice(&settings.own_pairs);
        Ok(Self {
            people: SeenPeople::new(settings.position_sigma, &settings.contact),
            bodies: Vec::with_capacity(SeenPeople::room()),
            acceleration_limits: accelerations.to_vec(),
            full_speed,
            velocity_change: accelerations.iter().map(|limit| limit * period).collect(),
            contact_speed: 0.0,
            person_velocity: Vector3::zeros(),
            leaving_speed: 0.0,
            nearest: None,
            supervisor: Supervisor::new(settings.supervisor)?,
            separation,
            own,
            own_pairs,
            settings,
        })
    }

    /// Adds the grasped object to the self-collision pairs of the gripper. `bodies` are those of
    /// the robot, with the grasped object as the last.
    pub fn attach(&mut self, bodies: &[RobotBody]) {
        self.detach();
        let Some((grasped, own)) = bodies.split_last() else { return };
        let of_gripper =
            |index: &usize| own.get(*index).is_some_and(|body| body.joints == grasped.joints);
        for &(first, second) in &self.settings.own_pairs {
            let others = [(first, second), (second, first)];
            for (_, other) in others.into_iter().filter(|(gripper, _)| of_gripper(gripper)) {
                let pair = (own.len(), other);
                if !of_gripper(&other) && !self.own_pairs.contains(&pair) {
                    self.own_pairs.push(pair);
                }
            }
        }
    }

    /// Removes the pairs of the grasped object.
    pub fn detach(&mut self) {
        self.own_pairs.truncate(self.settings.own_pairs.len());
    }

    /// Takes the person of a camera frame who works with the robot. A person without an id is the
    /// one of the frame before.
    ///
    /// # Errors
    /// [`Error::BodySpeed`] if the person is at a place that nobody can have reached since the
    /// frame before. The robot keeps its distance from that place, and from the one before.
    /// [`Error::TooManyPeople`] if there is no room for a new person.
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        self.people.observe(percept)
    }

    /// Takes the bodies of the other people in the frame of a percept, after the percept. The robot
    /// keeps its distance from each of them, at the velocities of their own joints. A new person
    /// has the speed of [`SeparationSettings`] until theirs is measured. A person without an id is
    /// new in each frame, and is remembered like any other. A source without ids soon stops the
    /// robot, unless [`People::identify`](vision_models::People::identify) comes before.
    ///
    /// # Errors
    /// [`Error::TooManyPeople`] if there is no room for all of them. The robot does not know of the
    /// rest. [`Error::BodySpeed`] as in [`observe`](Self::observe).
    pub fn observe_others(&mut self, percept: &Percept, bodies: &[Body]) -> Result<(), Error> {
        self.people.observe_others(percept, bodies)
    }

    /// Forgets all observations of people, for frames whose times turned out to be wrong.
    pub fn forget(&mut self) {
        self.people.forget();
        self.nearest = None;
    }

    /// Reports a fault of the loop to the supervisor.
    pub fn report(&mut self, fault: Fault) {
        self.supervisor.report(fault);
    }

    /// Measures the distances of a tick. Ignores `braking` and `change` of `motion`. Allocates
    /// nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if the robot has other joints or bodies than the layout and the settings.
    /// [`Error::Value`] if a number is not finite.
    pub fn measure(
        &mut self,
        motion: &JointMotion<'_>,
        bodies: &[RobotBody],
        input: &SafetyInput,
    ) -> Result<(), Error> {
        let step = CONTACT_ACCELERATION * input.elapsed;
        let change = if input.together && input.measures_force { step } else { -step };
        for (change, limit) in self.velocity_change.iter_mut().zip(&self.acceleration_limits) {
            *change = limit * input.elapsed;
        }
        self.contact_speed = (self.contact_speed + change).clamp(0.0, self.settings.contact_speed);
        if !input.measures_force {
            self.contact_speed = 0.0;
        }
        let separation = *self.separation.settings();
        self.person_velocity = self.people.velocity(input.now, &separation);
        self.people.place(input.now, &separation, self.contact_speed, &mut self.bodies);
        self.measure_people(motion, bodies)?;
        let change = Some(&*self.velocity_change);
        let motion = JointMotion { braking: None, change, ..*motion };
        self.own.measure_own(&motion, bodies, &self.own_pairs)?;
        Ok(())
    }

    /// Measures the distances from people again, with an inverse inertia that was not known in
    /// [`measure`](Self::measure). Allocates nothing.
    ///
    /// # Errors
    /// Those of [`measure`](Self::measure).
    pub fn measure_people(
        &mut self,
        motion: &JointMotion<'_>,
        bodies: &[RobotBody],
    ) -> Result<(), Error> {
        let change = Some(&*self.velocity_change);
        let motion = JointMotion { braking: None, change, ..*motion };
        self.nearest = self.separation.measure(&motion, bodies, &self.bodies)?;
        Ok(())
    }

    /// Returns true if [`JointMotion::inverse_inertia`] decided, or would have decided, the speed
    /// limit of a contact with a person measured last. Most ticks do not need it. A tick that does
    /// is usually followed by others.
    pub fn needs_inertia(&self) -> bool {
        self.separation.needs_inertia()
    }

    /// Reports the measured distances to the supervisor. `bodies` are those of
    /// [`measure`](Self::measure). Allocates nothing.
    pub fn decide(&mut self, bodies: &[RobotBody], input: &SafetyInput) {
        let age = self.people.age(input.now);
        self.wait(if age > input.age { age } else { input.age }, input.elapsed);
        self.leaving_speed = match self.supervisor.state() {
            SafetyState::Retreat => self.speed_of_who_comes(bodies),
            _ => 0.0,
        };
    }

    /// Returns the measured speed of the person towards the robot's body that is nearest to its
    /// protective distance \[m/s\].
    fn speed_of_who_comes(&self, bodies: &[RobotBody]) -> f64 {
        let pair = self.nearest.and_then(|nearest| {
            let (body, part) = (bodies.get(nearest.robot)?, self.bodies.get(nearest.other)?);
            Some((body, part, part.velocity?))
        });
        pair.map_or(0.0, |(body, part, velocity)| {
            let normal = proximity(&body.capsule, &part.capsule).normal;
            velocity.mean.dot(&normal).max(0.0)
        })
    }

    /// Updates the supervisor for a tick without measured distances. Those of the last tick count.
    /// `elapsed` is the time since that tick \[s\].
    pub fn wait(&mut self, age: Age, elapsed: f64) {
        self.supervisor.update(&Observation { nearest: self.nearest, age }, elapsed);
    }

    /// Writes the hard rows on the tool's speed. They admit [`JointMotion::braking`], the velocities
    /// nearest to rest that the joints may take. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if the joints or the rows are not those of the layout. [`Error::Value`] if a
    /// number is not finite.
    pub fn write_cap(&self, motion: &JointMotion<'_>, rows: &mut Rows) -> Result<(), Error> {
        let cap = SpeedCap::limit(self.separation.least_distance());
        SpeedCap::write(motion, &self.person_velocity, cap, rows)
    }

    /// Returns the rows of the protective distances, as measured in this tick. As an objective they are
    /// written with no [`JointMotion::braking`], which would relax them.
    pub fn separation(&self) -> &ApproachRows {
        &self.separation
    }

    /// Returns the rows of the protective distances, to change the velocities of a stop.
    pub fn separation_mut(&mut self) -> &mut ApproachRows {
        &mut self.separation
    }

    /// Returns the rows of the distances between the robot's own bodies, as measured in this tick.
    pub fn own(&self) -> &ApproachRows {
        &self.own
    }

    /// Returns the share of their speeds that the joints may use, at most 1.
    ///
    /// It is zero at once in a stop for a fault, and during motion towards a person who is too
    /// close. It is also zero if more pairs are at their limits than there are rows, or if a person
    /// is closer than the uncertainty. Otherwise it is the supervisor's share. In retreat the speed
    /// at which the person approaches is added.
    pub fn speed_scale(&self) -> f64 {
        let separation = &self.separation;
        let brakes = separation.is_crowded()
            || separation.is_too_near_to_tell()
            || self.supervisor.stops_at_once();
        if brakes {
            0.0
        } else {
            (self.supervisor.speed_scale() + self.leaving_speed / self.full_speed).min(1.0)
        }
    }

    /// Returns the supervisor, with the safety state and its cause.
    pub fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// Returns the supervisor, to acknowledge a stop.
    pub fn supervisor_mut(&mut self) -> &mut Supervisor {
        &mut self.supervisor
    }

    /// Returns the pair with the least room above its protective distance.
    pub fn nearest(&self) -> Option<&Nearest> {
        self.nearest.as_ref()
    }

    /// Returns the speed at which the robot may now approach the person who works with it \[m/s\].
    pub fn contact_speed(&self) -> f64 {
        self.contact_speed
    }

    /// Returns the capsules of the person who may work with the robot, in the world frame.
    pub fn person_bodies(&self) -> &[PersonBody] {
        self.people.placed()
    }

    /// Returns the capsules of all people in the world frame, first those of
    /// [`person_bodies`](Self::person_bodies).
    pub fn all_bodies(&self) -> &[PersonBody] {
        &self.bodies
    }
}
