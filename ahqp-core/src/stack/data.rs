//! Data of the problem, shared by all blended stacks.

use std::sync::Arc;

use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::ids::LevelId;
use crate::problem::level::Level;

/// The bounds `lower ≤ x ≤ upper`.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

impl Bounds {
    pub(super) fn none(variables: usize) -> Self {
        let (lower, upper) = (vec![f64::NEG_INFINITY; variables], vec![f64::INFINITY; variables]);
        Self { lower, upper }
    }

    pub(super) fn hold(&self, x: &[f64]) -> bool {
        let bounds = self.lower.iter().zip(&self.upper);
        bounds.zip(x).all(|((lower, upper), x)| lower <= x && x <= upper)
    }
}

#[derive(Debug, Clone)]
pub(super) struct Data {
    pub(super) bounds: Bounds,
    /// Bounds of the blend, which the blended solutions need not obey.
    pub(super) output: Bounds,
    pub(super) ids: Vec<LevelId>,
    /// One level for each id.
    pub(super) levels: Vec<Level>,
    pub(super) variable_names: Vec<Arc<str>>,
}

impl Data {
    pub(super) fn level(&self, id: LevelId) -> Option<&Level> {
        self.levels.get(self.place(id)?)
    }

    pub(super) fn level_mut(&mut self, id: LevelId) -> Option<&mut Level> {
        let place = self.place(id)?;
        self.levels.get_mut(place)
    }

    /// Iterates over all levels with their ids.
    pub(super) fn entries(&self) -> impl Iterator<Item = (LevelId, &Level)> + Clone {
        self.ids.iter().copied().zip(&self.levels)
    }

    pub(super) fn push(&mut self, id: LevelId, level: Level) {
        self.ids.push(id);
        self.levels.push(level);
    }

    pub(super) fn remove(&mut self, id: LevelId) {
        if let Some(place) = self.place(id) {
            self.ids.remove(place);
            self.levels.remove(place);
        }
    }

    fn place(&self, id: LevelId) -> Option<usize> {
        self.ids.iter().position(|other| *other == id)
    }

    /// Creates a problem over the same variables, without levels.
    pub(super) fn frame(&self) -> Result<Hierarchy, Error> {
        let mut frame = Hierarchy::new(self.bounds.lower.len())?;
        if !self.variable_names.is_empty() {
            frame.name_variables(self.variable_names.iter().cloned())?;
        }
        Ok(frame)
    }

    /// Writes the bounds of the variables. If `narrow` is true, they are limited to the bounds of
    /// the output, which hold if the two exclude each other. NaN is kept, so that the solver
    /// refuses it.
    pub(super) fn write_bounds(&self, narrow: bool, hierarchy: &mut Hierarchy) {
        let (lower, upper) = hierarchy.bounds_mut();
        for (to, from) in [(lower, &self.bounds.lower), (upper, &self.bounds.upper)] {
            to.copy_from_slice(from);
            if narrow {
                let output = self.output.lower.iter().zip(&self.output.upper);
                for (bound, (least, greatest)) in to.iter_mut().zip(output) {
                    *bound = if least.is_nan() || *bound < *least {
                        *least
                    } else if greatest.is_nan() || *bound > *greatest {
                        *greatest
                    } else {
                        *bound
                    };
                }
            }
        }
    }
}
