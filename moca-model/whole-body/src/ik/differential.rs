//! Differential inverse kinematics with strict priorities.

mod builder;
mod step;

use std::any::Any;
use std::ops::Range;

use ahqp_core::{Level, Objective, Rows, VelocityInterval};
use nalgebra::Isometry3;

use super::settings::IkSettings;
use super::singularity::SingularityDamping;
use crate::error::{Error, check_size};
use crate::limits::anticipation::Anticipation;
use crate::limits::common_point::widen;
use crate::limits::joint_intervals::JointIntervals;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;
use crate::stack::task_level::TaskId;
use crate::stack::task_stack::TaskStack;
use crate::state::data::Data;
pub use builder::IkBuilder;
pub use step::{ActiveLimit, ActiveRow, LevelReport, Step};

/// Differential inverse kinematics of one robot. It computes velocities within the limits of all joints that serve
/// levels of tasks, each level as well as the levels above it allow.
///
/// Minimises ½ Σ wᵢ dᵢ² of each level lexicographically, highest priority first. The distance of aᵢ q̇ to the range
/// that a task asks for is dᵢ. Constraints are the position, velocity, acceleration and jerk limits of the model, and
/// further [limits](IkBuilder::limit). Among equal optima the velocity of least norm is taken. Limits never contradict
/// each other, from any start, and after construction a step allocates nothing.
///
/// ```
/// use nalgebra::Point3;
/// use whole_body::tasks::{PositionTask, PostureTask};
/// use whole_body::{Description, Ik, Model};
///
/// let urdf = r#"<robot name="arm">
///   <link name="base"/> <link name="upper"/> <link name="lower"/> <link name="tool"/>
///   <joint name="shoulder" type="revolute">
///     <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
///     <limit lower="-2" upper="2" velocity="2" effort="9"/>
///   </joint>
///   <joint name="elbow" type="revolute">
///     <origin xyz="0.5 0 0"/><parent link="upper"/><child link="lower"/><axis xyz="0 0 1"/>
///     <limit lower="-2" upper="2" velocity="2" effort="9"/>
///   </joint>
///   <joint name="wrist" type="fixed">
///     <origin xyz="0.5 0 0"/><parent link="lower"/><child link="tool"/>
///   </joint>
/// </robot>"#;
/// let model = Model::from_urdf(urdf, &Description::default())?;
/// let tool = model.frame_id("tool")?;
///
/// let mut builder = Ik::builder(&model);
/// let reach = builder.push("reach", PositionTask::new(tool));
/// let posture = builder.push("posture", PostureTask::new());
/// let mut ik = builder.build()?;
///
/// let mut q = vec![0.3, 0.3];
/// ik.task_mut(posture)?.set_target(&q)?;
/// ik.task_mut(reach)?.set_target(Point3::new(0.4, 0.6, 0.0))?;
/// for _ in 0..2000 {
///     ik.step(&q, 1e-3)?.integrate(&mut q)?;
/// }
/// let step = ik.step(&q, 1e-3)?;
/// assert!(step.slack(reach)? < 1e-6 && step.slack(posture)? > 0.1);
/// assert_eq!(step.active_limits().count(), 0);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Ik {
    pub(super) model: Model,
    data: Data,
    pub(super) settings: IkSettings,
    pub(super) stack: TaskStack,
    /// True if the first level is that of hard limits.
    has_limits: bool,
    pub(super) intervals: JointIntervals,
    pub(super) velocity: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    /// q̈ of the step before the last.
    pub(super) last_acceleration: Vec<f64>,
    pub(super) displacement: Vec<f64>,
    pub(super) period: f64,
    pub(super) singularity: SingularityDamping,
    /// The rows of each level from the first to the last damped one, before damping.
    asked: Vec<AskedRows>,
    anticipation: Anticipation,
    /// The yaw of a base that only moves along its heading, if that is a limit \[rad\].
    heading: Option<f64>,
    /// Time in which the acceleration of each entry of q̇ fades, where limits of rows need that \[s\].
    fading: Vec<f64>,
    /// Joints at the ends of their ranges that levels would move beyond them.
    clamped: Vec<usize>,
    /// A velocity that all limits admit.
    admitted: Vec<f64>,
    /// Values of the rows of the limits.
    limit_values: Vec<f64>,
}

/// The rows of a level before damping.
#[derive(Debug, Clone)]
pub(super) struct AskedRows {
    rows: Rows,
    /// The number of rows that belong to tasks.
    count: usize,
    /// The places of the rows among those that are damped.
    span: Range<usize>,
    counts: bool,
    /// True if rows of curvature follow them.
    bends: bool,
}

impl Ik {
    /// Creates a builder that collects levels of tasks for a robot.
    pub fn builder(model: &Model) -> IkBuilder {
        IkBuilder::new(model)
    }

    pub(super) fn new(
        model: Model,
        settings: IkSettings,
        stack: TaskStack,
        has_limits: bool,
    ) -> Result<Self, Error> {
        let rest = vec![0.0; model.velocity_count()];
        let mut ik = Self {
            data: Data::new(&model),
            intervals: JointIntervals::new(&model)?,
            velocity: rest.clone(),
            acceleration: rest.clone(),
            last_acceleration: rest.clone(),
            displacement: rest.clone(),
            period: 1e-3,
            anticipation: Anticipation::new(rest.len(), Vec::new()),
            heading: None,
            fading: model.fading_times(),
            singularity: SingularityDamping::new(0.0, &[], stack.names().len(), rest.len()),
            asked: Vec::new(),
            clamped: Vec::with_capacity(rest.len()),
            admitted: rest,
            limit_values: Vec::new(),
            has_limits,
            model,
            settings,
            stack,
        };
        ik.make_room();
        Ok(ik)
    }

    /// Sizes limits and damping for the levels of the stack.
    fn make_room(&mut self) {
        let limits = self.stack.levels().next().filter(|_| self.has_limits);
        let keeps_heading = limits.is_some_and(|(tasks, _)| tasks.keeps_heading());
        self.heading = keeps_heading.then_some(0.0);
        let anticipating = limits.map(|(tasks, _)| tasks.anticipating_constraints().collect());
        let anticipating: Vec<bool> = anticipating.unwrap_or_default();
        self.limit_values = vec![0.0; anticipating.len()];
        self.anticipation = Anticipation::new(self.velocity.len(), anticipating);
        let damped = self.stack.levels().map(|(tasks, _)| tasks.is_damped);
        let last = damped.enumerate().filter(|(_, is)| *is).last().map_or(0, |(last, _)| last + 1);
        let levels = self.stack.levels().take(last);
        let sizes: Vec<_> = levels
            .map(|(tasks, _)| (tasks.row_count(), tasks.rows_with_curvature(), tasks.bends()))
            .collect();
        let counts: Vec<usize> = sizes.iter().map(|(count, ..)| *count).collect();
        let (threshold, columns) = (self.settings.singularity_threshold, self.stack.names().len());
        self.singularity =
            SingularityDamping::new(threshold, &counts, columns, self.velocity.len());
        let asked = sizes.into_iter().map(|(count, all, bends)| {
            let mut rows = Rows::zeros(all, columns);
            // The size is right and the weights positive, so no error is possible. This makes the room for them.
            let _ = rows.set_weights(&vec![1.0; all]);
            AskedRows { rows, count, span: 0..0, counts: false, bends }
        });
        self.asked = asked.collect();
    }

    /// Computes the velocities for the next `period` \[s\], with the robot at the configuration `q` and the velocity of
    /// the last step. Allocates nothing, unless it returns an error.
    ///
    /// Call [`reset`](Self::reset) before the first step of a robot that is already in motion.
    ///
    /// # Errors
    /// [`Error::Value`] for a period that is not positive; those of [`Data::pose`] on q;
    /// [`Error::InTask`], with the names of task and level, such as a target that was never set.
    /// The state is then as before; [`brake`](Self::brake) gives velocities that stop the robot.
    pub fn step(&mut self, q: &[f64], period: f64) -> Result<Step<'_>, Error> {
        self.step_within(q, period, &[])
    }

    /// Computes a step whose velocities also lie within `intervals`, one for each entry of q̇ or none at all. They may
    /// come from a following-error limit or from a speed limit of a safety layer. Where an interval contradicts a
    /// joint's limits, the limits win.
    ///
    /// # Errors
    /// Those of [`step`](Self::step); [`Error::Size`] and [`Error::Value`] for intervals.
    pub fn step_within(
        &mut self,
        q: &[f64],
        period: f64,
        intervals: &[VelocityInterval],
    ) -> Result<Step<'_>, Error> {
        check_period(period)?;
        if !intervals.is_empty() {
            check_size("the list of intervals", intervals.len(), self.velocity.len())?;
            let nan =
                |interval: &&VelocityInterval| interval.lower.is_nan() || interval.upper.is_nan();
            if intervals.iter().any(|interval| nan(&interval)) {
                let what = "an end of an interval of velocities".to_owned();
                return Err(Error::not_finite(what, f64::NAN));
            }
        }
        self.write(q, period, intervals)?;
        self.stack.solve(self.settings.budget)?;
        if let (Some(own), Some(yaw)) = (&mut self.heading, q.get(2)) {
            *own = *yaw;
        }
        self.read(period);
        Ok(Step { ik: self })
    }

    /// Writes the bounds of the variables, limits and tasks, and damps levels.
    fn write(
        &mut self,
        q: &[f64],
        period: f64,
        narrower: &[VelocityInterval],
    ) -> Result<(), Error> {
        let mut posed = self.data.pose(&self.model, q)?;
        self.intervals.update(q, &self.velocity, &self.acceleration, period);
        let base = self.heading.map(|_| self.intervals.stop_along(&self.velocity));
        let mut longest = f64::INFINITY;
        if self.anticipation.is_needed() {
            longest = self.anticipation.stop_time();
            let v = &self.velocity;
            longest = self.intervals.keep_even_stop(q, v, longest, base, period);
        }
        let heading =
            base.and_then(|_| self.intervals.keep_heading(q, &self.velocity, longest, period));
        self.intervals.narrow(narrower);
        if let Some(heading) = &heading {
            self.intervals.align_with(heading);
        }
        self.stack.bound(&self.intervals.now);
        self.singularity.begin();
        let (velocity, acceleration) = (&self.velocity, &self.acceleration);
        let (intervals, anticipation) = (&self.intervals, &mut self.anticipation);
        let (singularity, admitted) = (&mut self.singularity, &mut self.admitted);
        let values = &mut self.limit_values;
        let (has_limits, asked, fading) = (self.has_limits, &mut self.asked, &self.fading);
        for asked in asked.iter_mut() {
            asked.span = 0..0;
        }
        self.stack.write_with(&mut posed, velocity, period, |index, level| {
            if has_limits && index == 0 {
                let rows = level.constraints_mut();
                anticipation.narrow(rows, velocity, acceleration, intervals, period, values);
                let faded = |entry: usize| {
                    let share = fading[entry] / (fading[entry] + period);
                    velocity[entry] + acceleration[entry] * period * share
                };
                widen(rows, &intervals.now, faded, admitted, values);
            } else if let Some(asked) = asked.get_mut(index)
                && let Ok(rows) = level.rows_mut()
            {
                asked.span = singularity.load(rows, asked.count);
            }
        })?;
        singularity.factorise();
        // Rows for clamped joints and rows of curvature stand between the levels.
        let (mut moved, mut ends) = (0, false);
        self.clamped.clear();
        let limits = self.model.limits();
        let places = q.iter().skip(q.len().saturating_sub(limits.len()));
        let room =
            limits.iter().zip(places).map(|(limits, q)| [q - limits.lower, limits.upper - q]);
        for (index, asked) in asked.iter_mut().enumerate() {
            asked.span = asked.span.start + moved..asked.span.end + moved;
            let has_rows = asked.span.start < asked.span.end;
            let above = self.clamped.len();
            let (span, counts) = (&mut asked.span, &mut asked.counts);
            *counts = false;
            let Some(rows) = self.stack.rows_mut(index) else { continue };
            // Further limits may forbid a joint to stand still, so none is clamped. The solver itself handles joints at
            // their ends below a level that reaches its targets.
            if has_rows && !has_limits && (ends || span.start == 0) {
                let clamp = |entry| self.clamped.push(entry);
                let added = singularity.clamp_ends(span, rows, room.clone(), clamp);
                moved += added;
                *span = span.start + added..span.end + added;
            }
            if has_rows && singularity.examine(span, rows) {
                *counts = asked.rows.copy_from(rows).is_ok();
            }
            if *counts && asked.bends {
                singularity.bound(span, |factors, curvature| {
                    self.stack.add_curvature(index, &mut posed, factors, curvature)
                })?;
            } else if *counts {
                singularity.damp(span);
            }
            let Some(rows) = self.stack.rows_mut(index) else { continue };
            if *counts {
                singularity.give_up(span, rows);
            }
            let bent =
                if asked.bends { singularity.write_curvature(span, rows, asked.count) } else { 0 };
            moved += bent;
            ends |= bent > 0;
            if !ends {
                // Levels that reach their targets leave the ends of joints to the solver.
                let added = self.clamped.len() - above;
                self.clamped.truncate(above);
                singularity.release(span, added);
                moved -= added;
                *span = span.start - added..span.end - added;
            }
            let own = span.start..span.end + bent;
            singularity.take(&own);
        }
        let (lower, upper) = self.stack.bounds_mut();
        for &entry in &self.clamped {
            if let (Some(lower), Some(upper)) = (lower.get_mut(entry), upper.get_mut(entry)) {
                let rest = 0.0_f64.clamp(*lower, *upper);
                (*lower, *upper) = (rest, rest);
            }
        }
        Ok(())
    }

    fn read(&mut self, period: f64) {
        let x = self.stack.solution().map_or(&[][..], ahqp_core::Solution::best);
        for ((next, x), interval) in self.admitted.iter_mut().zip(x).zip(&self.intervals.now) {
            *next = x.max(interval.lower).min(interval.upper);
        }
        self.take(period);
    }

    /// Takes the admitted velocity as that of the next period.
    fn take(&mut self, period: f64) {
        std::mem::swap(&mut self.acceleration, &mut self.last_acceleration);
        let entries = self.velocity.iter_mut().zip(&mut self.acceleration);
        let entries = entries.zip(&mut self.displacement).zip(&self.admitted);
        for (((velocity, acceleration), displacement), next) in entries {
            *acceleration = (next - *velocity) / period;
            *velocity = *next;
            *displacement = next * period;
        }
        self.period = period;
    }

    /// Brakes every joint for a period within the limits of acceleration and jerk. Use it where [`step`](Self::step)
    /// fails. A joint without such limits stops at once.
    ///
    /// # Errors
    /// [`Error::Value`] for a period that is not positive.
    pub fn brake(&mut self, period: f64) -> Result<&[f64], Error> {
        check_period(period)?;
        self.admitted.copy_from_slice(&self.velocity);
        let accelerations = self.acceleration.iter().map(|acceleration| [*acceleration; 2]);
        self.intervals.brake(accelerations, period, &mut self.admitted);
        if let Some(yaw) = &mut self.heading {
            // The last step turned the base by this angle.
            *yaw += self.displacement.get(2).copied().unwrap_or_default();
            self.intervals.brake_along(*yaw, &self.velocity, period, &mut self.admitted);
        }
        self.take(period);
        Ok(&self.velocity)
    }

    /// Sets the robot's present velocity, with zero acceleration.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`]; nothing has changed then.
    pub fn reset(&mut self, velocity: &[f64]) -> Result<(), Error> {
        self.model.check_velocity("q̇", velocity)?;
        self.velocity.copy_from_slice(velocity);
        self.acceleration.fill(0.0);
        Ok(())
    }

    /// A task or limit, for setting its target.
    ///
    /// # Errors
    /// [`Error::UnknownTask`] for the id of another stack.
    pub fn task_mut<T: Any>(&mut self, id: TaskId<T>) -> Result<&mut T, Error> {
        self.stack.task_mut(id)
    }

    /// Sets targets that were never set to the present state at the configuration `q`, such as the pose of a frame or
    /// the posture.
    ///
    /// # Errors
    /// Those of [`Data::pose`] on q; [`Error::InTask`].
    pub fn hold(&mut self, q: &[f64]) -> Result<(), Error> {
        let mut posed = self.data.pose(&self.model, q)?;
        self.stack.hold(&mut posed)
    }

    /// The pose of a frame in the world at the configuration `q`, for example as a first target.
    ///
    /// # Errors
    /// Those of [`Data::pose`] on q; [`Error::ForeignId`].
    pub fn pose(&mut self, q: &[f64], frame: FrameId) -> Result<Isometry3<f64>, Error> {
        self.data.pose(&self.model, q)?.world_from(frame)
    }

    /// The robot.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// q̇ of the last step; zero before the first.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// The acceleration of the last step.
    pub fn acceleration(&self) -> &[f64] {
        &self.acceleration
    }

    /// The settings.
    pub fn settings(&self) -> &IkSettings {
        &self.settings
    }

    /// The rows that the tasks of a level ask for, before damping. `None` for levels of quadratics.
    pub(super) fn asked_rows<'a>(&'a self, index: usize, level: &'a Level) -> Option<&'a Rows> {
        match (self.asked.get(index), level.objective()) {
            (Some(asked), _) if asked.counts => Some(&asked.rows),
            (_, Objective::LeastSquares(rows)) => Some(rows),
            _ => None,
        }
    }
}

/// Returns an error unless the period is a positive number.
pub(super) fn check_period(period: f64) -> Result<(), Error> {
    if period > 0.0 && period.is_finite() {
        Ok(())
    } else {
        Err(Error::not_positive("the control period [s]", period))
    }
}
