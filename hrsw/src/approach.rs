//! Rows that bound how fast bodies of the robot approach others.

use ahqp_core::{AugmentedState, Rows};
use nalgebra::{DMatrix, Matrix6xX, Vector3, Vector6};

use crate::contact::{Contact, Mobility};
use crate::distance::{Proximity, proximity};
use crate::error::{Error, check_all, check_size, not_negative};
use crate::separation::SeparationSettings;
use crate::shape::Capsule;

/// A body of the robot, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotBody {
    /// Its shape in the world \[m\].
    pub capsule: Capsule,
    /// How many of the joints, from the first, move it.
    pub joints: usize,
}

/// How a part of the person's body moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredVelocity {
    /// As measured, in the world \[m/s\].
    pub mean: Vector3<f64>,
    /// How much faster than that the part may move, because the measurement is late and noisy \[m/s\].
    pub uncertainty: f64,
}

impl MeasuredVelocity {
    /// A velocity that is known exactly \[m/s\].
    pub fn exact(mean: Vector3<f64>) -> Self {
        Self { mean, uncertainty: 0.0 }
    }
}

/// A part of the person's body, placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersonBody {
    /// Its shape in the world \[m\].
    pub capsule: Capsule,
    /// Its velocity; unmeasured, the person is taken to come nearer at
    /// [`SeparationSettings::human_speed`].
    pub velocity: Option<MeasuredVelocity>,
    /// For a part that the robot may touch now: whatever the distance, the two may come nearer to each
    /// other as fast as their contact allows. None where only the distance counts.
    pub contact: Option<Contact>,
}

/// How the robot moves with its joints now.
#[derive(Debug, Clone, Copy)]
pub struct JointMotion<'a> {
    /// The geometric Jacobian, 6 × n, linear then angular, in world axes, of a point fixed to
    /// the last link. That of a point p on a link moved by the first k joints follows from its
    /// first k columns, v + ω × (p − o).
    pub jacobian: &'a Matrix6xX<f64>,
    /// o, the point that the Jacobian is of \[m\].
    pub origin: Vector3<f64>,
    /// q̇ commanded last, n.
    pub velocity: &'a [f64],
    /// A q̇ that all other constraints admit, n: usually the one nearest to rest within the
    /// limits. Every row is relaxed to admit it, so that hard rows never make the problem
    /// infeasible. None for rows that are minimised in a level of their own.
    pub braking: Option<&'a [f64]>,
    /// M⁻¹, the inverse of the joint-space inertia, n × n, with which the robot gives way in a contact.
    /// None for a robot that does not give way at all, the worst case.
    pub inverse_inertia: Option<&'a DMatrix<f64>>,
}

/// The pair that is nearest to its protective distance, or deepest within, of those that may not
/// touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Index of the robot's body.
    pub robot: usize,
    /// Index of the person's body, or of the robot's other.
    pub other: usize,
    /// Between the surfaces \[m\].
    pub distance: f64,
    /// S_p at the last commanded velocity and the person's as measured \[m\].
    pub required: f64,
    /// How fast the robot comes nearer at the last commanded velocity \[m/s\].
    pub approach: f64,
}

/// A pair with the place where it is nearest.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    robot: usize,
    other: usize,
    robot_joints: usize,
    other_joints: usize,
    near: Proximity,
    /// As measured, without the uncertainty.
    human_speed: f64,
    limit: f64,
    /// How much faster the pair may come nearer than at the last commanded velocity \[m/s\].
    headroom: f64,
    contact: bool,
}

/// Bodies of a robot whose motion is computed once for all pairs of its own that they are in.
const REMEMBERED: usize = 32;

/// How a body moves at the last commanded velocity: the twist of the point o as if fixed to it.
#[derive(Debug, Clone, Copy)]
struct BodyMotion {
    twist: Vector6<f64>,
    /// The speed of none of its points is larger \[m/s\].
    fastest: f64,
}

impl BodyMotion {
    fn new(motion: &JointMotion<'_>, body: &RobotBody) -> Self {
        let mut twist = Vector6::zeros();
        let joints = motion.jacobian.column_iter().zip(motion.velocity);
        for (column, &velocity) in joints.take(body.joints) {
            twist += column * velocity;
        }
        let (linear, angular) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
        let middle = (body.capsule.start() + body.capsule.end()) * 0.5;
        let lever = (middle - motion.origin).norm() + body.capsule.reach();
        Self { fastest: linear.norm() + angular.norm() * lever, twist }
    }
}

/// Writes a block of rows, −∂d/∂q q̇ ≤ v_max(d), for the pairs of bodies that come nearest to
/// their largest speed of approach, or exceed it most, at the last commanded velocity.
///
/// Rest and retreat are always admitted. Where acceleration limits admit neither, as when
/// somebody steps in front of a moving robot, there are two ways to keep the problem feasible:
/// as the first level of the hierarchy, `Level::least_squares(rows)`, the rows are exceeded by
/// as little as can be; as hard constraints they are relaxed to admit
/// [`JointMotion::braking`]. The first keeps them wherever they can be kept, the second costs
/// no level. A block holds `capacity` rows; those not needed bound nothing.
///
/// ```
/// use ahqp_core::AugmentedState;
/// use hrsw::{
///     ApproachRows, Capsule, JointMotion, MeasuredVelocity, PersonBody, RobotBody, SeparationSettings,
/// };
/// use nalgebra::{Matrix6xX, Vector3};
///
/// // One joint slides the robot along x, towards a person.
/// let state = AugmentedState { joints: 1, task: 6, slack: 6 };
/// let mut separation = ApproachRows::new(state, SeparationSettings::default(), 4)?;
/// let mut rows = separation.rows();
/// let mut jacobian = Matrix6xX::zeros(1);
/// jacobian[(0, 0)] = 1.0;
/// let motion = JointMotion {
///     jacobian: &jacobian,
///     origin: Vector3::zeros(),
///     velocity: &[0.0],
///     braking: Some(&[0.0]),
///     inverse_inertia: None,
/// };
/// let robot = [RobotBody { capsule: Capsule::sphere(Vector3::zeros(), 0.1)?, joints: 1 }];
/// let head = Capsule::sphere(Vector3::new(1.5, 0.0, 0.0), 0.1)?;
/// let velocity = Some(MeasuredVelocity::exact(Vector3::zeros()));
/// let person = [PersonBody { capsule: head, velocity, contact: None }];
/// let nearest = separation.write(&motion, &robot, &person, &mut rows)?;
/// assert!((nearest.map_or(0.0, |pair| pair.distance) - 1.3).abs() < 1e-12);
/// let limit = SeparationSettings::default().approach_limit(1.3, 0.0);
/// assert!((rows.upper()[0] - limit).abs() < 1e-12);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ApproachRows {
    state: AugmentedState,
    settings: SeparationSettings,
    capacity: usize,
    candidates: Vec<Candidate>,
    nearest: Option<Nearest>,
    mobility: Mobility,
}

impl ApproachRows {
    /// For the layout of χ, with room for `capacity` pairs.
    ///
    /// # Errors
    /// [`Error::Parameter`] for settings out of range.
    pub fn new(
        state: AugmentedState,
        settings: SeparationSettings,
        capacity: usize,
    ) -> Result<Self, Error> {
        settings.validate()?;
        let candidates = Vec::with_capacity(capacity + 1);
        let mobility = Mobility::new(state.joints);
        Ok(Self { state, settings, capacity, candidates, nearest: None, mobility })
    }

    /// The block, bounding nothing yet.
    pub fn rows(&self) -> Rows {
        let mut rows = Rows::zeros(self.capacity, self.state.len());
        rows.lower_mut().fill(f64::NEG_INFINITY);
        rows.upper_mut().fill(f64::INFINITY);
        rows
    }

    /// The settings.
    pub fn settings(&self) -> &SeparationSettings {
        &self.settings
    }

    /// Writes the rows for the robot and the person into a block made by [`rows`](Self::rows),
    /// and returns, of the pairs that may not touch, the one with the least room. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] for a block, Jacobian or velocities that do not fit; [`Error::NotFinite`].
    /// The block then bounds what it did before.
    pub fn write(
        &mut self,
        motion: &JointMotion<'_>,
        robot: &[RobotBody],
        person: &[PersonBody],
        rows: &mut Rows,
    ) -> Result<Option<Nearest>, Error> {
        self.check(motion, robot, rows)?;
        person.iter().try_for_each(|part| part.capsule.check("a capsule of the person"))?;
        for part in person {
            if let Some(velocity) = &part.velocity {
                check_all("the velocity of a person's body", velocity.mean.iter())?;
                not_negative("the uncertainty of a person's velocity", velocity.uncertainty)?;
            }
            part.contact.as_ref().map_or(Ok(()), Contact::validate)?;
        }
        self.clear();
        self.mobility.clear();
        for (i, body) in robot.iter().enumerate() {
            let moves = BodyMotion::new(motion, body);
            for (j, part) in person.iter().enumerate() {
                // The sum of the parts is no less than the norm.
                let fastest = part.velocity.map(|v| v.mean.abs().sum() + v.uncertainty);
                let capsules = (&body.capsule, &part.capsule);
                if self.is_out_of_sight(capsules, moves.fastest, fastest) {
                    continue;
                }
                let near = proximity(&body.capsule, &part.capsule);
                let measured = part.velocity.map(|v| v.mean.dot(&near.normal));
                let uncertainty = part.velocity.map_or(0.0, |v| v.uncertainty);
                let worst = measured.map(|speed| speed + uncertainty);
                let assumed = self.settings.speed_towards_robot(worst);
                let gradient = near.gradient_first(&motion.origin);
                let mut limit = self.settings.approach_limit(near.distance, assumed);
                if let Some(contact) = part.contact {
                    let (jacobian, inverse) = (motion.jacobian, motion.inverse_inertia);
                    let mass = self.mobility.mass(jacobian, inverse, body.joints, &gradient);
                    let (measured, worst) = (measured.unwrap_or(assumed), worst.unwrap_or(assumed));
                    limit = limit.max(contact.approach_limit(mass, measured, worst));
                }
                let contact = part.contact.is_some();
                let approach = -gradient.dot(&moves.twist);
                self.consider(Candidate {
                    robot: i,
                    other: j,
                    robot_joints: body.joints,
                    other_joints: 0,
                    near,
                    human_speed: measured.map_or(assumed, |speed| speed.max(0.0)),
                    limit,
                    headroom: limit - approach,
                    contact,
                });
            }
        }
        self.write_candidates(motion, rows)
    }

    /// The least distance of the pairs written last \[m\]; infinite for none.
    pub fn least_distance(&self) -> f64 {
        let distances = self.candidates.iter().map(|candidate| candidate.near.distance);
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Writes the rows for pairs of the robot's own bodies, by their indices, as
    /// [`write`](Self::write). Allocates nothing.
    ///
    /// # Errors
    /// As [`write`](Self::write); [`Error::Size`] for an index that is not of a body.
    pub fn write_own(
        &mut self,
        motion: &JointMotion<'_>,
        robot: &[RobotBody],
        pairs: &[(usize, usize)],
        rows: &mut Rows,
    ) -> Result<Option<Nearest>, Error> {
        self.check(motion, robot, rows)?;
        self.clear();
        let mut remembered = [None; REMEMBERED];
        let mut moves_of = |index: usize, body: &RobotBody| match remembered.get_mut(index) {
            Some(slot) => *slot.get_or_insert_with(|| BodyMotion::new(motion, body)),
            None => BodyMotion::new(motion, body),
        };
        for &(i, j) in pairs {
            let (Some(first), Some(second)) = (robot.get(i), robot.get(j)) else {
                let (found, expected) = (i.max(j), robot.len());
                return Err(Error::Size { what: "an index of a body", found, expected });
            };
            let moves = [moves_of(i, first), moves_of(j, second)];
            let fastest = moves[0].fastest + moves[1].fastest;
            if self.is_out_of_sight((&first.capsule, &second.capsule), fastest, Some(0.0)) {
                continue;
            }
            let near = proximity(&first.capsule, &second.capsule);
            let approach = -near.gradient_first(&motion.origin).dot(&moves[0].twist)
                - near.gradient_second(&motion.origin).dot(&moves[1].twist);
            let limit = self.settings.approach_limit(near.distance, 0.0);
            self.consider(Candidate {
                robot: i,
                other: j,
                robot_joints: first.joints,
                other_joints: second.joints,
                near,
                human_speed: 0.0,
                limit,
                headroom: limit - approach,
                contact: false,
            });
        }
        self.write_candidates(motion, rows)
    }

    fn clear(&mut self) {
        self.candidates.clear();
        self.nearest = None;
    }

    fn check(
        &self,
        motion: &JointMotion<'_>,
        robot: &[RobotBody],
        rows: &Rows,
    ) -> Result<(), Error> {
        robot.iter().try_for_each(|body| body.capsule.check("a capsule of the robot"))?;
        let joints = self.state.joints;
        check_size("the block of rows", rows.len(), self.capacity)?;
        check_size("a row of the block", rows.columns(), self.state.len())?;
        check_size("the columns of the Jacobian", motion.jacobian.ncols(), joints)?;
        check_size("the joint velocity", motion.velocity.len(), joints)?;
        let braking = motion.braking.unwrap_or(motion.velocity);
        check_size("the braking velocity", braking.len(), joints)?;
        check_all("the Jacobian", motion.jacobian.iter())?;
        check_all("the origin of the Jacobian", motion.origin.iter())?;
        if let Some(inverse) = motion.inverse_inertia {
            check_size("the rows of the inverse inertia", inverse.nrows(), joints)?;
            check_size("the columns of the inverse inertia", inverse.ncols(), joints)?;
            check_all("the inverse inertia", inverse.iter())?;
        }
        check_all("a joint velocity", motion.velocity.iter().chain(braking))
    }

    /// Returns true if a pair has more headroom than all that are kept, by a bound on its distance that
    /// takes no search for the nearest points; `robot_speed` bounds the approach, and `human`
    /// the measured human speed.
    fn is_out_of_sight(
        &self,
        (first, second): (&Capsule, &Capsule),
        robot_speed: f64,
        human: Option<f64>,
    ) -> bool {
        let worst = match self.candidates.last() {
            Some(worst) if self.candidates.len() == self.capacity => worst.headroom,
            _ => return false,
        };
        let human_speed = self.settings.speed_towards_robot(human);
        let speed = worst + robot_speed;
        speed < 0.0
            || first.is_beyond(second, self.settings.protective_distance(human_speed, speed))
    }

    /// Keeps the pairs with the least headroom, by insertion, and of all that may not touch the one with
    /// the least room.
    fn consider(&mut self, candidate: Candidate) {
        if !candidate.contact {
            let pair = candidate.seen(&self.settings);
            if self.nearest.is_none_or(|other| pair.room() < other.room()) {
                self.nearest = Some(pair);
            }
        }
        let key = |candidate: &Candidate| {
            let standing = self.settings.protective_distance(candidate.human_speed, 0.0);
            (candidate.headroom, candidate.near.distance - standing)
        };
        let own = key(&candidate);
        let place = self.candidates.partition_point(|other| key(other) <= own);
        if place < self.capacity {
            self.candidates.insert(place, candidate);
            self.candidates.truncate(self.capacity);
        }
    }

    fn write_candidates(
        &self,
        motion: &JointMotion<'_>,
        rows: &mut Rows,
    ) -> Result<Option<Nearest>, Error> {
        for index in 0..self.capacity {
            let candidate = self.candidates.get(index);
            let row = rows.row_mut(index)?;
            row.fill(0.0);
            let mut upper = f64::INFINITY;
            if let Some(candidate) = candidate {
                candidate.write(motion, row);
                let along = |velocity: &[f64]| -> f64 {
                    row.iter().zip(velocity).map(|(a, b)| a * b).sum()
                };
                upper = candidate.limit.max(motion.braking.map_or(0.0, along));
            }
            rows.upper_mut()[index] = upper;
        }
        Ok(self.nearest)
    }
}

impl Nearest {
    /// The distance above the protective one \[m\]; negative where it is undercut.
    pub fn room(&self) -> f64 {
        self.distance - self.required
    }
}

impl Candidate {
    /// −∂d/∂q: how fast the pair comes nearer.
    fn write(&self, motion: &JointMotion<'_>, row: &mut [f64]) {
        let toward = self.near.gradient_first(&motion.origin);
        let away = self.near.gradient_second(&motion.origin);
        for (j, (out, column)) in row.iter_mut().zip(motion.jacobian.column_iter()).enumerate() {
            if j < self.robot_joints {
                *out -= column.dot(&toward);
            }
            if j < self.other_joints {
                *out -= column.dot(&away);
            }
        }
    }

    fn seen(&self, settings: &SeparationSettings) -> Nearest {
        let approach = self.limit - self.headroom;
        Nearest {
            robot: self.robot,
            other: self.other,
            distance: self.near.distance,
            required: settings.protective_distance(self.human_speed, approach),
            approach,
        }
    }
}
