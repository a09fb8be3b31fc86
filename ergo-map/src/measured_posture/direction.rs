//! Angles on the circle and directions on the sphere.

use nalgebra::Vector3;

/// Returns the equivalent angle in [-π, π].
pub(super) fn turned(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Returns the angle between two unit vectors \[rad\].
pub(super) fn between(one: &Vector3<f64>, other: &Vector3<f64>) -> f64 {
    one.cross(other).norm().atan2(one.dot(other))
}

/// Turns the unit vector `from` towards another by an angle \[rad\]. Towards the opposite vector
/// the direction is arbitrary.
pub(super) fn towards(from: &Vector3<f64>, to: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    let part = to - from * from.dot(to);
    let any = || {
        let axis = if from.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
        from.cross(&axis).normalize()
    };
    let across = part.try_normalize(1e-9).unwrap_or_else(any);
    (from * angle.cos() + across * angle.sin()).normalize()
}
