//! The stack of tasks: safety, the paper's Sec. III-E (inverse kinematics, workspace, then
//! ergonomics or its benchmark), and a posture for what is left.

mod goal;

use ahqp_core::{AugmentedState, Budget, Hierarchy, Rows, Settings, Solution, VelocityInterval};
use hrsw::{SoftWorkspace, Softening, Workspace};
use hrsw_safety::{JointMotion, Safety, SpeedCap};
use nalgebra::{Isometry3, Translation3};
use whole_body::limits::{WheelLimit, nearest_to_rest};
use whole_body::stack::{TaskId, TaskLevel, TaskStack};
use whole_body::tasks::{AugmentedFrameTask, RowBlock, VariableLayout, VelocityTask};

use crate::controller::commanded_motion::CommandedMotion;
use crate::error::Error;
use crate::robot::kinematics::Kinematics;
use crate::robot::moca::MOCA_BASE_JOINTS;
use crate::settings::{ControllerSettings, Levels};
use crate::shared_space::POSITION_ROWS;
use goal::GoalTask;
pub(crate) use goal::GoalTerms;

/// Weights of a change of velocity against the posture in the last level, for the joints of the base and the others.
/// Motions that no other level decides then change over some tens of ticks.
const SMOOTH_BASE: f64 = 40.0;
const SMOOTH_ARM: f64 = 5.0;

/// The stack of a robot that works with a person, made of tasks of [`whole_body`]. It is sized once and rewritten each
/// tick.
///
/// The variables are χ = [q̇; ẋ_d; s]: see [`AugmentedState`].
#[derive(Debug, Clone)]
pub struct CollaborationStack {
    stack: TaskStack,
    tasks: Tasks,
    soft: SoftWorkspace,
    period: f64,
    budget: Budget,
}

/// The tasks, by priority.
#[derive(Debug, Clone, Copy)]
struct Tasks {
    speed_cap: TaskId<RowBlock>,
    separation: Option<TaskId<RowBlock>>,
    wheels: Option<TaskId<WheelLimit>>,
    own_bodies: Option<TaskId<RowBlock>>,
    returns: Option<TaskId<VelocityTask>>,
    gentle: Option<TaskId<VelocityTask>>,
    kinematics: TaskId<AugmentedFrameTask>,
    workspace: TaskId<RowBlock>,
    goal: TaskId<GoalTask>,
    smoothness: Option<TaskId<VelocityTask>>,
}

/// The inputs of a tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StackInput<'a> {
    /// x_d(t−1).
    pub(crate) desired: &'a Isometry3<f64>,
    /// The shared workspace.
    pub(crate) workspace: &'a Workspace,
    /// The objective of the third level.
    pub(crate) goal: GoalTerms<'a>,
    /// The last commanded q̇, n \[m/s or rad/s\].
    pub(crate) velocity: &'a [f64],
    /// The velocities that limits allow.
    pub(crate) motion: &'a CommandedMotion,
    /// Separation from people and from the robot itself, as measured in this tick.
    pub(crate) safety: &'a Safety,
}

impl CollaborationStack {
    /// Creates the stack for a robot, with the blocks of rows of `safety`.
    ///
    /// # Errors
    /// Parameters out of range, or a posture of another size.
    pub(crate) fn new(
        robot: &Kinematics,
        settings: &ControllerSettings,
        safety: &Safety,
    ) -> Result<Self, Error> {
        let ControllerSettings { gain, period, horizon, base, posture, space, .. } = settings;
        let softening = Softening {
            margin: space.margin,
            position_rows: POSITION_ROWS,
            ..Softening::default()
        };
        let extended = settings.levels == Levels::Extended;
        let (model, joints) = (robot.model(), robot.jacobian().ncols());
        posture.check(joints)?;
        let state = Self::layout(joints);
        let mut variables = VariableLayout::new(model);
        let desired = variables.add("desired twist", state.task);
        let slack = variables.add("slack", state.slack);
        let soft = SoftWorkspace::new(state, *horizon, softening)?;
        let on_base = base.map_or(0, |_| MOCA_BASE_JOINTS.min(joints));

        let mut speed_cap = TaskLevel::new("speed cap");
        let mut separation = TaskLevel::new("separation");
        let mut own_bodies = TaskLevel::new("own bodies");
        let mut returns = TaskLevel::new("return into the limits");
        let mut gentle = TaskLevel::new("base");
        let mut kinematics = TaskLevel::new("inverse kinematics");
        let mut workspace = TaskLevel::new("shared workspace");
        let mut goal = TaskLevel::new("goal");
        let mut rest = TaskLevel::new("posture");
        let augmented = AugmentedFrameTask::new(robot.tool(), &desired).with_gains(*gain);
        let bounds = RowBlock::new(soft.capacity());
        // Kinds of rows without any row have no task.
        let task = |rows: Rows| (!rows.is_empty()).then(|| RowBlock::new(rows.len()));
        let tasks = Tasks {
            speed_cap: speed_cap.constrain("speed cap", RowBlock::new(SpeedCap::ROWS)),
            separation: task(safety.separation().rows())
                .map(|task| separation.push("people", task)),
            wheels: base.map(|base| separation.constrain("wheels", base.limit())),
            own_bodies: task(safety.own().rows()).map(|task| own_bodies.push("own bodies", task)),
            returns: if extended {
                Some(returns.push("return", entries(0..joints)?))
            } else {
                None
            },
            gentle: match &base {
                Some(_) if extended => Some(gentle.push("base", entries(0..on_base)?)),
                _ => None,
            },
            kinematics: kinematics.push("tool", augmented),
            workspace: {
                let mut slacks = entries(slack.range())?;
                for (row, weight) in softening.weights.iter().enumerate() {
                    slacks.set_weight(row, *weight)?;
                }
                workspace.push("slack", slacks);
                workspace.constrain("workspace", bounds)
            },
            goal: goal.push_quadratic("goal", GoalTask::new(desired, *horizon)),
            smoothness: if extended {
                let mut task = entries(0..joints)?;
                for row in 0..joints {
                    let weight = if row < on_base { SMOOTH_BASE } else { SMOOTH_ARM };
                    task.set_weight(row, weight)?;
                }
                let smoothness = rest.push("smoothness", task);
                rest.push("posture", posture.task()?);
                Some(smoothness)
            } else {
                None
            },
        };
        let solver = Settings { stacking: settings.stacking, ..Settings::default() };
        let mut levels = vec![
            speed_cap, separation, own_bodies, returns, gentle, kinematics, workspace, goal, rest,
        ];
        levels.retain(|level| !level.is_empty());
        Ok(Self {
            stack: TaskStack::new(model, &variables, levels, solver)?,
            tasks,
            soft,
            period: *period,
            budget: settings.budget,
        })
    }

    /// The layout of χ for n = `joints`.
    pub fn layout(joints: usize) -> AugmentedState {
        AugmentedState { joints, task: 6, slack: 6 }
    }

    /// The problem of the last tick. Levels without tasks are left out.
    pub fn hierarchy(&self) -> &Hierarchy {
        self.stack.hierarchy()
    }

    /// The rows of the protective distances in the last tick; `None` for a robot that keeps none.
    pub(crate) fn separation(&self) -> Option<&Rows> {
        self.stack.block(self.tasks.separation?).ok()
    }

    /// The solution of the last tick, χ*; `None` before the first and after an error.
    pub fn solution(&self) -> Option<&Solution> {
        self.stack.solution()
    }

    /// Updates the tasks for the tick and solves, with the robot at its configuration.
    ///
    /// # Errors
    /// Data that are not finite or do not fit; the problem itself is always feasible.
    pub(crate) fn solve(
        &mut self,
        robot: &mut Kinematics,
        input: &StackInput<'_>,
    ) -> Result<&Solution, Error> {
        let intervals = input.motion.joints.now.iter().chain(&input.motion.desired.now);
        self.stack.bound(intervals);
        self.set_safety(robot, input)?;
        let Self { stack, tasks, soft, .. } = self;
        let kinematics = stack.task_mut(tasks.kinematics)?;
        kinematics.set_desired(*input.desired)?;
        kinematics.set_point(Translation3::from(*robot.tool_from_hand()).into())?;
        soft.write_rows(input.workspace, input.desired, stack.block_mut(tasks.workspace)?)?;
        stack.task_mut(tasks.goal)?.set(&input.goal, &input.desired.translation.vector)?;
        if let (Some(gentle), Some(drive)) = (tasks.gentle, &input.motion.base_drive) {
            set_ranges(stack.task_mut(gentle)?, &drive.gentle.now)?;
        }
        if let Some(smoothness) = tasks.smoothness {
            let smoothness = stack.task_mut(smoothness)?;
            for (row, velocity) in input.velocity.iter().enumerate() {
                smoothness.set_range(row, *velocity, *velocity)?;
            }
        }
        stack.write(&mut robot.posed()?, input.velocity, self.period)?;
        Ok(stack.solve(self.budget)?)
    }

    fn set_safety(&mut self, robot: &mut Kinematics, input: &StackInput<'_>) -> Result<(), Error> {
        let Self { stack, tasks, .. } = self;
        let motion = robot.motion(input.velocity);
        let braking = JointMotion { braking: Some(&input.motion.braking), ..motion };
        input.safety.write_cap(&braking, stack.block_mut(tasks.speed_cap)?)?;
        if let Some(separation) = tasks.separation {
            input.safety.separation().write_rows(&motion, stack.block_mut(separation)?)?;
        }
        if let Some(own_bodies) = tasks.own_bodies {
            input.safety.own().write_rows(&motion, stack.block_mut(own_bodies)?)?;
        }
        if let Some(wheels) = tasks.wheels {
            let slowest = input
                .motion
                .joints
                .now
                .first_chunk()
                .map(|base: &[_; 3]| base.each_ref().map(nearest_to_rest));
            stack.task_mut(wheels)?.admit(slowest.unwrap_or_default().into());
        }
        if let Some(returns) = tasks.returns {
            set_ranges(stack.task_mut(returns)?, &input.motion.returns)?;
        }
        Ok(())
    }
}

fn set_ranges(task: &mut VelocityTask, intervals: &[VelocityInterval]) -> Result<(), Error> {
    let rows = intervals.iter().enumerate();
    Ok(rows
        .into_iter()
        .try_for_each(|(row, interval)| task.set_range(row, interval.lower, interval.upper))?)
}

/// Creates a task with one row for each of these variables, at zero.
fn entries(variables: std::ops::Range<usize>) -> Result<VelocityTask, Error> {
    let mut task = VelocityTask::new(variables.len());
    let mut row = vec![0.0; variables.end];
    for (index, variable) in variables.enumerate() {
        row.fill(0.0);
        row[variable] = 1.0;
        task.set_row(index, &row, 0.0, 0.0)?;
    }
    Ok(task)
}
