//! Checks of every tick of a motion.

use whole_body::Model;

use super::stacks::PERIOD;

/// Checks every tick against the model's limits by differences of positions.
pub(crate) struct Monitor {
    model: Model,
    last: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    inside: Vec<bool>,
}

impl Monitor {
    pub(crate) fn new(model: &Model, q: &[f64]) -> Self {
        let rest = vec![0.0; model.velocity_count()];
        let inside = vec![false; rest.len()];
        let (velocity, acceleration) = (rest.clone(), rest);
        Self { model: model.clone(), last: q.to_vec(), velocity, acceleration, inside }
    }

    pub(crate) fn check(&mut self, q: &[f64]) {
        let mut moved = vec![0.0; self.velocity.len()];
        self.model.difference(&self.last, q, &mut moved).unwrap();
        let names = self.model.velocity_names();
        let size = q.len() - moved.len();
        for (entry, limits) in self.model.limits().iter().enumerate() {
            let name = &names[entry];
            let velocity = moved[entry] / PERIOD;
            let acceleration = (velocity - self.velocity[entry]) / PERIOD;
            let jerk = (acceleration - self.acceleration[entry]) / PERIOD;
            // Differences of positions of about 1 have rounding errors of 1e-16 / Δt, 1e-16 / Δt², …
            for (what, value, limit, rounding) in [
                ("velocity", velocity, limits.velocity, 1e-11),
                ("acceleration", acceleration, limits.acceleration, 1e-8),
                ("jerk", jerk, limits.jerk, 1e-4),
            ] {
                assert!(
                    value.is_finite() && value.abs() <= limit * (1.0 + 1e-7) + rounding,
                    "{what} of {name} is {value}, limit {limit}"
                );
            }
            let (position, is_base) =
                (q[entry + size], self.model.base() == whole_body::Base::Floating && entry < 6);
            let within = position >= limits.lower - 1e-9 && position <= limits.upper + 1e-9;
            assert!(within || is_base || !self.inside[entry], "{name} left its range: {position}");
            self.inside[entry] |= within;
            self.velocity[entry] = velocity;
            self.acceleration[entry] = acceleration;
        }
        self.last.copy_from_slice(q);
    }
}
