//! Limit that keeps bodies of one robot apart.

use hrsw_safety::{Capsule, LinkCapsule, SeparationSettings, proximity};
use whole_body::tasks::{Limit, TaskInput, TaskRows};
use whole_body::{Axes, FrameId, Model, Task};

use crate::error::Error;

/// Margin that remains between two bodies \[m\].
const MARGIN: f64 = 0.03;
/// Deceleration of two bodies that approach each other \[m/s²\].
const DECELERATION: f64 = 2.0;
/// Period for which settings are checked \[s\].
const PERIOD: f64 = 1e-3;

/// Keeps pairs of a robot's own capsules apart, as a hard limit of [`Ik`](whole_body::Ik) for any robot.
///
/// Each pair has a row −∂d/∂q q̇ ≤ v(d). The speed v(d) is the largest at which both stop before their margin, by
/// [`SeparationSettings::between_own_bodies`]. Pairs within their margin do not come nearer, and are not pushed apart.
/// The margin holds as far as the joints can brake at the deceleration.
///
/// ```
/// use moca_model::whole_body::{Ik, tasks::PostureTask, stack::TaskLevel};
/// use moca_model::{MOCA_HOME, SelfCollisionLimit, moca, moca_safety};
///
/// let (model, bodies) = (moca()?, moca_safety());
/// let mut builder = Ik::builder(&model);
/// builder.limit("own bodies", SelfCollisionLimit::new(&model, &bodies.bodies, &bodies.own_pairs)?);
/// let mut level = TaskLevel::new("posture");
/// level.push("posture", PostureTask::new());
/// builder.push_level(level);
/// let mut ik = builder.build_at(&MOCA_HOME)?;
/// assert!(ik.step(&MOCA_HOME, 1e-3)?.velocity().iter().all(|velocity| velocity.abs() < 1e-9));
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SelfCollisionLimit {
    pairs: Vec<[(FrameId, Capsule); 2]>,
    margin: f64,
    deceleration: f64,
}

impl SelfCollisionLimit {
    /// Creates the limit for pairs of these bodies, by their indices. The margin is 0.03 m, the deceleration 2 m/s².
    ///
    /// # Errors
    /// [`Error::Robot`] for a link that the robot does not have, [`Error::Value`] for an index without a body and for no
    /// pairs.
    pub fn new(
        model: &Model,
        bodies: &[LinkCapsule],
        pairs: &[(usize, usize)],
    ) -> Result<Self, Error> {
        let body = |index: usize| {
            let value = index as f64;
            let what = "the index of a body of a pair".to_owned();
            let unknown = Error::Value { what, value, expected: "that of a body in the list" };
            let body = bodies.get(index).ok_or(unknown)?;
            Ok::<_, Error>((model.frame_id(&body.link)?, body.capsule))
        };
        let pairs = pairs.iter().map(|&(first, second)| Ok([body(first)?, body(second)?]));
        let pairs = pairs.collect::<Result<Vec<_>, Error>>()?;
        if pairs.is_empty() {
            let what = "the number of pairs of bodies".to_owned();
            return Err(Error::Value { what, value: 0.0, expected: "at least 1" });
        }
        Ok(Self { pairs, margin: MARGIN, deceleration: DECELERATION })
    }

    /// Sets the margin that remains \[m\], and the deceleration before it \[m/s²\].
    ///
    /// # Errors
    /// [`Error::Safety`] for a negative margin, and a deceleration that is not positive.
    pub fn with_margin(mut self, margin: f64, deceleration: f64) -> Result<Self, Error> {
        SeparationSettings::between_own_bodies(PERIOD, deceleration, margin).validate()?;
        (self.margin, self.deceleration) = (margin, deceleration);
        Ok(self)
    }
}

impl Task for SelfCollisionLimit {
    fn dimension(&self, _model: &Model) -> usize {
        self.pairs.len()
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), whole_body::Error> {
        let settings =
            SeparationSettings::between_own_bodies(input.period(), self.deceleration, self.margin);
        for (row, &[(one, first), (other, second)]) in self.pairs.iter().enumerate() {
            let [at, to] = [input.posed().world_from(one)?, input.posed().world_from(other)?];
            let near = proximity(&first.placed(&at), &second.placed(&to));
            for (frame, gradient) in [
                (one, near.gradient_first(&at.translation.vector)),
                (other, near.gradient_second(&to.translation.vector)),
            ] {
                let columns = input.jacobian(frame, Axes::World)?.column_iter();
                let own = rows.row_mut(row).iter_mut();
                own.zip(columns).for_each(|(own, column)| *own -= gradient.dot(&column));
            }
            rows.set_range(row, f64::NEG_INFINITY, settings.approach_limit(near.distance, 0.0));
        }
        Ok(())
    }
}

/// Rest is always admitted.
impl Limit for SelfCollisionLimit {}
