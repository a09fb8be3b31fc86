//! Limit that keeps bodies of one robot apart.

use hrsw_safety::{Capsule, LinkCapsule, proximity};
use nalgebra::Matrix6xX;
use whole_body::tasks::{Limit, TaskInput, TaskRows};
use whole_body::{Axes, Data, FrameId, Model, Task};

use super::stopping::Stopping;
use crate::error::Error;

/// Number of parts of the way to rest, of equal length if all joints stop together.
const PARTS: usize = 12;
/// Number of rows of a pair: one for the place of least distance on the way to rest, one for its end.
const ROWS: usize = 2;
/// Largest speed at which a pair that is too near is pushed apart \[m/s\].
const RECOVERY: f64 = 0.1;

/// Keeps pairs of a robot's own capsules apart, as a hard limit of [`Ik`](whole_body::Ik) for any robot.
///
/// Each tick follows the way q(t) to rest on which every joint brakes within its limits of acceleration and jerk. The
/// rows keep the distance d of a pair on that way, linear in the next velocity: −∇d · W (q̇ − q̇₀) ≤ d(q(t)) − d_min − r.
/// W is the derivative of the way. One row stands for the t with the least distance, one for the end. So the robot can
/// brake before every pair, and both links and all joints count.
///
/// The gradient changes within a period Δt. The rows therefore keep r = ½ Δt Σ |∂d/∂qᵢ q̇ᵢ| in reserve, half the way of a
/// period, which is zero at rest. Braking is always admitted. A pair that is too near at the start moves apart at up to
/// 0.1 m/s.
///
/// ```
/// use hrsw_safety::{Capsule, LinkCapsule};
/// use moca_model::nalgebra::Vector3;
/// use moca_model::whole_body::{Description, Ik, Model, tasks::PositionTask};
/// use moca_model::SelfCollisionLimit;
///
/// let model = Model::from_urdf(moca_model::MOCA_URDF, &Description::default())?;
/// let body = |link: &str, z, radius| {
///     let capsule = Capsule::sphere(Vector3::z() * z, radius)?;
///     Ok::<_, moca_model::Error>(LinkCapsule { link: link.to_owned(), capsule })
/// };
/// let bodies = [body("panda_link0", 0.1, 0.15)?, body("panda_hand", 0.05, 0.1)?];
/// let pairs = [("panda_link0", "panda_hand")];
/// let mut builder = Ik::builder(&model);
/// builder.limit("own bodies", SelfCollisionLimit::new(&model, &bodies, &pairs, 0.03)?);
/// builder.push("tool", PositionTask::new(model.frame_id("panda_hand")?));
/// let mut ik = builder.build_at(&model.neutral())?;
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SelfCollisionLimit {
    model: Model,
    data: Data,
    pairs: Vec<Pair>,
    distance: f64,
    stops: Vec<Stopping>,
    /// q̇ of the tick before the last.
    before: Vec<f64>,
    q: Vec<f64>,
    moved: Vec<f64>,
    jacobian: Matrix6xX<f64>,
}

#[derive(Debug, Clone)]
struct Pair {
    bodies: [(FrameId, Capsule); 2],
    /// The least distance on the way to rest \[m\], and its part of the way.
    least: (f64, usize),
}

impl SelfCollisionLimit {
    /// Creates the limit for pairs of links. Each capsule on one link stays at least `distance` \[m\] away from each
    /// capsule on the other. Links next to each other overlap at their joint, so their capsules must not.
    ///
    /// # Errors
    /// [`Error::Robot`] for a link that the robot does not have; [`Error::NoBody`] for one without a capsule;
    /// [`Error::Value`] for a negative distance, and for no pairs.
    pub fn new(
        model: &Model,
        bodies: &[LinkCapsule],
        pairs: &[(impl AsRef<str>, impl AsRef<str>)],
        distance: f64,
    ) -> Result<Self, Error> {
        if !(distance.is_finite() && distance >= 0.0) {
            let what = "the least distance of own bodies [m]".to_owned();
            return Err(Error::Value { what, got: distance, wanted: "0 or more" });
        }
        let on = |link: &str| {
            let frame = model.frame_id(link)?;
            let own = bodies.iter().filter(|body| body.link == link);
            let own: Vec<_> = own.map(|body| (frame, body.capsule)).collect();
            if own.is_empty() { Err(Error::NoBody { link: link.to_owned() }) } else { Ok(own) }
        };
        let mut all = Vec::new();
        for (one, other) in pairs {
            let others = on(other.as_ref())?;
            for one in on(one.as_ref())? {
                let pair = |other: &_| Pair { bodies: [one, *other], least: (f64::INFINITY, 0) };
                all.extend(others.iter().map(pair));
            }
        }
        if all.is_empty() {
            let what = "the number of pairs of own bodies".to_owned();
            return Err(Error::Value { what, got: 0.0, wanted: "at least 1" });
        }
        let count = model.velocity_count();
        Ok(Self {
            data: Data::new(model),
            pairs: all,
            distance,
            stops: Vec::with_capacity(count),
            before: vec![0.0; count],
            q: model.neutral(),
            moved: vec![0.0; count],
            jacobian: Matrix6xX::zeros(count),
            model: model.clone(),
        })
    }

    /// Moves the own configuration to a time of the way to rest from `q`.
    fn follow(&mut self, q: &[f64], time: f64) -> Result<(), whole_body::Error> {
        self.q.copy_from_slice(q);
        for (moved, stop) in self.moved.iter_mut().zip(&self.stops) {
            *moved = stop.way(time);
        }
        self.model.integrate(&mut self.q, &self.moved)
    }

    /// Writes the row of a pair for the own configuration, at a time of the way to rest.
    fn write_row(
        &mut self,
        (pair, row): (usize, usize),
        (time, period): (f64, f64),
        rows: &mut TaskRows<'_>,
    ) -> Result<(), whole_body::Error> {
        let Some(Pair { bodies: [(one, first), (other, second)], .. }) = self.pairs.get(pair)
        else {
            return Ok(());
        };
        let posed = self.data.pose(&self.model, &self.q)?;
        let [at, to] = [posed.world_from(*one)?, posed.world_from(*other)?];
        let near = proximity(&first.placed(&at), &second.placed(&to));
        let own = rows.row_mut(row);
        for (frame, gradient) in [
            (*one, near.gradient_first(&at.translation.vector)),
            (*other, near.gradient_second(&to.translation.vector)),
        ] {
            posed.jacobian_into(frame, Axes::World, &mut self.jacobian)?;
            let columns = self.jacobian.column_iter();
            own.iter_mut().zip(columns).for_each(|(own, column)| *own -= gradient.dot(&column));
        }
        // A speed, as in other rows: the way of the slowest stop counts as one.
        let longest =
            self.stops.iter().map(|stop| stop.lever(time)).fold(f64::MIN_POSITIVE, f64::max);
        let speeds = own.iter().zip(&self.before).map(|(own, velocity)| (own * velocity).abs());
        let kept = self.distance + 0.5 * period * speeds.sum::<f64>();
        let mut room = ((near.distance - kept) / longest).max(-RECOVERY);
        for (own, stop) in own.iter_mut().zip(&self.stops) {
            *own *= stop.lever(time) / longest;
            room += *own * stop.velocity();
        }
        rows.set_range(row, f64::NEG_INFINITY, room);
        Ok(())
    }
}

impl Task for SelfCollisionLimit {
    fn dimension(&self, _model: &Model) -> usize {
        ROWS * self.pairs.len()
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn anticipates(&self) -> bool {
        true
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), whole_body::Error> {
        let (velocity, period) = (input.velocity(), input.period());
        self.stops.clear();
        let entries = self.model.limits().iter().zip(velocity).zip(&self.before);
        self.stops.extend(
            entries.map(|((limits, velocity), before)| {
                Stopping::new(limits, *velocity, *before, period)
            }),
        );
        self.before.copy_from_slice(velocity);
        let longest = self.stops.iter().map(Stopping::time).fold(0.0, f64::max);
        let time = |part: usize| longest * (1.0 - (1.0 - part as f64 / PARTS as f64).sqrt());
        for part in 0..=PARTS {
            self.follow(input.posed().configuration(), time(part))?;
            let posed = self.data.pose(&self.model, &self.q)?;
            for pair in &mut self.pairs {
                let [(one, first), (other, second)] = &pair.bodies;
                let placed = [
                    first.placed(&posed.world_from(*one)?),
                    second.placed(&posed.world_from(*other)?),
                ];
                let distance = proximity(&placed[0], &placed[1]).distance;
                if part == 0 || distance < pair.least.0 {
                    pair.least = (distance, part);
                }
            }
        }
        for part in 0..=PARTS {
            if part < PARTS && self.pairs.iter().all(|pair| pair.least.1 != part) {
                continue;
            }
            self.follow(input.posed().configuration(), time(part))?;
            for pair in 0..self.pairs.len() {
                if part == PARTS {
                    self.write_row((pair, ROWS * pair + 1), (time(part), period), rows)?;
                }
                if self.pairs.get(pair).is_some_and(|pair| pair.least.1 == part && part < PARTS) {
                    self.write_row((pair, ROWS * pair), (time(part), period), rows)?;
                }
            }
        }
        for (pair, Pair { least, .. }) in self.pairs.iter().enumerate() {
            if least.1 == PARTS {
                rows.set_range(ROWS * pair, f64::NEG_INFINITY, f64::INFINITY);
            }
        }
        Ok(())
    }
}

/// Braking is always admitted.
impl Limit for SelfCollisionLimit {}
