//! The quadratic's minimum within a box, exactly.

use nalgebra::Vector3;

use super::ErgonomicsQuadratic;
use crate::region::Region;

impl ErgonomicsQuadratic {
    /// Returns the point in a box at which e is smallest \[m\]. Allocates nothing.
    ///
    /// Every axis is free, at its lower face, or at its upper face. The best of these 27 cases that
    /// lies in the box is the minimum, because e is convex.
    pub fn minimiser_in(&self, region: &Region) -> Vector3<f64> {
        let (min, max) = (region.min(), region.max());
        let mut best = (min + max) * 0.5;
        let mut lowest = self.value(&best);
        for case in 0..27_usize {
            let state = [case % 3, case / 3 % 3, case / 9];
            if let Some(x) = self.stationary(state, min, max)
                && region.contains(&x)
            {
                let value = self.value(&x);
                if value < lowest {
                    (best, lowest) = (x, value);
                }
            }
        }
        best
    }

    /// Returns the stationary point with axes held at a face (1 lower, 2 upper) or free (0).
    fn stationary(
        &self,
        state: [usize; 3],
        min: &Vector3<f64>,
        max: &Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let mut x = Vector3::zeros();
        for axis in 0..3 {
            x[axis] = match state[axis] {
                1 => min[axis],
                2 => max[axis],
                _ => 0.0,
            };
        }
        // The rows of held axes are replaced by "no change".
        let mut matrix = self.hessian;
        let mut slope = self.gradient_at(&x);
        for axis in (0..3).filter(|&axis| state[axis] != 0) {
            matrix.row_mut(axis).fill(0.0);
            matrix.column_mut(axis).fill(0.0);
            matrix[(axis, axis)] = 1.0;
            slope[axis] = 0.0;
        }
        x -= matrix.cholesky()?.solve(&slope);
        Some(x)
    }
}
