//! Capsules on a robot's links.

use hrsw_safety::{Capsule, LinkCapsule};
use pyo3::prelude::*;

use crate::arrays::numbers;
use crate::failure::{Failure, Result};

/// A capsule on a link, as Python gives it: link, start, end, radius.
pub(crate) type BodyOfLink<'py> = (String, Bound<'py, PyAny>, Bound<'py, PyAny>, f64);

/// Reads a capsule.
pub(crate) fn body((link, start, end, radius): BodyOfLink<'_>) -> Result<LinkCapsule> {
    let ends = [numbers::<3>("bodies", &start)?, numbers::<3>("bodies", &end)?];
    let [start, end] = ends.map(Into::into);
    Ok(LinkCapsule { link, capsule: Capsule::new(start, end, radius)? })
}

/// Returns the pairs of capsules of two links, by index. `name` is that of the argument.
pub(crate) fn pairs_of(
    name: &str,
    bodies: &[LinkCapsule],
    links: &[(String, String)],
) -> Result<Vec<(usize, usize)>> {
    let of = |link: &String| -> Result<Vec<usize>> {
        let on = |(index, body): (usize, &LinkCapsule)| (body.link == *link).then_some(index);
        let found: Vec<_> = bodies.iter().enumerate().filter_map(on).collect();
        if found.is_empty() {
            let text = format!("{name} names link `{link}`, of which bodies has no capsule");
            return Err(Failure::value(text));
        }
        Ok(found)
    };
    let mut pairs = Vec::new();
    for (one, other) in links {
        let others = of(other)?;
        for one in of(one)? {
            pairs.extend(others.iter().map(|other| (one, *other)));
        }
    }
    Ok(pairs)
}
