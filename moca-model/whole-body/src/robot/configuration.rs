//! Configurations q: neutral configuration, integration and difference.

use ahqp_core::rotation_log;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::description::Base;
use super::model::Model;
use crate::error::{Error, check_size, is_sensible};

/// Largest deviation of a quaternion's norm from 1.
const UNIT: f64 = 1e-6;

impl Model {
    /// q \[rad or m\] with all joints at zero and a floating base at the world's origin.
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.positions];
        if let (Base::Floating, Some(scalar)) = (self.base, q.get_mut(6)) {
            *scalar = 1.0;
        }
        q
    }

    /// Adds the displacement v·Δt to q, of the size of q̇ \[rad or m\].
    ///
    /// A floating base moves along straight lines in the world and rotates about the world's axis of its angular part:
    /// R ← exp(ω Δt) R. All other entries are sums. The quaternion stays a unit one.
    ///
    /// ```
    /// # use whole_body::{Base, Description, Model};
    /// # let urdf = r#"<robot name="box"><link name="body"/></robot>"#;
    /// let description = Description { base: Base::Floating, ..Description::default() };
    /// let model = Model::from_urdf(urdf, &description)?;
    /// let mut q = model.neutral();
    /// model.integrate(&mut q, &[0.1, 0.0, 0.0, 0.0, 0.0, 0.2])?;
    /// let mut moved = [0.0; 6];
    /// model.difference(&model.neutral(), &q, &mut moved)?;
    /// assert!((moved[0] - 0.1).abs() < 1e-15 && (moved[5] - 0.2).abs() < 1e-15);
    /// # Ok::<(), whole_body::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`]; q is then unchanged.
    pub fn integrate(&self, q: &mut [f64], displacement: &[f64]) -> Result<(), Error> {
        self.check_configuration(q)?;
        self.check_velocity("the displacement", displacement)?;
        if let (
            Base::Floating,
            [x, y, z, i, j, k, w, joints @ ..],
            [vx, vy, vz, wx, wy, wz, moves @ ..],
        ) = (self.base, &mut *q, displacement)
        {
            (*x, *y, *z) = (*x + vx, *y + vy, *z + vz);
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(*wx, *wy, *wz));
            let turned = turn.into_inner() * Quaternion::new(*w, *i, *j, *k);
            let turned = turned / turned.norm();
            (*i, *j, *k, *w) = (turned.i, turned.j, turned.k, turned.w);
            joints.iter_mut().zip(moves).for_each(|(q, by)| *q += by);
        } else {
            q.iter_mut().zip(displacement).for_each(|(q, by)| *q += by);
        }
        Ok(())
    }

    /// The displacement with which [`integrate`](Self::integrate) goes from `start` to `end` \[rad or m\], of the size of
    /// q̇. The base turns by at most half a turn.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`]; `out` is then unchanged.
    pub fn difference(&self, start: &[f64], end: &[f64], out: &mut [f64]) -> Result<(), Error> {
        self.check_configuration(start)?;
        self.check_configuration(end)?;
        check_size("the displacement", out.len(), self.velocities)?;
        if let Base::Floating = self.base {
            for ((out, start), end) in out.iter_mut().zip(start).zip(end).take(3) {
                *out = end - start;
            }
            let turn = rotation_log(&(orientation(end) * orientation(start).inverse()));
            out.iter_mut().skip(3).zip(&turn).for_each(|(out, turn)| *out = *turn);
            let joints = start.iter().zip(end).skip(7);
            out.iter_mut().skip(6).zip(joints).for_each(|(out, (start, end))| *out = end - start);
        } else {
            let joints = start.iter().zip(end);
            out.iter_mut().zip(joints).for_each(|(out, (start, end))| *out = end - start);
        }
        Ok(())
    }

    /// Returns true if [`Data::pose`](crate::Data::pose) accepts `q`: right size, finite numbers of sensible size and a
    /// unit quaternion.
    ///
    /// It allocates nothing and so suits control loops. An error would allocate its message.
    pub fn is_configuration(&self, q: &[f64]) -> bool {
        q.len() == self.positions
            && q.iter().all(|value| is_sensible(*value))
            && self.quaternion_norm(q).is_none_or(is_unit)
    }

    /// Returns an error unless q has the right size, finite numbers and a unit quaternion.
    pub(crate) fn check_configuration(&self, q: &[f64]) -> Result<(), Error> {
        check_size("q", q.len(), self.positions)?;
        if let Some(entry) = q.iter().position(|value| !is_sensible(*value)) {
            return Err(Error::not_finite(self.position_entry(entry), q[entry]));
        }
        match self.quaternion_norm(q) {
            Some(norm) if !is_unit(norm) => Err(Error::value(
                "the norm of the floating base's quaternion",
                norm,
                "1: integrate with the model's `integrate`, or normalise q[3..7]",
            )),
            _ => Ok(()),
        }
    }

    /// The norm of a floating base's quaternion.
    fn quaternion_norm(&self, q: &[f64]) -> Option<f64> {
        match (self.base, q) {
            (Base::Floating, [_, _, _, i, j, k, w, ..]) => {
                Some(Quaternion::new(*w, *i, *j, *k).norm())
            }
            _ => None,
        }
    }

    /// Returns an error unless `v` has the size of q̇ and finite numbers.
    pub(crate) fn check_velocity(&self, what: &'static str, v: &[f64]) -> Result<(), Error> {
        check_size(what, v.len(), self.velocities)?;
        match v.iter().position(|value| !is_sensible(*value)) {
            None => Ok(()),
            Some(entry) => {
                let names = self.velocity_names();
                let what = format!("{what} of `{}`", names[entry]);
                Err(Error::not_finite(what, v[entry]))
            }
        }
    }

    #[cold]
    fn position_entry(&self, entry: usize) -> String {
        let own = |joint: &&super::joint::Joint| {
            (joint.position_index..joint.position_index + joint.kind.positions()).contains(&entry)
        };
        let joint = self.joints.iter().find(own).map_or("", |joint| joint.name.as_str());
        format!("the position of joint `{joint}`, entry {entry} of q,")
    }
}

/// Returns true if this is the norm of a rotation's quaternion.
fn is_unit(norm: f64) -> bool {
    (norm - 1.0).abs() <= UNIT
}

/// The orientation of a floating base, normalised.
pub(crate) fn orientation(q: &[f64]) -> UnitQuaternion<f64> {
    match q {
        [_, _, _, i, j, k, w, ..] => UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k)),
        _ => UnitQuaternion::identity(),
    }
}
