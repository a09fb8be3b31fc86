//! Power and force limiting: the speed at which a robot may touch a part of a person, following ISO
//! 10218-2:2025, Annex M (formerly ISO/TS 15066, Annex A).

use nalgebra::{DMatrix, Matrix6, Matrix6xX, Vector6};

use crate::error::{Error, not_negative, positive};
use crate::measured_velocity::MeasuredVelocity;

/// Limit of a contact with a part of a body.
///
/// Robot and part are two masses with a spring between them. They meet at a relative speed v, and
/// the spring takes the energy of their relative motion. The force is F = v √(k μ) with 1/μ = 1/m_H
/// + 1/m_R.
///
/// ```
/// use hrsw_safety::ContactLimit;
///
/// let chest = ContactLimit { force: 140.0, stiffness: 25e3, mass: 40.0 };
/// let speed = chest.speed(12.0);
/// assert!((speed - 0.291).abs() < 1e-3);
/// // The heavier the robot, the slower.
/// assert!(chest.speed(180.0) < speed);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLimit {
    /// Largest force \[N\].
    pub force: f64,
    /// Stiffness k of the part \[N/m\].
    pub stiffness: f64,
    /// Effective mass m_H of the part, the part of the person's mass that moves with it \[kg\].
    pub mass: f64,
}

impl ContactLimit {
    /// Returns the relative speed at which a contact with `robot_mass` \[kg\] reaches the largest
    /// force \[m/s\]. An infinite mass stands for a robot that does not give way.
    pub fn speed(&self, robot_mass: f64) -> f64 {
        self.force / self.impedance(robot_mass)
    }

    /// Returns √(k μ) \[N s/m\].
    fn impedance(&self, robot_mass: f64) -> f64 {
        (self.stiffness / (1.0 / self.mass + 1.0 / robot_mass)).sqrt()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first field that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        positive("the largest force of a contact", self.force)?;
        positive("the stiffness of a part of the body", self.stiffness)?;
        positive("the mass of a part of the body", self.mass)?;
        Ok(())
    }
}

/// Conditions under which the robot may touch a part of a person now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Limit of the contact.
    pub limit: ContactLimit,
    /// Largest measured speed at which robot and part may approach each other, whatever the limit
    /// allows \[m/s\]. It is the speed of working together, or less while working together begins
    /// and ends.
    pub fastest: f64,
    /// Velocity of the part that counts for contacts only. An arm that may reach out at any time,
    /// for instance, is assumed to move with the trunk. None if
    /// [`PersonBody::velocity`](crate::PersonBody::velocity) counts here too.
    pub velocity: Option<MeasuredVelocity>,
}

impl Contact {
    /// Returns the largest speed of the robot towards the part \[m/s\].
    ///
    /// The part approaches the robot at `measured`, and at `worst` in the worst case of the
    /// measurement. A part that recedes counts only by the speed at which it surely recedes.
    /// Otherwise noise would allow a faster robot.
    pub(crate) fn approach_limit(&self, robot_mass: f64, measured: f64, worst: f64) -> f64 {
        let coming = measured.max(0.0) + worst.min(0.0);
        (self.limit.speed(robot_mass) - worst).min(self.fastest - coming)
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        self.limit.validate()?;
        not_negative("the largest speed of a contact", self.fastest)?;
        Ok(())
    }
}

/// Mobility Λ⁻¹ = J M⁻¹ Jᵀ of the robot at a point that the first k joints move. It is computed for
/// each k that is asked for.
#[derive(Debug, Clone)]
pub(crate) struct Mobility {
    by_joints: Vec<Option<Matrix6<f64>>>,
}

impl Mobility {
    /// Creates an empty table for a robot with this number of joints.
    pub(crate) fn new(joints: usize) -> Self {
        Self { by_joints: vec![None; joints + 1] }
    }

    /// Forgets the robot's last configuration.
    pub(crate) fn clear(&mut self) {
        self.by_joints.fill(None);
    }

    /// Returns the effective mass 1/(wᵀ Λ⁻¹ w) along a unit force \[kg\]. `wrench` is the force and
    /// its moment about the origin of the Jacobian. The mass is infinite without an inverse
    /// inertia, or where no joint gives way.
    pub(crate) fn mass(
        &mut self,
        jacobian: &Matrix6xX<f64>,
        inverse_inertia: Option<&DMatrix<f64>>,
        joints: usize,
        wrench: &Vector6<f64>,
    ) -> f64 {
        let (Some(inverse), Some(slot)) = (inverse_inertia, self.by_joints.get_mut(joints)) else {
            return f64::INFINITY;
        };
        let mobility = slot.get_or_insert_with(|| mobility(jacobian, inverse, joints));
        let lightness = wrench.dot(&(*mobility * wrench));
        if lightness > 0.0 { 1.0 / lightness } else { f64::INFINITY }
    }
}

fn mobility(jacobian: &Matrix6xX<f64>, inverse: &DMatrix<f64>, joints: usize) -> Matrix6<f64> {
    let columns = jacobian.column_iter().take(joints);
    let mut sum = Matrix6::zeros();
    for (column, weights) in columns.zip(inverse.column_iter()) {
        let mut moved = Vector6::zeros();
        for (other, &weight) in jacobian.column_iter().take(joints).zip(weights.iter()) {
            moved += other * weight;
        }
        sum += moved * column.transpose();
    }
    sum
}
