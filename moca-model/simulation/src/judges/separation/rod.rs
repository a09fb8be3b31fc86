//! The distance of two capsules by clamped closest points of two segments.

use nalgebra::Vector3;

/// A capsule: the points within a radius of a segment \[m\].
#[derive(Clone, Copy, Debug)]
pub struct Rod {
    /// Ends of the segment \[m\].
    pub ends: [Vector3<f64>; 2],
    /// Radius \[m\].
    pub radius: f64,
}

impl Rod {
    /// The distance between the surfaces \[m\]; negative if they overlap.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        segments(&self.ends, &other.ends) - self.radius - other.radius
    }

    /// The largest distance that a point of the segment moves to that of `other`, for equal radii \[m\].
    pub(crate) fn farthest_move(&self, other: &Self) -> f64 {
        let ends = self.ends.iter().zip(&other.ends);
        ends.map(|(end, other)| (other - end).norm_squared()).fold(0.0, f64::max).sqrt()
    }

    /// The ball around it.
    pub(super) fn ball(&self) -> Ball {
        let [a, b] = self.ends;
        Ball { middle: (a + b) * 0.5, radius: (b - a).norm() * 0.5 + self.radius }
    }
}

/// A ball that contains a capsule \[m\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    middle: Vector3<f64>,
    radius: f64,
}

impl Ball {
    /// Returns true if two balls are farther apart than this \[m\]. Then so are their contents.
    pub(super) fn is_beyond(&self, other: &Self, distance: f64) -> bool {
        let apart = distance + self.radius + other.radius;
        apart < 0.0 || (other.middle - self.middle).norm_squared() > apart * apart
    }
}

/// The distance of two segments. Given the parameter s on the first one, the best t on the second is explicit. The
/// squared distance is then convex in s, with at most two kinks where t reaches an end. Its minimum is at an end, at a
/// kink, or where the lines are nearest.
fn segments([a, b]: &[Vector3<f64>; 2], [c, d]: &[Vector3<f64>; 2]) -> f64 {
    let (u, w, r) = (b - a, d - c, c - a);
    let (uu, uw, ww) = (u.dot(&u), u.dot(&w), w.dot(&w));
    let from = |s: f64| {
        let point = a + u * s;
        let t = if ww > 0.0 { ((point - c).dot(&w) / ww).clamp(0.0, 1.0) } else { 0.0 };
        (point - (c + w * t)).norm_squared()
    };
    let along = |target: f64| if uu > 0.0 { (target / uu).clamp(0.0, 1.0) } else { 0.0 };
    // Points nearest to the two ends of the second segment, and the nearest point of the lines.
    let mut candidates = [0.0, 1.0, along(r.dot(&u)), along((d - a).dot(&u)), 0.0];
    let determinant = uu * ww - uw * uw;
    if determinant > 0.0 {
        candidates[4] = ((ww * r.dot(&u) - uw * r.dot(&w)) / determinant).clamp(0.0, 1.0);
    }
    candidates.into_iter().map(from).fold(f64::INFINITY, f64::min).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from)
    }

    proptest! {
        #[test]
        fn no_points_of_a_fine_grid_are_nearer(a in point(), b in point(), c in point(), d in point()) {
            let found = segments(&[a, b], &[c, d]);
            let mut least = f64::INFINITY;
            for i in 0..=60_i32 {
                for j in 0..=60_i32 {
                    let (s, t) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    least = least.min((a.lerp(&b, s) - c.lerp(&d, t)).norm());
                }
            }
            prop_assert!(found <= least + 1e-12);
            prop_assert!(found >= least - 0.05);
        }

        #[test]
        fn capsules_surely_beyond_a_distance_are_beyond_it(
            a in point(), b in point(), c in point(), d in point(),
            radius in 0.0..0.3_f64, by in -1.0..2.0_f64,
        ) {
            let (one, other) = (Rod { ends: [a, b], radius }, Rod { ends: [c, d], radius: 0.1 });
            if one.ball().is_beyond(&other.ball(), by) {
                prop_assert!(one.distance(&other) > by - 1e-12);
            }
        }
    }
}
