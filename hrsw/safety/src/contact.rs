//! Power and force limiting: how fast a robot may touch a part of a person, following ISO 10218-2:2025,
//! Annex M (formerly ISO/TS 15066, Annex A).

use nalgebra::{DMatrix, Matrix6, Matrix6xX, Vector6};

use crate::error::{Error, not_negative, positive};
use crate::measured_velocity::MeasuredVelocity;

/// What a contact with a part of a body may do.
///
/// Robot and part are two masses with a spring between them. They meet at a relative speed v, and the spring
/// takes the energy of their relative motion: F = v √(k μ) with 1/μ = 1/m_H + 1/m_R.
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
    /// The largest force \[N\].
    pub force: f64,
    /// k, how stiff the part is \[N/m\].
    pub stiffness: f64,
    /// m_H, what of the person moves with the part \[kg\].
    pub mass: f64,
}

impl ContactLimit {
    /// The relative speed at which a contact with `robot_mass` \[kg\] reaches the largest force \[m/s\];
    /// infinite mass is a robot that does not give way.
    pub fn speed(&self, robot_mass: f64) -> f64 {
        self.force / self.impedance(robot_mass)
    }

    /// √(k μ) \[N s/m\].
    fn impedance(&self, robot_mass: f64) -> f64 {
        (self.stiffness / (1.0 / self.mass + 1.0 / robot_mass)).sqrt()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        positive("the largest force of a contact", self.force)?;
        positive("the stiffness of a part of the body", self.stiffness)?;
        positive("the mass of a part of the body", self.mass)?;
        Ok(())
    }
}

/// A part of a person that the robot may touch now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// What that may do.
    pub limit: ContactLimit,
    /// How fast the two may come nearer to each other at most, as measured, whatever the limit allows
    /// \[m/s\]: the speed of working together, or less while that begins and ends.
    pub fastest: f64,
    /// How the part moves as far as that is known, for contacts only: with the trunk, say, of an arm that
    /// may reach out at any time, of which [`PersonBody::velocity`](crate::PersonBody::velocity) knows
    /// nothing. None where that holds here, too.
    pub velocity: Option<MeasuredVelocity>,
}

impl Contact {
    /// How fast the robot may come nearer to the part, which comes nearer to the robot at `measured`, and
    /// at `worst` if the measurement is as wrong as it may be \[m/s\]. A part that leaves counts only as far as it surely
    /// does: noise would let the robot come faster.
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

/// How light the robot is where it is touched: Λ⁻¹ = J M⁻¹ Jᵀ of a point that the first k joints move, for
/// each k that is asked for.
#[derive(Debug, Clone)]
pub(crate) struct Mobility {
    by_joints: Vec<Option<Matrix6<f64>>>,
}

impl Mobility {
    /// For a robot with so many joints.
    pub(crate) fn new(joints: usize) -> Self {
        Self { by_joints: vec![None; joints + 1] }
    }

    /// Forgets the robot's last configuration.
    pub(crate) fn clear(&mut self) {
        self.by_joints.fill(None);
    }

    /// 1/(wᵀ Λ⁻¹ w), the mass behind a unit force of which `wrench` is the force and its moment about the
    /// origin of the Jacobian \[kg\]; infinite without the inverse of the joint-space inertia, or where no
    /// joint gives way.
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
