//! Convex polytopes, from half-spaces or as the hull of points.

use std::sync::Arc;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;
use parry3d_f64::transformation::try_convex_hull;

use super::half_space::HalfSpace;
use crate::error::{Error, check_all};

/// Largest number of faces of a polytope.
const MAX_FACES: usize = 64;
/// Largest coordinate of a polytope \[m\].
const MAX_REACH: f64 = 1e3;
/// Points closer to a plane than this are on it \[m\].
const ON_PLANE: f64 = 1e-7;
/// Smallest depth that counts as a volume \[m\].
const MIN_DEPTH: f64 = 1e-6;

/// A bounded convex polytope with a volume.
///
/// Clones share the data, so that cloning allocates nothing.
///
/// ```
/// use hrsw::Polytope;
/// use nalgebra::Vector3;
///
/// let corners = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
/// let tetrahedron = Polytope::hull(&corners)?;
/// assert_eq!(tetrahedron.faces().len(), 4);
/// assert!(tetrahedron.signed_distance(&Vector3::repeat(0.2)) < 0.0);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Polytope {
    data: Arc<Data>,
}

#[derive(Debug, PartialEq)]
struct Data {
    faces: Vec<HalfSpace>,
    /// Corners \[m\].
    vertices: Vec<Vector3<f64>>,
    /// Indices of the corners of triangles that cover the faces.
    triangles: Vec<[usize; 3]>,
}

impl Polytope {
    /// Creates the intersection of half-spaces. Those that contribute no face are left out.
    ///
    /// # Errors
    /// [`Error::TooMany`] if there are more than 64. [`Error::Unbounded`] if the set reaches
    /// farther than 1 km. [`Error::NoVolume`] if it is empty or flat.
    pub fn new(half_spaces: &[HalfSpace]) -> Result<Self, Error> {
        check_count(half_spaces.len())?;
        let planes = without_repeats(half_spaces);
        let vertices = vertices_of(&planes);
        let no_volume = Error::NoVolume { faces: half_spaces.len() };
        if vertices.iter().any(|vertex| vertex.amax() > MAX_REACH * (1.0 - 1e-9)) {
            return Err(Error::Unbounded { limit: MAX_REACH });
        }
        if vertices.is_empty() {
            return Err(no_volume);
        }
        let center = vertices.iter().sum::<Vector3<f64>>() / vertices.len() as f64;
        if planes.iter().any(|plane| plane.signed_distance(&center) > -MIN_DEPTH) {
            return Err(no_volume);
        }
        let mut faces = Vec::new();
        let mut triangles = Vec::new();
        for plane in planes {
            let corners = corners_in_order(&plane, &vertices);
            if let [first, rest @ ..] = &corners[..]
                && rest.len() >= 2
            {
                triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                faces.push(plane);
            }
        }
        Ok(Self { data: Arc::new(Data { faces, vertices, triangles }) })
    }

    /// Creates the smallest convex set around `points` \[m\].
    ///
    /// # Errors
    /// [`Error::Value`] if a number is not finite. [`Error::NoVolume`] if the points are in a
    /// plane, or fewer than four. [`Error::TooMany`] if the hull has more than 64 faces.
    pub fn hull(points: &[Vector3<f64>]) -> Result<Self, Error> {
        check_all("a point of the hull", points.iter().flat_map(|point| point.iter()))?;
        let no_volume = Error::NoVolume { faces: points.len() };
        let Some(rounding) = Rounding::of(points) else { return Err(no_volume) };
        let round: Vec<Vector> = points.iter().map(|p| to_parry(&rounding.apply(p))).collect();
        let (vertices, triangles) = try_convex_hull(&round).map_err(|_| no_volume.clone())?;
        let vertices: Vec<Vector3<f64>> =
            vertices.iter().map(|v| rounding.undo(&from_parry(v))).collect();
        let corner = |index: u32| vertices.get(index as usize);
        let mut planes = Vec::new();
        for [a, b, c] in triangles {
            let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else {
                return Err(no_volume);
            };
            // Slivers have no reliable normal. Their neighbours bound the same set.
            if let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-12) {
                let offset = vertices.iter().map(|v| normal.dot(v)).fold(f64::MIN, f64::max);
                planes.push(HalfSpace { normal, offset });
            }
        }
        Self::new(&without_repeats(&planes))
    }

    /// Faces, with outer normals of length 1.
    pub fn faces(&self) -> &[HalfSpace] {
        &self.data.faces
    }

    /// Corners \[m\].
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.data.vertices
    }

    /// Returns the nearest point of the polytope \[m\]. A point inside is its own nearest point.
    pub fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        if self.depth(point) <= 0.0 {
            return *point;
        }
        let Data { vertices, triangles, .. } = &*self.data;
        let corner = |index: usize| vertices.get(index).map_or(Vector::ZERO, to_parry);
        let target = to_parry(point);
        let mut best = (f64::INFINITY, *point);
        for &[a, b, c] in triangles {
            let triangle = Triangle::new(corner(a), corner(b), corner(c));
            let nearest = from_parry(&triangle.project_local_point(target, false).point);
            let distance = (nearest - point).norm_squared();
            if distance < best.0 {
                best = (distance, nearest);
            }
        }
        best.1
    }

    /// Returns the Euclidean distance \[m\]. Inside it is minus the distance to the nearest face.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        let depth = self.depth(point);
        if depth <= 0.0 { depth } else { (point - self.nearest(point)).norm() }
    }

    /// Returns the distance of the point beyond the farthest plane.
    fn depth(&self, point: &Vector3<f64>) -> f64 {
        self.faces().iter().map(|face| face.signed_distance(point)).fold(f64::MIN, f64::max)
    }

    pub(crate) fn support(&self, direction: &Vector3<f64>) -> f64 {
        self.vertices().iter().map(|vertex| direction.dot(vertex)).fold(f64::MIN, f64::max)
    }
}

fn check_count(found: usize) -> Result<(), Error> {
    if found > MAX_FACES {
        let what = "the faces of a polytope";
        return Err(Error::TooMany { what, got: found, most: MAX_FACES });
    }
    Ok(())
}

/// Keeps only the tightest of planes that coincide.
fn without_repeats(planes: &[HalfSpace]) -> Vec<HalfSpace> {
    let mut kept: Vec<HalfSpace> = Vec::new();
    for plane in planes {
        match kept.iter_mut().find(|other| (other.normal - plane.normal).norm() < ON_PLANE) {
            Some(other) => other.offset = other.offset.min(plane.offset),
            None => kept.push(*plane),
        }
    }
    kept
}

/// Returns the points at which three planes meet, inside all others and within ±`MAX_REACH` along
/// the axes.
fn vertices_of(planes: &[HalfSpace]) -> Vec<Vector3<f64>> {
    let guards = (0..6).map(|i| {
        let sign = if i < 3 { 1.0 } else { -1.0 };
        HalfSpace { normal: Vector3::ith(i % 3, sign), offset: MAX_REACH }
    });
    let planes: Vec<HalfSpace> = planes.iter().copied().chain(guards).collect();
    let mut vertices: Vec<Vector3<f64>> = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in planes.iter().skip(j + 1) {
                let Some(vertex) = meeting_point(a, b, c) else { continue };
                let within = planes.iter().all(|plane| plane.signed_distance(&vertex) < ON_PLANE);
                if within && vertices.iter().all(|known| (known - vertex).norm() > ON_PLANE) {
                    vertices.push(vertex);
                }
            }
        }
    }
    vertices
}

fn meeting_point(a: &HalfSpace, b: &HalfSpace, c: &HalfSpace) -> Option<Vector3<f64>> {
    let normals =
        Matrix3::from_rows(&[a.normal.transpose(), b.normal.transpose(), c.normal.transpose()]);
    if normals.determinant().abs() < 1e-9 {
        return None;
    }
    normals.lu().solve(&Vector3::new(a.offset, b.offset, c.offset))
}

/// Returns the vertices on the plane, counter-clockwise about its normal.
fn corners_in_order(plane: &HalfSpace, vertices: &[Vector3<f64>]) -> Vec<usize> {
    let on_plane = |vertex: &Vector3<f64>| plane.signed_distance(vertex) > -2.0 * ON_PLANE;
    let corners = vertices.iter().enumerate().filter(|(_, vertex)| on_plane(vertex));
    let mut corners: Vec<(usize, Vector3<f64>)> = corners.map(|(i, vertex)| (i, *vertex)).collect();
    let Some(&(_, first)) = corners.first() else { return Vec::new() };
    let center = corners.iter().map(|(_, v)| v).sum::<Vector3<f64>>() / corners.len() as f64;
    let right = (first - center).try_normalize(0.0).unwrap_or_else(Vector3::x);
    let up = plane.normal.cross(&right);
    let angle = |v: &Vector3<f64>| (v - center).dot(&up).atan2((v - center).dot(&right));
    corners.sort_by(|(_, a), (_, b)| angle(a).total_cmp(&angle(b)));
    corners.into_iter().map(|(i, _)| i).collect()
}

/// An affine map that spreads points evenly in all directions. It keeps the corners of their hull.
/// A thin plate would count as flat otherwise. The map is symmetric and positive, so that faces
/// keep their orientation.
struct Rounding {
    center: Vector3<f64>,
    axes: Matrix3<f64>,
    extents: Vector3<f64>,
}

impl Rounding {
    /// Computes the map. None if the points are in a plane, by the least variance along any axis,
    /// or fewer than four.
    fn of(points: &[Vector3<f64>]) -> Option<Self> {
        if points.len() < 4 {
            return None;
        }
        let center = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let scatter: Matrix3<f64> =
            points.iter().map(|p| (p - center) * (p - center).transpose()).sum();
        let SymmetricEigen { eigenvectors, eigenvalues } = scatter.symmetric_eigen();
        if eigenvalues.min() < MIN_DEPTH * MIN_DEPTH {
            return None;
        }
        Some(Self { center, axes: eigenvectors, extents: eigenvalues.map(f64::sqrt) })
    }

    fn apply(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let along = self.axes.tr_mul(&(point - self.center));
        self.axes * along.component_div(&self.extents)
    }

    fn undo(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let along = self.axes.tr_mul(point);
        self.center + self.axes * along.component_mul(&self.extents)
    }
}

fn to_parry(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn from_parry(v: &Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}
