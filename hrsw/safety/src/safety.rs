//! What keeps the robot away from people and from itself: rows for the stack, and a supervisor.

use ahqp_core::{AugmentedState, Rows};
use nalgebra::Vector3;
use vision_models::{Body, Percept};

use crate::age::Age;
use crate::approach::{ApproachRows, JointMotion, Nearest, PersonBody, RobotBody};
use crate::bystanders::{Bystanders, MOST};
use crate::distance::proximity;
use crate::error::{Error, check_size, positive};
use crate::fault::Fault;
use crate::person_bodies::PersonBodies;
use crate::safety_state::SafetyState;
use crate::separation::SeparationSettings;
use crate::settings::SafetySettings;
use crate::speed_cap::SpeedCap;
use crate::supervisor::{Observation, Supervisor, SupervisorSettings};

/// The rows of the safety levels, for a stack of tasks.
#[derive(Debug, Clone, Copy)]
pub struct SafetyRows<'a> {
    /// Hard: the tool's speed near people. Braking is always admitted.
    pub cap: &'a Rows,
    /// The first objective: the robot keeps its protective distances.
    pub separation: &'a Rows,
    /// The second: the robot's own bodies keep apart.
    pub own: &'a Rows,
}

/// What the robot can do.
#[derive(Debug, Clone, Copy)]
pub struct RobotLimits<'a> {
    /// The largest accelerations of the joints, n \[m/s² or rad/s²\].
    pub accelerations: &'a [f64],
    /// How fast the robot leaves somebody with its joints at their full speeds \[m/s\]: that of its base, if it has one.
    pub speed: f64,
}

/// What a tick knows of robot and person.
#[derive(Debug, Clone, Copy)]
pub struct SafetyInput {
    /// The time of the tick \[s\].
    pub now: f64,
    /// The time since the tick before \[s\].
    pub elapsed: f64,
    /// The age of the newest camera frame.
    pub age: Age,
    /// Whether person and robot work together.
    pub together: bool,
    /// Whether a contact would be noticed: the force from outside was measured for this tick.
    pub feels: bool,
}

/// Speed and separation monitoring of the robot's bodies against the person's, self-collision,
/// the speed cap and the supervisor.
///
/// Every tick: [`measure`](Self::measure) finds the distances, and [`decide`](Self::decide) tells the
/// supervisor, which says how fast the robot may be. From that follow the velocities that the joints may take.
/// [`bound`](Self::bound) gives the rows, of which the hard ones must admit the slowest of them.
#[derive(Debug, Clone)]
pub struct Safety {
    settings: SafetySettings,
    person: PersonBodies,
    others: Bystanders,
    /// The bodies of all of them in this tick.
    people: Vec<PersonBody>,
    /// Of the joints.
    acceleration_limits: Vec<f64>,
    /// Speed of the robot that leaves somebody \[m/s\].
    full_speed: f64,
    /// By how much the joints' velocities may change in this tick.
    velocity_change: Vec<f64>,
    contact_speed: f64,
    person_velocity: Vector3<f64>,
    /// How much faster than the supervisor says a robot in retreat leaves: as fast as the person comes \[m/s\].
    leaving_speed: f64,
    nearest: Option<Nearest>,
    supervisor: Supervisor,
    separation: ApproachRows,
    own: ApproachRows,
    /// Those of the settings, and those of what is held.
    own_pairs: Vec<(usize, usize)>,
    separation_rows: Rows,
    own_rows: Rows,
    cap_rows: Rows,
}

impl Safety {
    /// For the layout of χ and a robot with these limits, with the control period \[s\].
    ///
    /// # Errors
    /// [`Error::Value`] for settings or limits out of range, [`Error::Size`] for accelerations of other joints or a
    /// pair of bodies that the settings do not have.
    pub fn new(
        state: AugmentedState,
        settings: SafetySettings,
        limits: &RobotLimits<'_>,
        period: f64,
    ) -> Result<Self, Error> {
        settings.validate()?;
        let accelerations = limits.accelerations;
        check_size("the accelerations of the joints", accelerations.len(), state.joints)?;
        let full_speed = positive("the full speed of the robot", limits.speed)?;
        let SupervisorSettings { tolerance, hysteresis, .. } = settings.supervisor;
        let separation = ApproachRows::new(state, settings.separation, settings.pairs)?
            .watching(tolerance + hysteresis);
        let SafetySettings { own_deceleration, own_margin, .. } = settings;
        let between = SeparationSettings::between_own_bodies(period, own_deceleration, own_margin);
        let own = ApproachRows::new(state, between, settings.own_rows)?;
        let count = settings.bodies.len();
        for &(first, second) in &settings.own_pairs {
            if first.max(second) >= count {
                let got = first.max(second);
                return Err(Error::Size { what: "a body's index", got, wanted: count });
            }
        }
        let person = PersonBodies::new(settings.person, &settings.contact);
        Ok(Self {
            others: Bystanders::new(settings.person, &settings.contact),
            people: Vec::with_capacity(PersonBodies::ROOM + Bystanders::room()),
            person,
            acceleration_limits: accelerations.to_vec(),
            full_speed,
            velocity_change: accelerations.iter().map(|limit| limit * period).collect(),
            contact_speed: 0.0,
            person_velocity: Vector3::zeros(),
            leaving_speed: 0.0,
            nearest: None,
            supervisor: Supervisor::new(settings.supervisor)?,
            separation_rows: separation.rows(),
            own_rows: own.rows(),
            cap_rows: SpeedCap::rows(state),
            separation,
            own,
            own_pairs: settings.own_pairs.clone(),
            settings,
        })
    }

    /// What the robot holds is kept apart from what the hand is kept apart from, too; `bodies` are
    /// those of the robot with what it holds as the last.
    pub fn hold(&mut self, bodies: &[RobotBody]) {
        self.release();
        let Some((held, own)) = bodies.split_last() else { return };
        let of_hand =
            |index: &usize| own.get(*index).is_some_and(|body| body.joints == held.joints);
        for &(first, second) in &self.settings.own_pairs {
            let others = [(first, second), (second, first)];
            for (_, other) in others.into_iter().filter(|(hand, _)| of_hand(hand)) {
                let pair = (own.len(), other);
                if !of_hand(&other) && !self.own_pairs.contains(&pair) {
                    self.own_pairs.push(pair);
                }
            }
        }
    }

    /// The robot holds nothing.
    pub fn release(&mut self) {
        self.own_pairs.truncate(self.settings.own_pairs.len());
    }

    /// Takes a camera frame.
    ///
    /// # Errors
    /// [`Error::BodySpeed`] for a person who is where nobody can have gone since the frame before. The robot keeps
    /// its distance from there, and from where they were.
    pub fn observe(&mut self, percept: &Percept) -> Result<(), Error> {
        self.person.observe(percept).map_or(Ok(()), |speed| Err(Error::BodySpeed { speed }))
    }

    /// Takes the bodies of the other people in the frame of a percept: the robot keeps its distance from each.
    ///
    /// # Errors
    /// [`Error::TooManyPeople`] for more than it has room for; those it does not know of.
    pub fn observe_others(&mut self, percept: &Percept, bodies: &[Body]) -> Result<(), Error> {
        match self.others.observe(percept, bodies) {
            0 => Ok(()),
            left_out => Err(Error::TooManyPeople { got: bodies.len(), left_out, most: MOST }),
        }
    }

    /// Forgets what was seen of people, for frames whose times turned out to be wrong.
    pub fn forget(&mut self) {
        self.person.forget();
        self.others.forget();
        self.nearest = None;
    }

    /// Tells the supervisor what went wrong in the loop.
    pub fn report(&mut self, fault: Fault) {
        self.supervisor.report(fault);
    }

    /// Measures the distances of a tick. Allocates nothing. Of `motion` neither `braking` nor `change` counts.
    ///
    /// # Errors
    /// [`Error::Size`] for a robot with other joints or bodies than the layout and the settings have,
    /// [`Error::Value`] for numbers that are not finite.
    pub fn measure(
        &mut self,
        motion: &JointMotion<'_>,
        bodies: &[RobotBody],
        input: &SafetyInput,
    ) -> Result<(), Error> {
        let step = self.settings.contact_acceleration * input.elapsed;
        let change = if input.together && input.feels { step } else { -step };
        for (change, limit) in self.velocity_change.iter_mut().zip(&self.acceleration_limits) {
            *change = limit * input.elapsed;
        }
        self.contact_speed = (self.contact_speed + change).clamp(0.0, self.settings.contact_speed);
        if !input.feels {
            self.contact_speed = 0.0;
        }
        let separation = *self.separation.settings();
        self.person_velocity = self.person.velocity(input.now, &separation);
        let person = self.person.place(input.now, &separation, self.contact_speed);
        self.people.clear();
        self.people.extend_from_slice(person);
        self.others.place(input.now, &separation, &mut self.people);
        self.measure_people(motion, bodies)?;
        let change = Some(&*self.velocity_change);
        let motion = JointMotion { braking: None, change, ..*motion };
        self.own.write_own(&motion, bodies, &self.own_pairs, &mut self.own_rows)?;
        Ok(())
    }

    /// Measures the distances from people once more, with an inverse inertia that was not known in
    /// [`measure`](Self::measure). Allocates nothing.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    pub fn measure_people(
        &mut self,
        motion: &JointMotion<'_>,
        bodies: &[RobotBody],
    ) -> Result<(), Error> {
        let change = Some(&*self.velocity_change);
        let motion = JointMotion { braking: None, change, ..*motion };
        let (people, rows) = (&self.people, &mut self.separation_rows);
        self.nearest = self.separation.write(&motion, bodies, people, rows)?;
        Ok(())
    }

    /// Returns true if [`JointMotion::inverse_inertia`] has decided how fast a person measured last may be touched, or
    /// would have. Most ticks do not ask for it; one that does is mostly followed by others.
    pub fn needs_inertia(&self) -> bool {
        self.separation.needs_inertia()
    }

    /// Tells the supervisor what was measured, with the robot's bodies of [`measure`](Self::measure). Allocates nothing.
    pub fn decide(&mut self, bodies: &[RobotBody], input: &SafetyInput) {
        let age = self.person.age(input.now);
        self.wait(if age > input.age { age } else { input.age }, input.elapsed);
        self.leaving_speed = match self.supervisor.state() {
            SafetyState::Retreat => self.speed_of_who_comes(bodies),
            _ => 0.0,
        };
    }

    /// How fast the person comes towards the body of the robot that is nearest to its protective distance, as
    /// far as that is measured \[m/s\].
    fn speed_of_who_comes(&self, bodies: &[RobotBody]) -> f64 {
        let pair = self.nearest.and_then(|nearest| {
            let (body, part) = (bodies.get(nearest.robot)?, self.people.get(nearest.other)?);
            Some((body, part, part.velocity?))
        });
        pair.map_or(0.0, |(body, part, velocity)| {
            let normal = proximity(&body.capsule, &part.capsule).normal;
            velocity.mean.dot(&normal).max(0.0)
        })
    }

    /// Tells the supervisor of a tick in which no distances could be measured: those of the last
    /// count.
    pub fn wait(&mut self, age: Age, elapsed: f64) {
        self.supervisor.update(&Observation { nearest: self.nearest, age }, elapsed);
    }

    /// The rows of the tick; the hard ones admit [`JointMotion::braking`], the velocities nearest to rest that the
    /// joints may take. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] for other joints than the layout has, [`Error::Value`] for numbers that are not finite.
    pub fn bound(&mut self, motion: &JointMotion<'_>) -> Result<SafetyRows<'_>, Error> {
        let cap = self.settings.speed_cap.limit(self.separation.least_distance());
        SpeedCap::write(motion, &self.person_velocity, cap, &mut self.cap_rows)?;
        let (cap, own) = (&self.cap_rows, &self.own_rows);
        Ok(SafetyRows { cap, separation: &self.separation_rows, own })
    }

    /// The share of the way from the velocities of `motion` to `braking`, each n, that the distances ask for \[-\]. See
    /// [`ApproachRows::braking_share`].
    pub fn braking_share(&self, motion: &JointMotion<'_>, braking: &[f64]) -> f64 {
        self.separation.braking_share(motion, &self.separation_rows, motion.velocity, braking)
    }

    /// Returns true if the robot comes about as near to people as it may, with this velocity of the joints, n
    /// \[m/s or rad/s\]. See [`ApproachRows::is_at_limit`].
    pub fn is_at_limit(&self, velocity: &[f64]) -> bool {
        self.separation.is_at_limit(&self.separation_rows, velocity)
    }

    /// The share of their speeds that the joints may use: at once zero in a stop for a fault, while the
    /// robot moves towards somebody who is too close, and where more pairs are at their limit than there
    /// are rows or one is nearer than can be told; else the supervisor's, in retreat more by the speed at
    /// which the person comes. At most 1.
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

    /// The safety state and what brought it there.
    pub fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// The same, to acknowledge a stop.
    pub fn supervisor_mut(&mut self) -> &mut Supervisor {
        &mut self.supervisor
    }

    /// The pair with the least room above its protective distance.
    pub fn nearest(&self) -> Option<&Nearest> {
        self.nearest.as_ref()
    }

    /// How fast the robot may now come nearer to the person it works with \[m/s\].
    pub fn contact_speed(&self) -> f64 {
        self.contact_speed
    }

    /// The bodies of the person who may work with the robot as they are taken to be, in the world.
    pub fn person_bodies(&self) -> &[PersonBody] {
        self.person.placed()
    }

    /// The bodies of everybody as they are taken to be, in the world: first those of
    /// [`person_bodies`](Self::person_bodies).
    pub fn all_bodies(&self) -> &[PersonBody] {
        &self.people
    }
}
