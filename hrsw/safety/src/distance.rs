//! Distance of two capsules and its gradient.

use nalgebra::{Vector3, Vector6};

use hrsw::Capsule;

/// Nearest points of two capsules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity {
    /// Distance between the surfaces \[m\]. Negative if they overlap.
    pub distance: f64,
    /// Unit vector from the second capsule to the first.
    pub normal: Vector3<f64>,
    /// Nearest point on the segment of the first capsule \[m\].
    pub on_first: Vector3<f64>,
    /// Nearest point on the segment of the second capsule \[m\].
    pub on_second: Vector3<f64>,
}

/// Computes the distance of two capsules. Allocates nothing.
///
/// ```
/// use hrsw_safety::{Capsule, proximity};
/// use nalgebra::Vector3;
///
/// let arm = Capsule::new(Vector3::zeros(), Vector3::x(), 0.1)?;
/// let head = Capsule::sphere(Vector3::new(0.4, 0.0, 1.0), 0.2)?;
/// let near = proximity(&head, &arm);
/// assert!((near.distance - 0.7).abs() < 1e-15);
/// assert_eq!(near.normal, Vector3::z());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn proximity(first: &Capsule, second: &Capsule) -> Proximity {
    let (on_first, on_second) = nearest_on_segments(first, second);
    let apart = on_first - on_second;
    let distance = apart.norm();
    let normal = if distance > 1e-12 { apart / distance } else { way_out(first, second) };
    let distance = distance - first.radius() - second.radius();
    Proximity { distance, normal, on_first, on_second }
}

impl Proximity {
    /// Returns the gradient of the distance with respect to the twist of the first capsule, [n; (p
    /// − o) × n]. The twist is linear at `origin`, then angular, in world axes.
    pub fn gradient_first(&self, origin: &Vector3<f64>) -> Vector6<f64> {
        wrench(&self.normal, &(self.on_first - origin))
    }

    /// Returns the gradient of the distance with respect to the twist of the second capsule. Its
    /// layout is that of [`gradient_first`](Self::gradient_first).
    pub fn gradient_second(&self, origin: &Vector3<f64>) -> Vector6<f64> {
        wrench(&-self.normal, &(self.on_second - origin))
    }
}

fn wrench(normal: &Vector3<f64>, arm: &Vector3<f64>) -> Vector6<f64> {
    let turning = arm.cross(normal);
    Vector6::new(normal.x, normal.y, normal.z, turning.x, turning.y, turning.z)
}

/// Solves the convex problem: minimise ‖(a + s u) − (b + t w)‖² over s, t in \[0, 1\].
fn nearest_on_segments(first: &Capsule, second: &Capsule) -> (Vector3<f64>, Vector3<f64>) {
    let (a, b) = (first.start(), second.start());
    let (u, w) = (first.end() - a, second.end() - b);
    let between = a - b;
    let (uu, ww) = (u.norm_squared(), w.norm_squared());
    if uu == 0.0 {
        return (*a, b + w * share(w.dot(&between), ww));
    }
    let (uw, ub, wb) = (u.dot(&w), u.dot(&between), w.dot(&between));
    let determinant = uu * ww - uw * uw;
    if determinant <= 1e-9 * uu * ww {
        let (s, t) = nearest_on_sides((a, &u), (b, &w));
        return (a + u * s, b + w * t);
    }
    // The best s for a free t, then the best t for that s. If t is at a bound, the best s for that
    // bound.
    let s = ((uw * wb - ww * ub) / determinant).clamp(0.0, 1.0);
    let t = (uw * s + wb) / ww;
    let (s, t) = if t < 0.0 {
        (share(-ub, uu), 0.0)
    } else if t > 1.0 {
        (share(uw - ub, uu), 1.0)
    } else {
        (s, t)
    };
    (a + u * s, b + w * t)
}

/// Returns the share of a line of this squared length at which it comes nearest to a point.
fn share(along: f64, length_squared: f64) -> f64 {
    if length_squared > 0.0 { (along / length_squared).clamp(0.0, 1.0) } else { 0.5 }
}

/// Solves the same problem for parallel segments, or if one is a point. The minimum lies on one of
/// the four sides. If several sides are equally good, so are all points between them. Their mean
/// moves least as the segments turn.
fn nearest_on_sides(
    (a, u): (&Vector3<f64>, &Vector3<f64>),
    (b, w): (&Vector3<f64>, &Vector3<f64>),
) -> (f64, f64) {
    let between = a - b;
    let (uu, uw, ww) = (u.norm_squared(), u.dot(w), w.norm_squared());
    let (ub, wb) = (u.dot(&between), w.dot(&between));
    let sides = [
        (0.0, share(wb, ww)),
        (1.0, share(wb + uw, ww)),
        (share(-ub, uu), 0.0),
        (share(uw - ub, uu), 1.0),
    ];
    let squared = sides.map(|(s, t)| (between + u * s - w * t).norm_squared());
    let least = squared.iter().copied().fold(f64::INFINITY, f64::min);
    let tolerance = 1e-12 * (uu + ww) + f64::MIN_POSITIVE;
    let (mut s, mut t, mut count) = (0.0, 0.0, 0.0);
    for ((side_s, side_t), distance) in sides.iter().zip(squared) {
        if distance <= least + tolerance {
            s += side_s;
            t += side_t;
            count += 1.0;
        }
    }
    (s / count, t / count)
}

/// Returns a direction that separates capsules whose segments meet.
fn way_out(first: &Capsule, second: &Capsule) -> Vector3<f64> {
    let (u, w) = (first.end() - first.start(), second.end() - second.start());
    let across = u.cross(&w).try_normalize(1e-12);
    across.unwrap_or_else(|| if u.norm_squared() > 0.0 { first.across() } else { second.across() })
}
