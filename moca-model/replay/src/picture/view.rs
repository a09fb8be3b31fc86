//! Orthographic view: a capsule is a thick line with round ends.

use nalgebra::{Vector2, Vector3};

/// View of a target from above and from the side.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    target: Vector3<f64>,
    /// Directions to the right, upwards and to the eye.
    axes: [Vector3<f64>; 3],
    /// Pixels per metre.
    pub(super) scale: f64,
    /// Position of the target in the picture.
    middle: Vector2<f64>,
}

impl View {
    /// Creates a view. The eye is in the direction `turn` from the target \[rad\], raised by `rise` \[rad\].
    pub(super) fn new(
        target: Vector3<f64>,
        [turn, rise]: [f64; 2],
        scale: f64,
        middle: Vector2<f64>,
    ) -> Self {
        let level = Vector3::new(turn.cos(), turn.sin(), 0.0);
        let eye = level * rise.cos() + Vector3::z() * rise.sin();
        let right = Vector3::new(-turn.sin(), turn.cos(), 0.0);
        Self { target, axes: [right, eye.cross(&right), eye], scale, middle }
    }

    /// Returns a point in pixels, x to the right and y down.
    pub(super) fn at(&self, point: &Vector3<f64>) -> Vector2<f64> {
        let [right, up, _] = &self.axes;
        let from = point - self.target;
        self.middle + Vector2::new(right.dot(&from), -up.dot(&from)) * self.scale
    }

    /// Returns the nearness of a point to the eye, relative to the target \[m\].
    pub(super) fn nearness(&self, point: &Vector3<f64>) -> f64 {
        self.axes[2].dot(&(point - self.target))
    }

    /// Returns the component of a direction towards the eye.
    pub(super) fn facing(&self, direction: &Vector3<f64>) -> f64 {
        self.axes[2].dot(direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_up_and_near_is_near() {
        let view =
            View::new(Vector3::new(1.0, 2.0, 0.5), [-0.9, 0.4], 100.0, Vector2::new(50.0, 60.0));
        assert!((view.at(&Vector3::new(1.0, 2.0, 0.5)) - Vector2::new(50.0, 60.0)).norm() < 1e-9);
        let above = view.at(&Vector3::new(1.0, 2.0, 1.5));
        assert!((above.x - 50.0).abs() < 1e-9 && above.y < 60.0);
        let nearer =
            Vector3::new(1.0, 2.0, 0.5) + Vector3::new((-0.9_f64).cos(), (-0.9_f64).sin(), 0.0);
        assert!(view.nearness(&nearer) > 0.9);
        // A length across the view keeps its size.
        let aside = Vector3::new(0.9_f64.sin(), 0.9_f64.cos(), 0.0);
        let moved = view.at(&(Vector3::new(1.0, 2.0, 0.5) + aside));
        assert!(((moved - Vector2::new(50.0, 60.0)).norm() - 100.0).abs() < 1e-9);
    }
}
