//! Simulation of rigid bodies under torques.

use super::contact::Contact;
use crate::dynamics::articulated::Part;
use crate::dynamics::external::ExternalWrench;
use crate::error::{Error, check_size};
use crate::robot::description::Base;
use crate::robot::model::Model;
use crate::state::data::Data;

/// Number of wrenches that there is room for at construction.
const WRENCHES: usize = 8;

/// The drive of a joint of a simulated robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointDrive {
    /// Applies the commanded torque or force, within the joint's effort limit, with the friction of the
    /// [`Description`](crate::Description).
    Torque {
        /// Inertia of the rotor at the joint: that of the rotor times the gear ratio squared \[kg m² or kg\].
        rotor_inertia: f64,
    },
    /// Follows the commanded velocity by T q̈ + q̇ = q̇*, whatever the other joints do. This suits a base of large
    /// mass.
    Velocity {
        /// T \[s\].
        time_constant: f64,
    },
}

impl JointDrive {
    /// A torque drive without a rotor.
    pub const TORQUE: Self = Self::Torque { rotor_inertia: 0.0 };

    fn validate(&self) -> Result<(), Error> {
        let (what, value, least) = match *self {
            Self::Torque { rotor_inertia } => ("a rotor's inertia [kg m²]", rotor_inertia, 0.0),
            Self::Velocity { time_constant } => {
                ("a drive's time constant [s]", time_constant, f64::MIN_POSITIVE)
            }
        };
        if value >= least && value.is_finite() {
            return Ok(());
        }
        let expected = "positive and finite; an inertia may be zero";
        Err(Error::value(what, value, expected))
    }

    fn part(self) -> Part {
        match self {
            Self::Torque { rotor_inertia } => Part::Free { rotor_inertia },
            Self::Velocity { .. } => Part::Prescribed,
        }
    }
}

/// A robot of rigid bodies under torques, gravity, friction and contacts.
///
/// The articulated-body algorithm computes forward dynamics; joints that follow velocities are prescribed (Featherstone
/// 2008, Sec. 7.3 and 9.2). Commands are constant during a step. The classical Runge-Kutta method of fourth order
/// integrates it in equal substeps. Halving these divides the error by 16 with smooth forces, and by at least 2 where a
/// contact begins or ends.
///
/// Position and velocity limits are not enforced, so that errors of a controller stay visible. The same input gives the
/// same bits.
///
/// ```
/// use whole_body::simulation::{JointDrive, RigidBodySimulation};
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/>
/// #   <link name="tip"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
/// #   <inertia ixx="0.1" iyy="0.02" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="50"/></joint></robot>"#, &Description::default())?;
/// let mut pendulum = RigidBodySimulation::new(&model, &[JointDrive::TORQUE], &[0.1])?;
/// for _ in 0..1000 {
///     pendulum.step(&[0.0], &[], 1e-3)?; // Nm
/// }
/// assert!(pendulum.position()[0].abs() <= 0.1 + 1e-9);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct RigidBodySimulation {
    model: Model,
    drives: Vec<JointDrive>,
    substeps: u32,
    state: State,
    contacts: Vec<Contact>,
    /// Torques of the last step at the output of the gears.
    torque: Vec<f64>,
    room: Room,
}

/// q and q̇, then position and velocity of each contact.
#[derive(Debug, Clone)]
struct State {
    q: Vec<f64>,
    v: Vec<f64>,
    surfaces: Vec<[f64; 2]>,
}

/// The rates of a state's velocities.
#[derive(Debug, Clone)]
struct Rates {
    v: Vec<f64>,
    a: Vec<f64>,
    /// Velocity and acceleration of each surface.
    surfaces: Vec<[f64; 2]>,
}

#[derive(Debug, Clone)]
struct Room {
    data: Data,
    parts: Vec<Part>,
    /// Command of each joint in this step.
    command: Vec<f64>,
    torque: Vec<f64>,
    solved: Vec<f64>,
    wrenches: Vec<ExternalWrench>,
    start: State,
    stage: State,
    rates: [Rates; 4],
    forces: Vec<f64>,
    peaks: Vec<f64>,
}

impl RigidBodySimulation {
    /// Creates a robot at rest at the configuration `position` \[rad or m\] with a drive for each entry of q̇ and
    /// one substep.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for a drive; [`Error::UnknownEffort`] of a joint with a torque drive;
    /// [`Error::Unsuitable`] for a floating base or a mimic joint; those of [`Data::pose`].
    pub fn new(model: &Model, drives: &[JointDrive], position: &[f64]) -> Result<Self, Error> {
        if model.base() == Base::Floating {
            let joint = model.joints().first().map_or_else(String::new, |joint| joint.name.clone());
            return Err(Error::floating_joint(&joint));
        }
        if let Some(mimic) = model.mimic_joints().first() {
            let what = format!(
                "joint `{}` follows another joint, which a simulation does not do",
                mimic.name
            );
            return Err(Error::unsuitable(what, "hold it"));
        }
        model.check_configuration(position)?;
        let n = model.velocity_count();
        check_size("the list of drives", drives.len(), n)?;
        drives.iter().try_for_each(JointDrive::validate)?;
        let driven = drives.iter().enumerate();
        let mut driven = driven.filter(|(_, drive)| matches!(drive, JointDrive::Torque { .. }));
        driven.try_for_each(|(entry, _)| model.expect_effort(entry))?;
        let none = vec![0.0; n];
        let state = State { q: position.to_vec(), v: none.clone(), surfaces: Vec::new() };
        let rates = Rates { v: none.clone(), a: none.clone(), surfaces: Vec::new() };
        Ok(Self {
            drives: drives.to_vec(),
            substeps: 1,
            contacts: Vec::new(),
            torque: none.clone(),
            room: Room {
                data: Data::new(model),
                parts: drives.iter().map(|drive| drive.part()).collect(),
                command: none.clone(),
                torque: none.clone(),
                solved: none,
                wrenches: Vec::with_capacity(WRENCHES),
                start: state.clone(),
                stage: state.clone(),
                rates: [rates.clone(), rates.clone(), rates.clone(), rates],
                forces: Vec::new(),
                peaks: Vec::new(),
            },
            model: model.clone(),
            state,
        })
    }

    /// Divides each step into this number of substeps.
    ///
    /// # Errors
    /// [`Error::Value`] for zero.
    pub fn with_substeps(mut self, substeps: u32) -> Result<Self, Error> {
        if substeps == 0 {
            return Err(Error::not_positive("the number of substeps", 0.0));
        }
        self.substeps = substeps;
        Ok(self)
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// q \[rad or m\].
    pub fn position(&self) -> &[f64] {
        &self.state.q
    }

    /// q̇ \[rad/s or m/s\].
    pub fn velocity(&self) -> &[f64] {
        &self.state.v
    }

    /// The mean torque of the last step at a sensor between gear and link \[Nm or N\]. That is the motor's torque minus
    /// that which accelerates the rotor, friction included. Zero for joints that follow velocities.
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// The contacts, with their state at the end of the last step.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The contacts, to add, move and remove them. The next step makes room for new ones.
    pub fn contacts_mut(&mut self) -> &mut Vec<Contact> {
        &mut self.contacts
    }

    /// The robot's data, for example to [attach](Data::attach) payloads.
    pub fn data_mut(&mut self) -> &mut Data {
        &mut self.room.data
    }

    /// Moves the robot for `period` \[s\] under a `command` for each entry of q̇ and constant external wrenches. A
    /// command is a torque or a velocity, depending on the drive \[Nm or N, rad/s or m/s\]. Allocates nothing once
    /// there is room for wrenches and contacts.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`], [`Error::ForeignId`]; [`Error::NoInertia`]; [`Error::Value`] for a state
    /// whose numbers have grown too large. The robot then stays where it was.
    pub fn step(
        &mut self,
        command: &[f64],
        external: &[ExternalWrench],
        period: f64,
    ) -> Result<(), Error> {
        self.model.check_velocity("the command", command)?;
        if !(period > 0.0 && period.is_finite()) {
            return Err(Error::not_positive("the time step [s]", period));
        }
        self.contacts.iter().try_for_each(Contact::validate)?;
        self.begin(command);
        let step = period / f64::from(self.substeps);
        for _ in 0..self.substeps {
            self.substep(external, step)?;
        }
        self.finish(external, period)
    }

    /// Reads the command within the limits, and the present contacts.
    fn begin(&mut self, command: &[f64]) {
        let Room { command: held, start, stage, rates, forces, peaks, .. } = &mut self.room;
        let drives = self.drives.iter().zip(self.model.limits());
        for ((held, command), (drive, limits)) in held.iter_mut().zip(command).zip(drives) {
            *held = match drive {
                JointDrive::Torque { .. } => command.max(-limits.effort).min(limits.effort),
                JointDrive::Velocity { .. } => *command,
            };
        }
        let count = self.contacts.len();
        start.q.copy_from_slice(&self.state.q);
        start.v.copy_from_slice(&self.state.v);
        for surfaces in [&mut start.surfaces, &mut stage.surfaces] {
            surfaces.resize(count, [0.0; 2]);
        }
        for (surface, contact) in start.surfaces.iter_mut().zip(&self.contacts) {
            *surface = [contact.position, contact.velocity];
        }
        for rates in rates {
            rates.surfaces.resize(count, [0.0; 2]);
        }
        forces.resize(count, 0.0);
        peaks.clear();
        peaks.resize(count, 0.0);
    }

    /// y ← y + h (k₁ + 2 k₂ + 2 k₃ + k₄) / 6.
    fn substep(&mut self, external: &[ExternalWrench], step: f64) -> Result<(), Error> {
        self.copy_start();
        self.evaluate(0, external)?;
        for (stage, share) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            self.move_stage(stage - 1, share * step);
            self.evaluate(stage, external)?;
        }
        let Room { start, rates, .. } = &mut self.room;
        let [first, second, third, fourth] = rates;
        let mean = |a: f64, b: f64, c: f64, d: f64| step / 6.0 * (a + 2.0 * (b + c) + d);
        for entry in 0..start.v.len() {
            let at = |rates: &Rates| (rates.v[entry], rates.a[entry]);
            let [a, b, c, d] = [at(first), at(second), at(third), at(fourth)];
            start.q[entry] += mean(a.0, b.0, c.0, d.0);
            start.v[entry] += mean(a.1, b.1, c.1, d.1);
        }
        for (contact, surface) in start.surfaces.iter_mut().enumerate() {
            for (part, value) in surface.iter_mut().enumerate() {
                let at = |rates: &Rates| rates.surfaces[contact][part];
                *value += mean(at(first), at(second), at(third), at(fourth));
            }
        }
        Ok(())
    }

    fn copy_start(&mut self) {
        let Room { start, stage, .. } = &mut self.room;
        stage.q.copy_from_slice(&start.q);
        stage.v.copy_from_slice(&start.v);
        stage.surfaces.copy_from_slice(&start.surfaces);
    }

    /// Sets the stage to the start, moved by `time` at the rates of a stage.
    fn move_stage(&mut self, of: usize, time: f64) {
        let Room { start, stage, rates, .. } = &mut self.room;
        let rates = &rates[of];
        let moved = |out: &mut [f64], from: &[f64], rates: &[f64]| {
            for ((out, from), rate) in out.iter_mut().zip(from).zip(rates) {
                *out = from + time * rate;
            }
        };
        moved(&mut stage.q, &start.q, &rates.v);
        moved(&mut stage.v, &start.v, &rates.a);
        let surfaces = stage.surfaces.iter_mut().zip(&start.surfaces);
        for ((out, from), rates) in surfaces.zip(&rates.surfaces) {
            moved(out, from, rates);
        }
    }

    /// Computes the rates of the stage.
    fn evaluate(&mut self, stage: usize, external: &[ExternalWrench]) -> Result<(), Error> {
        let Room {
            data,
            parts,
            command,
            torque,
            solved,
            wrenches,
            stage: at,
            rates,
            forces,
            peaks,
            ..
        } = &mut self.room;
        let rates = &mut rates[stage];
        let mut robot = data.pose(&self.model, &at.q)?.moving(&at.v)?;
        robot.friction_into(torque)?;
        let drives = self.drives.iter().zip(command).zip(&at.v);
        for ((torque, acceleration), ((drive, command), velocity)) in
            torque.iter_mut().zip(&mut rates.a).zip(drives)
        {
            match drive {
                JointDrive::Torque { .. } => *torque = *command - *torque,
                JointDrive::Velocity { time_constant } => {
                    *acceleration = (*command - velocity) / time_constant;
                }
            }
        }
        wrenches.clear();
        wrenches.extend_from_slice(external);
        for (index, contact) in self.contacts.iter().enumerate() {
            let [position, velocity] = at.surfaces[index];
            let force = contact.force_on(&robot, position, velocity)?;
            (forces[index], peaks[index]) = (force, force.max(peaks[index]));
            wrenches.push(contact.wrench(force));
            rates.surfaces[index] = [velocity, -force / contact.mass];
        }
        robot.hybrid_dynamics_into(torque, parts, wrenches, solved, &mut rates.a)?;
        rates.v.copy_from_slice(&at.v);
        Ok(())
    }

    /// Accepts the computed state, with the contact forces at its end.
    fn finish(&mut self, external: &[ExternalWrench], period: f64) -> Result<(), Error> {
        if !self.contacts.is_empty() {
            self.copy_start();
            self.evaluate(0, external)?;
        }
        let Room { start, command, forces, peaks, .. } = &mut self.room;
        self.model.check_configuration(&start.q)?;
        self.model.check_velocity("q̇", &start.v)?;
        let joints = self.drives.iter().zip(command).zip(start.v.iter().zip(&self.state.v));
        for (torque, ((drive, command), (after, before))) in self.torque.iter_mut().zip(joints) {
            *torque = match drive {
                JointDrive::Torque { rotor_inertia } => {
                    *command - rotor_inertia * (after - before) / period
                }
                JointDrive::Velocity { .. } => 0.0,
            };
        }
        for (index, contact) in self.contacts.iter_mut().enumerate() {
            [contact.position, contact.velocity] = start.surfaces[index];
            contact.force = forces[index];
            contact.peak_force = contact.peak_force.max(peaks[index]);
        }
        self.state.q.copy_from_slice(&start.q);
        self.state.v.copy_from_slice(&start.v);
        Ok(())
    }
}
