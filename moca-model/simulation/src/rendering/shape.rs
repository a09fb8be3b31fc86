//! Intersections of rays with capsules, boxes and planes. All are in the optical frame of the camera. A ray from the
//! origin has z = 1 there, so that its parameter is the depth.

use nalgebra::{Isometry3, Point3, Vector3};

/// The surface that is seen along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Depth along the optical axis \[m\].
    pub(super) depth: f64,
    /// Normal of the surface, towards the camera.
    pub(super) normal: Vector3<f64>,
    /// Red, green, blue.
    pub(super) colour: [f64; 3],
}

/// A capsule: all points within a radius of a segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capsule {
    pub(super) ends: [Point3<f64>; 2],
    pub(super) radius: f64,
    pub(super) colour: [f64; 3],
}

/// A box, with or without holes drawn on its faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct TexturedBox {
    pub(super) pose: Isometry3<f64>,
    pub(super) half: Vector3<f64>,
    pub(super) colour: [f64; 3],
    pub(super) perforated: bool,
}

impl Capsule {
    pub(super) fn hit(&self, ray: &Vector3<f64>) -> Option<Hit> {
        let [from, to] = &self.ends;
        let (from, to) = (from.coords, to.coords);
        let axis = to - from;
        let (length, along, square) = (axis.norm_squared(), axis.dot(ray), ray.norm_squared());
        let a = length * square - along * along;
        let (start, across) = (axis.dot(&from), from.dot(ray));
        let reach = self.radius * self.radius;
        let of_from = entry(square, across, from.norm_squared() - reach);
        let mut depth = of_from.min(entry(square, to.dot(ray), to.norm_squared() - reach));
        if a > 1e-12 {
            let b = length * across - start * along;
            let of_side = entry(a, b, length * (from.norm_squared() - reach) - start * start);
            let place = along * of_side - start;
            if (0.0..=length).contains(&place) {
                depth = depth.min(of_side);
            }
        }
        if depth == f64::INFINITY {
            return None;
        }
        let point = ray * depth;
        let share = if length > 0.0 { axis.dot(&(point - from)) / length } else { 0.0 };
        let normal = (point - from - axis * share.clamp(0.0, 1.0)) / self.radius;
        Some(Hit { depth, normal, colour: self.colour })
    }
}

/// The smaller root of a t² - 2 b t + c if it is ahead; otherwise infinity.
fn entry(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let depth = (b - discriminant.sqrt()) / a;
    if depth > 0.0 { depth } else { f64::INFINITY }
}

impl TexturedBox {
    pub(super) fn hit(&self, ray: &Vector3<f64>) -> Option<Hit> {
        let origin = self.pose.inverse_transform_point(&Point3::origin()).coords;
        let direction = self.pose.inverse_transform_vector(ray);
        let (mut enter, mut leave, mut face) = (f64::NEG_INFINITY, f64::INFINITY, 0);
        for axis in 0..3 {
            let speed = direction[axis];
            let bounds = [-self.half[axis], self.half[axis]];
            if speed.abs() < 1e-12 {
                if origin[axis].abs() > self.half[axis] {
                    return None;
                }
                continue;
            }
            let [one, other] = bounds.map(|bound| (bound - origin[axis]) / speed);
            if one.min(other) > enter {
                (enter, face) = (one.min(other), axis);
            }
            leave = leave.min(one.max(other));
        }
        if !(enter > 0.0 && enter <= leave) {
            return None;
        }
        let mut normal = Vector3::zeros();
        normal[face] = -direction[face].signum();
        let at = origin + direction * enter;
        let colour = self.texture([at[(face + 1) % 3], at[(face + 2) % 3]]);
        Some(Hit { depth: enter, normal: self.pose.rotation * normal, colour })
    }

    /// The texture: dark holes of 12 mm every 40 mm.
    fn texture(&self, at: [f64; 2]) -> [f64; 3] {
        let from_middle = |x: f64| (x / 0.04).fract().abs() - 0.5;
        let (u, v) = (from_middle(at[0]), from_middle(at[1]));
        let hole = self.perforated && u * u + v * v < 0.3 * 0.3;
        if hole { [0.08, 0.08, 0.09] } else { self.colour }
    }
}

/// Intersects a ray with the plane through a point with a normal.
pub(super) fn plane(
    ray: &Vector3<f64>,
    point: &Point3<f64>,
    normal: &Vector3<f64>,
    colour: [f64; 3],
) -> Option<Hit> {
    let depth = point.coords.dot(normal) / ray.dot(normal);
    (depth > 0.0 && depth.is_finite()).then_some(Hit { depth, normal: *normal, colour })
}
