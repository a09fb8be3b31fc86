//! Motion of a robot along a path at the control rate.

use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::{Result, ensure};
use nalgebra::{Isometry3, Point3, Vector3};
use whole_body::limits::LimitKind;
use whole_body::robot::JointKind;
use whole_body::stack::{Status, TaskId, TaskLevel};
use whole_body::tasks::{FrameTask, OrientationTask, PositionTask, PostureTask};
use whole_body::{FrameId, Ik, Model};

use crate::path::Path;
use crate::record::{Record, Summary, Tick};

/// The run of a robot: held frames, then a frame's position along a path, its orientation, and the posture.
#[derive(Debug)]
pub(crate) struct Run {
    ik: Ik,
    model: Model,
    path: Path,
    period: f64,
    frame: FrameId,
    position: TaskId<PositionTask>,
    q: Vec<f64>,
    start: Isometry3<f64>,
    /// Entries of joints with a range in q and q̇.
    entries: Vec<(usize, usize)>,
    way: Vec<FrameId>,
    record: Record,
    infeasible: usize,
    violations: Violations,
}

/// Counts exceeded limits from the motion alone.
#[derive(Clone, Debug)]
struct Violations {
    count: usize,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    inside: Vec<bool>,
}

/// Number of poses of the robot in the picture.
const POSES: usize = 12;

impl Run {
    /// Creates a run with the robot at `q`, and the frames named `held` kept in place.
    ///
    /// # Errors
    /// Names that the robot does not have, a configuration that does not fit, or a period that is not a positive number
    /// of seconds.
    pub(crate) fn new(
        model: &Model,
        frame: &str,
        held: &[String],
        q: &[f64],
        path: Path,
        period: f64,
    ) -> Result<Self> {
        ensure!(
            period > 0.0 && period <= 0.1,
            "the period is {period} s; it must be above 0 and at most 0.1 s"
        );
        let frame = model.frame_id(frame)?;
        let mut builder = Ik::builder(model);
        let mut level = TaskLevel::new("held");
        let held: Vec<_> = held
            .iter()
            .map(|name| {
                let frame = model.frame_id(name)?;
                Ok((level.push(name.as_str(), FrameTask::new(frame)), frame))
            })
            .collect::<Result<_>>()?;
        if !held.is_empty() {
            builder.push_level(level);
        }
        let position = builder.push("position", PositionTask::new(frame));
        let orientation = builder.push("orientation", OrientationTask::new(frame));
        let posture = builder.push("posture", PostureTask::new());
        let mut ik = builder.build()?;
        for (task, frame) in held {
            let pose = ik.pose(q, frame)?;
            ik.task_mut(task)?.set_target(pose)?;
        }
        let start = ik.pose(q, frame)?;
        ik.task_mut(orientation)?.set_target(start.rotation)?;
        ik.task_mut(posture)?.set_target(q)?;
        let single = model.joints().iter().filter(|joint| joint.kind != JointKind::Floating);
        let limits = model.limits();
        let record = Record {
            joints: single.clone().map(|joint| joint.name.clone()).collect(),
            ranges: single
                .clone()
                .map(|joint| {
                    (limits[joint.velocity_index].lower, limits[joint.velocity_index].upper)
                })
                .collect(),
            ..Record::default()
        };
        let entries: Vec<_> =
            single.map(|joint| (joint.position_index, joint.velocity_index)).collect();
        let rest = vec![0.0; model.velocity_count()];
        Ok(Self {
            way: way(model, frame)?,
            q: q.to_vec(),
            violations: Violations {
                count: 0,
                velocity: rest.clone(),
                acceleration: rest,
                inside: vec![false; entries.len()],
            },
            model: model.clone(),
            ik,
            path,
            period,
            frame,
            position,
            start,
            entries,
            record,
            infeasible: 0,
        })
    }

    /// The number of ticks.
    pub(crate) fn ticks(&self) -> usize {
        // The path takes at most a day.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let ticks = (self.path.time() / self.period).min(1e8) as usize;
        ticks
    }

    /// Follows the path and tells `each` how many ticks are done.
    ///
    /// # Errors
    /// Problems that cannot be computed at all, such as a gain too high for the period.
    pub(crate) fn play(
        mut self,
        mut each: impl FnMut(usize) -> ControlFlow<()>,
    ) -> Result<(Record, Summary)> {
        let ticks = self.ticks();
        for tick in 0..ticks {
            if each(tick).is_break() {
                break;
            }
            if tick % (ticks / POSES).max(1) == 0 {
                let places = self.way.iter().map(|frame| self.ik.pose(&self.q, *frame));
                let places: Vec<Vector3<f64>> = places
                    .map(|pose| Ok(pose?.translation.vector))
                    .collect::<Result<_, whole_body::Error>>()?;
                self.record.poses.push(places);
            }
            self.tick(tick as f64 * self.period, tick + 1 == ticks)?;
        }
        let summary = self.record.summary(self.violations.count, self.infeasible);
        Ok((self.record, summary))
    }

    fn tick(&mut self, time: f64, is_last: bool) -> Result<()> {
        let (target, velocity) = self.path.at(time, &self.start.translation.vector);
        let pose = self.ik.pose(&self.q, self.frame)?;
        let task = self.ik.task_mut(self.position)?;
        task.set_moving_target(Point3::from(target), velocity)?;
        let begin = Instant::now();
        let step = match self.ik.step(&self.q, self.period) {
            Ok(step) => step,
            Err(error @ whole_body::Error::Hierarchy(_)) => {
                self.infeasible += 1;
                ensure!(self.infeasible < 1000, "1000 ticks had no solution: {error}");
                self.ik.brake(self.period)?;
                return Ok(());
            }
            Err(error) => return Err(error.into()),
        };
        let duration = 1e6 * begin.elapsed().as_secs_f64();
        if step.status() != Status::Solved {
            self.infeasible += 1;
        }
        let actual = pose.translation.vector;
        self.record.ticks.push(Tick {
            time,
            positions: self.entries.iter().map(|(position, _)| self.q[*position]).collect(),
            target,
            actual,
            position_error: (actual - target).norm(),
            orientation_error: pose.rotation.angle_to(&self.start.rotation),
            limited: step.active_limits().count(),
            duration,
        });
        if is_last {
            let stopped = step.active_limits().filter(|limit| limit.kind == LimitKind::Position);
            self.record.stopped = stopped.map(|limit| limit.name.to_owned()).collect();
        }
        step.integrate(&mut self.q)?;
        let velocity = step.velocity();
        self.violations.check(&self.model, &self.q, velocity, self.period, &self.entries);
        Ok(())
    }
}

impl Violations {
    fn check(
        &mut self,
        model: &Model,
        q: &[f64],
        velocity: &[f64],
        period: f64,
        entries: &[(usize, usize)],
    ) {
        for (index, (position, entry)) in entries.iter().enumerate() {
            let (limits, now) = (&model.limits()[*entry], velocity[*entry]);
            let acceleration = (now - self.velocity[*entry]) / period;
            let jerk = (acceleration - self.acceleration[*entry]) / period;
            let rates =
                [(now, limits.velocity), (acceleration, limits.acceleration), (jerk, limits.jerk)];
            let exceeds = |(value, limit): &(f64, f64)| value.abs() > limit * (1.0 + 1e-6);
            self.count += rates.iter().filter(|rate| exceeds(rate)).count();
            let within = q[*position] >= limits.lower - 1e-9 && q[*position] <= limits.upper + 1e-9;
            self.count += usize::from(!within && self.inside[index]);
            self.inside[index] |= within;
            self.velocity[*entry] = now;
            self.acceleration[*entry] = acceleration;
        }
    }
}

/// The links of the joints on the path to a frame, from the root, and the frame.
fn way(model: &Model, frame: FrameId) -> Result<Vec<FrameId>> {
    let entries: Vec<usize> = model.moved_by(frame)?.collect();
    let mut way: Vec<FrameId> = model.frames().next().map(|(root, _)| root).into_iter().collect();
    for entry in entries.iter().rev() {
        let mut joints = model.joints().iter();
        if let Some(joint) = joints.find(|joint| joint.velocity_index == *entry) {
            way.push(joint.child);
        }
    }
    way.push(frame);
    Ok(way)
}
