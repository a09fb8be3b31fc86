//! Checks of the inertia of a link.

use nalgebra::{Matrix3, Vector3};

use super::warning::{InertiaFault, Warning};
use crate::error::Error;
use crate::inertia::body::BodyInertia;
use crate::spatial::Pose;
use crate::urdf::document::{Inertial, Link};

/// Deviation from a physical inertia that counts as rounding of a URDF, over the largest moment.
const ROUNDING: f64 = 1e-5;

/// Square of the radius of gyration, 30 µm, below which a mass is a point \[m²\]. Smaller values are rounding.
const POINT: f64 = 1e-9;

/// Returns mass, centre and inertia of a link in the link's frame; zero mass if it states none.
pub(super) fn of_link(
    link: &Link,
    pose: impl Fn(&Inertial) -> Pose,
    warnings: &mut Vec<Warning>,
) -> Result<BodyInertia, Error> {
    let Some(inertial) = &link.inertial else {
        return Ok(BodyInertia::zero());
    };
    let mass = inertial.mass;
    if mass < 0.0 {
        let what = format!("line {}: the mass of link `{}`", inertial.line, link.name);
        return Err(Error::value(what, mass, "zero or positive [kg]"));
    }
    let [xx, yy, zz, xy, xz, yz] = inertial.moments;
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    if let Some(fault) = fault(mass, &inertia) {
        let (link, line) = (link.name.clone(), inertial.line);
        warnings.push(Warning::NotAnInertia { link, line, fault });
    }
    let central = BodyInertia { mass, centre: Vector3::zeros(), inertia };
    Ok(central.placed(&pose(inertial)))
}

/// Returns why no rigid body has this mass and inertia, or `None`.
///
/// The principal moments of a body are ∫ (y² + z²) dm and so on. So none is negative, and none is larger than the sum
/// of the other two.
pub(super) fn fault(mass: f64, inertia: &Matrix3<f64>) -> Option<InertiaFault> {
    let mut moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [small, middle, large] = moments;
    let size = large.abs().max(small.abs());
    if size <= POINT * mass {
        return None;
    }
    if mass == 0.0 {
        return Some(InertiaFault::NoMass);
    }
    if small < -ROUNDING * size {
        return Some(InertiaFault::NegativeMoment(small));
    }
    (large > small + middle + ROUNDING * size).then_some(InertiaFault::Triangle(moments))
}
