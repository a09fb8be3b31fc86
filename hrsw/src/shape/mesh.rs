//! Triangles for drawing.

use nalgebra::{Isometry3, Point3, Vector3};

/// A closed surface of triangles, counter-clockwise as seen from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Corners \[m\].
    pub vertices: Vec<Vector3<f64>>,
    /// Three indices of vertices for each triangle.
    pub triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// Returns the surface in the outer axes of `pose`, if it is given in the inner ones.
    #[must_use]
    pub fn placed(mut self, pose: &Isometry3<f64>) -> Self {
        for vertex in &mut self.vertices {
            *vertex = (pose * Point3::from(*vertex)).coords;
        }
        self
    }

    /// Creates a box from corners in the order of [`Bounds::corners`](super::Bounds::corners).
    pub(crate) fn of_box(corners: [Vector3<f64>; 8]) -> Self {
        let quads =
            [[1, 3, 7, 5], [2, 6, 7, 3], [4, 5, 7, 6], [0, 4, 6, 2], [0, 1, 5, 4], [0, 2, 3, 1]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        Self { vertices: corners.to_vec(), triangles: triangles.collect() }
    }

    /// Creates rings from a first to a last point. All have one size, and are counter-clockwise
    /// about the direction from the first to the last point.
    pub(crate) fn of_rings(
        first: Vector3<f64>,
        rings: impl Iterator<Item = Vec<Vector3<f64>>>,
        last: Vector3<f64>,
    ) -> Self {
        let mut vertices = vec![first];
        let mut triangles = Vec::new();
        let mut around = 0;
        for ring in rings {
            around = ring.len();
            let begin = vertices.len();
            vertices.extend(ring);
            for i in 0..around {
                let (here, next) = (begin + i, begin + (i + 1) % around);
                if begin == 1 {
                    triangles.push([0, next, here]);
                } else {
                    triangles.push([here - around, next, here]);
                    triangles.push([here - around, next - around, next]);
                }
            }
        }
        let (begin, end) = (vertices.len() - around, vertices.len());
        vertices.push(last);
        for i in 0..around {
            triangles.push([begin + i, begin + (i + 1) % around, end]);
        }
        Self { vertices, triangles }
    }
}
