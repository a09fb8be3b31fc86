//! Capsules on a robot's links.

use hrsw_safety::{Capsule, LinkCapsule};
use pyo3::prelude::*;

use crate::arrays::numbers;
use crate::failure::Result;

/// A capsule on a link, as Python gives it: link, start, end, radius.
pub(crate) type BodyOfLink<'py> = (String, Bound<'py, PyAny>, Bound<'py, PyAny>, f64);

/// Reads a capsule.
pub(crate) fn body((link, start, end, radius): BodyOfLink<'_>) -> Result<LinkCapsule> {
    let ends = [numbers::<3>("bodies", &start)?, numbers::<3>("bodies", &end)?];
    let [start, end] = ends.map(Into::into);
    Ok(LinkCapsule { link, capsule: Capsule::new(start, end, radius)? })
}
