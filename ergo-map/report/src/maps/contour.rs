//! Outlines of the region in which a field over a plane reaches a level, by marching squares.

use std::collections::BTreeMap;
use std::ops::Range;

/// Values on a regular grid over a plane. NaN stands for a missing value.
#[derive(Debug)]
pub(super) struct Field {
    origin: (f64, f64),
    step: f64,
    size: (usize, usize),
    values: Vec<f64>,
}

/// A point of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    pub(super) at: (f64, f64),
    /// True if the field crosses the level here. Otherwise the field ends here.
    pub(super) crossing: bool,
}

/// A closed outline without a repeated vertex. The higher side is on its left.
pub(super) type Ring = Vec<Vertex>;

/// An edge between two neighbours of the grid: the lower or left one, and whether the edge goes
/// upward.
type Edge = (isize, isize, bool);

impl Field {
    /// Samples a function over a rectangle.
    pub(super) fn sampled(
        across: &Range<f64>,
        up: &Range<f64>,
        step: f64,
        of: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let count = |range: &Range<f64>| {
            // There are at most some thousands for ranges of metres.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let steps = ((range.end - range.start) / step).round().max(1.0) as usize;
            steps + 1
        };
        let size = (count(across), count(up));
        let place =
            |i: usize, j: usize| (across.start + i as f64 * step, up.start + j as f64 * step);
        let all = (0..size.1).flat_map(|j| (0..size.0).map(move |i| (i, j)));
        let values = all.map(|(i, j)| place(i, j)).map(|(u, v)| of(u, v)).collect();
        Self { origin: (across.start, up.start), step, size, values }
    }

    /// Returns the value at a node, NaN outside the grid.
    fn value(&self, i: isize, j: isize) -> f64 {
        let index = || {
            let (i, j) = (usize::try_from(i).ok()?, usize::try_from(j).ok()?);
            (i < self.size.0).then_some(j * self.size.0 + i)
        };
        index().and_then(|index| self.values.get(index)).copied().unwrap_or(f64::NAN)
    }

    /// Returns the outlines of the points whose value is at least `level`.
    pub(super) fn outlines(&self, level: f64) -> Vec<Ring> {
        let mut next = BTreeMap::new();
        let reach = |count: usize| -1..isize::try_from(count).unwrap_or(isize::MAX);
        for j in reach(self.size.1) {
            for i in reach(self.size.0) {
                self.link_cell((i, j), level, &mut next);
            }
        }
        let mut rings = Vec::new();
        while let Some((start, mut edge)) = next.pop_first() {
            let mut ring = vec![self.vertex(start, level)];
            while edge != start {
                ring.push(self.vertex(edge, level));
                match next.remove(&edge) {
                    Some(after) => edge = after,
                    None => break,
                }
            }
            rings.push(straightened(&ring));
        }
        rings
    }

    /// Links the edges through which the outline enters and leaves a cell.
    fn link_cell(&self, (i, j): (isize, isize), level: f64, next: &mut BTreeMap<Edge, Edge>) {
        // The corners are counterclockwise, each with the edge to the next one.
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        let edges = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
        let values = corners.map(|(i, j)| self.value(i, j));
        let inside = values.map(|value| value >= level);
        let leaves = |k: usize| inside[k] && !inside[(k + 1) % 4];
        let enters = |k: usize| !inside[k] && inside[(k + 1) % 4];
        // At a saddle the centre decides whether opposite corners are connected.
        let middle = values.iter().sum::<f64>() / 4.0;
        let together = middle >= level;
        for from in (0..4).filter(|k| leaves(*k)) {
            let turn = |k: usize| if together { (from + k) % 4 } else { (from + 4 - k) % 4 };
            if let Some(to) = (1..4).map(turn).find(|k| enters(*k)) {
                next.insert(edges[from], edges[to]);
            }
        }
    }

    fn vertex(&self, (i, j, upward): Edge, level: f64) -> Vertex {
        let a = self.value(i, j);
        let b = if upward { self.value(i, j + 1) } else { self.value(i + 1, j) };
        let crossing = a.is_finite() && b.is_finite();
        let share = if crossing { (level - a) / (b - a) } else { 0.5 };
        let (right, up) = if upward { (0.0, share) } else { (share, 0.0) };
        let at = (
            self.origin.0 + (i as f64 + right) * self.step,
            self.origin.1 + (j as f64 + up) * self.step,
        );
        Vertex { at, crossing }
    }
}

/// Returns the ring without the vertices on straight stretches.
fn straightened(ring: &Ring) -> Ring {
    let n = ring.len();
    let bends = |k: usize| {
        let (Some(a), Some(b), Some(c)) =
            (ring.get((k + n - 1) % n), ring.get(k), ring.get((k + 1) % n))
        else {
            return true;
        };
        let (u, v) = ((b.at.0 - a.at.0, b.at.1 - a.at.1), (c.at.0 - b.at.0, c.at.1 - b.at.1));
        let turn = (u.0 * v.1 - u.1 * v.0).abs();
        turn > 1e-9 || a.crossing != c.crossing
    };
    let kept: Vec<bool> = (0..n).map(bends).collect();
    ring.iter().zip(kept).filter(|(_, kept)| *kept).map(|(vertex, _)| *vertex).collect()
}

/// Returns the area that a ring encloses, negative for a hole.
pub(super) fn area(ring: &Ring) -> f64 {
    let next = ring.iter().cycle().skip(1);
    let parts = ring.iter().zip(next).map(|(a, b)| a.at.0 * b.at.1 - a.at.1 * b.at.0);
    0.5 * parts.sum::<f64>()
}

/// Returns the stretches of rings along which the field crosses the level.
pub(super) fn lines(rings: &[Ring]) -> Vec<Vec<(f64, f64)>> {
    let mut lines = Vec::new();
    for ring in rings {
        // The start is where the field ends, so that no stretch is cut in two. A ring without such
        // a place is one closed stretch.
        let start = ring.iter().position(|vertex| !vertex.crossing);
        let mut turned: Vec<Vertex> = ring.clone();
        match start {
            Some(start) => turned.rotate_left(start),
            None => turned.extend(ring.first().copied()),
        }
        let stretches = turned.chunk_by(|a, b| a.crossing == b.crossing);
        let crossing = stretches.filter(|stretch| stretch.first().is_some_and(|v| v.crossing));
        lines.extend(crossing.map(|stretch| stretch.iter().map(|vertex| vertex.at).collect()));
    }
    lines
}

/// Joins all rings into one polygon. Its seams are used in both directions, and enclose nothing.
pub(super) fn polygon(rings: &[Ring]) -> Vec<(f64, f64)> {
    let Some(anchor) = rings.first().and_then(|ring| ring.first()).map(|vertex| vertex.at) else {
        return Vec::new();
    };
    let closed = |ring: &Ring| {
        let points: Vec<_> = ring.iter().chain(ring.first()).map(|vertex| vertex.at).collect();
        points.into_iter().chain([anchor])
    };
    rings.iter().flat_map(closed).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_ring_shaped_region_has_two_outlines() {
        let ring = |u: f64, v: f64| -((u * u + v * v).sqrt() - 1.0).abs();
        let field = Field::sampled(&(-2.0..2.0), &(-2.0..2.0), 0.01, ring);
        let outlines = field.outlines(-0.5);
        assert_eq!(outlines.len(), 2);
        let expected = std::f64::consts::PI * (1.5_f64.powi(2) - 0.5_f64.powi(2));
        let enclosed: f64 = outlines.iter().map(area).sum();
        assert!((enclosed - expected).abs() < 1e-3 * expected);
        for line in lines(&outlines) {
            assert_eq!(line.first(), line.last());
            assert!(line.iter().all(|p| (ring(p.0, p.1) + 0.5).abs() < 1e-3));
        }
    }

    #[test]
    fn the_outline_closes_where_the_field_ends() {
        let half = |u: f64, v: f64| if u < 0.0 { f64::NAN } else { 1.0 - u * u - v * v };
        let field = Field::sampled(&(-1.5..1.5), &(-1.5..1.5), 0.01, half);
        let outlines = field.outlines(0.0);
        let half_disc = 0.5 * std::f64::consts::PI;
        assert!((outlines.iter().map(area).sum::<f64>() - half_disc).abs() < 0.02);
        let lines = lines(&outlines);
        assert_eq!(lines.len(), 1);
        let length: f64 =
            lines[0].windows(2).map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1)).sum();
        assert!((length - std::f64::consts::PI).abs() < 0.02, "{length}");
    }

    proptest! {
        /// Every node is on the correct side of the outline.
        #[test]
        fn outlines_enclose_what_is_high(values in prop::collection::vec(0..5_u8, 36)) {
            let at = |u: f64, v: f64| {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                let value = values[(v.round() * 6.0 + u.round()) as usize];
                if value == 4 { f64::NAN } else { f64::from(value) }
            };
            let field = Field::sampled(&(0.0..5.0), &(0.0..5.0), 1.0, at);
            let outline = polygon(&field.outlines(1.5));
            for index in 0..36_u8 {
                let (u, v) = (f64::from(index % 6), f64::from(index / 6));
                prop_assert_eq!(winding(&outline, (u, v)), i32::from(at(u, v) >= 1.5));
            }
        }
    }

    /// Returns the winding number of the outline around a point, counterclockwise.
    fn winding(outline: &[(f64, f64)], (u, v): (f64, f64)) -> i32 {
        let next = outline.iter().cycle().skip(1);
        outline
            .iter()
            .zip(next)
            .map(|(a, b)| {
                let side = (b.0 - a.0) * (v - a.1) - (b.1 - a.1) * (u - a.0);
                i32::from(a.1 <= v && b.1 > v && side > 0.0)
                    - i32::from(b.1 <= v && a.1 > v && side < 0.0)
            })
            .sum()
    }
}
