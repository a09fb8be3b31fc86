//! Robots with realistic limits, random numbers, and the rows of a task.

use std::sync::{Arc, Mutex};

use whole_body::robot::LimitOverride;
use whole_body::tasks::{TaskInput, TaskRows};
use whole_body::{Base, Description, Error, Ik, Model, Task};

pub(crate) const PERIOD: f64 = 1e-3;

pub(crate) fn panda() -> Model {
    let urdf = include_str!("../../../examples/urdf/panda.urdf");
    Model::from_urdf(urdf, &Description::default()).unwrap()
}

/// A Panda with this share of its acceleration limits.
pub(crate) fn panda_of_acceleration(share: f64) -> Model {
    let urdf = include_str!("../../../examples/urdf/panda.urdf");
    let model = panda();
    let limits = model.joints().iter().zip(model.limits()).map(|(joint, limits)| {
        let acceleration = Some(share * limits.acceleration);
        (joint.name.clone(), LimitOverride { acceleration, ..LimitOverride::default() })
    });
    let description = Description { limits: limits.collect(), ..Description::default() };
    Model::from_urdf(urdf, &description).unwrap()
}

pub(crate) fn two_arms() -> Model {
    let urdf = include_str!("../../../examples/urdf/two_arms.urdf");
    let (linear, angular) = (LimitOverride::of_speed(1.0, 1.0), LimitOverride::of_speed(2.0, 3.0));
    let description = Description::on_planar_base(linear, angular);
    Model::from_urdf(urdf, &description).unwrap()
}

pub(crate) fn humanoid() -> Model {
    let urdf = include_str!("../../../examples/urdf/humanoid.urdf");
    let description = Description { base: Base::Floating, ..Description::default() };
    Model::from_urdf(urdf, &description).unwrap()
}

/// A random tree with the default acceleration limits and no jerk limits.
pub(crate) fn bush() -> Model {
    Model::from_urdf(include_str!("../../golden/bush.urdf"), &Description::default()).unwrap()
}

/// MOCA with its fingers held.
pub(crate) fn moca() -> Model {
    let urdf = include_str!("../../../examples/urdf/moca.urdf");
    let tips = vec!["panda_tcp".to_owned()];
    Model::from_urdf(urdf, &Description { tips, ..Description::default() }).unwrap()
}

/// Pseudo-random numbers (the SplitMix64 generator).
#[derive(Debug, Clone)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// A number from 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let bits = (z ^ (z >> 31)) >> 11;
        bits as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, lower: f64, upper: f64) -> f64 {
        lower + self.unit() * (upper - lower)
    }

    /// A configuration within the position limits, stretched by `beyond` to both sides.
    pub(crate) fn configuration(&mut self, model: &Model, beyond: f64) -> Vec<f64> {
        let mut moves = vec![0.0; model.velocity_count()];
        let neutral = model.neutral();
        for (entry, (to, limits)) in moves.iter_mut().zip(model.limits()).enumerate() {
            let (lower, upper) = (limits.lower.max(-2.0), limits.upper.min(2.0));
            let margin = beyond * (upper - lower);
            // Zero is not within the range of every joint.
            let from = neutral.get(entry + neutral.len() - model.velocity_count());
            *to = self.within(lower - margin, upper + margin) - from.copied().unwrap_or(0.0);
        }
        let mut q = neutral;
        model.integrate(&mut q, &moves).unwrap();
        q
    }
}

/// The last rows of a task: coefficients, lower bound, upper bound.
pub(crate) type Recorded = Arc<Mutex<Vec<(Vec<f64>, f64, f64)>>>;

/// A task that wraps another one and records what it writes.
#[derive(Debug, Clone)]
pub(crate) struct Recording<T> {
    pub(crate) task: T,
    pub(crate) rows: Recorded,
}

impl<T: Task> Recording<T> {
    pub(crate) fn new(task: T) -> (Self, Recorded) {
        let rows = Recorded::default();
        (Self { task, rows: Arc::clone(&rows) }, rows)
    }
}

impl<T: Task + Clone> Task for Recording<T> {
    fn dimension(&self, model: &Model) -> usize {
        self.task.dimension(model)
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        self.task.validate(model)
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        self.task.write(input, rows)?;
        let written = (0..rows.len()).map(|row| {
            let (lower, upper) = rows.range(row).unwrap();
            (rows.row_mut(row).to_vec(), lower, upper)
        });
        *self.rows.lock().unwrap() = written.collect();
        Ok(())
    }
}

/// The rows that a task writes at q.
pub(crate) fn rows_at<T: Task + Clone>(
    model: &Model,
    task: T,
    q: &[f64],
) -> Vec<(Vec<f64>, f64, f64)> {
    let (task, rows) = Recording::new(task);
    let mut builder = Ik::builder(model);
    builder.push("task", task);
    let _ = builder.build().unwrap().step(q, PERIOD).unwrap();
    rows.lock().unwrap().clone()
}
