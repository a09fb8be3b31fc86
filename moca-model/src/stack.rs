//! The stack of tasks: safety, the paper's Sec. III-E (inverse kinematics, workspace, then
//! ergonomics or its benchmark), and a posture for what is left.

use ahqp_core::{
    AugmentedClik, AugmentedState, Budget, Hierarchy, Level, LevelId, PoseAxes, Rows, Settings,
    Solution, Solver, VelocityInterval,
};
use ergo_map::ErgonomicsQuadratic;
use hrsw::{SoftWorkspace, Softening, Workspace};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Matrix6xX, Vector3, Vector6};

use crate::error::Error;
use crate::motion_limits::MecanumBase;
use crate::safety::SafetyRows;

/// The levels, by priority.
#[derive(Debug, Clone, Copy)]
struct Levels {
    speed_cap: LevelId,
    separation: LevelId,
    own_bodies: LevelId,
    returns: LevelId,
    kinematics: LevelId,
    workspace: LevelId,
    goal: LevelId,
    posture: LevelId,
}

/// What the third level minimises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoalTerms<'a> {
    /// The person's ergonomics in the world, τ seconds ahead.
    pub ergonomics: Option<&'a ErgonomicsQuadratic>,
    /// The velocity at which the person walks, world axes \[m/s\]: fed forward, so that the
    /// optimum does not lag behind a walking person.
    pub drift: Vector3<f64>,
    /// From 0, the benchmark min ‖ẋ_d‖², to 1, ergonomics alone; between, both so weighted.
    pub activation: f64,
}

/// How the joints spread what no other level decides.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureTask {
    /// Preferred configuration \[m or rad\]; joints without a gain ignore it.
    pub configuration: Vec<f64>,
    /// Rate at which a joint returns to it \[1/s\]; zero for joints that should just rest.
    pub gain: Vec<f64>,
    /// Weight of a joint against the others \[-\].
    pub weight: Vec<f64>,
}

/// What does not change from tick to tick.
#[derive(Debug, Clone, PartialEq)]
pub struct StackSettings {
    /// The diagonal of K_p \[1/s\].
    pub gain: Vector6<f64>,
    /// Δt of the inverse kinematics \[s\].
    pub period: f64,
    /// τ of workspace and goal \[s\].
    pub horizon: f64,
    /// How the workspace gives way.
    pub softening: Softening,
    /// The wheel limit.
    pub base: Option<MecanumBase>,
    /// The last level.
    pub posture: PostureTask,
    /// What the solve of a tick may cost.
    pub budget: Budget,
}

/// The hierarchy of the levels and its solver; sized once, rewritten each tick.
#[derive(Debug, Clone)]
pub struct TaskStack {
    state: AugmentedState,
    hierarchy: Hierarchy,
    levels: Levels,
    solver: Solver,
    clik: AugmentedClik,
    soft: SoftWorkspace,
    base: Option<MecanumBase>,
    posture: PostureTask,
    horizon: f64,
    budget: Budget,
}

/// What a tick asks of the stack.
#[derive(Debug, Clone, Copy)]
pub struct StackInput<'a> {
    /// J, 6 × n.
    pub jacobian: &'a Matrix6xX<f64>,
    /// x_d(t−1) − x_a \[m, rad\].
    pub error: &'a Vector6<f64>,
    /// x_d(t−1).
    pub desired: &'a Isometry3<f64>,
    /// q \[m or rad\].
    pub configuration: &'a [f64],
    /// The shared workspace.
    pub workspace: &'a Workspace,
    /// The third level.
    pub goal: GoalTerms<'a>,
    /// Velocities that the joints may take, then those of ẋ_d.
    pub intervals: &'a [VelocityInterval],
    /// Velocities that bring joints back within their position limits; infinite ends for those
    /// that are within.
    pub returns: &'a [VelocityInterval],
    /// Separation from people and from the robot itself.
    pub safety: SafetyRows<'a>,
}

impl TaskStack {
    /// For n = `joints`, with blocks of the sizes of `safety`.
    ///
    /// # Errors
    /// Parameters out of range, or a posture of another size.
    pub fn new(
        joints: usize,
        settings: StackSettings,
        safety: SafetyRows<'_>,
    ) -> Result<Self, Error> {
        let StackSettings { gain, period, horizon, softening, base, posture, budget } = settings;
        let state = Self::layout(joints);
        let clik = AugmentedClik::new(state, PoseAxes::ALL, gain, period)?;
        let soft = SoftWorkspace::with_softening(state, horizon, softening)?;
        posture.check(joints)?;
        let mut hierarchy = Hierarchy::new(state.len())?;
        let wheels = base.map_or(Rows::zeros(0, state.len()), |base| base.rows(state));
        let separation = Level::least_squares(safety.separation.clone());
        let zero = (DMatrix::zeros(state.len(), state.len()), DVector::zeros(state.len()));
        let mut push = |name, level: Level| hierarchy.push(level.named(name));
        let levels = Levels {
            speed_cap: push("speed cap", Level::constraints_only(safety.cap.clone()))?,
            separation: push("separation", separation.with_constraints(wheels))?,
            own_bodies: push("own bodies", Level::least_squares(safety.own.clone()))?,
            returns: push("return into the limits", Level::least_squares(return_rows(state)?))?,
            kinematics: push("inverse kinematics", Level::least_squares(clik.rows()))?,
            workspace: push("shared workspace", soft.level()?)?,
            goal: push("goal", Level::quadratic(zero.0, zero.1)?)?,
            posture: push("posture", Level::least_squares(posture.rows(state)?))?,
        };
        let solver = Solver::new(&hierarchy, Settings::default())?;
        Ok(Self { state, hierarchy, levels, solver, clik, soft, base, posture, horizon, budget })
    }

    /// The layout of χ for n = `joints`.
    pub fn layout(joints: usize) -> AugmentedState {
        AugmentedState { joints, task: 6, slack: 6 }
    }

    /// The layout of χ.
    pub fn state(&self) -> AugmentedState {
        self.state
    }

    /// Writes the tick's data and solves.
    ///
    /// # Errors
    /// Data that are not finite or do not fit; the problem itself is always feasible.
    pub fn solve(&mut self, input: &StackInput<'_>) -> Result<&Solution, Error> {
        self.write_bounds(input.intervals);
        self.write_safety(input)?;
        self.write_kinematics(input)?;
        let level = self.hierarchy.level_mut(self.levels.workspace)?;
        self.soft.write(input.workspace, input.desired, level)?;
        self.write_goal(&input.goal, input.desired)?;
        self.write_posture(input.configuration)?;
        Ok(self.solver.solve_within(&self.hierarchy, self.budget)?)
    }

    fn write_bounds(&mut self, intervals: &[VelocityInterval]) {
        let (lower, upper) = self.hierarchy.bounds_mut();
        for ((lower, upper), interval) in lower.iter_mut().zip(upper).zip(intervals) {
            *lower = interval.lower;
            *upper = interval.upper;
        }
    }

    fn write_kinematics(&mut self, input: &StackInput<'_>) -> Result<(), Error> {
        let rows = self.hierarchy.rows_mut(self.levels.kinematics)?;
        Ok(self.clik.write(input.jacobian, input.error, rows)?)
    }

    fn write_safety(&mut self, input: &StackInput<'_>) -> Result<(), Error> {
        let (hierarchy, levels) = (&mut self.hierarchy, &self.levels);
        hierarchy.rows_mut(levels.own_bodies)?.copy_from(input.safety.own)?;
        hierarchy.constraints_mut(levels.speed_cap)?.copy_from(input.safety.cap)?;
        hierarchy.rows_mut(levels.separation)?.copy_from(input.safety.separation)?;
        if let (Some(base), Some(&yaw)) = (&self.base, input.configuration.get(2)) {
            base.write(yaw, input.intervals, hierarchy.constraints_mut(levels.separation)?)?;
        }
        let rows = hierarchy.rows_mut(levels.returns)?;
        for (bound, interval) in rows.lower_mut().iter_mut().zip(input.returns) {
            *bound = interval.lower;
        }
        for (bound, interval) in rows.upper_mut().iter_mut().zip(input.returns) {
            *bound = interval.upper;
        }
        Ok(())
    }

    /// activation · e_s(x_d + τ (ẋ_d − drift)) + (1 − activation) ‖ẋ_d‖², over ẋ_d.
    fn write_goal(&mut self, goal: &GoalTerms<'_>, desired: &Isometry3<f64>) -> Result<(), Error> {
        let ergonomics = match goal.ergonomics {
            Some(quadratic) if goal.activation > 0.0 => {
                let ahead = desired.translation.vector - goal.drift * self.horizon;
                Some(quadratic.task_terms(&ahead, self.horizon)?)
            }
            _ => None,
        };
        let share = if ergonomics.is_some() { goal.activation.min(1.0) } else { 0.0 };
        let (curvature, slope) = ergonomics
            .map_or((Matrix3::zeros(), Vector3::zeros()), |terms| (terms.hessian, terms.gradient));
        let velocity = self.state.desired_velocity().start;
        let (hessian, gradient) = self.hierarchy.quadratic_mut(self.levels.goal)?;
        for i in 0..6 {
            let at = velocity + i;
            hessian[(at, at)] = 2.0 * (1.0 - share);
            gradient[at] = if i < 3 { share * slope[i] } else { 0.0 };
        }
        for i in 0..3 {
            for j in 0..3 {
                let benchmark = if i == j { 2.0 * (1.0 - share) } else { 0.0 };
                hessian[(velocity + i, velocity + j)] = share * curvature[(i, j)] + benchmark;
            }
        }
        Ok(())
    }

    fn write_posture(&mut self, configuration: &[f64]) -> Result<(), Error> {
        let rows = self.hierarchy.rows_mut(self.levels.posture)?;
        let task = &self.posture;
        let rates = task
            .configuration
            .iter()
            .zip(configuration)
            .zip(task.gain.iter().zip(&task.weight))
            .map(|((goal, now), (gain, weight))| weight * gain * (goal - now));
        for (i, rate) in rates.enumerate() {
            rows.lower_mut()[i] = rate;
            rows.upper_mut()[i] = rate;
        }
        Ok(())
    }
}

/// The joints' velocities, within bounds still to be written.
fn return_rows(state: AugmentedState) -> Result<Rows, Error> {
    let matrix = DMatrix::identity(state.joints, state.len());
    Ok(Rows::equalities(&matrix, &DVector::zeros(state.joints))?)
}

impl PostureTask {
    fn check(&self, joints: usize) -> Result<(), Error> {
        for (what, values) in [
            ("posture.configuration", &self.configuration),
            ("posture.gain", &self.gain),
            ("posture.weight", &self.weight),
        ] {
            if values.len() != joints {
                return Err(Error::JointCount { what, found: values.len(), expected: joints });
            }
            if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
                return Err(Error::Setting { name: what, value, expected: "finite" });
            }
        }
        for (name, values) in [("posture.gain", &self.gain), ("posture.weight", &self.weight)] {
            if let Some(&value) = values.iter().find(|&&value| value < 0.0) {
                return Err(Error::Setting { name, value, expected: "not negative" });
            }
        }
        Ok(())
    }

    fn rows(&self, state: AugmentedState) -> Result<Rows, Error> {
        let n = state.joints;
        let matrix = DMatrix::from_fn(n, state.len(), |i, j| {
            if i == j { self.weight.get(i).copied().unwrap_or_default() } else { 0.0 }
        });
        Ok(Rows::equalities(&matrix, &DVector::zeros(n))?)
    }
}
