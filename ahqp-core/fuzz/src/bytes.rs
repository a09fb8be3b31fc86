//! Hierarchies made from bytes.

use ahqp_core::nalgebra::{DMatrix, DVector};
use ahqp_core::{Hierarchy, Level, Rows};

/// A fuzzer's bytes in sequence, followed by zeros.
pub struct Bytes<'a>(pub &'a [u8]);

/// Shape that stays the same from tick to tick: the variables, and the levels with their rows.
pub struct Shape {
    variables: usize,
    hard: usize,
    /// Number of rows of each level, and whether it is a quadratic.
    levels: Vec<(usize, bool)>,
}

impl Bytes<'_> {
    fn next(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// Returns an integer from 0 to `most`.
    fn up_to(&mut self, most: u8) -> usize {
        usize::from(self.next() % (most + 1))
    }

    /// Returns an integer from −4 to 4.
    fn small(&mut self) -> f64 {
        f64::from(self.next() % 9) - 4.0
    }

    /// Returns a power of two. Products and sums of small numbers with it are exact.
    fn weight(&mut self) -> f64 {
        f64::from(i16::from(self.next() % 31) - 15).exp2()
    }

    /// Returns an arbitrary double.
    pub fn any(&mut self) -> f64 {
        f64::from_le_bytes(std::array::from_fn(|_| self.next()))
    }

    /// Creates a shape of up to three variables, two hard rows, and two levels of up to three rows.
    pub fn shape(&mut self) -> Shape {
        let variables = 1 + self.up_to(2);
        let hard = self.up_to(2);
        let levels = (0..=self.up_to(1)).map(|_| (self.up_to(3), self.up_to(3) == 3)).collect();
        Shape { variables, hard, levels }
    }

    /// Creates a tick: bounds, and numbers with few digits, multiplied by a weight for each row.
    pub fn tick(&mut self, shape: &Shape) -> Hierarchy {
        let n = shape.variables;
        let mut hierarchy = Hierarchy::new(n).expect("a variable");
        let (lower, upper) = hierarchy.bounds_mut();
        for (lower, upper) in lower.iter_mut().zip(upper) {
            (*lower, *upper) = (-1.0, [1.0, 8.0, -1.0, f64::INFINITY][self.up_to(3)]);
        }
        for (index, &(count, quadratic)) in shape.levels.iter().enumerate() {
            let level = if quadratic {
                self.quadratic(n)
            } else {
                Level::least_squares(self.rows(count, n))
            };
            let hard = if index == 0 { shape.hard } else { 0 };
            let level = level.with_constraints(self.rows(hard, n));
            hierarchy.push(level).expect("a level of n variables");
        }
        hierarchy
    }

    fn rows(&mut self, count: usize, n: usize) -> Rows {
        let mut rows = Rows::zeros(count, n);
        for i in 0..count {
            let weight = self.weight();
            for entry in rows.row_mut(i).expect("a row") {
                *entry = weight * self.small();
            }
            let target = weight * self.small();
            let width = [0.0, 0.5, 3.0, f64::INFINITY][self.up_to(3)];
            (rows.lower_mut()[i], rows.upper_mut()[i]) = (target, target + weight * width);
        }
        rows
    }

    /// Creates the quadratic ½‖R x − b‖², without its constant.
    fn quadratic(&mut self, n: usize) -> Level {
        let rank = self.up_to(3);
        let root = DMatrix::from_fn(rank, n, |_, _| self.small());
        let target = DVector::from_fn(rank, |_, _| self.small());
        let gradient = -(root.transpose() * target);
        Level::quadratic(&(root.transpose() * root), &gradient).expect("a square matrix")
    }

    /// Creates a hierarchy in which every number may be arbitrary.
    pub fn wild(&mut self) -> Hierarchy {
        let shape = self.shape();
        let n = shape.variables;
        let mut hierarchy = self.tick(&shape);
        let (lower, upper) = hierarchy.bounds_mut();
        for bound in lower.iter_mut().chain(upper) {
            self.replace(bound);
        }
        for id in hierarchy.ids() {
            let level = hierarchy.level_mut(id).expect("a level");
            self.replace_rows(level.constraints_mut());
            if let Ok(rows) = level.rows_mut() {
                self.replace_rows(rows);
                let weights: Vec<f64> = (0..rows.len()).map(|_| self.any()).collect();
                // Invalid weights are refused.
                let _ = rows.set_weights(&weights);
            } else if let Ok((hessian, gradient)) = level.quadratic_mut() {
                (0..n * n).for_each(|i| self.replace(&mut hessian[i]));
                (0..n).for_each(|i| self.replace(&mut gradient[i]));
            }
        }
        hierarchy
    }

    fn replace_rows(&mut self, rows: &mut Rows) {
        for i in 0..rows.len() {
            for entry in rows.row_mut(i).expect("a row") {
                self.replace(entry);
            }
            self.replace(&mut rows.lower_mut()[i]);
            self.replace(&mut rows.upper_mut()[i]);
        }
    }

    /// Replaces a number by an arbitrary one in some cases.
    fn replace(&mut self, number: &mut f64) {
        if self.next() % 4 == 1 {
            *number = self.any();
        }
    }
}
